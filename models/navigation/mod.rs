//! Free-inertial navigation with a calibration applied: what the calibration is worth.
//!
//! # Alignment
//! Navigation begins with an attitude. One that is known to 0.03 deg of level drifts by two nautical miles whatever
//! the calibration, so the initial attitude of a log is only where an [`Alignment`] starts: over the first minutes the
//! unit, compensated with the calibration in question, navigates with the help of the point it is known to stand on, as
//! a gyrocompass does, and a smoother carries what was learnt back to the first update. As in practice a constant error of
//! an accelerometer is absorbed by the level, and does harm when the unit turns, warms or dithers otherwise.
//!
//! # Navigation
//! From there on nothing is measured. [`FreeInertial`] holds the height and the vertical velocity, without which the vertical
//! channel diverges, and compares the observed point with where the reference says it is.

#[cfg(feature = "std")]
mod pilot;

#[cfg(feature = "std")]
pub use pilot::{Pilot, pilot, pilot_of};

#[cfg(feature = "std")]
use calib_core::Conventional;
use calib_core::{Filter, Shape, Vector, first_state, leaves};
use nalgebra::{ComplexField, Vector3};

use crate::compensation::Compensator;
use crate::strapdown::{Before, NavigationState};
#[cfg(feature = "std")]
use crate::{Calibration, Diverged, Smoother};
use crate::{OuterLeverArm, Sample, Setup, Site, StateInfo, Strapdown};

/// One nautical mile, m.
pub const NAUTICAL_MILE: f64 = 1852.0;
/// Positions are compared at most this often, Hz.
const COMPARISONS: f64 = 1.0;

/// Parameters of filter `F` from values by name: `value(info)` is that of one state, `None` counts as zero.
///
/// The outer lever arm, as people know it, includes its first guess; a state of it does not.
pub fn parameters_of<F: Filter<Dynamics = Strapdown>>(
    setup: &Setup,
    mut value: impl FnMut(&StateInfo) -> Option<f64>,
) -> Vector<F, f64> {
    let mut parameters = F::Shape::vector(0.0);
    let mut i = 0;
    F::states(&mut |info| {
        if i >= F::Shape::CORE {
            parameters[i] = value(&info).unwrap_or(0.0);
        }
        i += 1;
    });
    if let Some(first) = first_state::<F, OuterLeverArm>() {
        for axis in 0..3 {
            parameters[first + axis] -= setup.outer_lever[axis];
        }
    }
    parameters
}

/// Finds where a unit is at the beginning of a log, with its parameters taken as known.
#[cfg(feature = "std")]
pub struct Alignment<F: Filter<Dynamics = Strapdown>> {
    run: std::boxed::Box<Calibration<F, Conventional>>,
    smoother: Smoother<F>,
}

#[cfg(feature = "std")]
impl<F: Filter<Dynamics = Strapdown>> Alignment<F> {
    /// Begins at the first sample.
    pub fn new(setup: &Setup, parameters: &Vector<F, f64>) -> Self {
        let mut run = std::boxed::Box::new(Calibration::with_prior(setup, |_, _, sigma| sigma));
        run.begin_known(parameters);
        Self { run, smoother: Smoother::default() }
    }

    /// Takes in the next sample.
    ///
    /// # Errors
    /// When the filter has diverged.
    pub fn step(&mut self, sample: &Sample) -> Result<(), Diverged> {
        self.run.step_observed(sample, &mut self.smoother).map(drop)
    }

    /// Time and solution at the first update after the first sample; `None` when there was none.
    pub fn finish(self) -> Option<(f64, NavigationState<f64>)> {
        // memory does not fail
        let smoothed = self.smoother.finish(&self.run.covariance()).ok()?;
        smoothed.first().map(|smoothed| (smoothed.time, smoothed.navigation))
    }
}

