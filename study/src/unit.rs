//! One unit through the experiment.

use core::ops::ControlFlow;

use nalgebra::{DMatrix, DVector};
use rig::{Simulation, Truth};
use runs::{Calibrated, Flight, Options, Outcome, ReadError, Samples, calibrate_all, navigate, wandering};
use serde::{Deserialize, Serialize};
use sinscal::Sample;

use crate::{Plan, Trouble};

/// Points of a parameter's history are at least this far apart, s.
const LOOK: f64 = 10.0;
/// Samples of a simulation that are handed over at a time.
const CHUNK: usize = 8192;

/// What became of one unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct UnitResult {
    /// Seed of the unit.
    pub unit: u64,
    /// By filter, in the order of the plan.
    pub filters: Vec<FilterResult>,
}

/// What one filter made of the unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FilterResult {
    /// Name of the filter.
    pub filter: String,
    /// Mean normalised innovation squared per scalar measurement.
    pub nis_per_dof: f64,
    /// Normalised estimation error squared of all parameters together.
    pub nees: f64,
    /// Number of parameters.
    pub degrees_of_freedom: usize,
    /// By parameter.
    pub parameters: Vec<ParameterResult>,
    /// Largest horizontal error in navigation, m.
    pub max_horizontal_m: Option<f64>,
    /// Horizontal error at the end, m.
    pub final_horizontal_m: Option<f64>,
}

/// One parameter, SI.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ParameterResult {
    /// Name of the effect.
    pub name: String,
    /// Component.
    pub component: String,
    /// Unit of data sheets.
    pub sheet_unit: String,
    /// Size of one of them, SI.
    pub sheet_scale: f64,
    /// What the unit has.
    pub truth: f64,
    /// What the filter found.
    pub value: f64,
    /// What it says of its error.
    pub sigma: f64,
    /// When its sigma came within twice the final one for good, s.
    pub converged_s: f64,
}

/// A unit with all that figures are made of.
#[derive(Clone, Debug)]
pub struct Traced {
    /// The numbers.
    pub result: UnitResult,
    /// By filter: the calibration.
    pub outcomes: Vec<Outcome>,
    /// By filter: the navigation, where there was any.
    pub flights: Vec<Flight>,
}

/// The samples of a simulation, made anew for each reading.
struct Simulated(Simulation);

impl Samples for Simulated {
    fn read(&self, visit: &mut dyn FnMut(&[Sample]) -> ControlFlow<()>) -> Result<(), ReadError> {
        let mut simulation = self.0.clone();
        let mut chunk = Vec::with_capacity(CHUNK);
        loop {
            chunk.clear();
            chunk.extend(simulation.by_ref().take(CHUNK));
            if chunk.is_empty() || visit(&chunk).is_break() {
                return Ok(());
            }
        }
    }
}

impl Plan {
    /// Puts unit `unit` through the experiment.
    ///
    /// # Errors
    /// When the scenario cannot be simulated or a filter diverges.
    pub fn unit(&self, unit: u64) -> Result<UnitResult, Trouble> {
        self.unit_traced(unit).map(|traced| traced.result)
    }

    /// The same with all that figures are made of.
    ///
    /// # Errors
    /// As there.
    pub fn unit_traced(&self, unit: u64) -> Result<Traced, Trouble> {
        let trouble = |error| Trouble::Run { unit, error };
        let mut simulation = Simulation::new(&self.scenario, unit)?;
        let description = simulation.description().clone();
        // several passes: kept rather than made again
        let samples: Vec<Sample> = simulation.by_ref().collect();
        let truth = simulation.truth().clone();
        let mut outcomes = Vec::new();
        for filter in &self.filters {
            let wandering = wandering(filter, &description.wander).map_err(|e| trouble(e.into()))?;
            let filter = &*wandering;
            let options = Options { passes: self.passes, history_step: LOOK, ..Options::of(filter) };
            let mut outcome = calibrate_all(&[filter], &samples, &description.setup(&[]), &options, &mut ())
                .map_err(trouble)?;
            outcomes.append(&mut outcome);
        }
        drop(samples);
        let flights = if self.hours > 0.0 { self.navigate(unit, &outcomes)? } else { Vec::new() };
        let result = |(i, outcome)| FilterResult::new(outcome, &truth, flights.get(i));
        let result = UnitResult { unit, filters: outcomes.iter().enumerate().map(result).collect() };
        Ok(Traced { result, outcomes, flights })
    }

    fn navigate(&self, unit: u64, outcomes: &[Outcome]) -> Result<Vec<Flight>, Trouble> {
        let simulation = Simulation::new(&self.navigation(), unit)?;
        let description = simulation.description().clone();
        let calibrations: Vec<Calibrated> = self
            .filters
            .iter()
            .zip(outcomes)
            .map(|(filter, outcome)| Calibrated {
                filter: filter.clone(),
                values: outcome.values(),
                reference_temperature: Some(self.scenario.temperature.reference),
            })
            .collect();
        let setup = description.setup(&[]);
        let board = || calibrations.iter().map(|calibrated| calibrated.pilot(&setup)).collect();
        let (flights, _) = navigate(&Simulated(simulation), &board, self.aligning())
            .map_err(|error| Trouble::Run { unit, error })?;
        Ok(flights)
    }
}

impl FilterResult {
    fn new(outcome: &Outcome, truth: &Truth, flight: Option<&Flight>) -> Self {
        let parameters: Vec<ParameterResult> = outcome
            .parameters
            .iter()
            .enumerate()
            .map(|(i, parameter)| ParameterResult {
                name: parameter.info.block.to_owned(),
                component: parameter.info.component.to_owned(),
                sheet_unit: parameter.info.sheet_unit.to_owned(),
                sheet_scale: parameter.info.sheet_scale,
                truth: truth.of(&parameter.info),
                value: parameter.value,
                sigma: parameter.sigma,
                converged_s: outcome.converged(i).unwrap_or(outcome.duration),
            })
            .collect();
        Self {
            filter: outcome.filter.clone(),
            nis_per_dof: outcome.statistics.nis_per_dof(),
            nees: nees(outcome, &parameters),
            degrees_of_freedom: parameters.len(),
            parameters,
            max_horizontal_m: flight.map(|flight| flight.drift.largest),
            final_horizontal_m: flight.map(|flight| flight.drift.last),
        }
    }
}

/// Normalised estimation error squared of all parameters together.
fn nees(outcome: &Outcome, parameters: &[ParameterResult]) -> f64 {
    let (n, p) = (parameters.len(), &outcome.covariance);
    // scaled to unit diagonal, so that Cholesky meets numbers of one size
    let scale: Vec<f64> = (0..n).map(|i| p[i][i].sqrt()).collect();
    let scaled = DMatrix::from_fn(n, n, |i, j| p[i][j] / (scale[i] * scale[j]));
    let error = DVector::from_fn(n, |i, _| (parameters[i].value - parameters[i].truth) / scale[i]);
    scaled.cholesky().map_or(f64::NAN, |factor| error.dot(&factor.solve(&error)))
}
