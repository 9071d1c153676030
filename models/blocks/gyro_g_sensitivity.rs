use super::units::{DEG_PER_HOUR, GRAVITY};

effect! {
    /// Drifts of the gyros under specific force along their own axes.
    ///
    /// - Equation: `d_omega_i = g_i f_i`. Not in the paper.
    /// - Sign: a positive state makes the gyro read more under a positive specific force.
    /// - Prior: 0.5 deg/h/g, as large as the default drift; a MEMS unit needs more.
    GyroGSensitivity {
        table: gyro_g_sensitivity,
        jacobian: input,
        needs: &[],
        prior: 0.5 * DEG_PER_HOUR / GRAVITY,
        sheet: "deg/h/g" = DEG_PER_HOUR / GRAVITY,
        kin: "gyro-bias",
    }
}
