//! One row of a log, in SI units.

use calib_core::Filter;
use nalgebra::{UnitQuaternion, Vector3};

use crate::Strapdown;
use crate::measurements::KNOWN;

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

/// Numbers that a sample holds for measurements of other crates.
pub const OWN: usize = 8;

/// What the reference says at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    /// Velocity of the observed point over ground, ENU, m/s.
    pub velocity: Option<Vector3<f64>>,
    /// Position of the observed point from the site origin, ENU, m.
    pub position: Option<Vector3<f64>>,
    /// Attitude of the reference's body frame, C_bn.
    pub attitude: Option<UnitQuaternion<f64>>,
    /// Rate of the body against the Earth, in b, rad/s: zero at rest.
    pub rate: Option<Vector3<f64>>,
    /// Height of the observed point over the site origin, m.
    pub height: Option<f64>,
    /// Heading of the body's forward axis, from north over east, rad.
    pub heading: Option<f64>,
    /// What the other columns hold that the filter's measurements read, in the order of [`own_columns`]; NaN where there is no
    /// reading.
    pub own: [f64; OWN],
    /// Standard deviations of these readings.
    pub sigma: ReadingSigma,
    /// What the increments since the reading before may have missed.
    pub missed: Missed,
}

/// What the increments of a motion may have missed beside their noise, standard deviations per component in n; zero where they are
/// believed. A unit that was turned by hand and rests again: what its increments make of the turn closes to some 0.1 m/s only, and to
/// a thousandth of the angle. State and covariance are opened by so much before the reading is used.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Missed {
    /// Of the attitude, rad.
    pub attitude: f64,
    /// Of the velocity, m/s.
    pub velocity: f64,
}

impl Missed {
    /// Both, the larger of each.
    pub(crate) fn or(self, other: Self) -> Self {
        Self { attitude: self.attitude.max(other.attitude), velocity: self.velocity.max(other.velocity) }
    }
}

/// Standard deviations that the readings of one instant state themselves; NaN, the default, leaves it to the [`Setup`](crate::Setup).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReadingSigma {
    /// Velocity, m/s.
    pub velocity: Vector3<f64>,
    /// Position, m.
    pub position: Vector3<f64>,
    /// Attitude about east, north, up, rad.
    pub attitude: Vector3<f64>,
    /// Rate, rad/s.
    pub rate: Vector3<f64>,
    /// Height, m.
    pub height: f64,
    /// Heading, rad.
    pub heading: f64,
    /// The numbers of [`Reference::own`]: of a measurement with as many rows as columns.
    pub own: [f64; OWN],
}

impl Default for Reference {
    /// Nothing.
    fn default() -> Self {
        Self {
            velocity: None,
            position: None,
            attitude: None,
            rate: None,
            height: None,
            heading: None,
            own: [f64::NAN; OWN],
            sigma: ReadingSigma::default(),
            missed: Missed::default(),
        }
    }
}

impl Default for ReadingSigma {
    /// That of the setup.
    fn default() -> Self {
        let none = Vector3::repeat(f64::NAN);
        Self {
            velocity: none,
            position: none,
            attitude: none,
            rate: none,
            height: f64::NAN,
            heading: f64::NAN,
            own: [f64::NAN; OWN],
        }
    }
}

impl Reference {
    /// Whether it says that the unit is at rest.
    pub(crate) fn is_rest(&self) -> bool {
        [self.velocity, self.rate]
            .iter()
            .all(|reading| reading.is_some_and(|reading| reading == Vector3::zeros()))
    }

    /// Whether there is any reading.
    pub fn is_read(&self) -> bool {
        self.velocity.is_some()
            || self.position.is_some()
            || self.attitude.is_some()
            || self.rate.is_some()
            || self.height.is_some()
            || self.heading.is_some()
            || self.own.iter().any(|value| !value.is_nan())
    }

    /// The number in one of the slots: the columns that a reference has fields for, then its own.
    pub(crate) fn value(&self, slot: usize) -> Option<f64> {
        match slot {
            0..3 => self.velocity.map(|v| v[slot]),
            3..6 => self.position.map(|p| p[slot - 3]),
            6..10 => self.attitude.map(|q| [q.w, q.i, q.j, q.k][slot - 6]),
            10..13 => self.rate.map(|rate| rate[slot - 10]),
            13 => self.height,
            14 => self.heading,
            _ => self.own.get(slot - KNOWN.len()).copied().filter(|value| !value.is_nan()),
        }
    }

    /// Its stated standard deviation, NaN without one; those of attitude are three, in the first slots of the quaternion.
    pub(crate) fn stated_sigma(&self, slot: usize) -> f64 {
        let sigma = &self.sigma;
        match slot {
            0..3 => sigma.velocity[slot],
            3..6 => sigma.position[slot - 3],
            6..9 => sigma.attitude[slot - 6],
            9 => f64::NAN,
            10..13 => sigma.rate[slot - 10],
            13 => sigma.height,
            14 => sigma.heading,
            _ => sigma.own.get(slot - KNOWN.len()).copied().unwrap_or(f64::NAN),
        }
    }
}

/// Names of the log's columns that [`Reference::own`] holds for a filter, in that order: those its measurements read and a
/// reference has no field for.
pub fn own_columns<F: Filter<Dynamics = Strapdown>>() -> impl Iterator<Item = &'static str> {
    let (columns, count) = const { crate::measurements::own_columns(F::MEASURES) };
    columns.into_iter().take(count)
}
