use super::needs;
use super::units::MILLI;

effect! {
    /// Delay of the accelerometers against the gyros: tau.
    ///
    /// - Equation: `d_f = f(t - tau) - f(t) = tau (omega x f)`, for a specific force that is constant in n
    ///   (Eq. 12-21).
    /// - Sign: positive when the sample stamped t was felt at t - tau.
    /// - Prior: 5 ms: a fraction of a sampling interval at 50 to 100 Hz.
    AccelDelay {
        table: accel_delay,
        jacobian: input,
        needs: &[needs::ACCELEROMETER],
        prior: 5e-3,
        sheet: "ms" = MILLI,
    }
}
