use super::needs;
use super::units::MILLI;

effect! {
    /// Delay of the accelerometers against the gyros: tau.
    ///
    /// - Equation: `d_f = f(t - tau) - f(t) = -tau f_b'`, the whole derivative of the specific force along the axes of b:
    ///   `f_b' = -omega x f + C' d(f_n)/dt`. Where the specific force in n is constant, on a turntable, this is
    ///   `tau (omega x f)` (Eq. 12-21).
    /// - Sign: positive when the sample stamped t was felt at t - tau.
    /// - Small: first order in tau; a change of acceleration within 10 ms, over which [`Compensator`](crate::Compensator) smooths it, or
    ///   within tau itself is not followed.
    /// - Prior: 5 ms: a fraction of a sampling interval at 50 to 100 Hz.
    AccelDelay {
        table: accel_delay,
        jacobian: input,
        needs: &[needs::ACCELEROMETER],
        prior: 5e-3,
        sheet: "ms" = MILLI,
    }
}
