//! Blind trials: simulated units with something hidden, drawn by seed, and how the diagnosis of each is scored.

use nalgebra::Vector3;
use rig::scenario::{Path, Population};
use rig::{DitherMode, Scenario, ScenarioError, Simulation, TemperatureProfile};
use sinscal::{Sample, effect};

use crate::random::Stream;
use crate::{Diagnosis, Error, Log, Options, Verdict, diagnose_named};

/// What is hidden in a case.
#[derive(Clone, Debug, PartialEq)]
pub enum Hidden {
    /// Nothing; the stated noise is that of the simulation times these factors (gyro, accelerometer).
    Nothing(f64, f64),
    /// Effects of the catalogue, at about so many standard deviations of what the path can see.
    Effects(Vec<&'static str>, f64),
    /// Something that is in no library, by its name, at about so many standard deviations.
    Outside(&'static str, f64),
    /// An effect that the path does not show.
    NotExcited(&'static str),
}

/// Effects that can be hidden, with what one standard deviation of the estimate is on the path of these trials.
const EFFECTS: &[(&str, f64)] = &[
    ("inner-lever-arm", 2.9e-4),
    ("dither-size-effect", 1.5e-3),
    ("accel-delay", 3.6e-6),
    ("accel-temperature-scale", 1.0e-7),
    ("accel-temperature-bias", 1.0e-6),
    ("accel-temperature-rate", 7.0e-4),
    ("gyro-temperature-bias", 4.0e-9),
    ("gyro-g-sensitivity", 2.5e-8),
    ("accel-cubic", 4.0e-8),
    ("accel-cross-coupling", 4.0e-7),
    ("accel-bias-drift", 3.0e-9),
    ("gyro-bias-drift", 6.0e-12),
    ("inner-lever-arm-tangential", 4.0e-4),
];

/// What can be hidden that no block models.
const OUTSIDE: &[(&str, f64)] = &[
    ("accelerometer transient after rotation", 4e-6),
    ("accelerometer bias step", 4e-6),
    ("accelerometer bias by temperature squared", 3e-8),
    ("gyro bias by (omega_i f_k)", 1e-7),
    ("gyro bias step", 6e-9),
    ("accelerometer bias by omega_i", 2e-5),
];

const NOT_EXCITED: &[&str] = &["gyro-rate-nonlinearity", "gyro-scale-asymmetry", "dither-size-effect"];

impl Hidden {
    /// In which row of the table a case counts.
    fn kind(&self) -> &'static str {
        match self {
            Self::Nothing(gyro, accel) if *gyro == 1.0 && *accel == 1.0 => "nothing",
            Self::Nothing(..) => "nothing, noise misstated",
            Self::Effects(names, _) if names.len() > 1 => "pair",
            Self::Effects(_, strength) if *strength < 10.0 => "single, 8 sigma",
            Self::Effects(_, strength) if *strength < 50.0 => "single, 20 sigma",
            Self::Effects(..) => "single, 80 sigma",
            Self::Outside(..) => "outside",
            Self::NotExcited(_) => "not excited",
        }
    }
}

/// A case: two logs of one unit, and what is hidden in them.
#[derive(Clone, Debug)]
pub struct Case {
    /// What it was drawn from.
    pub seed: u64,
    /// The filter to be diagnosed.
    pub filter: &'static str,
    /// What it lacks.
    pub hidden: Hidden,
    logs: [(Vec<Sample>, rig::Description); 2],
}

/// How a diagnosis did.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Grade {
    /// The one right answer.
    Right,
    /// The truth is in a list of at most three, or something was flagged without its name.
    Half,
    /// Nothing was said where something is.
    Miss,
    /// A wrong name, confirmed.
    Wrong,
    /// Something was said where nothing is.
    Alarm,
}

impl Grade {
    /// What it counts.
    pub fn points(self) -> f64 {
        match self {
            Self::Right => 1.0,
            Self::Half => 0.5,
            Self::Miss => 0.0,
            Self::Wrong => -2.0,
            Self::Alarm => -1.0,
        }
    }
}

impl Case {
    /// Draws the case of a seed.
    ///
    /// # Errors
    /// When the rig refuses the scenario; that would be a fault of this crate.
    pub fn draw(seed: u64) -> Result<Self, ScenarioError> {
        let mut stream = Stream::new(seed, "blind");
        let strength = [8.0, 20.0, 80.0][stream.below(3)];
        let hidden = match stream.below(20) {
            0..2 => Hidden::Nothing(1.0, 1.0),
            2..4 => {
                let factor = |s: &mut Stream| [0.5, 1.0, 2.0][s.below(3)];
                Hidden::Nothing(factor(&mut stream), factor(&mut stream))
            }
            4..13 => Hidden::Effects(vec![EFFECTS[stream.below(EFFECTS.len())].0], strength),
            13..16 => {
                let one = stream.below(EFFECTS.len());
                let other = (one + 1 + stream.below(EFFECTS.len() - 1)) % EFFECTS.len();
                // the filter that dither is hidden from knows the inner lever arms
                let (one, other) = if one + other == 1 { (1, 2) } else { (one, other) };
                Hidden::Effects(
                    vec![EFFECTS[one.min(other)].0, EFFECTS[one.max(other)].0],
                    strength.max(20.0),
                )
            }
            16..19 => Hidden::Outside(OUTSIDE[stream.below(OUTSIDE.len())].0, strength.max(20.0)),
            _ => Hidden::NotExcited(NOT_EXCITED[stream.below(NOT_EXCITED.len())]),
        };
        Self::with(seed, hidden)
    }

