//! Scenarios: what is simulated, in SI units, and how people write it.

mod check;
mod fault;
mod read;
mod reader;

use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use sinscal::{AnyEffect, Dither, Filter, InitialAttitude, Site, declares};

use crate::environment::TemperaturePlan;
use crate::motion::{
    Axis, Imperfections, Motion, NINETEEN_POSITIONS, Rotation, Swing, TWO_AXIS, Turn, Turning, Turntable,
    eighteen_rotations, turns,
};
use crate::noise::NoiseFigures;
use crate::random::{Seed, Stream};
use crate::truth::Truth;

pub use fault::{Fault, ScenarioError};

/// The default scenario, commented: what `--print-scenario` prints.
pub const DEFAULT_SCENARIO: &str = include_str!("default.toml");

/// What is simulated.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// Which run of the unit: another number is the same unit with other noise.
    pub run: u64,
    /// Sampling rate, Hz.
    pub rate: f64,
    /// Where the table stands.
    pub site: Site,
    /// How the unit is moved.
    pub motion: MotionPlan,
    /// What is wrong with the table.
    pub table: Imperfections,
    /// What is measured of the motion.
    pub reference: ReferencePlan,
    /// What is known at the first row.
    pub initial: InitialPlan,
    /// Noise of the gyros.
    pub gyro: NoiseFigures,
    /// Noise of the accelerometers.
    pub accelerometer: NoiseFigures,
    /// Temperatures.
    pub temperature: TemperaturePlan,
    /// Dither of the gyros.
    pub dither: DitherPlan,
    /// How units differ.
    pub population: Vec<Population>,
}

/// How the unit is moved.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionPlan {
    /// Which motion.
    pub path: Path,
    /// Attitude at the beginning, C_bn.
    pub start: UnitQuaternion<f64>,
    /// Rest before the first turn, s.
    pub still: f64,
    /// Rate of turns, rad/s.
    pub rate: f64,
    /// Acceleration of the ramps, rad/s^2.
    pub acceleration: f64,
    /// The corners of the trapezoid of rate are rounded over this time, s.
    pub rounding: f64,
    /// Rest after each turn, s.
    pub dwell: f64,
    /// What the table can do, rad/s.
    pub max_rate: f64,
    /// And rad/s^2.
    pub max_acceleration: f64,
    /// Of motions that do not end by themselves, s.
    pub duration: f64,
}

/// Which motion.
#[derive(Clone, Debug, PartialEq)]
pub enum Path {
    /// Camberlein's 18 rotations.
    EighteenRotations,
    /// Nineteen positions.
    NineteenPositions,
    /// A path for a table of two axes.
    TwoAxis,
    /// Turns as listed.
    Turns(Vec<Turn>),
    /// Rocking.
    Swing {
        /// About x, y, z, rad.
        amplitude: Vector3<f64>,
        /// Hz.
        frequency: Vector3<f64>,
        /// rad.
        phase: Vector3<f64>,
    },
    /// Standing still.
    Still,
}

impl MotionPlan {
    /// The turns of the path, if it is one of turns.
    pub fn turns(&self) -> Option<Vec<Turn>> {
        match &self.path {
            Path::EighteenRotations => {
                let turn = |(axis, angle)| Turn { axis, angle, rate: self.rate, dwell: self.dwell };
                Some(eighteen_rotations().into_iter().map(turn).collect())
            }
            Path::NineteenPositions => Some(turns(&NINETEEN_POSITIONS, self.rate, self.dwell)),
            Path::TwoAxis => Some(turns(&TWO_AXIS, self.rate, self.dwell)),
            Path::Turns(list) => Some(list.clone()),
            Path::Swing { .. } | Path::Still => None,
        }
    }

    /// C_bn at the beginning and, of a path of turns, after each of them, on a perfect table.
    pub fn attitudes(&self) -> Vec<Matrix3<f64>> {
        let mut now = self.start.to_rotation_matrix().into_inner();
        let mut attitudes = vec![now];
        for turn in self.turns().unwrap_or_default() {
            let whole = Turning { angle: turn.angle, ..Turning::default() };
            let turned = Rotation::about(&turn.axis.direction(), &whole).c_bn;
            now = if matches!(turn.axis, Axis::Body(_)) { now * turned } else { turned * now };
            attitudes.push(now);
        }
        attitudes
    }

