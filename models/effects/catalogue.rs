//! The catalogue: every effect that the library knows, in one list.

use state_macro::StateBlocks;

use super::{AnyEffect, Effect, EffectInfo};
use crate::blocks::*;

/// Makes of one list of blocks the group of those that may be missing and the lists of their entries and objects.
macro_rules! catalogue {
    (missing { $($field:ident: $block:ident,)+ } joining { $($joining:ident,)+ } influences { $($from:ident,)+ }) => {
        /// The effects of the catalogue that may be missing in a filter, as one block, for code that lets a filter do without most of
        /// them. The others join a filter in its block [`Open`](crate::Open).
        #[derive(Debug, StateBlocks)]
        #[group]
        pub struct Catalogue {
            $($field: $block,)+
        }

        /// The entries of the catalogue, in order.
        pub static EFFECTS: &[EffectInfo] = &[$(<$block as Effect>::EFFECT,)+ $(<$joining as Effect>::EFFECT,)+ $(<$from as Effect>::EFFECT,)+];

        /// The effects of the catalogue, in order.
        pub static CATALOGUE: &[&dyn AnyEffect] =
            &[$(<dyn AnyEffect>::of::<$block>(),)+ $(<dyn AnyEffect>::of::<$joining>(),)+ $(<dyn AnyEffect>::of::<$from>(),)+];

        /// The effects of the chain of measurement: of site, clock, thermometers, pick-offs and reference, not of the unit. What a log
        /// does not show of them is considered.
        pub static INFLUENCES: &[&str] = &[$(<$from as calib_core::Block>::NAME,)+];
    };
}

catalogue! {
    missing {
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
    joining {
        GyroBiasWander,
        AccelBiasWander,
        GyroBiasRandomWalk,
        AccelBiasRandomWalk,
    }
    influences {
        ClockScale,
        SiteLatitude,
        SiteHeight,
        SiteGravity,
        ThermometerLag,
        ThermometerScale,
        ThermometerOffset,
        DitherScale,
        ReferenceScale,
        TableOrthogonality,
    }
}

/// The entry of the effect called `name`: of the catalogue, or a [`Law`](crate::Law).
pub fn effect(name: &str) -> Option<&'static EffectInfo> {
    EFFECTS.iter().find(|effect| effect.name() == name).or_else(|| law(name).map(AnyEffect::info))
}

/// The effect called `name`: of the catalogue, or a [`Law`](crate::Law).
pub fn any_effect(name: &str) -> Option<&'static dyn AnyEffect> {
    CATALOGUE.iter().copied().find(|effect| effect.name() == name).or_else(|| law(name))
}

#[cfg(feature = "std")]
fn law(name: &str) -> Option<&'static dyn AnyEffect> {
    Some(super::Law::named(name)?.effect())
}

/// Without an allocator there are none.
#[cfg(not(feature = "std"))]
fn law(_: &str) -> Option<&'static dyn AnyEffect> {
    None
}
