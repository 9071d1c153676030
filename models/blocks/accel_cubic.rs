use super::needs;
use super::units::{GRAVITY, PPM};

effect! {
    /// Cubic scale-factor errors of the accelerometers.
    ///
    /// - Equation: `d_f_i = k_i f_i^3`. Not in the paper.
    /// - Observability: needs forces of more than one size; at rest only gravity's components give them.
    /// - Sign: a positive state makes the accelerometer read more in size.
    /// - Prior: about 200 ug/g^3, as large as the default quadratic error at 1 g.
    AccelCubic {
        table: accel_cubic,
        jacobian: input,
        needs: &[needs::ACCELEROMETER],
        prior: 2e-6,
        sheet: "ug/g^3" = PPM / (GRAVITY * GRAVITY),
        kin: "accel-scale",
    }
}
