//! The effects that are priced against a filter.

use sinscal::prelude::*;
use sinscal::{EffectInfo, Setup, effect};

/// Every effect of the catalogue that a filter may do without: 21 effects, 61 states.
///
/// Only scale factors, installation errors and biases are missing from it: every filter has them. A user's own effect is
/// priced beside these by a group of both:
///
/// ```
/// # use sinscal::prelude::*;
/// # type MyEffect = Dither;
/// #[derive(StateBlocks)]
/// #[group]
/// struct Mine {
///     known: gap::Candidates,
///     own: MyEffect,
/// }
/// ```
#[derive(Debug, StateBlocks)]
#[group]
pub struct Candidates {
    accel_quadratic: AccelQuadratic,
    outer_lever_arm: OuterLeverArm,
    inner_lever_arm: InnerLeverArm,
    dither_size_effect: DitherSizeEffect,
    accel_delay: AccelDelay,
    accel_temperature_scale: AccelTemperatureScale,
    accel_temperature_bias: AccelTemperatureBias,
    accel_temperature_rate: AccelTemperatureRate,
    gyro_temperature_bias: GyroTemperatureBias,
    gyro_g_sensitivity: GyroGSensitivity,
    accel_scale_asymmetry: AccelScaleAsymmetry,
    gyro_scale_asymmetry: GyroScaleAsymmetry,
    accel_cubic: AccelCubic,
    accel_cross_coupling: AccelCrossCoupling,
    gyro_rate_nonlinearity: GyroRateNonlinearity,
    accel_bias_drift: AccelBiasDrift,
    gyro_bias_drift: GyroBiasDrift,
    inner_lever_arm_tangential: InnerLeverArmTangential,
    reference_delay: ReferenceDelay,
    reference_misalignment: ReferenceMisalignment,
    reference_tilt: ReferenceTilt,
}

/// Factor on the default prior of a candidate that the description of the log does not name: how much larger than its
/// default the stated prior of its kin is ([`EffectInfo::kin`]).
pub(crate) fn prior_factor(setup: &Setup, block: &str) -> f64 {
    let stated = |name: &str| setup.priors.iter().find(|(n, _)| *n == name).map(|(_, sigma)| *sigma);
    if stated(block).is_some() {
        return 1.0;
    }
    let Some(kin) = effect(block).and_then(EffectInfo::kin) else { return 1.0 };
    match (stated(kin), effect(kin)) {
        (Some(stated), Some(effect)) if effect.prior_sigma > 0.0 => (stated / effect.prior_sigma).max(1.0),
        _ => 1.0,
    }
}
