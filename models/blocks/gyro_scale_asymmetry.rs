use super::units::PPM;

effect! {
    /// Scale factors of the gyros that differ between the two senses of rotation.
    ///
    /// - Equation: `d_omega_i = k_i |omega_i|`. Not in the paper.
    /// - Sign: a positive state adds to the reading whichever way the body turns; k is half the difference of
    ///   the two scale factors.
    /// - Prior: 30 ppm, a tenth of the default scale-factor error.
    GyroScaleAsymmetry {
        table: gyro_scale_asymmetry,
        jacobian: input,
        needs: &[],
        prior: 3e-5,
        sheet: "ppm" = PPM,
        kin: "gyro-scale",
    }
}
