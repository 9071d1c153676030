//! State blocks of strapdown filters: one file per block, and what they share.
//!
//! A block's names, unit, equation and Jacobian come from its table (see [`tables`](crate::tables)); its file
//! adds what a table does not know: what it needs beside it, its prior and the unit of data sheets.

#[macro_use]
mod effect;

mod accel_bias;
mod accel_bias_drift;
mod accel_cross_coupling;
mod accel_cubic;
mod accel_delay;
mod accel_misalignment;
mod accel_quadratic;
mod accel_scale;
mod accel_scale_asymmetry;
mod accel_temperature_bias;
mod accel_temperature_rate;
mod accel_temperature_scale;
mod attitude;
mod dither;
mod dither_size_effect;
pub mod groups;
mod gyro_bias;
mod gyro_bias_drift;
mod gyro_g_sensitivity;
mod gyro_misalignment;
mod gyro_rate_nonlinearity;
mod gyro_scale;
mod gyro_scale_asymmetry;
mod gyro_temperature_bias;
mod inner_lever_arm;
mod inner_lever_arm_tangential;
mod open;
mod outer_lever_arm;
mod position;
mod reference_delay;
mod reference_misalignment;
mod reference_tilt;
mod velocity;

pub use accel_bias::AccelBias;
pub use accel_bias_drift::AccelBiasDrift;
pub use accel_cross_coupling::AccelCrossCoupling;
pub use accel_cubic::AccelCubic;
pub use accel_delay::AccelDelay;
pub use accel_misalignment::AccelMisalignment;
pub use accel_quadratic::AccelQuadratic;
pub use accel_scale::AccelScale;
pub use accel_scale_asymmetry::AccelScaleAsymmetry;
pub use accel_temperature_bias::AccelTemperatureBias;
pub use accel_temperature_rate::AccelTemperatureRate;
pub use accel_temperature_scale::AccelTemperatureScale;
pub use attitude::Attitude;
pub use dither::Dither;
pub use dither_size_effect::DitherSizeEffect;
pub use gyro_bias::GyroBias;
pub use gyro_bias_drift::GyroBiasDrift;
pub use gyro_g_sensitivity::GyroGSensitivity;
pub use gyro_misalignment::GyroMisalignment;
pub use gyro_rate_nonlinearity::GyroRateNonlinearity;
pub use gyro_scale::GyroScale;
pub use gyro_scale_asymmetry::GyroScaleAsymmetry;
pub use gyro_temperature_bias::GyroTemperatureBias;
pub use inner_lever_arm::InnerLeverArm;
pub use inner_lever_arm_tangential::InnerLeverArmTangential;
pub use open::{Open, OpenBlocks, OpenError};
pub use outer_lever_arm::OuterLeverArm;
pub use position::Position;
pub use reference_delay::ReferenceDelay;
pub use reference_misalignment::ReferenceMisalignment;
pub use reference_tilt::ReferenceTilt;
pub use velocity::Velocity;

/// Bits of the blocks, for [`Block::SET`](calib_core::Block::SET).
///
/// Bits from 31 on are free for blocks of other crates.
pub mod set {
    use calib_core::BlockSet;

