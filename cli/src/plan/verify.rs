//! A plan tried on simulated units.

use std::fmt;
use std::sync::Arc;

use miette::{IntoDiagnostic, Result};
use plan::Expected;
use rayon::prelude::*;
use rig::{DitherMode, Scenario};
use runs::AnyFilter;
use serde::Serialize;
use study::{Plan, Summary};

/// What simulated units say of a plan: whether sigmas are those of the errors.
#[derive(Serialize)]
pub(super) struct Verified {
    units: usize,
    /// Mean normalised estimation error squared per parameter.
    nees_per_dof: f64,
    /// Where that lies in 99 % of such trials if the filter knows its errors.
    nees_band_99: [f64; 2],
    consistent: bool,
    /// Least and greatest of the sigmas that the calibrations stated, as parts of those that were expected.
    stated_to_expected: [f64; 2],
}

impl fmt::Display for Verified {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [low, high] = self.nees_band_99;
        let within = if self.consistent { "within" } else { "NOT within" };
        let Self { units, nees_per_dof, .. } = self;
        let [least, most] = self.stated_to_expected;
        write!(
            f,
            "NEES {nees_per_dof:.2} of {units} simulated units, {within} {low:.2} to {high:.2}, their sigmas {least:.2} to {most:.2} of \
             those expected"
        )
    }
}

/// Puts units with the errors that the filter models through the path, and calibrates them.
pub(super) fn fly(
    filter: &Arc<dyn AnyFilter>,
    scenario: &Scenario,
    expected: &Expected,
    (seed, units): (u64, u32),
) -> Result<Verified> {
    let mut scenario = scenario.clone();
    let parameters = filter.parameters();
    scenario
        .population
        .retain(|population| parameters.iter().any(|state| state.block == population.effect.name()));
    if !filter.needs_dither() {
        scenario.dither.mode = DitherMode::Off;
    }
    let motion = scenario.motion.clone();
    let plan = Plan {
        passes: filter.passes(),
        filters: vec![filter.clone()],
        hours: 0.0,
        alignment: 0.0,
        scenario,
        motion,
    };
    let units: Result<Vec<_>, _> =
        (seed..seed + u64::from(units)).into_par_iter().map(|unit| plan.unit(unit)).collect();
    let units = units.into_diagnostic()?;
    let stated = units.iter().flat_map(|unit| unit.filters[0].parameters.iter().zip(&expected.sigma));
    let mut stated_to_expected = [f64::INFINITY, 0.0];
    for (parameter, (_, expected)) in stated {
        let ratio = parameter.sigma / expected;
        stated_to_expected = [stated_to_expected[0].min(ratio), stated_to_expected[1].max(ratio)];
    }
    let summary = Summary::new(&units);
    let filter = &summary.filters[0];
    Ok(Verified {
        units: summary.units,
        nees_per_dof: filter.nees_per_dof,
        nees_band_99: filter.nees_band_99,
        consistent: filter.consistent,
        stated_to_expected,
    })
}
