use super::units::{DEG_PER_HOUR, HOUR};

effect! {
    /// Drifts of the gyros that grow with time.
    ///
    /// - Equation: `d_omega_i = k_i t`, t the time since the first sample. Not in the paper.
    /// - Sign: a positive state makes the gyro read more and more.
    /// - Prior: a tenth of the default drift in each hour.
    GyroBiasDrift {
        table: gyro_bias_drift,
        jacobian: input,
        needs: &[],
        prior: 0.05 * DEG_PER_HOUR / HOUR,
        sheet: "deg/h/h" = DEG_PER_HOUR / HOUR,
        kin: "gyro-bias",
    }
}
