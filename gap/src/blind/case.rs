//! A unit with something hidden in it, and two logs of it.

use core::fmt;

use nalgebra::Vector3;
use rig::scenario::{Path, Population};
use rig::{DitherMode, Scenario, ScenarioError, Simulation, TemperatureProfile};
use runs::Vocabulary;
use sinscal::{PAPER, Sample, any_effect};

use super::Grade;
use crate::random::Stream;
use crate::{Diagnosis, Error, Log, Options, Verdict, diagnose};

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

/// Effects that can be hidden, with about what one standard deviation of the estimate is on the paths of these trials.
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
    ("gyro-bias-drift", 2.0e-11),
    ("inner-lever-arm-tangential", 4.0e-4),
];

/// What can be hidden that no block models.
const OUTSIDE: &[(&str, f64)] = &[
    ("accelerometer transient after rotation", 4e-6),
    ("accelerometer bias step", 4e-6),
    ("accelerometer bias by temperature squared", 3e-8),
    ("gyro bias by (omega_i f_k)", 1e-7),
    ("gyro bias step", 6e-9),
    ("gyro bias for 60 s", 5e-8),
    ("accelerometer bias for 60 s", 8e-6),
    ("accelerometer bias by omega_i", 2e-5),
];

/// Laws that resemble known effects, which no draw takes: the rules know of them.
const LAWS: &[(&str, f64)] = &[
    ("accelerometer bias by (T - T_ref) f_i^2", 3e-8),
    ("accelerometer bias by (dT/dt)^2", 2e-2),
    ("accelerometer bias by |omega| f_i", 4e-6),
];

const NOT_EXCITED: &[&str] = &["gyro-rate-nonlinearity", "dither-size-effect"];

/// Purpose of the random numbers that say how large and where.
const SIZE: &str = "blind/size";

const DITHER: &str = "dither-size-effect";

impl Hidden {
    /// In which row of the table a case counts.
    pub(crate) fn kind(&self) -> &'static str {
        match self {
            Self::Nothing(gyro, accel) if *gyro == 1.0 && *accel == 1.0 => "nothing",
            Self::Nothing(..) => "nothing, noise misstated",
            Self::Effects(names, _) if names.len() > 1 => "pair",
            Self::Effects(_, strength) => match strength {
                ..7.0 => "single,  6 sigma",
                ..10.0 => "single,  8 sigma",
                ..16.0 => "single, 12 sigma",
                ..50.0 => "single, 20 sigma",
                _ => "single, 80 sigma",
            },
            Self::Outside(..) => "outside",
            Self::NotExcited(_) => "not excited",
        }
    }

    /// Effects of the catalogue that the unit has and the filter does not.
    fn names(&self) -> &[&'static str] {
        match self {
            Self::Effects(names, _) => names,
            Self::NotExcited(name) => core::slice::from_ref(name),
            Self::Nothing(..) | Self::Outside(..) => &[],
        }
    }
}

impl fmt::Display for Hidden {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nothing(gyro, accel) => {
                write!(
                    f,
                    "nothing; noise stated {gyro} (gyro) and {accel} (accelerometer) times the true one"
                )
            }
            Self::Effects(names, sigma) => write!(f, "{}, about {sigma} sigma", names.join(" + ")),
            Self::Outside(name, sigma) => write!(f, "{name}, about {sigma} sigma"),
            Self::NotExcited(name) => write!(f, "{name}, which the path does not show"),
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
    truth: rig::Truth,
}

