use super::relaxes;
use super::units::MICRO_G;

effect! {
    /// Biases of the accelerometers that walk away from what they were at the first row.
    ///
    /// - Equation: `d_f_i = b_i`, `b_i' = w_i`, zero at the first row. Not in the paper.
    /// - Sign: a positive state makes the accelerometer read more than the truth.
    /// - Prior: what is known at the first row, where next to nothing has gathered: 0.05 ug, the walk of a second. The walk is
    ///   3 ug/sqrt(h); [`Setup::wander`](crate::Setup::wander) states another.
    /// - The state is what has gathered until the end of the log; the bias at the first row is that of
    ///   [`AccelBias`](crate::AccelBias).
    AccelBiasRandomWalk {
        table: accel_bias_random_walk,
        jacobian: input,
        needs: &[],
        prior: 0.05 * MICRO_G,
        sheet: "ug" = MICRO_G,
        kin: "accel-bias",
        relaxes: relaxes::walking(3.0 * MICRO_G / 60.0),
    }
}
