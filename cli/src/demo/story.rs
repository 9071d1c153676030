//! What happens in the demonstration: two runs of a unit, a diagnosis, and navigation before and after.

use calib_core::{Extended, Vector};
use gap::{Candidates, Diagnosis, Options};
use miette::{Result, miette};
use rig::scenario::{Path, Population};
use rig::{Description, DitherMode, Scenario, Simulation, TemperatureProfile, Truth};
use sinscal::navigation::{Alignment, Drift, FreeInertial, NAUTICAL_MILE};
use sinscal::{
    Block, Calibration, ChannelInnovations, Diverged, EffectInfo, Filter, FilterVisitor, Innovations,
    Parameter, Sample, Setup, Sins36P, Statistics, Strapdown, visit_filter,
};
use study::Plan;

use crate::say;
use reports::Inputs;
use runs::History;

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
/// Points kept of the error in navigation: one for so many samples.
const TRACK: usize = 10;

/// Time, east and north error, s and m.
type Track = Vec<(f64, f64, f64)>;

/// A run of the unit.
pub(super) struct Run {
    pub(super) samples: Vec<Sample>,
    pub(super) description: Description,
}

/// What one filter made of the unit.
pub(super) struct Fit {
    pub(super) parameters: Vec<Parameter>,
    pub(super) history: History,
    pub(super) statistics: Statistics,
    pub(super) residuals: Vec<ChannelInnovations>,
    drift: Drift,
    pub(super) track: Track,
}

/// Everything that happened.
pub(super) struct Story {
    pub(super) seed: u64,
    pub(super) hidden: &'static EffectInfo,
    /// The filter that lacks it.
    pub(super) base: &'static str,
    pub(super) truth: Truth,
    pub(super) first: Run,
    pub(super) found: Diagnosis,
    pub(super) before: Fit,
    /// With what was found.
    pub(super) after: Option<Fit>,
}

/// Names of the effects that can be hidden: those that the filter for them lacks.
pub(super) fn hideable() -> Vec<&'static str> {
    let lacks = |effect: &&EffectInfo| !states(base_for(effect.name())).contains(&effect.name());
    sinscal::EFFECTS.iter().filter(lacks).map(EffectInfo::name).collect()
}

/// Dither acts through inner lever arms: the filter that lacks it knows those.
fn base_for(effect: &str) -> &'static str {
    if effect == "dither-size-effect" { "39d-p" } else { "36d-p" }
}

/// Names of a filter's effects.
fn states(filter: &str) -> Vec<&'static str> {
    struct Names;
    impl FilterVisitor for Names {
        type Output = Vec<&'static str>;

        fn visit<F: Filter<Dynamics = Strapdown>>(self) -> Self::Output {
            let mut names = Vec::new();
            F::states(&mut |info| names.push(info.block));
            names
        }
    }
    visit_filter(filter, Names).unwrap_or_default()
}

impl Story {
    /// Draws unit `seed`, hides the effect called `hide` in it, and looks for it.
    pub(super) fn tell(seed: u64, hide: &str) -> Result<Self> {
        let hidden = sinscal::effect(hide).ok_or_else(|| miette!("there is no effect called {hide}"))?;
        let base = base_for(hide);
        let scenario = scenario(hidden, base)?;
        let bar = say::progress_bar(100, "simulating");
        let first = Run::new(&scenario, seed)?;
        let second = Run::new(&again(&scenario), seed)?;
        let swing = swing(&scenario, seed)?;
        let truth = scenario.unit(seed);

        let setups = [&first, &second].map(|run| run.description.setup(&[]));
        let log = gap::Log { samples: &first.samples, setup: &setups[0] };
        let verify = gap::Log { samples: &second.samples, setup: &setups[1] };
        let options = Options { seed, ..Options::default() };
        let found = gap::diagnose_named(base, &log, Some(&verify), &options, &mut |stage, done| {
            bar.set_message(stage);
            bar.set_position((80.0 * done) as u64);
        })
        .ok_or_else(|| miette!("there is no filter called {base}"))?
        .map_err(|error| miette!("the demonstration: {error}"))?;

        bar.set_message("navigating");
        bar.set_position(85);
        let names: Vec<&str> = found.effects.iter().map(|effect| effect.name.as_str()).collect();
        let known = states(base);
        let with_found: Vec<&str> = known.iter().copied().chain(names.iter().copied()).collect();
        let (before, after) = rayon::join(
            || Fit::new(&first, &swing, &known),
            || (!names.is_empty()).then(|| Fit::new(&first, &swing, &with_found)),
        );
        bar.finish_and_clear();
        let failed = |error: Diverged| miette!("the demonstration: {error}");
        let (before, after) = (before.map_err(failed)?, after.transpose().map_err(failed)?);
        Ok(Self { seed, hidden, base, truth, first, found, before, after })
    }
}