impl Case {
    /// Draws the case of a seed: what is hidden, and from which filter.
    ///
    /// # Errors
    /// When the rig refuses the scenario; that would be a fault of this crate.
    pub fn draw(seed: u64) -> Result<Self, ScenarioError> {
        let mut stream = Stream::new(seed, "blind");
        let strength = [6.0, 8.0, 12.0, 20.0, 80.0][stream.below(5)];
        let hidden = match stream.below(20) {
            0..2 => Hidden::Nothing(1.0, 1.0),
            2..4 => {
                let factor = |s: &mut Stream| [1.0 / 3.0, 0.5, 1.0, 2.0, 3.0][s.below(5)];
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
        let mut stream = Stream::new(seed, "blind/base");
        let bases: Vec<&'static str> =
            PAPER.iter().copied().filter(|base| lacks(base, hidden.names())).collect();
        Self::with(seed, bases[stream.below(bases.len())], hidden)
    }

    /// A unit of `seed` with `hidden` in it, and what `filter` knows.
    ///
    /// # Errors
    /// When the rig refuses the scenario.
    pub fn with(seed: u64, filter: &'static str, hidden: Hidden) -> Result<Self, ScenarioError> {
        let (first, truth) = simulate(seed, filter, &hidden, 0)?;
        let (second, _) = simulate(seed, filter, &hidden, 1)?;
        Ok(Self { seed, filter, hidden, logs: [first, second], truth })
    }

    /// Diagnoses it.
    ///
    /// # Errors
    /// When a filter diverges.
    pub fn diagnose(&self, options: &Options) -> Result<Diagnosis, Error> {
        let [a, b] = self.logs.each_ref().map(|(samples, description)| (samples, self.setup(description)));
        let first = Log { samples: a.0, setup: &a.1 };
        let second = Log { samples: b.0, setup: &b.1 };
        let vocabulary = Vocabulary::standard();
        let Ok(filter) = vocabulary.filter(self.filter) else {
            return Err(Error::TooShort { log: crate::Which::FIRST, updates: 0 });
        };
        diagnose(&*filter, vocabulary.effects(), &[first], Some(&second), options, &mut |_, _| {})
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
                    _ if listed(&[*name]) => Grade::Half,
                    _ => Grade::Miss,
                }
            }
        }
    }

    /// From when to when what is hidden lasts, s, where that is a minute.
    pub fn burst(&self) -> Option<(f64, f64)> {
        let Hidden::Outside(name, _) = self.hidden else { return None };
        let (samples, description) = &self.logs[0];
        let length = samples.len() as f64 / description.rate;
        let start = drawn(&mut Stream::new(self.seed, SIZE)).1 * length;
        name.contains("for 60 s").then_some((start, start + 60.0))
    }

    /// At how many standard deviations the single hidden effect shows in the log, to a filter that is the declared one.
    pub(crate) fn strength(&self, d: &Diagnosis) -> Option<f64> {
        let Hidden::Effects(names, _) = &self.hidden else { return None };
        let &[name] = names.as_slice() else { return None };
        let information = &d.rivals.iter().find(|r| r.name == name && name != DITHER)?.information;
        let n = information.len().isqrt();
        let of = |i: usize| self.truth.value(name, i);
        let sum: f64 = (0..n * n).map(|k| of(k / n) * information[k] * of(k % n)).sum();
        Some(sum.max(0.0).sqrt())
    }

    /// Normalised squared error of the values of rightly named effects, component by component, and their number.
    pub(crate) fn nees(&self, d: &Diagnosis) -> Option<(f64, usize)> {
        if self.grade(d) != Grade::Right || d.effects.is_empty() {
            return None;
        }
        let mut sum = (0.0, 0);
        for effect in d.effects.iter().filter(|e| e.name != DITHER) {
            for (i, (estimate, sigma)) in effect.estimate.iter().zip(&effect.sigma).enumerate() {
                sum.0 += ((estimate - self.truth.value(&effect.name, i)) / sigma).powi(2);
                sum.1 += 1;
            }
        }
        (sum.1 > 0).then_some(sum)
    }
}

/// Whether a filter has an effect.
fn has(filter: &str, effect: &str) -> bool {
    let Ok(filter) = Vocabulary::standard().filter(filter) else { return false };
    filter.blocks().iter().any(|leaf| leaf.name == effect) || effect == DITHER && filter.needs_dither()
}

/// Whether a filter has none of `names`, and for the dither's size effect the inner lever arms through which it acts.
fn lacks(filter: &str, names: &[&str]) -> bool {
    names.iter().all(|n| !has(filter, n)) && (!names.contains(&DITHER) || has(filter, "inner-lever-arm"))
}

