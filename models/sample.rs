//! One row of a log, and the description that goes with the table, in SI units.

use nalgebra::{UnitQuaternion, Vector3};

use crate::OpenBlocks;

/// One IMU sample at the end of its sampling interval, with the reference where there is one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// End of the interval, s.
    pub time: f64,
    /// Gyro angle increments over the interval, b, rad.
    pub dtheta: Vector3<f64>,
    /// Accelerometer velocity increments over the interval, b, m/s.
    pub dvel: Vector3<f64>,
    /// Temperature at each accelerometer, degC; a NaN component is no new reading.
    pub temperature: Vector3<f64>,
    /// Temperature at each gyro, degC; a NaN component is no new reading.
    pub gyro_temperature: Vector3<f64>,
    /// Amplitude of the sensor block's dither rate about each axis, rad/s; a NaN component is no new reading.
    pub dither: Vector3<f64>,
    /// What the reference says at this instant.
    pub reference: Reference,
}

/// What the reference says about the observed point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reference {
    /// Velocity over ground, ENU, m/s.
    pub velocity: Option<Vector3<f64>>,
    /// Position from the site origin, ENU, m.
    pub position: Option<Vector3<f64>>,
    /// Attitude of the reference's body frame, C_bn.
    pub attitude: Option<UnitQuaternion<f64>>,
}

/// What must be known to run a filter over a log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup<'a> {
    /// Nominal sampling rate of the IMU, Hz.
    pub rate: f64,
    /// Where the log was taken.
    pub site: Site,
    /// Attitude at the start of the first interval.
    pub initial: InitialAttitude,
    /// Standard deviations of one reference reading.
    pub reference: ReferenceSigma,
    /// The reference is used at most this often, Hz.
    pub update_rate: f64,
    /// Random walks of the sensors.
    pub noise: SensorNoise,
    /// Temperature at which temperature effects vanish, degC.
    pub reference_temperature: f64,
    /// First guess of the outer lever arm, b, m: from the IMU's sensitive centre to the observed point.
    pub outer_lever: Vector3<f64>,
    /// Prior standard deviations that replace a block's default, by block name, SI.
    pub priors: &'a [(&'a str, f64)],
    /// What joins a filter with the block [`Open`](crate::Open).
    pub open: OpenBlocks,
}

/// The origin of the local frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site {
    /// Geodetic latitude, rad.
    pub latitude: f64,
    /// Longitude, rad.
    pub longitude: f64,
    /// Height over the ellipsoid, m.
    pub height: f64,
}

/// Coarse attitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InitialAttitude {
    /// C_bn.
    pub attitude: UnitQuaternion<f64>,
    /// Standard deviation of the tilt about east and about north, rad.
    pub level_sigma: f64,
    /// Standard deviation of the rotation about up, rad.
    pub heading_sigma: f64,
}

/// Standard deviations of one reference reading, per component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferenceSigma {
    /// Velocity, m/s.
    pub velocity: f64,
    /// Position, m.
    pub position: f64,
    /// Attitude, rad.
    pub attitude: f64,
}

/// Random walks of the sensors, the same on each axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorNoise {
    /// Angle random walk, rad/sqrt(s).
    pub angle_random_walk: f64,
    /// Velocity random walk, (m/s)/sqrt(s).
    pub velocity_random_walk: f64,
}
