use super::units::{DEGREE, PPM};

effect! {
    /// Scale factors of the gyros that change with the size of the rate.
    ///
    /// - Equation: `d_omega_i = k_i omega_i |omega_i|`. Not in the paper.
    /// - Observability: needs turns at more than one rate.
    /// - Sign: a positive state makes the gyro read more in size, the more the faster.
    /// - Prior: about 50 ppm at 10 deg/s.
    GyroRateNonlinearity {
        table: gyro_rate_nonlinearity,
        jacobian: input,
        needs: &[],
        prior: 3e-4,
        sheet: "ppm/(deg/s)" = PPM / DEGREE,
        kin: "gyro-scale",
    }
}
