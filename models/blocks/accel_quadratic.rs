use super::units::{GRAVITY, PPM};

effect! {
    /// Quadratic scale-factor errors of the accelerometers.
    ///
    /// - Equation: `d_f_i = k_i f_i^2` (Eq. 23, 35); `f_i^2`, not `f_i |f_i|`, where the paper leaves the
    ///   choice.
    /// - Sign: a positive state adds to the reading whichever way the force points.
    /// - Prior: about 200 ug/g^2, several times what a quartz accelerometer shows.
    AccelQuadratic {
        table: accel_quadratic,
        jacobian: input,
        needs: &[],
        prior: 2e-5,
        sheet: "ug/g^2" = PPM / GRAVITY,
        kin: "accel-scale",
    }
}