/// Horizontal errors of a free-inertial run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drift {
    /// Time since the solution that navigation began with, s.
    pub duration: f64,
    /// Largest horizontal error, m; NaN once one was no number.
    pub largest: f64,
    /// Horizontal error at the last comparison, m.
    pub last: f64,
    /// Comparisons with the reference.
    pub comparisons: u64,
}

/// Navigates with compensated increments alone, height and vertical velocity held.
pub struct FreeInertial<F: Filter<Dynamics = Strapdown>> {
    parameters: Vector<F, f64>,
    site: Site,
    lever: Vector3<f64>,
    compensator: Compensator,
    navigation: NavigationState<f64>,
    before: Before<f64>,
    nominal: f64,
    start: f64,
    begun: f64,
    time: f64,
    next: f64,
    drift: Drift,
}

impl<F: Filter<Dynamics = Strapdown>> FreeInertial<F> {
    /// A run that begins at the first sample, with the initial attitude and velocity.
    pub fn new(setup: &Setup, parameters: &Vector<F, f64>) -> Self {
        let mut lever = setup.outer_lever;
        leaves::<F>(|leaf| {
            // a filter extended by a second such block has the sum of both
            if leaf.is::<OuterLeverArm>() {
                for axis in 0..3 {
                    lever[axis] += parameters[leaf.first + axis];
                }
            }
        });
        let mut navigation = NavigationState::at_rest(&setup.site, setup.initial.attitude);
        navigation.velocity = setup.velocity.velocity;
        Self {
            parameters: parameters.clone(),
            site: setup.site,
            lever,
            compensator: Compensator::new(setup.reference_temperature).with_open(setup.open),
            navigation,
            before: Before::nothing(),
            nominal: 1.0 / setup.rate,
            start: f64::NEG_INFINITY,
            begun: f64::NAN,
            time: f64::NAN,
            next: f64::NEG_INFINITY,
            drift: Drift::default(),
        }
    }

    /// Begins with the solution `from` at its `time`, s, instead; samples up to that are read, not navigated with.
    pub fn depart(&mut self, time: f64, from: NavigationState<f64>) {
        self.start = time;
        self.navigation = from;
        self.navigation.velocity.z = 0.0;
    }

    /// Takes in the next sample. Returns the error of the observed point's position in n, m, where it was compared.
    pub fn step(&mut self, sample: &Sample) -> Option<Vector3<f64>> {
        let dt = if self.time.is_nan() { self.nominal } else { sample.time - self.time };
        self.time = sample.time;
        if self.begun.is_nan() {
            self.begun = self.start.max(sample.time - dt);
        }
        self.compensator.read(sample);
        self.compensator.stand(&self.navigation);
        let (now, _) = self.compensator.compensate::<F>(sample, dt, &self.parameters);
        if sample.time > self.start {
            let height = self.navigation.height;
            self.navigation.step(&now, &mut self.before, dt);
            self.navigation.height = height;
            self.navigation.velocity.z = 0.0;
        } else {
            self.before.follow(&now);
        }
        if sample.time < self.start || sample.time < self.next {
            return None;
        }
        let reference = sample.reference.position?;
        self.next = sample.time + 1.0 / COMPARISONS - 0.5 * self.nominal;
        let point = self.navigation.position(&self.site) + self.navigation.attitude * self.lever;
        let error = point - reference;
        let horizontal = ComplexField::sqrt(error.x * error.x + error.y * error.y);
        self.drift.duration = sample.time - self.begun;
        // an error that is no number stays the largest
        if !self.drift.largest.is_nan() && !(horizontal <= self.drift.largest) {
            self.drift.largest = horizontal;
        }
        self.drift.last = horizontal;
        self.drift.comparisons += 1;
        Some(error)
    }

    /// The errors so far.
    pub fn drift(&self) -> &Drift {
        &self.drift
    }

    /// The solution at the last sample.
    pub fn navigation(&self) -> &NavigationState<f64> {
        &self.navigation
    }
}
