use super::units::MILLI;

effect! {
    /// Inner lever arms: each accelerometer's displacement along its own axis.
    ///
    /// - Frame: accelerometer i sits at `r_i` along axis i of b, from the IMU's sensitive centre.
    /// - Equation: `d_f_i = -(omega_j^2 + omega_k^2 + A_j^2/2 + A_k^2/2) r_i`, j and k the other axes (Eq.
    ///   1-11). The mean square of the dither, `A^2/2`, counts only where a declaration has
    ///   [`Dither`](crate::Dither) beside this block.
    /// - Sign: an accelerometer displaced outwards reads less.
    /// - Prior: 0.1 m: the accelerometers are inside the case.
    InnerLeverArm {
        table: inner_lever_arm,
        jacobian: input,
        needs: &[],
        prior: 0.1,
        sheet: "mm" = MILLI,
    }
}