    /// A unit of `seed` with `hidden` in it.
    ///
    /// # Errors
    /// When the rig refuses the scenario.
    pub fn with(seed: u64, hidden: Hidden) -> Result<Self, ScenarioError> {
        let names: &[&str] = match &hidden {
            Hidden::Effects(names, _) => names,
            Hidden::NotExcited(name) => &[name],
            _ => &[],
        };
        let dithers = names.contains(&"dither-size-effect");
        // dither acts through inner lever arms: the filter for it knows those
        let filter = if dithers { "39d-p" } else { "36d-p" };
        let first = simulate(seed, filter, &hidden, names, false)?;
        let second = simulate(seed, filter, &hidden, names, true)?;
        Ok(Self { seed, filter, hidden, logs: [first, second] })
    }

    /// Diagnoses it.
    ///
    /// # Errors
    /// When a filter diverges.
    pub fn diagnose(&self, options: &Options) -> Result<Diagnosis, Error> {
        let [a, b] = self.logs.each_ref().map(|(samples, description)| (samples, self.setup(description)));
        let first = Log { samples: a.0, setup: &a.1 };
        let second = Log { samples: b.0, setup: &b.1 };
        match diagnose_named(self.filter, &first, Some(&second), options, &mut |_, _| {}) {
            Some(done) => done,
            None => Err(Error::TooShort { log: "no such filter", updates: 0 }),
        }
    }

    fn setup(&self, description: &rig::Description) -> sinscal::Setup<'static> {
        let mut setup = description.setup(&[]);
        if let Hidden::Nothing(gyro, accel) = self.hidden {
            setup.noise.angle_random_walk *= gyro;
            setup.noise.velocity_random_walk *= accel;
        }
        setup
    }

    /// Scores a diagnosis by the protocol.
    pub fn grade(&self, d: &Diagnosis) -> Grade {
        let named: Vec<&str> = d.effects.iter().map(|e| e.name.as_str()).collect();
        let silent = matches!(d.verdict, Verdict::NothingMissing);
        let listed = |truth: &[&str]| {
            d.ambiguous.len() <= 3
                && d.ambiguous
                    .iter()
                    .any(|s| s.len() == truth.len() && truth.iter().all(|t| s.iter().any(|n| n == t)))
        };
        match &self.hidden {
            Hidden::Nothing(..) => match d.verdict {
                Verdict::NothingMissing => Grade::Right,
                Verdict::EffectsFound => Grade::Wrong,
                Verdict::NotConfirmed if d.ambiguous.is_empty() => Grade::Miss,
                _ => Grade::Alarm,
            },
            Hidden::Effects(truth, _) => {
                if d.verdict == Verdict::EffectsFound {
                    let all = truth.iter().all(|t| named.contains(t));
                    return if named.iter().any(|n| !truth.contains(n)) {
                        Grade::Wrong
                    } else if all {
                        Grade::Right
                    } else {
                        Grade::Half
                    };
                }
                if listed(truth) { Grade::Half } else { Grade::Miss }
            }
            Hidden::Outside(..) => match d.verdict {
                Verdict::OutsideLibrary => Grade::Right,
                Verdict::EffectsFound => Grade::Wrong,
                Verdict::NothingMissing => Grade::Miss,
                _ => Grade::Half,
            },
            Hidden::NotExcited(name) => {
                let honest = d.not_excited.iter().any(|n| n == name)
                    || d.indistinguishable.iter().any(|p| p.iter().any(|n| n == name));
                match d.verdict {
                    Verdict::EffectsFound if named == [*name] => Grade::Right,
                    Verdict::EffectsFound => Grade::Wrong,
                    _ if silent && honest => Grade::Right,
                    _ => Grade::Miss,
                }
            }
        }
    }
}