/// Log `run` of the unit, and its truth.
fn simulate(
    seed: u64,
    filter: &str,
    hidden: &Hidden,
    run: u64,
) -> Result<((Vec<Sample>, rig::Description), rig::Truth), ScenarioError> {
    let mut stream = Stream::new(seed, "blind/scene");
    let rate = [25.0, 50.0][stream.below(2)];
    let swapped = stream.below(2) as u64;
    let mut scenario = Scenario::default().with_rate(rate)?;
    let names = hidden.names();
    let dithers = names.contains(&DITHER) || has(filter, DITHER);
    scenario.keep_effects(|name| has(filter, name) || dithers && name == DITHER);
    scenario.run = run;
    scenario.motion.still = 150.0;
    scenario.motion.dwell = 80.0;
    scenario.dither.mode = if dithers { DitherMode::Mean } else { DitherMode::Off };
    scenario.dither.period = 1500.0;
    scenario.dither.change = if matches!(hidden, Hidden::NotExcited(_)) { 0.0 } else { 0.3 };
    if run != swapped {
        scenario.motion.path = Path::NineteenPositions;
    }
    scenario.temperature.profile = TemperatureProfile::Ramps(if run == 0 {
        vec![(0.0, 20.0), (700.0, 38.0), (1300.0, 30.0), (2000.0, 33.0)]
    } else {
        vec![(0.0, 33.0), (500.0, 22.0), (1200.0, 36.0), (2000.0, 24.0)]
    });
    let mut stream = Stream::new(seed, SIZE);
    for name in names.iter().filter(|n| **n != DITHER) {
        let Some(effect) = any_effect(name) else { continue };
        let size = match hidden {
            Hidden::Effects(_, strength) => {
                EFFECTS.iter().find(|e| e.0 == *name).map_or(0.0, |e| e.1 * strength)
            }
            _ => 0.1 * effect.info().prior_sigma,
        };
        let mut mean: Vec<f64> = (0..effect.dim()).map(|_| stream.normal()).collect();
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
    let truth = simulation.truth().clone();
    let mut samples: Vec<Sample> = simulation.collect();
    if let Hidden::Outside(name, strength) = hidden {
        hide(name, *strength, scenario.rate, &mut samples, &mut stream);
    }
    Ok(((samples, description), truth))
}

/// Direction of what is hidden, and after which part of the log it begins where it lasts a minute.
fn drawn(stream: &mut Stream) -> (Vector3<f64>, f64) {
    let direction = Vector3::new(stream.normal(), stream.normal(), stream.normal()).normalize();
    (direction, 0.1 + 0.08 * stream.below(10) as f64)
}

/// Adds an error that no block models to the samples.
fn hide(name: &str, strength: f64, rate: f64, samples: &mut [Sample], stream: &mut Stream) {
    let size = OUTSIDE.iter().chain(LAWS).find(|o| o.0 == name).map_or(0.0, |o| o.1) * strength;
    let (direction, part) = drawn(stream);
    let direction = direction * size;
    let dt = 1.0 / rate;
    let half = samples.len() / 2;
    let minute = part * samples.len() as f64 * dt;
    let mut temperature = Vector3::repeat(25.0);
    let mut ended = f64::NEG_INFINITY;
    // follows the temperature by this time, s; as far as it is behind, the temperature changes
    let behind = 20.0;
    let mut followed: Option<Vector3<f64>> = None;
    for (at, s) in samples.iter_mut().enumerate() {
        let (w, f) = (s.dtheta / dt, s.dvel / dt);
        if !s.temperature.x.is_nan() {
            temperature = s.temperature;
        }
        if w.norm() > 0.01 {
            ended = s.time;
        }
        let t = temperature.add_scalar(-25.0);
        let before = *followed.get_or_insert(temperature);
        let warming = (temperature - before) / behind;
        followed = Some(before + warming * dt);
        let late = if at > half { 1.0 } else { 0.0 };
        let for_a_minute = if (0.0..60.0).contains(&(at as f64 * dt - minute)) { 1.0 } else { 0.0 };
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
            "accelerometer bias by (T - T_ref) f_i^2" => {
                s.dvel += direction.component_mul(&t).component_mul(&f.component_mul(&f)) * dt;
            }
            "accelerometer bias by (dT/dt)^2" => {
                s.dvel += direction.component_mul(&warming.component_mul(&warming)) * dt;
            }
            "accelerometer bias by |omega| f_i" => s.dvel += direction.component_mul(&f) * w.norm() * dt,
            "gyro bias step" => s.dtheta += direction * late * dt,
            "gyro bias for 60 s" => s.dtheta += direction * for_a_minute * dt,
            "accelerometer bias for 60 s" => s.dvel += direction * for_a_minute * dt,
            _ => s.dvel += direction.component_mul(&w) * dt,
        }
    }
}
