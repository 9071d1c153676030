use super::relaxes;
use super::units::DEG_PER_HOUR;

effect! {
    /// Biases of the gyros that wander about their mean: the bias instability of a data sheet.
    ///
    /// - Equation: `d_omega_i = eps_i`, `eps_i' = -eps_i / tau + w_i`: first-order Gauss-Markov, stationary. Not in the paper.
    /// - Sign: a positive state makes the gyro read more than the truth.
    /// - Prior: 0.02 deg/h, which is also the standard deviation at any later time, and a correlation time of an hour;
    ///   [`Setup::wander`](crate::Setup::wander) states others.
    /// - The state is the wander at the end of the log; the mean is that of [`GyroBias`](crate::GyroBias).
    GyroBiasWander {
        table: gyro_bias_wander,
        jacobian: input,
        needs: &[],
        prior: 0.02 * DEG_PER_HOUR,
        sheet: "deg/h" = DEG_PER_HOUR,
        kin: "gyro-bias",
        relaxes: relaxes::stationary(0.02 * DEG_PER_HOUR),
    }
}