    /// The motion and how long it takes, s.
    pub(crate) fn build(&self, table: &Imperfections) -> (Motion, f64) {
        let start = self.start.to_rotation_matrix().into_inner();
        if let Some(list) = self.turns() {
            let turntable = Turntable::new(start, self.still, &list, self.acceleration, self.rounding, table);
            let duration = turntable.duration();
            return (Motion::Turntable(turntable), duration);
        }
        match self.path {
            Path::Swing { amplitude, frequency, phase } => {
                (Motion::Swing(Swing { start, amplitude, frequency, phase }), self.duration)
            }
            _ => (Motion::Still(start), self.duration),
        }
    }
}

/// What is measured of the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferencePlan {
    /// Whether the log has readings; without, the centre of rotation is taken to stand still. Readings follow a base that vibrates,
    /// a point taken to be fixed does not.
    pub readings: bool,
    /// Hz.
    pub rate: f64,
    /// m/s.
    pub velocity_sigma: f64,
    /// m.
    pub position_sigma: f64,
    /// Whether attitude is read as well.
    pub attitude: bool,
    /// rad.
    pub attitude_sigma: f64,
}

/// What is known at the first row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InitialPlan {
    /// Standard deviation of the tilt, rad.
    pub level_sigma: f64,
    /// Standard deviation of the heading, rad.
    pub heading_sigma: f64,
    /// First guess of the outer lever arm, m.
    pub outer_lever: Vector3<f64>,
}

/// How dither is simulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DitherMode {
    /// Not at all.
    Off,
    /// As the mean of its size effect.
    Mean,
    /// At its own rate.
    Full,
}

/// Dither of the gyros.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DitherPlan {
    /// How it is simulated.
    pub mode: DitherMode,
    /// Amplitude of the sensor block's rate about each axis, rad/s: the root of twice its mean square.
    pub amplitude: Vector3<f64>,
    /// Relative standard deviation of the amplitudes over units and axes.
    pub spread: f64,
    /// Relative slow change of the amplitudes.
    pub change: f64,
    /// Period of the slow change, s.
    pub period: f64,
    /// Standard deviation of one reading, rad/s.
    pub reading_noise: f64,
    /// Rate of the readings, Hz.
    pub rate: f64,
    /// Frequencies about each axis, Hz.
    pub frequency: Vector3<f64>,
    /// Relative standard deviation of the amplitude from cycle to cycle.
    pub modulation: f64,
    /// Standard deviation of the frequency from cycle to cycle, Hz.
    pub frequency_noise: f64,
    /// Rate of the simulation at the dither's own rate, Hz.
    pub simulation_rate: f64,
}

/// How units differ in one effect.
#[derive(Clone, Debug, PartialEq)]
pub struct Population {
    /// Which effect.
    pub effect: &'static dyn AnyEffect,
    /// Mean of each component, SI.
    pub mean: Vec<f64>,
    /// Standard deviation of each component, SI.
    pub sigma: Vec<f64>,
}

impl Default for Scenario {
    /// The scenario of [`DEFAULT_SCENARIO`].
    fn default() -> Self {
        read::default_scenario()
    }
}

impl Scenario {
    /// Reads a scenario. What it does not say is as in [`DEFAULT_SCENARIO`].
    ///
    /// # Errors
    /// With everything that is wrong, each with its field, its line and what is accepted.
    pub fn parse(text: &str) -> Result<Self, ScenarioError> {
        Self::parse_with(text, &[])
    }

