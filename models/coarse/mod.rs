//! Coarse calibration from a log's own still positions and the turns between them (needs the standard library: it remembers
//! the turns). The first process of section 4.2 of the paper.
//!
//! A unit that stands still feels gravity, whose size is known, and a turn carries gravity from one position to the next. With
//! `f_k` the compensated mean specific force of position k and `R_k` the compensated gyros' rotation from position k to the
//! next over the Earth, three kinds of residuals say what scale, installation and bias of both triads are:
//!
//! ```text
//! |f_k| - g          f_(k+1) - R_k^T f_k          omega_k . f_k / |f_k| - omega_ie sin L
//! ```
//!
//! They are fitted together by least squares over 21 parameters (Levenberg and Marquardt, derivatives by differences), each
//! kind weighted by what it leaves behind. Nothing is linearised about a nominal unit, so scale errors of per cents,
//! installation errors of degrees and biases of tens of mg are as good as small ones. Heading does not matter.
//!
//! Where the log holds pulse counts of unknown size, a closed-form fit and a search over scales and signs come first.
//! Signs are determined up to the eight ways of calling axes positive that no motion can tell apart. Of these the one is
//! taken that agrees with the initial attitude, where one is given, and with the Earth's rate, where the gyros are good
//! enough to feel it; then the one with the most positive signs, those of the gyros first: the body axes are the gyros'.

mod fit;
mod positions;
mod pulses;
mod site;

use std::vec::Vec;

use nalgebra::Vector3;

pub use self::site::{SiteFault, SiteRests, SiteShown};

use self::positions::Recorder;
use crate::{InitialAttitude, Sample, SensorNoise, Site, StateInfo, earth};

/// Number of parameters.
const N: usize = 21;
/// Standard deviations that keep the fit away from what no unit is, SI: 5 %, 3 deg, 300 deg/h, 50 mg.
const RANGE: [f64; N] = [
    0.05, 0.05, 0.05, 0.05, 0.05, 0.05, 0.02, 0.02, 0.02, 0.05, 0.05, 0.05, 0.05, 0.05, 0.05, 0.05, 0.05,
    0.05, 0.5, 0.5, 0.5,
];
/// A parameter whose standard deviation stays above this part of its range is not determined.
const DETERMINED: f64 = 0.5;
/// The fit uses the data that the filter uses after it: its standard deviations are made wider by this for the filter's prior,
/// so that what is counted twice is a hundredth of the information.
const WIDENED: f64 = 10.0;

/// Which increments of a log are pulse counts of unknown size.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UnknownPulses {
    /// `dtheta` counts pulses.
    pub gyro: bool,
    /// `dvel` counts pulses.
    pub accel: bool,
}

/// Collects a log for the coarse calibration, sample by sample.
///
/// It keeps the gyro increments over hundredths of a second: 12 MB for an hour.
#[derive(Clone, Debug)]
pub struct Coarse {
    site: Site,
    noise: SensorNoise,
    recorder: Recorder,
}

/// What the positions and turns of a log say about its unit, SI.
#[derive(Clone, Debug, PartialEq)]
pub struct CoarseCalibration {
    /// Angle per gyro pulse, rad, where `dtheta` counts pulses; negative where an axis counts backwards.
    pub gyro_pulse: Option<Vector3<f64>>,
    /// Velocity per accelerometer pulse, m/s, where `dvel` counts pulses.
    pub accel_pulse: Option<Vector3<f64>>,
    /// Still positions used.
    pub positions: usize,
    /// Turns used.
    pub turns: usize,
    /// Root mean square of what the fit leaves of gravity from position to position, m/s^2.
    pub force_residual: f64,
    values: [f64; N],
    sigmas: [f64; N],
}

/// One parameter of a coarse calibration, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoarseParameter {
    /// Name of the effect.
    pub name: &'static str,
    /// Component.
    pub component: &'static str,
    /// Estimate; zero where the log cannot say.
    pub value: f64,
    /// Standard deviation of the fit.
    pub sigma: f64,
    /// Whether the log can say.
    pub determined: bool,
}

