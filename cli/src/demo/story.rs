//! What happens in the demonstration: two runs of a unit, a diagnosis, and navigation before and after.

use std::sync::Arc;

use gap::Diagnosis;
use miette::{Result, miette};
use reports::Inputs;
use rig::scenario::{Path, Population};
use rig::{Description, DitherMode, Scenario, Simulation, TemperatureProfile, Truth};
use runs::{AnyFilter, Calibrated, Flight, Options, Outcome, calibrate, navigate};
use sinscal::{AnyEffect, DitherSizeEffect, Effect as _, InnerLeverArm, PAPER, Sample};
use study::Plan;

use crate::compose::compose;
use crate::say;
use crate::vocabulary::vocabulary;

/// How the unit is moved in the two runs, in words.
pub(super) const PATHS: [&str; 2] = ["on 18 rotations", "on 19 positions, warmed otherwise"];
/// Sampling rate of the two runs, Hz: what the turns need, and no more.
const RATE: f64 = 25.0;
/// Sampling rate of the swing, Hz: at half of it, what is lost of the coning outweighs a good calibration.
const SWING_RATE: f64 = 50.0;
/// Hours of navigation.
const HOURS: f64 = 4.0;
/// Alignment before it, s.
const ALIGNMENT: f64 = 900.0;
/// Passes of a calibration.
const PASSES: u32 = 2;
/// An effect that the default population lacks has components of about this part of its prior sigma.
const SIZE: f64 = 0.5;
/// A run of the unit.
pub(super) struct Run {
    pub(super) samples: Vec<Sample>,
    pub(super) description: Description,
}

/// What one filter made of the unit.
pub(super) struct Fit {
    pub(super) outcome: Outcome,
    pub(super) flight: Flight,
}

/// Everything that happened.
pub(super) struct Story {
    pub(super) seed: u64,
    pub(super) hidden: &'static dyn AnyEffect,
    /// The filter that lacks it.
    pub(super) base: &'static str,
    pub(super) truth: Truth,
    pub(super) first: Run,
    pub(super) found: Diagnosis,
    pub(super) before: Fit,
    /// With what was found.
    pub(super) after: Option<Fit>,
}

/// Names of the effects that can be hidden: those that some filter of the paper lacks.
pub(super) fn hideable() -> Vec<&'static str> {
    let lacked = |effect: &&&'static dyn AnyEffect| base_for(**effect).is_some();
    vocabulary().effects().iter().filter(lacked).map(|effect| effect.name()).collect()
}

/// The first filter of the paper that lacks an effect; dither acts through inner lever arms, so the filter that lacks it knows
/// those.
fn base_for(effect: &'static dyn AnyEffect) -> Option<Arc<dyn AnyFilter>> {
    let dithers = effect.id() == <dyn AnyEffect>::of::<DitherSizeEffect>().id();
    let lacks = |filter: &&Arc<dyn AnyFilter>| {
        PAPER.contains(&filter.name())
            && !names(&***filter).contains(&effect.name())
            && (!dithers || filter.blocks().iter().any(|leaf| leaf.is::<InnerLeverArm>()))
    };
    vocabulary().filters().find(lacks).cloned()
}

/// Names of a filter's effects.
fn names(filter: &dyn AnyFilter) -> Vec<&'static str> {
    filter.blocks().iter().map(|leaf| leaf.name).collect()
}

impl Story {
    /// Draws unit `seed`, hides the effect called `hide` in it, and looks for it.
    pub(super) fn tell(seed: u64, hide: &str) -> Result<Self> {
        let hidden = vocabulary().effect(hide).map_err(|error| miette!("{error}"))?;
        let base = base_for(hidden).ok_or_else(|| miette!("every filter of the paper has {hide}"))?;
        let scenario = scenario(hidden, &*base)?;
        let bar = say::progress_bar(100, "simulating");
        let first = Run::new(&scenario, seed)?;
        let second = Run::new(&again(&scenario), seed)?;
        let swing = swing(&scenario, seed)?;
        let truth = scenario.unit(seed);

        let setups = [&first, &second].map(|run| run.description.setup(&[]));
        let log = gap::Log { samples: &first.samples, setup: &setups[0] };
        let verify = gap::Log { samples: &second.samples, setup: &setups[1] };
        let options = gap::Options { seed, ..gap::Options::default() };
        let effects = vocabulary().effects();
        let found = gap::diagnose(&*base, effects, &[log], Some(&verify), &options, &mut |stage, done| {
            bar.set_message(stage);
            bar.set_position((80.0 * done) as u64);
        })
        .map_err(|error| miette!("the demonstration: {error}"))?;

        bar.set_message("navigating");
        bar.set_position(85);
        let added: Vec<String> = found.effects.iter().map(|effect| effect.name.clone()).collect();
        let with_found = (!added.is_empty()).then(|| compose(base.name(), &added, &[])).transpose()?;
        let (before, after) = rayon::join(
            || Fit::new(&first, &swing, &base),
            || with_found.map(|filter| Fit::new(&first, &swing, &filter)),
        );
        bar.finish_and_clear();
        let failed = |error: runs::Error| miette!("the demonstration: {error}");
        let (before, after) = (before.map_err(failed)?, after.transpose().map_err(failed)?);
        let base = base.name();
        Ok(Self { seed, hidden, base, truth, first, found, before, after })
    }
}

