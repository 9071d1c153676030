use super::units::MICRO_G;

effect! {
    /// Constant biases of the accelerometers.
    ///
    /// - Equation: `d_f_i = b_i` (Eq. 23, 35).
    /// - Sign: a positive state makes the accelerometer read more than the truth.
    /// - Prior: about 1000 ug: a quartz accelerometer before calibration.
    AccelBias {
        table: accel_bias,
        jacobian: input,
        needs: &[],
        prior: 1e-2,
        sheet: "ug" = MICRO_G,
    }
}
