effect! {
    /// Offset of the thermometers at the accelerometers and of those at the gyros.
    ///
    /// - Equation: `T_read = T + o`, through every temperature coefficient that is estimated. Not in the paper.
    /// - Sign: positive where the thermometers read too much.
    /// - Prior: 0.5 K.
    ThermometerOffset {
        table: thermometer_offset,
        jacobian: input,
        needs: &[],
        prior: 0.5,
        sheet: "K" = 1.0,
    }
}