/// Counts of a series of trials.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Kind of case, grade, how many.
    counts: Vec<(&'static str, Grade, usize)>,
}

impl Table {
    fn add(&mut self, kind: &'static str, grade: Grade) {
        match self.counts.iter_mut().find(|c| c.0 == kind && c.1 == grade) {
            Some(count) => count.2 += 1,
            None => self.counts.push((kind, grade, 1)),
        }
    }

    /// How many cases ended with `grade`.
    pub fn count(&self, grade: Grade) -> usize {
        self.counts.iter().filter(|c| c.1 == grade).map(|c| c.2).sum()
    }

    /// Number of cases.
    pub fn cases(&self) -> usize {
        self.counts.iter().map(|c| c.2).sum()
    }

    /// Mean score; 1 is perfect.
    pub fn score(&self) -> f64 {
        self.counts.iter().map(|c| c.1.points() * c.2 as f64).sum::<f64>() / self.cases().max(1) as f64
    }
}

/// Bounds that hold the true rate with 95 % (Wilson), of `k` out of `n`.
fn wilson(k: usize, n: usize) -> (f64, f64) {
    let (k, n, z) = (k as f64, n.max(1) as f64, 1.959_963_984_540_054);
    let centre = (k + z * z / 2.0) / (n + z * z);
    let half = z / (n + z * z) * (k * (n - k) / n + z * z / 4.0).sqrt();
    ((centre - half).max(0.0), (centre + half).min(1.0))
}

impl core::fmt::Display for Table {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        const GRADES: [Grade; 5] = [Grade::Right, Grade::Half, Grade::Miss, Grade::Wrong, Grade::Alarm];
        writeln!(
            f,
            "{:26} {:>6} {:>6} {:>6} {:>6} {:>6}",
            "hidden", "right", "half", "miss", "wrong", "alarm"
        )?;
        let mut kinds: Vec<&str> = self.counts.iter().map(|c| c.0).collect();
        kinds.sort_unstable();
        kinds.dedup();
        for kind in kinds {
            write!(f, "{kind:26}")?;
            for grade in GRADES {
                let n: usize = self.counts.iter().filter(|c| c.0 == kind && c.1 == grade).map(|c| c.2).sum();
                write!(f, " {n:6}")?;
            }
            writeln!(f)?;
        }
        write!(f, "{:26}", "all")?;
        for grade in GRADES {
            write!(f, " {:6}", self.count(grade))?;
        }
        writeln!(f)?;
        for (grade, name) in
            [(Grade::Right, "right"), (Grade::Wrong, "wrong names"), (Grade::Alarm, "alarms")]
        {
            let (low, high) = wilson(self.count(grade), self.cases());
            writeln!(f, "{name}: {:.1} % to {:.1} % (95 %)", 100.0 * low, 100.0 * high)?;
        }
        write!(f, "score {:.3} over {} cases", self.score(), self.cases())
    }
}

/// Why a trial could not be made.
#[derive(Clone, Debug, thiserror::Error)]
pub enum TrialError {
    /// The rig refused a scenario.
    #[error("seed {seed}: {source}")]
    Scenario {
        /// Of which case.
        seed: u64,
        /// Why.
        source: ScenarioError,
    },
    /// The diagnosis failed.
    #[error("seed {seed}: {source}")]
    Diagnosis {
        /// Of which case.
        seed: u64,
        /// Why.
        source: Error,
    },
}

/// Draws and diagnoses the cases of `seeds`, telling `seen` of each.
///
/// # Errors
/// When a case cannot be simulated or diagnosed.
pub fn self_test(
    seeds: core::ops::Range<u64>,
    options: &Options,
    seen: &mut dyn FnMut(&Case, &Diagnosis, Grade),
) -> Result<Table, TrialError> {
    let mut table = Table::default();
    for seed in seeds {
        let case = Case::draw(seed).map_err(|source| TrialError::Scenario { seed, source })?;
        let d = case.diagnose(options).map_err(|source| TrialError::Diagnosis { seed, source })?;
        let grade = case.grade(&d);
        table.add(case.hidden.kind(), grade);
        seen(&case, &d, grade);
    }
    Ok(table)
}