/// The default population, but of all effects only those of the filter, and the hidden one.
fn scenario(hidden: &'static EffectInfo, base: &str) -> Result<Scenario> {
    let mut scenario = Scenario::default().with_rate(RATE).map_err(|error| miette!("{error}"))?;
    let own = states(base);
    scenario.keep_effects(|name| own.contains(&name) || name == hidden.name());
    let known = scenario.population.iter().any(|population| population.effect.name() == hidden.name());
    let effect =
        sinscal::any_effect(hidden.name()).filter(|_| !known && hidden.name() != "dither-size-effect");
    if let Some(effect) = effect {
        let size = vec![SIZE * hidden.prior_sigma; hidden.components().len()];
        let sigma = size.iter().map(|size| 0.5 * size).collect();
        scenario.population.push(Population { effect, mean: size, sigma });
    }
    scenario.dither.mode =
        if hidden.name() == "dither-size-effect" { DitherMode::Mean } else { DitherMode::Off };
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

/// The smallest filter with every effect that it may lack: with priors of zero for what is not taken, each of the filters that
/// are compared.
type Everything = Extended<Sins36P, Candidates>;

impl Fit {
    /// Calibrates `run` with a filter of the given effects, and navigates on `swing`.
    fn new(run: &Run, swing: &Run, effects: &[&str]) -> Result<Self, Diverged> {
        let setup = run.description.setup(&[]);
        let own = states(Sins36P::NAME);
        let mut calibration =
            Box::new(Calibration::<Everything>::with_prior(&setup, |state, info, sigma| {
                // what the filter declares stands among the candidates once more
                let candidate = effects.contains(&info.block) && !own.contains(&info.block);
                if state < Sins36P::DIM || candidate { sigma } else { 0.0 }
            }));
        let taken = |calibration: &Calibration<Everything>, visit: &mut dyn FnMut(Parameter)| {
            calibration.parameters(&mut |parameter| {
                if parameter.prior_sigma > 0.0 {
                    visit(parameter);
                }
            });
        };
        let mut width = 0;
        taken(&calibration, &mut |_| width += 1);
        let mut history = History::new(width, 0.0);
        let mut observer = None;
        for pass in 0..PASSES {
            if pass > 0 {
                calibration.begin_pass();
                history.clear();
            }
            if pass + 1 == PASSES {
                observer = Some(Innovations::default());
            }
            for sample in &run.samples {
                let update = calibration.step_observed(sample, &mut observer)?;
                if update.is_some() && history.due(sample.time) {
                    let mut now = Vec::with_capacity(width);
                    taken(&calibration, &mut |parameter| now.push((parameter.value, parameter.sigma)));
                    history.push(sample.time, now.into_iter());
                }
            }
        }
        let mut parameters = Vec::new();
        taken(&calibration, &mut |parameter| parameters.push(parameter));
        let (drift, track) = fly(&swing.samples, &swing.description.setup(&[]), &calibration.estimate())?;
        Ok(Self {
            parameters,
            history,
            statistics: *calibration.statistics(),
            residuals: observer.map_or(Vec::new(), Innovations::finish),
            drift,
            track,
        })
    }

    /// Largest horizontal error, nautical miles.
    pub(super) fn largest(&self) -> f64 {
        self.drift.largest / NAUTICAL_MILE
    }

    /// Horizontal error at the end, nautical miles.
    pub(super) fn last(&self) -> f64 {
        self.drift.last / NAUTICAL_MILE
    }

    /// Length of the navigation, h.
    pub(super) fn hours(&self) -> f64 {
        self.drift.duration / 3600.0
    }
}

/// Aligns over the first minutes of a log, then navigates it.
fn fly(
    samples: &[Sample],
    setup: &Setup,
    parameters: &Vector<Everything, f64>,
) -> Result<(Drift, Track), Diverged> {
    let mut alignment = Alignment::<Everything>::new(setup, parameters);
    for sample in samples.iter().take_while(|sample| sample.time <= ALIGNMENT) {
        alignment.step(sample)?;
    }
    let mut flight = FreeInertial::<Everything>::new(setup, parameters);
    if let Some((time, solution)) = alignment.finish() {
        flight.depart(time, solution);
    }
    let mut track = Vec::new();
    let mut compared = 0;
    for sample in samples {
        if let Some(error) = flight.step(sample) {
            if compared % TRACK == 0 {
                track.push((sample.time, error.x, error.y));
            }
            compared += 1;
        }
    }
    Ok((*flight.drift(), track))
}
