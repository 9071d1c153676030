//! What the sensor-error models depend on.

use calib_core::Real;
use nalgebra::Vector3;

use crate::OpenBlocks;

/// The true motion and environment at one instant, as the error models see it.
///
/// All vectors have components along the body axes right, forward, up; accelerometer i and gyro i stand on
/// axis i. "Error" of a sensor is measured minus true.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Signals<T: Real> {
    /// Angular rate of the body against inertial space, rad/s.
    pub rate: Vector3<T>,
    /// Its time derivative, rad/s^2.
    pub angular_acceleration: Vector3<T>,
    /// Specific force at the IMU's sensitive centre, m/s^2.
    pub force: Vector3<T>,
    /// Its time derivative as the body sees it, f_b', m/s^3: `-omega x f` where the specific force in n is constant.
    pub force_rate: Vector3<T>,
    /// Temperature at each accelerometer minus the reference temperature, K.
    pub temperature: Vector3<T>,
    /// Its time derivative, K/s.
    pub temperature_rate: Vector3<T>,
    /// Temperature at each gyro minus the reference temperature, K.
    pub gyro_temperature: Vector3<T>,
    /// Mean square of the dither rate about each axis, A^2/2, (rad/s)^2.
    pub dither: Vector3<T>,
    /// The part of it that acts through the inner lever arm of a declaration: all of it where
    /// [`Dither`](crate::Dither) is declared, zero elsewhere.
    pub coupled_dither: Vector3<T>,
    /// Time since the first sample, s.
    pub time: T,
    /// Straight up.
    pub up: Vector3<T>,
    /// Rotation of the Earth, rad/s.
    pub earth_rate: Vector3<T>,
    /// Its derivative by the latitude, 1/s.
    pub earth_turn: Vector3<T>,
    /// Gravity, m/s^2.
    pub gravity: T,
    /// Its derivative by the latitude, m/s^2/rad.
    pub gravity_by_latitude: T,
    /// Its derivative by the height, 1/s^2.
    pub gravity_by_height: T,
    /// Rate of change of the temperature at each gyro, K/s.
    pub gyro_temperature_rate: Vector3<T>,
    /// By how much the modelled error of each accelerometer changes with its temperature, m/s^2/K.
    pub temperature_slope: Vector3<T>,
    /// The same of each gyro, rad/s/K.
    pub gyro_temperature_slope: Vector3<T>,
    /// Estimates of the inner lever arms that the dither acts through, m.
    pub arms: Vector3<T>,
    /// The blocks that joined the filter at run time.
    pub open: OpenBlocks,
}

impl<T: Real> Signals<T> {
    /// The same signals with every number converted.
    pub fn map<U: Real>(&self, of: impl Fn(T) -> U + Copy) -> Signals<U> {
        Signals {
            rate: self.rate.map(of),
            angular_acceleration: self.angular_acceleration.map(of),
            force: self.force.map(of),
            force_rate: self.force_rate.map(of),
            temperature: self.temperature.map(of),
            temperature_rate: self.temperature_rate.map(of),
            gyro_temperature: self.gyro_temperature.map(of),
            dither: self.dither.map(of),
            coupled_dither: self.coupled_dither.map(of),
            time: of(self.time),
            up: self.up.map(of),
            earth_rate: self.earth_rate.map(of),
            earth_turn: self.earth_turn.map(of),
            gravity: of(self.gravity),
            gravity_by_latitude: of(self.gravity_by_latitude),
            gravity_by_height: of(self.gravity_by_height),
            gyro_temperature_rate: self.gyro_temperature_rate.map(of),
            temperature_slope: self.temperature_slope.map(of),
            gyro_temperature_slope: self.gyro_temperature_slope.map(of),
            arms: self.arms.map(of),
            open: self.open,
        }
    }
}

/// Where the strapdown error model is linearised: navigation solution, inputs and lever arm.
///
/// n is east, north, up at the current position; b is right, forward, up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point<T: Real> {
    /// Turns b components into n components.
    pub c_bn: nalgebra::Matrix3<T>,
    /// Velocity over ground of the IMU in n, m/s.
    pub velocity: Vector3<T>,
    /// Geodetic latitude, rad.
    pub latitude: T,
    /// Height over the ellipsoid, m.
    pub height: T,
    /// Position of the IMU from the site origin in n, m.
    pub position: Vector3<T>,
    /// Specific force in n, m/s^2.
    pub force_n: Vector3<T>,
    /// Angular rate of the body against the Earth (omega_eb) in b, rad/s.
    pub rate_eb: Vector3<T>,
    /// Outer lever arm l: from the IMU's sensitive centre to the observed point, in b, m.
    pub lever: Vector3<T>,
    /// Velocity of the observed point over ground in n, m/s.
    pub point_velocity: Vector3<T>,
    /// Acceleration of the observed point over ground in n, m/s^2; a calibration leaves out `omega' x l` and Coriolis acceleration.
    pub point_acceleration: Vector3<T>,
    /// Position of the observed point from the site origin in n, m.
    pub point_position: Vector3<T>,
    /// The blocks that joined the filter at run time.
    pub open: OpenBlocks,
}

impl<T: Real> Point<T> {
    /// The same point with every number converted.
    pub fn map<U: Real>(&self, of: impl Fn(T) -> U + Copy) -> Point<U> {
        Point {
            c_bn: self.c_bn.map(of),
            velocity: self.velocity.map(of),
            latitude: of(self.latitude),
            height: of(self.height),
            position: self.position.map(of),
            force_n: self.force_n.map(of),
            rate_eb: self.rate_eb.map(of),
            lever: self.lever.map(of),
            point_velocity: self.point_velocity.map(of),
            point_acceleration: self.point_acceleration.map(of),
            point_position: self.point_position.map(of),
            open: self.open,
        }
    }
}
