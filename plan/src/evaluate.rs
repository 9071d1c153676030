//! What a path will show.

use std::sync::Arc;

use rig::motion::Turn;
use rig::scenario::Path;
use rig::{Ahead, Scenario, ScenarioError, Simulation};
use runs::{AnyFilter, Options, Outcome, calibrate};
use sinscal::{Sample, StateInfo};

use crate::criterion::{Group, groups};
use crate::foresight::Foresight;

/// Nobody looks at how sigmas came about.
const NO_HISTORY: f64 = 1e9;

/// Why a path cannot be evaluated.
#[derive(Debug, thiserror::Error)]
pub enum Trouble {
    /// It cannot be simulated.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// The filter came to no result.
    #[error(transparent)]
    Run(#[from] runs::Error),
    /// There is no path to choose from.
    #[error("{0}")]
    Impossible(String),
}

/// What a path is expected to show.
#[derive(Clone, Debug)]
pub struct Expected {
    /// How long the path takes, s.
    pub duration: f64,
    /// Each parameter with the sigma to expect at the end, SI.
    pub sigma: Vec<(StateInfo, f64)>,
}

impl From<&Outcome> for Expected {
    fn from(outcome: &Outcome) -> Self {
        let sigma = outcome.parameters.iter().map(|parameter| (parameter.info, parameter.sigma)).collect();
        Self { duration: outcome.duration, sigma }
    }
}

/// Says what paths will show to a filter.
///
/// Of a path of turns the covariance of the filter is moved along the motion as the table will make it, without samples: sigmas depend on
/// the motion, not on the errors of a unit. They are those that a calibration states once it has converged, within a few per cent.
#[derive(Clone)]
pub struct Evaluator {
    filter: Arc<dyn AnyFilter>,
    parameters: Vec<StateInfo>,
    scenario: Scenario,
    seed: u64,
}

impl Evaluator {
    /// For a filter and the surroundings of a scenario, with the means of its population. `seed` numbers the unit: its dither.
    pub fn new(filter: Arc<dyn AnyFilter>, scenario: &Scenario, seed: u64) -> Self {
        let mut scenario = scenario.clone();
        for population in &mut scenario.population {
            population.sigma.fill(0.0);
        }
        let parameters = filter.parameters();
        Self { filter, parameters, scenario, seed }
    }

    /// The scenario that paths are tried in.
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// What the scenario's own path will show. Of a swing or a rest the filter runs over what the unit would feel.
    ///
    /// # Errors
    /// When it cannot be simulated, or the filter comes to no result.
    pub fn own(&self) -> Result<Expected, Trouble> {
        let motion = &self.scenario.motion;
        match motion.turns() {
            Some(turns) => self.turns(&turns, motion.still),
            None => self.flown(),
        }
    }

    /// What `turns` after a rest of `still` seconds will show, in milliseconds.
    ///
    /// # Errors
    /// As there.
    pub fn turns(&self, turns: &[Turn], still: f64) -> Result<Expected, Trouble> {
        self.with_priors(turns, still, &[])
    }

    /// What `turns` would show of each effect if all the others were known: the noise alone.
    ///
    /// # Errors
    /// As there.
    pub fn alone(&self, turns: &[Turn], still: f64) -> Result<Vec<Group>, Trouble> {
        let mut alone = Vec::new();
        let names = groups(&self.turns(turns, still)?);
        for (name, _) in &names {
            let known = names.iter().filter(|(other, _)| other != name);
            let priors: Vec<(&str, f64)> = known.map(|(other, _)| (other.as_str(), 0.0)).collect();
            let expected = groups(&self.with_priors(turns, still, &priors)?);
            alone.extend(expected.into_iter().filter(|(other, _)| other == name));
        }
        Ok(alone)
    }

    /// The scenario with another path.
    pub fn along(&self, turns: &[Turn], still: f64) -> Scenario {
        let mut scenario = self.scenario.clone();
        scenario.motion.path = Path::Turns(turns.to_vec());
        scenario.motion.still = still;
        scenario
    }

    fn with_priors(&self, turns: &[Turn], still: f64, priors: &[(&str, f64)]) -> Result<Expected, Trouble> {
        let scenario = self.along(turns, still);
        let simulation = Simulation::new(&scenario, self.seed)?;
        let description = simulation.description().clone();
        let mut foresight = Foresight::new(Ahead::new(simulation), &scenario, turns, still);
        let sigma = self.filter.foresee(&mut foresight, &description.setup(priors))?;
        Ok(Expected {
            duration: scenario.duration(),
            sigma: self.parameters.iter().copied().zip(sigma).collect(),
        })
    }

    fn flown(&self) -> Result<Expected, Trouble> {
        let simulation = Simulation::new(&self.scenario, self.seed)?;
        let description = simulation.description().clone();
        let samples: Vec<Sample> = simulation.collect();
        let options = Options { history_step: NO_HISTORY, ..Options::of(&*self.filter) };
        let outcome = calibrate(&*self.filter, &samples, &description.setup(&[]), &options, &mut ())?;
        Ok(Expected { duration: self.scenario.duration(), ..Expected::from(&outcome) })
    }
}
