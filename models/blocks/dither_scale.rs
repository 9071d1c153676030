effect! {
    /// Scale of the pick-offs that tell the dither's amplitudes.
    ///
    /// - Equation: `A_read = (1 + k) A`, through the inner lever arms that are estimated. Not in the paper.
    /// - Sign: positive where the amplitudes are told too large.
    /// - Prior: 2 %.
    DitherScale {
        table: dither_scale,
        jacobian: input,
        needs: &[],
        prior: 2e-2,
        sheet: "%" = 1e-2,
    }
}
