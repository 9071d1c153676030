use super::units::PPM;

effect! {
    /// Scale-factor errors of the accelerometers.
    ///
    /// - Equation: `d_f_i = s_i f_i` (Eq. 23, 35).
    /// - Sign: a positive state makes the accelerometer read more than the truth in size.
    /// - Prior: 1000 ppm: a quartz accelerometer before calibration.
    AccelScale {
        table: accel_scale,
        jacobian: input,
        needs: &[],
        prior: 1e-3,
        sheet: "ppm" = PPM,
    }
}
