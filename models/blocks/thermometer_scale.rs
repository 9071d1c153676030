effect! {
    /// Scale of the thermometers at the accelerometers and of those at the gyros.
    ///
    /// - Equation: `T_read - T_ref = (1 + s) (T - T_ref)`, through every temperature coefficient that is estimated. Not in the paper.
    /// - Sign: positive where the thermometers tell too large differences.
    /// - Prior: 0.5 %.
    ThermometerScale {
        table: thermometer_scale,
        jacobian: input,
        needs: &[],
        prior: 5e-3,
        sheet: "%" = 1e-2,
    }
}
