effect! {
    /// Lag of the thermometers at the accelerometers and of those at the gyros.
    ///
    /// - Equation: `T_read = T - tau dT/dt`, through every temperature coefficient that is estimated. Not in the paper.
    /// - Sign: positive where the thermometers are late.
    /// - Prior: 20 s: a thermometer glued to the case of a sensor.
    ThermometerLag {
        table: thermometer_lag,
        jacobian: input,
        needs: &[],
        prior: 20.0,
        sheet: "s" = 1.0,
    }
}