    /// [`Attitude`](crate::Attitude).
    pub const ATTITUDE: BlockSet = BlockSet::only(0);
    /// [`Velocity`](crate::Velocity).
    pub const VELOCITY: BlockSet = BlockSet::only(1);
    /// [`Position`](crate::Position).
    pub const POSITION: BlockSet = BlockSet::only(2);
    /// [`Dither`](crate::Dither).
    pub const DITHER: BlockSet = BlockSet::only(3);
    /// [`GyroScale`](crate::GyroScale).
    pub const GYRO_SCALE: BlockSet = BlockSet::only(4);
    /// [`GyroMisalignment`](crate::GyroMisalignment).
    pub const GYRO_MISALIGNMENT: BlockSet = BlockSet::only(5);
    /// [`GyroBias`](crate::GyroBias).
    pub const GYRO_BIAS: BlockSet = BlockSet::only(6);
    /// [`AccelScale`](crate::AccelScale).
    pub const ACCEL_SCALE: BlockSet = BlockSet::only(7);
    /// [`AccelMisalignment`](crate::AccelMisalignment).
    pub const ACCEL_MISALIGNMENT: BlockSet = BlockSet::only(8);
    /// [`AccelBias`](crate::AccelBias).
    pub const ACCEL_BIAS: BlockSet = BlockSet::only(9);
    /// [`AccelQuadratic`](crate::AccelQuadratic).
    pub const ACCEL_QUADRATIC: BlockSet = BlockSet::only(10);
    /// [`OuterLeverArm`](crate::OuterLeverArm).
    pub const OUTER_LEVER_ARM: BlockSet = BlockSet::only(11);
    /// [`InnerLeverArm`](crate::InnerLeverArm).
    pub const INNER_LEVER_ARM: BlockSet = BlockSet::only(12);
    /// [`DitherSizeEffect`](crate::DitherSizeEffect).
    pub const DITHER_SIZE_EFFECT: BlockSet = BlockSet::only(13);
    /// [`AccelDelay`](crate::AccelDelay).
    pub const ACCEL_DELAY: BlockSet = BlockSet::only(14);
    /// [`AccelTemperatureScale`](crate::AccelTemperatureScale).
    pub const ACCEL_TEMPERATURE_SCALE: BlockSet = BlockSet::only(15);
    /// [`AccelTemperatureBias`](crate::AccelTemperatureBias).
    pub const ACCEL_TEMPERATURE_BIAS: BlockSet = BlockSet::only(16);
    /// [`AccelTemperatureRate`](crate::AccelTemperatureRate).
    pub const ACCEL_TEMPERATURE_RATE: BlockSet = BlockSet::only(17);
    /// [`GyroTemperatureBias`](crate::GyroTemperatureBias).
    pub const GYRO_TEMPERATURE_BIAS: BlockSet = BlockSet::only(18);
    /// [`GyroGSensitivity`](crate::GyroGSensitivity).
    pub const GYRO_G_SENSITIVITY: BlockSet = BlockSet::only(19);
    /// [`AccelScaleAsymmetry`](crate::AccelScaleAsymmetry).
    pub const ACCEL_SCALE_ASYMMETRY: BlockSet = BlockSet::only(20);
    /// [`GyroScaleAsymmetry`](crate::GyroScaleAsymmetry).
    pub const GYRO_SCALE_ASYMMETRY: BlockSet = BlockSet::only(21);
    /// [`AccelCubic`](crate::AccelCubic).
    pub const ACCEL_CUBIC: BlockSet = BlockSet::only(22);
    /// [`AccelCrossCoupling`](crate::AccelCrossCoupling).
    pub const ACCEL_CROSS_COUPLING: BlockSet = BlockSet::only(23);
    /// [`GyroRateNonlinearity`](crate::GyroRateNonlinearity).
    pub const GYRO_RATE_NONLINEARITY: BlockSet = BlockSet::only(24);
    /// [`AccelBiasDrift`](crate::AccelBiasDrift).
    pub const ACCEL_BIAS_DRIFT: BlockSet = BlockSet::only(25);
    /// [`GyroBiasDrift`](crate::GyroBiasDrift).
    pub const GYRO_BIAS_DRIFT: BlockSet = BlockSet::only(26);
    /// [`InnerLeverArmTangential`](crate::InnerLeverArmTangential).
    pub const INNER_LEVER_ARM_TANGENTIAL: BlockSet = BlockSet::only(27);
    /// [`ReferenceDelay`](crate::ReferenceDelay).
    pub const REFERENCE_DELAY: BlockSet = BlockSet::only(28);
    /// [`ReferenceMisalignment`](crate::ReferenceMisalignment).
    pub const REFERENCE_MISALIGNMENT: BlockSet = BlockSet::only(29);
    /// [`ReferenceTilt`](crate::ReferenceTilt).
    pub const REFERENCE_TILT: BlockSet = BlockSet::only(30);
}

/// Rules that several blocks share.
mod needs {
    use calib_core::Need;

    use super::set;

    pub(super) const ACCELEROMETER: Need = Need {
        any_of: set::ACCEL_SCALE.union(set::ACCEL_MISALIGNMENT).union(set::ACCEL_BIAS),
        message: "this effect distorts what the accelerometers read: declare their errors beside it, \
                  such as `AccelBias`",
    };

    pub(super) const ACCEL_BIAS: Need = Need {
        any_of: set::ACCEL_BIAS,
        message: "a drift of the accelerometers' biases starts from a bias: declare `AccelBias` beside it",
    };
}

/// Units of data sheets in SI.
pub(crate) mod units {
    use core::f64::consts::PI;

    pub(crate) const MILLI: f64 = 1e-3;
    pub(crate) const PPM: f64 = 1e-6;
    pub(crate) const HOUR: f64 = 3600.0;
    pub(crate) const DEGREE: f64 = PI / 180.0;
    pub(crate) const ARCSEC: f64 = DEGREE / 3600.0;
    pub(crate) const DEG_PER_HOUR: f64 = DEGREE / HOUR;
    /// Standard gravity, m/s^2.
    pub(crate) const GRAVITY: f64 = 9.80665;
    pub(crate) const MICRO_G: f64 = 1e-6 * GRAVITY;
}