/// Why a log has no coarse calibration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CoarseError {
    /// The unit rests in fewer positions than are needed.
    TooFewPositions {
        /// Positions found.
        found: usize,
    },
    /// The positions do not put the axes up and down.
    PulsesUnclear,
    /// The fit does not agree with gravity.
    NoFit {
        /// What it leaves of gravity from position to position, root mean square, m/s^2.
        residual: f64,
    },
}

/// Fewer positions say too little.
const FEWEST_POSITIONS: usize = 6;
/// A fit that leaves more of gravity than this has failed, m/s^2 (3 %).
const WORST_RESIDUAL: f64 = 0.3;

impl core::fmt::Display for CoarseError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::TooFewPositions { found } => write!(
                f,
                "the coarse stage needs at least {FEWEST_POSITIONS} still positions of two seconds and more with turns \
                 between them, and a log that begins with five seconds of stillness: {found} positions were found"
            ),
            Self::PulsesUnclear => write!(
                f,
                "the size of a pulse does not follow from the still positions: each accelerometer must point up in some of \
                 them and down in others"
            ),
            Self::NoFit { residual } => write!(
                f,
                "the coarse stage does not explain the still positions and the turns between them: {residual:.2} m/s^2 are left \
                 of gravity from position to position"
            ),
        }
    }
}

impl core::error::Error for CoarseError {}

impl Coarse {
    /// The effects that are fitted.
    pub const EFFECTS: [&str; 6] =
        ["gyro-scale", "gyro-misalignment", "gyro-bias", "accel-scale", "accel-misalignment", "accel-bias"];

    /// Begins at the first sample of a log at `site`, sampled at `rate` Hz.
    pub fn new(site: Site, rate: f64, noise: SensorNoise) -> Self {
        Self { site, noise, recorder: Recorder::new(rate) }
    }

    /// Takes in the next sample.
    pub fn push(&mut self, sample: &Sample) {
        self.recorder.push(sample);
    }

    /// Calibrates by what was taken in. The `initial` attitude decides between signs of pulses, nothing else.
    ///
    /// # Errors
    /// When the log has too few still positions, or nothing explains them.
    pub fn finish(
        self,
        pulses: UnknownPulses,
        initial: Option<&InitialAttitude>,
    ) -> Result<CoarseCalibration, CoarseError> {
        let mut track = self.recorder.finish();
        let found = track.positions.len();
        if found < FEWEST_POSITIONS {
            return Err(CoarseError::TooFewPositions { found });
        }
        let gravity = earth::gravity(self.site.latitude, self.site.height);
        let world = fit::World {
            gravity,
            rate: earth::rotation_n(self.site.latitude),
            gyro_noise: self.noise.angle_random_walk,
            accel_noise: self.noise.velocity_random_walk,
        };
        let mut scales = (Vector3::repeat(1.0), Vector3::repeat(1.0));
        if pulses.gyro || pulses.accel {
            scales = pulses::search(&track, &world, pulses, initial).ok_or(CoarseError::PulsesUnclear)?;
            track.scale(&scales.0, &scales.1);
        }
        let solution = fit::fit(&track, &world);
        if !(solution.force_residual < WORST_RESIDUAL) {
            return Err(CoarseError::NoFit { residual: solution.force_residual });
        }
        let mut calibration = CoarseCalibration {
            gyro_pulse: None,
            accel_pulse: None,
            positions: found,
            turns: track.turns.len(),
            force_residual: solution.force_residual,
            values: solution.values,
            sigmas: solution.sigmas,
        };
        if pulses.gyro {
            calibration.gyro_pulse = Some(calibration.absorb(0, &scales.0));
        }
        if pulses.accel {
            calibration.accel_pulse = Some(calibration.absorb(9, &scales.1));
        }
        Ok(calibration)
    }
}

