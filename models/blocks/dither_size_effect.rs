use super::units::MILLI;

effect! {
    /// The size effect of dither with states of its own.
    ///
    /// - Frame: displacements along the axes of b, as in [`InnerLeverArm`](crate::InnerLeverArm).
    /// - Equation: `d_f_i = -(A_j^2/2 + A_k^2/2) r_i`, j and k the other axes (Eq. 6-11).
    /// - Use: to ask whether dither is what a model lacks. A filter that knows takes
    ///   [`Dither`](crate::Dither), which needs no states.
    /// - Sign: an accelerometer displaced outwards reads less.
    /// - Prior: 0.1 m: the accelerometers are inside the case.
    DitherSizeEffect {
        table: dither_size_effect,
        jacobian: input,
        needs: &[],
        prior: 0.1,
        sheet: "mm" = MILLI,
    }
}
