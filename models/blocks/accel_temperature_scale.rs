use super::needs;
use super::units::PPM;

effect! {
    /// Scale factors of the accelerometers that change with temperature.
    ///
    /// - Equation: `d_f_i = k_i (T_i - T_ref) f_i`, T_i the temperature at accelerometer i (Eq. 35). The
    ///   paper calls it a temperature scale-factor error; forms that do not multiply the force are blocks of
    ///   their own.
    /// - Sign: a positive state makes the accelerometer read more in size when it is warmer than the
    ///   reference.
    /// - Prior: 50 ppm/K: a quartz accelerometer without compensation, taken generously.
    AccelTemperatureScale {
        table: accel_temperature_scale,
        jacobian: input,
        needs: &[needs::ACCELEROMETER],
        prior: 5e-5,
        sheet: "ppm/K" = PPM,
        kin: "accel-scale",
    }
}
