//! Which run would tell two effects apart: chosen by their information from a menu of paths, each simulated.

use rig::motion::Turn;
use rig::scenario::Path;
use rig::{DitherMode, Scenario, ScenarioError, Simulation, TemperatureProfile};
use runs::AnyFilter;
use sinscal::{AnyEffect, Sample};

use crate::Error;
use crate::error::{SceneError, Which};
use crate::excite::parts;
use crate::linear::Noise;
use crate::log::Log;
use crate::parallel::both;
use crate::prices::Prices;
use crate::run::{Machine, Runs};
use crate::scene::EXCITED;

/// A run of the menu, and how well it would show an effect beside another.
#[derive(Clone, Debug, PartialEq)]
pub struct Proposal {
    /// What to do.
    pub run: &'static str,
    /// Standard deviations that an effect of its prior's size would show in its worst direction, with everything else in the
    /// filter and the other effect free.
    pub shows: f64,
}

/// Why no proposal can be made.
#[derive(Debug, thiserror::Error)]
pub enum ProposalError {
    /// The rig refused a scenario.
    #[error("a run of the menu cannot be simulated: {0}")]
    Scenario(#[from] ScenarioError),
    /// A filter diverged.
    #[error(transparent)]
    Diagnosis(#[from] Error),
}

type Change = fn(&mut Scenario);

const MENU: &[(&str, Change)] = &[
    ("the eighteen rotations at 10 deg/s", |_| {}),
    ("nineteen positions", |s| s.motion.path = Path::NineteenPositions),
    ("the eighteen rotations at 60 deg/s", |s| s.motion.rate = 60_f64.to_radians()),
    ("rotations to 45 deg positions about all axes", |s| s.motion.path = Path::Turns(turns(45.0, 1.0))),
    ("rotations at 5, 20 and 60 deg/s in both senses", |s| s.motion.path = Path::Turns(turns(360.0, 4.0))),
    ("the eighteen rotations while the temperature rises and falls", |s| {
        s.temperature.profile =
            TemperatureProfile::Ramps(vec![(0.0, 15.0), (500.0, 45.0), (1100.0, 20.0), (1700.0, 35.0)]);
    }),
    ("the eighteen rotations with the dither amplitude changed by 30 %", |s| {
        s.dither.change = 0.3;
        s.dither.period = 1200.0;
    }),
];

/// Turns by `angle` about each axis, forward and back; with `spread` also at a quarter and six times the rate.
fn turns(angle: f64, spread: f64) -> Vec<Turn> {
    let mut list = Vec::new();
    let rates: &[f64] = if spread > 1.0 { &[5.0, 20.0, 60.0] } else { &[10.0] };
    for (i, axis) in (0..3).map(|i| (i, rig::motion::Axis::Body(i))) {
        for rate in rates {
            // an odd number of steps one way leaves the next axis another attitude to start from
            for k in 0..if spread > 1.0 { 2 } else { 7 + i } {
                let sense = if spread > 1.0 && k % 2 == 1 { -1.0 } else { 1.0 };
                let angle = (sense * angle).to_radians();
                list.push(Turn { axis, angle, rate: rate.to_radians(), dwell: 50.0 });
            }
        }
    }
    list
}

/// What each run of the menu, simulated with a filter, would say of everything.
#[derive(Debug)]
pub struct Menu {
    runs: Vec<(&'static str, Prices, usize)>,
}

impl Menu {
    /// Simulates the menu for a filter of a turntable and the effects that it may lack: a few seconds.
    ///
    /// # Errors
    /// When a run cannot be simulated, the filter diverges, or the effects cannot be added to it.
    pub fn new(filter: &dyn AnyFilter, effects: &[&'static dyn AnyEffect]) -> Result<Self, ProposalError> {
        let machine = Runs::new(filter, effects).map_err(|e| ProposalError::Diagnosis(e.into()))?;
        let simulated = |(run, change): &(&'static str, Change)| -> Result<_, ProposalError> {
            let mut scenario = Scenario::default().with_rate(20.0)?;
            scenario.keep_effects(|name| machine.has(name));
            scenario.motion.still = 100.0;
            scenario.motion.dwell = 50.0;
            scenario.temperature.profile = TemperatureProfile::Constant(30.0);
            scenario.dither.mode = DitherMode::Mean;
            scenario.dither.change = 0.0;
            change(&mut scenario);
            let simulation = Simulation::new(&scenario, 1)?;
            let description = simulation.description().clone();
            let samples: Vec<Sample> = simulation.collect();
            let setup = description.setup(&[]);
            let broken = |e| ProposalError::Diagnosis(Error::of(Which::FIRST, e));
            let ran = machine
                .run(&Log { samples: &samples, setup: &setup }, &Noise::STATED, &|_| 1.0)
                .map_err(broken)?;
            let everything = parts(&ran.recording, &Noise::STATED, 1).pop();
            Ok((*run, everything.ok_or(broken(SceneError::Indefinite))?, ran.recording.base().len()))
        };
        let (left, right) = MENU.split_at(MENU.len() / 2);
        let some =
            |part: &[(&'static str, Change)]| part.iter().map(simulated).collect::<Result<Vec<_>, _>>();
        let (other, mine) = both(|| some(right), || some(left));
        let mut runs = mine?;
        runs.extend(other?);
        Ok(Self { runs })
    }

    /// The runs, the one that shows `effect` best beside `other` first.
    pub fn propose(&self, effect: &str, other: &str) -> Vec<Proposal> {
        let mut all: Vec<Proposal> = self
            .runs
            .iter()
            .map(|(run, everything, base)| Proposal {
                run,
                shows: shown(everything, *base, effect, other).unwrap_or(0.0),
            })
            .collect();
        all.sort_by(|a, b| b.shows.total_cmp(&a.shows));
        all
    }

    /// The run that tells two effects apart, in a sentence; nothing where no run of the menu shows either beside the other.
    pub fn sentence(&self, effect: &str, other: &str) -> Option<String> {
        let best = |a: &str, b: &str| self.propose(a, b).into_iter().next();
        let proposal = best(effect, other)
            .into_iter()
            .chain(best(other, effect))
            .max_by(|a, b| a.shows.total_cmp(&b.shows))
            .filter(|proposal| proposal.shows > EXCITED)?;
        let Proposal { run, shows } = proposal;
        Some(format!(
            "{effect} against {other}: {run}; simulated, an effect of its prior's size shows at {shows:.0} sigma beside the other"
        ))
    }
}

/// Standard deviations that `effect` would show in its worst direction, with the filter's own parameters and `other` free.
fn shown(everything: &Prices, base: usize, effect: &str, other: &str) -> Option<f64> {
    let own = |g: &usize| everything.groups[*g].members.iter().all(|m| *m < base);
    let mut free: Vec<usize> = everything.all().into_iter().filter(own).collect();
    let g = everything.find(effect)?;
    if let Some(other) = everything.find(other).filter(|o| !free.contains(o)) {
        free.push(other);
    }
    Some(everything.given(&free)?.excitation(g).1)
}
