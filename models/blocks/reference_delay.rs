use super::units::MILLI;

effect! {
    /// How late the reference is stamped: tau.
    ///
    /// - Equation: the reading at stamp t shows the state at t - tau, so the prediction is made for t - tau:
    ///   `z_v` changes by the observed point's acceleration, `z_p` by its velocity, `z_a` by `-C omega_eb`.
    ///   Not in the paper.
    /// - Left out: the observed point's acceleration is that of the IMU and `omega x (omega x l)`. What the angular acceleration adds
    ///   over the lever arm, and Coriolis acceleration, is missing tau times in `z_v`: 1 mm/s for 0.1 m/s^2 and
    ///   10 ms. Position and attitude have no such term.
    /// - Sign: positive when the stamp is later than the event.
    /// - Prior: 10 ms: a reference over a serial line.
    ReferenceDelay {
        table: reference_delay,
        jacobian: measurement,
        needs: &[],
        prior: 1e-2,
        sheet: "ms" = MILLI,
    }
}
