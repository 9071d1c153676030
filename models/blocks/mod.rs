//! State blocks of strapdown filters: one file per block, and what they share.
//!
//! A block's names, unit, equation and Jacobian come from its table (see [`tables`](crate::tables)); its file
//! adds what a table does not know: what it needs beside it, its prior and the unit of data sheets.

#[macro_use]
mod effect;

mod accel_bias;
mod accel_bias_drift;
mod accel_bias_random_walk;
mod accel_bias_wander;
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
mod clock_scale;
mod dither;
mod dither_scale;
mod dither_size_effect;
pub mod groups;
mod gyro_bias;
mod gyro_bias_drift;
mod gyro_bias_random_walk;
mod gyro_bias_wander;
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
mod reference_scale;
mod reference_tilt;
mod site_gravity;
mod site_height;
mod site_latitude;
mod table_orthogonality;
mod thermometer_lag;
mod thermometer_offset;
mod thermometer_scale;
mod velocity;

pub use accel_bias::AccelBias;
pub use accel_bias_drift::AccelBiasDrift;
pub use accel_bias_random_walk::AccelBiasRandomWalk;
pub use accel_bias_wander::AccelBiasWander;
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
pub use clock_scale::ClockScale;
pub use dither::Dither;
pub use dither_scale::DitherScale;
pub use dither_size_effect::DitherSizeEffect;
pub use gyro_bias::GyroBias;
pub use gyro_bias_drift::GyroBiasDrift;
pub use gyro_bias_random_walk::GyroBiasRandomWalk;
pub use gyro_bias_wander::GyroBiasWander;
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
pub use reference_scale::ReferenceScale;
pub use reference_tilt::ReferenceTilt;
pub use site_gravity::SiteGravity;
pub use site_height::SiteHeight;
pub use site_latitude::SiteLatitude;
pub use table_orthogonality::TableOrthogonality;
pub use thermometer_lag::ThermometerLag;
pub use thermometer_offset::ThermometerOffset;
pub use thermometer_scale::ThermometerScale;
pub use velocity::Velocity;

/// Rules that several blocks share.
mod needs {
    use calib_core::{Block, Need};

    use super::{AccelBias, AccelMisalignment, AccelScale};

    pub(super) const ACCELEROMETER: Need = Need {
        any_of: &[AccelScale::NAME, AccelMisalignment::NAME, AccelBias::NAME],
        message: "this effect distorts what the accelerometers read: declare their errors beside it, \
                  such as `AccelBias`",
    };

    pub(super) const ACCEL_BIAS: Need = Need {
        any_of: &[AccelBias::NAME],
        message: "a drift of the accelerometers' biases starts from a bias: declare `AccelBias` beside it",
    };
}

/// How biases wander.
mod relaxes {
    use calib_core::Relaxation;

    use super::units::HOUR;

    /// Within an hour, with a standard deviation that stays what it is.
    pub(super) const fn stationary(sigma: f64) -> Relaxation<f64> {
        Relaxation { rate: 1.0 / HOUR, density: 2.0 * sigma * sigma / HOUR }
    }

    /// Without bound: so much more in the square root of a second.
    pub(super) const fn walking(walk: f64) -> Relaxation<f64> {
        Relaxation { rate: 0.0, density: walk * walk }
    }
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
    /// m/s^2.
    pub(crate) const MILLI_GAL: f64 = 1e-5;
    pub(crate) const MICRO_G: f64 = 1e-6 * GRAVITY;
}
