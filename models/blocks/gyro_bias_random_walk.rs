use super::relaxes;
use super::units::DEG_PER_HOUR;

effect! {
    /// Biases of the gyros that walk away from what they were at the first row.
    ///
    /// - Equation: `d_omega_i = eps_i`, `eps_i' = w_i`, zero at the first row. Not in the paper.
    /// - Sign: a positive state makes the gyro read more than the truth.
    /// - Prior: what is known at the first row, where next to nothing has gathered: 2e-5 deg/h, the walk of a second. The walk is
    ///   0.001 deg/h/sqrt(h); [`Setup::wander`](crate::Setup::wander) states another.
    /// - The state is what has gathered until the end of the log; the bias at the first row is that of [`GyroBias`](crate::GyroBias).
    GyroBiasRandomWalk {
        table: gyro_bias_random_walk,
        jacobian: input,
        needs: &[],
        prior: 2e-5 * DEG_PER_HOUR,
        sheet: "deg/h" = DEG_PER_HOUR,
        kin: "gyro-bias",
        relaxes: relaxes::walking(0.001 * DEG_PER_HOUR / 60.0),
    }
}
