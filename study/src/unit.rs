//! One unit through the experiment.

use nalgebra::{DMatrix, DVector, Vector3};
use rig::{Simulation, Truth};
use serde::{Deserialize, Serialize};
use sinscal::navigation::{Pilot, pilot};
use sinscal::{
    Calibration, Conventional, Diverged, Filter, FilterVisitor, Sample, Setup, Shape, StateInfo, Strapdown,
    visit_filter,
};

use crate::{Plan, Trouble};

/// Sigmas are looked at this often for the time of convergence, s.
const LOOK: f64 = 10.0;
/// A parameter has converged once its sigma stays within this factor of the final one.
const CONVERGED: f64 = 2.0;

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
    /// What the unit has.
    pub truth: f64,
    /// What the filter found.
    pub value: f64,
    /// What it says of its error.
    pub sigma: f64,
    /// When its sigma came within twice the final one for good, s.
    pub converged_s: f64,
}

/// Is told how things go, for figures. Every method does nothing by default.
pub trait Watch {
    /// Estimates and sigmas of a filter's parameters at a time of its last pass, s, at most every ten seconds.
    fn estimates(&mut self, filter: &str, time: f64, parameters: &[(f64, f64)]) {
        let _ = (filter, time, parameters);
    }

    /// Error of position in free-inertial navigation with a filter's calibration, m, at most every second.
    fn error(&mut self, filter: &str, time: f64, error: &Vector3<f64>) {
        let _ = (filter, time, error);
    }
}

/// Nobody watches.
impl Watch for () {}

impl Plan {
    /// [`unit`](Self::unit) with somebody watching.
    ///
    /// # Errors
    /// As there.
    pub fn unit_watched(&self, unit: u64, watch: &mut dyn Watch) -> Result<UnitResult, Trouble> {
        let simulation = Simulation::new(&self.scenario, unit)?;
        let description = simulation.description().clone();
        let truth = simulation.truth().clone();
        let samples: Vec<Sample> = simulation.collect();
        let mut filters = Vec::new();
        for name in &self.filters {
            let setup = description.setup(&[]);
            let calibrate =
                Calibrate { samples: &samples, setup, truth: &truth, plan: self, watch: &mut *watch };
            let result = visit_filter(name, calibrate).ok_or_else(|| Trouble::Filter(name.clone()))?;
            filters.push(result.map_err(|error| Trouble::Diverged { unit, filter: name.clone(), error })?);
        }
        drop(samples);
        if self.hours > 0.0 {
            self.navigate(unit, &mut filters, watch)?;
        }
        Ok(UnitResult { unit, filters })
    }

    /// Puts unit `unit` through the experiment.
    ///
    /// # Errors
    /// When the scenario cannot be simulated, a filter is unknown or diverges.
    pub fn unit(&self, unit: u64) -> Result<UnitResult, Trouble> {
        self.unit_watched(unit, &mut ())
    }

    fn navigate(
        &self,
        unit: u64,
        filters: &mut [FilterResult],
        watch: &mut dyn Watch,
    ) -> Result<(), Trouble> {
        let simulation = Simulation::new(&self.navigation(), unit)?;
        let description = simulation.description().clone();
        let setup = description.setup(&[]);
        let mut pilots: Vec<Box<dyn Pilot>> = Vec::new();
        for result in &*filters {
            let find = |info: &StateInfo| {
                let same = |p: &&ParameterResult| p.name == info.block && p.component == info.component;
                result.parameters.iter().find(same).map(|parameter| parameter.value)
            };
            pilots.push(
                pilot(&result.filter, &setup, find).ok_or_else(|| Trouble::Filter(result.filter.clone()))?,
            );
        }
        let until = self.alignment.min(0.5 * self.hours * 3600.0);
        for sample in simulation.clone().take_while(|sample| sample.time <= until) {
            step(unit, &mut pilots, &sample, watch)?;
        }
        for pilot in &mut pilots {
            pilot.depart();
        }
        for sample in simulation {
            step(unit, &mut pilots, &sample, watch)?;
        }
        for (result, pilot) in filters.iter_mut().zip(&pilots) {
            result.max_horizontal_m = Some(pilot.drift().largest);
            result.final_horizontal_m = Some(pilot.drift().last);
        }
        Ok(())
    }
}

fn step(
    unit: u64,
    pilots: &mut [Box<dyn Pilot>],
    sample: &Sample,
    watch: &mut dyn Watch,
) -> Result<(), Trouble> {
    for pilot in pilots {
        let compared = pilot.step(sample).map_err(|error| Trouble::Diverged {
            unit,
            filter: pilot.filter().to_owned(),
            error,
        })?;
        if let Some(error) = compared {
            watch.error(pilot.filter(), sample.time, &error);
        }
    }
    Ok(())
}

struct Calibrate<'a> {
    samples: &'a [Sample],
    setup: Setup<'a>,
    truth: &'a Truth,
    plan: &'a Plan,
    watch: &'a mut dyn Watch,
}

impl FilterVisitor for Calibrate<'_> {
    type Output = Result<FilterResult, Diverged>;

    fn visit<F: Filter<Dynamics = Strapdown>>(self) -> Self::Output {
        let mut run = Box::new(Calibration::<F, Conventional>::new(&self.setup));
        let mut sigmas: Vec<(f64, Vec<f64>)> = Vec::new();
        let passes = self.plan.passes.max(1);
        for pass in 0..passes {
            if pass > 0 {
                run.begin_pass();
            }
            sigmas.clear();
            for sample in self.samples {
                run.step(sample)?;
                if sigmas.last().is_none_or(|(time, _)| sample.time >= time + LOOK) {
                    let mut now = Vec::with_capacity(F::Shape::STATES);
                    run.parameters(&mut |parameter| now.push((parameter.value, parameter.sigma)));
                    if pass + 1 == passes {
                        self.watch.estimates(F::NAME, sample.time, &now);
                    }
                    sigmas.push((sample.time, now.iter().map(|(_, sigma)| *sigma).collect()));
                }
            }
        }
        let mut parameters = Vec::new();
        run.parameters(&mut |parameter| {
            let i = parameters.len();
            let settled = |(_, sigmas): &(f64, Vec<f64>)| sigmas[i] <= CONVERGED * parameter.sigma;
            let first = sigmas.iter().rposition(|look| !settled(look)).map_or(0, |last| last + 1);
            parameters.push(ParameterResult {
                name: parameter.info.block.to_owned(),
                component: parameter.info.component.to_owned(),
                truth: self.truth.of(&parameter.info),
                value: parameter.value,
                sigma: parameter.sigma,
                converged_s: sigmas.get(first).or(sigmas.last()).map_or(0.0, |(time, _)| *time),
            });
        });
        let (core, all) = (F::Shape::CORE, F::Shape::STATES);
        let p = run.covariance();
        // scaled to unit diagonal, so that Cholesky meets numbers of one size
        let scale: Vec<f64> = (core..all).map(|i| p[i][i].sqrt()).collect();
        let n = all - core;
        let scaled = DMatrix::from_fn(n, n, |i, j| p[core + i][core + j] / (scale[i] * scale[j]));
        let error = DVector::from_fn(n, |i, _| (parameters[i].value - parameters[i].truth) / scale[i]);
        let nees = scaled.cholesky().map_or(f64::NAN, |factor| error.dot(&factor.solve(&error)));
        Ok(FilterResult {
            filter: F::NAME.to_owned(),
            nis_per_dof: run.statistics().nis_per_dof(),
            nees,
            degrees_of_freedom: n,
            parameters,
            max_horizontal_m: None,
            final_horizontal_m: None,
        })
    }
}
