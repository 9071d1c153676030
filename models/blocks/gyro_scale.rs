use super::units::PPM;

effect! {
    /// Scale-factor errors of the gyros.
    ///
    /// - Equation: `d_omega_i = s_i omega_i`, omega the rate against inertial space in b (Eq. 22, 24-34).
    /// - Sign: a positive state makes the gyro read more than the truth in size.
    /// - Prior: 300 ppm: a ring-laser or fibre-optic gyro before calibration.
    GyroScale {
        table: gyro_scale,
        jacobian: input,
        needs: &[],
        prior: 3e-4,
        sheet: "ppm" = PPM,
    }
}
