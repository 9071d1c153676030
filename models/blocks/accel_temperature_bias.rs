use super::needs;
use super::units::MICRO_G;

effect! {
    /// Biases of the accelerometers that change with temperature.
    ///
    /// - Equation: `d_f_i = k_i (T_i - T_ref)`, T_i the temperature at accelerometer i. Not in the paper.
    /// - Sign: a positive state makes the accelerometer read more when it is warmer than the reference.
    /// - Prior: about 10 ug/K: a quartz accelerometer without compensation.
    AccelTemperatureBias {
        table: accel_temperature_bias,
        jacobian: input,
        needs: &[needs::ACCELEROMETER],
        prior: 1e-4,
        sheet: "ug/K" = MICRO_G,
        kin: "accel-bias",
    }
}
