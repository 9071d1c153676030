use super::units::DEG_PER_HOUR;

effect! {
    /// Drifts of the gyros that change with temperature.
    ///
    /// - Equation: `d_omega_i = k_i (T_gi - T_ref)`, T_gi the temperature at gyro i. Not in the paper.
    /// - Sign: a positive state makes the gyro read more when it is warmer than the reference.
    /// - Prior: a tenth of the default drift per kelvin.
    GyroTemperatureBias {
        table: gyro_temperature_bias,
        jacobian: input,
        needs: &[],
        prior: 0.05 * DEG_PER_HOUR,
        sheet: "deg/h/K" = DEG_PER_HOUR,
        kin: "gyro-bias",
    }
}
