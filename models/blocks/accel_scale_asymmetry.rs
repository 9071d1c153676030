use super::needs;
use super::units::PPM;

effect! {
    /// Scale factors of the accelerometers that differ between the two senses of force.
    ///
    /// - Equation: `d_f_i = k_i |f_i|`. Not in the paper.
    /// - Sign: a positive state adds to the reading whichever way the force points; k is half the difference
    ///   of the two scale factors.
    /// - Prior: 100 ppm, a tenth of the default scale-factor error.
    AccelScaleAsymmetry {
        table: accel_scale_asymmetry,
        jacobian: input,
        needs: &[needs::ACCELEROMETER],
        prior: 1e-4,
        sheet: "ppm" = PPM,
        kin: "accel-scale",
    }
}
