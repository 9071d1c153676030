use super::needs;
use super::units::{HOUR, MICRO_G};

effect! {
    /// Biases of the accelerometers that grow with time.
    ///
    /// - Equation: `d_f_i = k_i t`, t the time since the first sample. Not in the paper.
    /// - Sign: a positive state makes the accelerometer read more and more.
    /// - Prior: about 100 ug/h: the settling of an accelerometer after power-on.
    AccelBiasDrift {
        table: accel_bias_drift,
        jacobian: input,
        needs: &[needs::ACCEL_BIAS],
        prior: 3e-7,
        sheet: "ug/h" = MICRO_G / HOUR,
        kin: "accel-bias",
    }
}
