//! The catalogue: every effect that the library knows, in one list.

use state_macro::StateBlocks;

use super::{AnyEffect, Effect, EffectInfo};
use crate::blocks::*;

/// Makes of one list of blocks the group of them all and the lists of their entries and objects.
macro_rules! catalogue {
    ($($field:ident: $block:ident,)+) => {
        /// Every effect of the catalogue as one block, for code that lets a filter do without most of them.
        #[derive(Debug, StateBlocks)]
        #[group]
        pub struct Catalogue {
            $($field: $block,)+
        }

        /// The entries of the catalogue, in order.
        pub static EFFECTS: &[EffectInfo] = &[$(<$block as Effect>::EFFECT),+];

        /// The effects of the catalogue, in order.
        pub static CATALOGUE: &[&dyn AnyEffect] = &[$(<dyn AnyEffect>::of::<$block>()),+];
    };
}

catalogue! {
    gyro_scale: GyroScale,
    gyro_misalignment: GyroMisalignment,
    gyro_bias: GyroBias,
    accel_scale: AccelScale,
    accel_misalignment: AccelMisalignment,
    accel_bias: AccelBias,
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

/// The entry of the catalogue that is called `name`.
pub fn effect(name: &str) -> Option<&'static EffectInfo> {
    EFFECTS.iter().find(|effect| effect.name() == name)
}

/// The effect of the catalogue that is called `name`.
pub fn any_effect(name: &str) -> Option<&'static dyn AnyEffect> {
    CATALOGUE.iter().copied().find(|effect| effect.name() == name)
}