/// The default population, but of all effects only those of the filter, and the hidden one.
fn scenario(hidden: &'static dyn AnyEffect, base: &dyn AnyFilter) -> Result<Scenario> {
    let mut scenario = Scenario::default().with_rate(RATE).map_err(|error| miette!("{error}"))?;
    let own = names(base);
    scenario.keep_effects(|name| own.contains(&name) || name == hidden.name());
    let known = scenario.population.iter().any(|population| population.effect.name() == hidden.name());
    let dithers = hidden.name() == DitherSizeEffect::EFFECT.name();
    if !known && !dithers {
        let size = vec![SIZE * hidden.info().prior_sigma; hidden.dim()];
        let sigma = size.iter().map(|size| 0.5 * size).collect();
        scenario.population.push(Population { effect: hidden, mean: size, sigma });
    }
    scenario.dither.mode = if dithers { DitherMode::Mean } else { DitherMode::Off };
    scenario.dither.period = 3000.0;
    scenario.dither.change = 0.3;
    scenario.temperature.profile =
        TemperatureProfile::Ramps(vec![(0.0, 20.0), (1400.0, 38.0), (2600.0, 30.0), (4000.0, 33.0)]);
    Ok(scenario)
}

/// The same unit on another day, another path, at other temperatures.
fn again(scenario: &Scenario) -> Scenario {
    let mut scenario = scenario.clone();
    scenario.run = 1;
    scenario.motion.path = Path::NineteenPositions;
    scenario.temperature.profile =
        TemperatureProfile::Ramps(vec![(0.0, 33.0), (1000.0, 22.0), (2400.0, 36.0), (4000.0, 24.0)]);
    scenario
}

/// The same unit swinging, for navigation.
fn swing(scenario: &Scenario, seed: u64) -> Result<Run> {
    let mut plan = Plan {
        scenario: scenario.clone(),
        filters: Vec::new(),
        passes: PASSES,
        hours: HOURS,
        alignment: ALIGNMENT,
        motion: Plan::paper_swing().map_err(|error| miette!("{error}"))?,
    };
    plan.scenario.run = 1;
    plan.scenario.rate = SWING_RATE;
    Run::new(&plan.navigation(), seed)
}

impl Run {
    fn new(scenario: &Scenario, seed: u64) -> Result<Self> {
        let simulation = Simulation::new(scenario, seed).map_err(|error| miette!("{error}"))?;
        Ok(Self { description: simulation.description().clone(), samples: simulation.collect() })
    }

    /// s.
    pub(super) fn duration(&self) -> f64 {
        self.samples.last().map_or(0.0, |sample| sample.time)
    }

    /// What the unit was put through.
    pub(super) fn inputs(&self) -> Inputs {
        let mut inputs = Inputs::new();
        self.samples.iter().for_each(|sample| inputs.push(sample));
        inputs
    }
}

impl Fit {
    /// Calibrates `run` with a filter, and navigates on `swing`.
    fn new(run: &Run, swing: &Run, filter: &Arc<dyn AnyFilter>) -> Result<Self, runs::Error> {
        let options = Options { passes: PASSES, residuals: true, ..Options::of(&**filter) };
        let outcome = calibrate(&**filter, &run.samples, &run.description.setup(&[]), &options, &mut ())?;
        let reference_temperature = Some(run.description.reference_temperature);
        let calibrated =
            Calibrated { filter: filter.clone(), values: outcome.values(), reference_temperature };
        let setup = swing.description.setup(&[]);
        let (mut flights, _) = navigate(&swing.samples, &|| vec![calibrated.pilot(&setup)], ALIGNMENT)?;
        Ok(Self { outcome, flight: flights.swap_remove(0) })
    }
}