fn simulate(
    seed: u64,
    filter: &str,
    hidden: &Hidden,
    names: &[&str],
    second: bool,
) -> Result<(Vec<Sample>, rig::Description), ScenarioError> {
    let mut scenario = Scenario::default().with_rate(25.0)?;
    let own = |name: &str| {
        matches!(
            name,
            "gyro-scale"
                | "gyro-misalignment"
                | "gyro-bias"
                | "accel-scale"
                | "accel-misalignment"
                | "accel-bias"
                | "accel-quadratic"
                | "outer-lever-arm"
        ) || filter == "39d-p" && name == "inner-lever-arm"
    };
    let dithers = names.contains(&"dither-size-effect");
    scenario.keep_effects(|name| own(name) || dithers && name == "dither-size-effect");
    scenario.motion.still = 150.0;
    scenario.motion.dwell = 80.0;
    scenario.temperature.profile =
        TemperatureProfile::Ramps(vec![(0.0, 20.0), (700.0, 38.0), (1300.0, 30.0), (2000.0, 33.0)]);
    scenario.dither.mode = if dithers { DitherMode::Mean } else { DitherMode::Off };
    scenario.dither.period = 1500.0;
    scenario.dither.change = if matches!(hidden, Hidden::NotExcited(_)) { 0.0 } else { 0.3 };
    if second {
        scenario.run = 1;
        scenario.motion.path = Path::NineteenPositions;
        scenario.temperature.profile =
            TemperatureProfile::Ramps(vec![(0.0, 33.0), (500.0, 22.0), (1200.0, 36.0), (2000.0, 24.0)]);
    }
    let mut stream = Stream::new(seed, "blind/size");
    for name in names.iter().filter(|n| **n != "dither-size-effect") {
        let Some(effect) = effect(name) else { continue };
        let size = match hidden {
            Hidden::Effects(_, strength) => {
                EFFECTS.iter().find(|e| e.0 == *name).map_or(0.0, |e| e.1 * strength)
            }
            _ => 0.1 * effect.prior_sigma,
        };
        let mut mean: Vec<f64> = effect.components().iter().map(|_| stream.normal()).collect();
        let norm = mean.iter().map(|v| v * v).sum::<f64>().sqrt();
        for v in &mut mean {
            *v *= size / norm;
        }
        let sigma = vec![0.0; mean.len()];
        scenario.population.retain(|p| p.effect.name() != *name);
        scenario.population.push(Population { effect, mean, sigma });
    }
    let simulation = Simulation::new(&scenario, seed)?;
    let description = simulation.description().clone();
    let mut samples: Vec<Sample> = simulation.collect();
    if let Hidden::Outside(name, strength) = hidden {
        hide(name, *strength, scenario.rate, &mut samples, &mut stream);
    }
    Ok((samples, description))
}

/// Adds an error that no block models to the samples.
fn hide(name: &str, strength: f64, rate: f64, samples: &mut [Sample], stream: &mut Stream) {
    let size = OUTSIDE.iter().find(|o| o.0 == name).map_or(0.0, |o| o.1) * strength;
    let direction = Vector3::new(stream.normal(), stream.normal(), stream.normal()).normalize() * size;
    let dt = 1.0 / rate;
    let half = samples.len() / 2;
    let mut temperature = Vector3::repeat(25.0);
    let mut ended = f64::NEG_INFINITY;
    for (at, s) in samples.iter_mut().enumerate() {
        let (w, f) = (s.dtheta / dt, s.dvel / dt);
        if !s.temperature.x.is_nan() {
            temperature = s.temperature;
        }
        if w.norm() > 0.01 {
            ended = s.time;
        }
        let t = temperature.add_scalar(-25.0);
        let late = if at > half { 1.0 } else { 0.0 };
        match name {
            "accelerometer transient after rotation" => {
                s.dvel += direction * (-(s.time - ended) / 40.0).exp() * dt;
            }
            "accelerometer bias step" => s.dvel += direction * late * dt,
            "accelerometer bias by temperature squared" => {
                s.dvel += direction.component_mul(&t.component_mul(&t)) * dt;
            }
            "gyro bias by (omega_i f_k)" => {
                let k = Vector3::new(f.z, f.x, f.y);
                s.dtheta += direction.component_mul(&w.component_mul(&k)) * dt;
            }
            "gyro bias step" => s.dtheta += direction * late * dt,
            _ => s.dvel += direction.component_mul(&w) * dt,
        }
    }
}
