use super::units::DEG_PER_HOUR;

effect! {
    /// Constant drifts of the gyros.
    ///
    /// - Equation: `d_omega_i = eps_i` (Eq. 22, 24-34).
    /// - Sign: a positive state makes the gyro read more than the truth.
    /// - Prior: 0.5 deg/h: a navigation-grade gyro before calibration.
    GyroBias {
        table: gyro_bias,
        jacobian: input,
        needs: &[],
        prior: 0.5 * DEG_PER_HOUR,
        sheet: "deg/h" = DEG_PER_HOUR,
    }
}