    /// [`parse`](Self::parse) for a text whose populations may name effects of one's own beside those of the catalogue.
    ///
    /// # Errors
    /// As there.
    pub fn parse_with(text: &str, own: &[&'static dyn AnyEffect]) -> Result<Self, ScenarioError> {
        read::parse(text, own)
    }

    /// The same at another sampling rate, Hz: what `--rate` means.
    ///
    /// # Errors
    /// When the rates of readings do not divide it.
    pub fn with_rate(mut self, rate: f64) -> Result<Self, ScenarioError> {
        self.rate = rate;
        self.check()?;
        Ok(self)
    }

    /// Checks that this can be simulated; [`parse`](Self::parse) has done so.
    ///
    /// # Errors
    /// With everything that is wrong.
    pub fn check(&self) -> Result<(), ScenarioError> {
        let faults = fault::told(check::check(self));
        if faults.is_empty() { Ok(()) } else { Err(ScenarioError { faults }) }
    }

    /// How long it takes, s.
    pub fn duration(&self) -> f64 {
        self.motion.build(&self.table).1
    }

    /// How many samples it has.
    pub fn samples(&self) -> u64 {
        // half a hundredth of a sample of slack for the rounding of durations
        (self.duration() * self.rate + 5e-3).floor().max(0.0) as u64
    }

    /// Into how many parts a sampling interval is divided for quadrature, so that none is long beside the rounding of a turn, the
    /// period of a swing or that of a vibration.
    pub(crate) fn panels(&self) -> u32 {
        let dt = 1.0 / self.rate;
        let mut panels: f64 = match &self.motion.path {
            Path::Swing { frequency, .. } => 20.0 * frequency.max() * dt,
            Path::Still => 1.0,
            _ => 5.0 * dt / self.motion.rounding,
        };
        let vibration = &self.table.vibration;
        if (vibration.acceleration + vibration.tilt).max() > 0.0 {
            panels = panels.max(20.0 * vibration.frequency.max() * dt);
        }
        // less than a hundredth too many is not worth another panel
        (panels - 1e-2).ceil().clamp(1.0, 64.0) as u32
    }

    /// Keeps the effects that `wanted` says, by name; `dither-size-effect` stands for the dither.
    pub fn keep_effects(&mut self, wanted: impl Fn(&str) -> bool) {
        self.population.retain(|population| wanted(population.effect.name()));
        if !wanted("dither-size-effect") {
            self.dither.mode = DitherMode::Off;
        }
    }

    /// The same with the effects that filter `F` models and no others: its units are those the filter is right about.
    pub fn modelled_by<F: Filter>(mut self) -> Self {
        let mut names = Vec::new();
        F::states(&mut |info| names.push(info.block));
        if declares::<F, Dither>() {
            names.push("dither-size-effect");
        }
        self.keep_effects(|effect| names.contains(&effect));
        self
    }

    /// The true parameters of unit `seed`.
    pub fn unit(&self, seed: u64) -> Truth {
        let mut truth = Truth::default();
        for population in &self.population {
            let mut stream = Stream::new(seed, &format!("population/{}", population.effect.name()));
            let draw = |(mean, sigma): (&f64, &f64)| mean + sigma * stream.normal();
            let values = population.mean.iter().zip(&population.sigma).map(draw).collect();
            truth.insert(population.effect.info(), values);
        }
        if self.dither.mode != DitherMode::Off {
            let arms = truth.effects().get("inner-lever-arm").cloned();
            if let (Some(arms), Some(effect)) = (arms, sinscal::effect("dither-size-effect")) {
                truth.insert(effect, arms);
            }
        }
        truth
    }

    /// What is known of an attitude known to `initial`'s sigmas.
    pub(crate) fn initial_attitude(&self, attitude: UnitQuaternion<f64>, seed: Seed) -> InitialAttitude {
        let InitialPlan { level_sigma, heading_sigma, .. } = self.initial;
        let error = Stream::in_run(seed, "initial/attitude").normals().component_mul(&Vector3::new(
            level_sigma,
            level_sigma,
            heading_sigma,
        ));
        // C_hat = (I - [phi x]) C
        let attitude = UnitQuaternion::from_scaled_axis(-error) * attitude;
        InitialAttitude { attitude, level_sigma, heading_sigma }
    }
}
