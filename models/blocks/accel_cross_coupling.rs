use super::needs;
use super::units::{GRAVITY, PPM};

effect! {
    /// Products of the forces along the other two axes that an accelerometer reads.
    ///
    /// - Equation: `d_f_i = k_i f_j f_k`, j and k the other axes. Not in the paper.
    /// - Sign: a positive state adds to the reading when both other forces have the same sign.
    /// - Prior: as the default quadratic error.
    AccelCrossCoupling {
        table: accel_cross_coupling,
        jacobian: input,
        needs: &[needs::ACCELEROMETER],
        prior: 2e-5,
        sheet: "ug/g^2" = PPM / GRAVITY,
        kin: "accel-scale",
    }
}
