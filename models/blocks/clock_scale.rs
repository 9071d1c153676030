use super::units::PPM;

effect! {
    /// Scale of the clock that stamps the samples: an interval of a stamped second lasts (1 + c) seconds.
    ///
    /// - Equation: `d_omega = c omega_ie`, `d_f = c g up`: increments are angles and velocities whatever the clock says, and the Earth's
    ///   rotation and gravity go on for longer. Not in the paper. Of a unit near its place: of one that travels the way is longer too.
    /// - Sign: positive where the clock is slow.
    /// - Prior: 1 ppm: a good crystal.
    ClockScale {
        table: clock_scale,
        jacobian: input,
        needs: &[],
        prior: PPM,
        sheet: "ppm" = PPM,
    }
}
