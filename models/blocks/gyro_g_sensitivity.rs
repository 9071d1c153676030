use super::units::{DEG_PER_HOUR, GRAVITY};

effect! {
    /// Drifts of the gyros under specific force, along their own axes and across them: xx, xy, xz, yx, yy, yz, zx, zy, zz.
    ///
    /// - Equation: `d_omega_i = g_ix f_x + g_iy f_y + g_iz f_z`; `xy` is what gyro x reads of the force along y. Not in the paper.
    /// - Sign: a positive state makes the gyro read more under a positive specific force.
    /// - Observability: alike on all three axes it is a rate about the vertical, which turns a heading that nobody measures.
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