impl CoarseCalibration {
    /// Puts the scale errors of the triad whose parameters begin at `first` into the sizes of its pulses: what read
    /// `(1 + s) omega + ...` reads `omega + ...` once divided by `1 + s`.
    fn absorb(&mut self, first: usize, scale: &Vector3<f64>) -> Vector3<f64> {
        let factor = Vector3::from_fn(|i, _| 1.0 + self.values[first + i]);
        for i in 0..3 {
            self.values[first + i] = 0.0;
        }
        // which axis each installation error and each bias reads on
        let rows: &[usize] = if first == 0 { &[1, 2, 2, 0, 1, 2] } else { &[0, 0, 1, 1, 2, 2, 0, 1, 2] };
        for (i, row) in rows.iter().enumerate() {
            self.values[first + 3 + i] /= factor[*row];
        }
        scale.component_div(&factor)
    }

    /// The parameters, in the order of the catalogue.
    pub fn parameters(&self) -> impl Iterator<Item = CoarseParameter> {
        let names = Coarse::EFFECTS.iter().flat_map(|name| {
            let components = crate::effect(name).map_or(&[][..], |effect| effect.components());
            components.iter().map(|component| (*name, *component))
        });
        let used = self.used();
        names.enumerate().map(move |(i, (name, component))| {
            let determined = self.sigmas[i] < DETERMINED * RANGE[i];
            CoarseParameter { name, component, value: used[i], sigma: self.sigmas[i], determined }
        })
    }

    /// Whether it found a parameter beyond the standard deviation of its prior (SI, by the name of the effect): so far from zero the
    /// error model may not be linear any more.
    pub fn is_far(&self, prior: impl Fn(&str) -> f64) -> bool {
        self.parameters().any(|p| p.determined && p.value.abs() > prior(p.name))
    }

    /// Standard deviation that a filter's parameter state begins with on compensated samples, given that of its prior. The latter
    /// is never made smaller: it stands for what positions and turns cannot show, too.
    pub fn prior(&self, state: &StateInfo, sigma: f64) -> f64 {
        let found = self.parameters().find(|p| p.name == state.block && p.component == state.component);
        found.filter(|found| found.determined).map_or(sigma, |found| sigma.max(WIDENED * found.sigma))
    }

    /// Takes the errors found out of a sample that took `dt` seconds, its increments already in SI.
    pub fn compensate(&self, sample: &mut Sample, dt: f64) {
        let model = fit::Model::new(&self.used());
        sample.dtheta = model.rate(&sample.dtheta, dt);
        sample.dvel = model.force(&sample.dvel, dt);
    }

    /// Adds to `values` of parameters, found by a filter on compensated samples, what was taken out of the samples: with the
    /// filter's K and b they are `(I + K_c)(I + K) - I` and `b_c + (I + K_c) b`. What else adds to the reading of an axis, as
    /// nonlinearity and temperature do, reads as much larger as the axis's scale factor.
    pub fn total(&self, states: &[StateInfo], values: &mut [f64]) {
        let place = |p: &CoarseParameter| {
            states.iter().position(|state| state.block == p.name && state.component == p.component)
        };
        let places: Vec<Option<usize>> = self.parameters().map(|parameter| place(&parameter)).collect();
        let rest: [f64; N] = core::array::from_fn(|i| places[i].map_or(0.0, |at| values[at]));
        let used = self.used();
        for (state, value) in states.iter().zip(values.iter_mut()) {
            let first = if state.block.starts_with("accel-") { 9 } else { 0 };
            let adds = first > 0 || state.block.starts_with("gyro-");
            let axis = ["x", "y", "z"].iter().position(|axis| *axis == state.component);
            if let Some(axis) = axis.filter(|_| adds) {
                *value *= 1.0 + used[first + axis];
            }
        }
        let total = fit::compose(&used, &rest);
        for (i, at) in places.iter().enumerate() {
            if let Some(at) = at {
                values[*at] = total[i];
            }
        }
    }

    /// The values, without those that the log cannot say.
    fn used(&self) -> [f64; N] {
        core::array::from_fn(|i| if self.sigmas[i] < DETERMINED * RANGE[i] { self.values[i] } else { 0.0 })
    }
}
