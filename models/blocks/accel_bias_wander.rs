use super::relaxes;
use super::units::MICRO_G;

effect! {
    /// Biases of the accelerometers that wander about their mean: the bias instability of a data sheet.
    ///
    /// - Equation: `d_f_i = b_i`, `b_i' = -b_i / tau + w_i`: first-order Gauss-Markov, stationary. Not in the paper.
    /// - Sign: a positive state makes the accelerometer read more than the truth.
    /// - Prior: 5 ug, which is also the standard deviation at any later time, and a correlation time of an hour;
    ///   [`Setup::wander`](crate::Setup::wander) states others.
    /// - The state is the wander at the end of the log; the mean is that of [`AccelBias`](crate::AccelBias).
    AccelBiasWander {
        table: accel_bias_wander,
        jacobian: input,
        needs: &[],
        prior: 5.0 * MICRO_G,
        sheet: "ug" = MICRO_G,
        kin: "accel-bias",
        relaxes: relaxes::stationary(5.0 * MICRO_G),
    }
}
