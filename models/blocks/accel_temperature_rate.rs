use super::needs;
use super::units::MICRO_G;

effect! {
    /// Biases of the accelerometers while they warm up or cool down.
    ///
    /// - Equation: `d_f_i = k_i dT_i/dt`, T_i the temperature at accelerometer i. Not in the paper.
    /// - Sign: a positive state makes the accelerometer read more while it warms up.
    /// - Prior: about 85 ug at 1 K/min, a brisk warm-up.
    AccelTemperatureRate {
        table: accel_temperature_rate,
        jacobian: input,
        needs: &[needs::ACCELEROMETER],
        prior: 0.05,
        sheet: "ug/(K/min)" = 60.0 * MICRO_G,
        kin: "accel-bias",
    }
}
