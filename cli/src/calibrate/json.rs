//! The results for machines.

use std::time::Duration;

use logs::{Bridged, Log};
use miette::{IntoDiagnostic, Result};
use nalgebra::{UnitQuaternion, Vector3};
use runs::{AnyFilter, Options, Outcome, Stretch};
use serde::Serialize;
use sinscal::{CoarseCalibration, Smoothed};

/// `calibrate --json`.
#[derive(Serialize)]
pub(super) struct Report {
    filter: &'static str,
    /// Effects that were added to the filter at run time.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    with: Vec<&'static str>,
    /// Blocks that were left out of it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    without: Vec<&'static str>,
    states: usize,
    samples: u64,
    duration_s: f64,
    wall_s: f64,
    nis_per_dof: f64,
    verdict: &'static str,
    parameters: Vec<ParameterReport>,
    r#final: Final,
    passes: u32,
    form: &'static str,
    updates: usize,
    rejected: usize,
    repeated: usize,
    reopened: usize,
    /// Readings of the reference that were left out.
    refused: Vec<Stretch>,
    log_likelihood: f64,
    bridged_rows: u64,
    log: String,
    /// Where temperature effects vanish.
    reference_temperature_c: f64,
    /// What stands for a reference, and for what the description leaves open; in sentences.
    #[serde(skip_serializing_if = "<[String]>::is_empty")]
    assumed: Vec<String>,
    /// What the coarse stage took out of the samples; it is contained in the parameters.
    #[serde(skip_serializing_if = "Option::is_none")]
    coarse: Option<CoarseReport>,
    /// The smoothed navigation solution at the first update, with `--smooth`.
    #[serde(skip_serializing_if = "Option::is_none")]
    smoothed_start: Option<Final>,
}

#[derive(Serialize)]
struct CoarseReport {
    positions: usize,
    turns: usize,
    force_residual_m_s2: f64,
    gyro_rad_per_pulse: Option<[f64; 3]>,
    accel_m_s_per_pulse: Option<[f64; 3]>,
    parameters: Vec<CoarseEntry>,
}

#[derive(Serialize)]
struct CoarseEntry {
    name: &'static str,
    component: &'static str,
    value: Option<f64>,
    sigma: f64,
}

impl CoarseReport {
    fn new(coarse: &CoarseCalibration) -> Self {
        let parameters = coarse.parameters().map(|parameter| CoarseEntry {
            name: parameter.name,
            component: parameter.component,
            value: parameter.determined.then_some(parameter.value),
            sigma: parameter.sigma,
        });
        Self {
            positions: coarse.positions,
            turns: coarse.turns,
            force_residual_m_s2: coarse.force_residual,
            gyro_rad_per_pulse: coarse.gyro_pulse.map(Into::into),
            accel_m_s_per_pulse: coarse.accel_pulse.map(Into::into),
            parameters: parameters.collect(),
        }
    }
}

/// One parameter; what the data cannot show has no value.
#[derive(Serialize)]
struct ParameterReport {
    name: &'static str,
    component: &'static str,
    value: Option<f64>,
    sigma: Option<f64>,
    unit: &'static str,
    prior_sigma: f64,
    converged_s: Option<f64>,
    estimated: bool,
}

/// The navigation solution at one instant.
#[derive(Serialize)]
struct Final {
    attitude_quat_wxyz: [f64; 4],
    position_enu_m: [f64; 3],
    velocity_enu_m_s: [f64; 3],
}

impl Final {
    fn new(attitude: &UnitQuaternion<f64>, position: Vector3<f64>, velocity: Vector3<f64>) -> Self {
        Self {
            attitude_quat_wxyz: [attitude.w, attitude.i, attitude.j, attitude.k],
            position_enu_m: position.into(),
            velocity_enu_m_s: velocity.into(),
        }
    }
}

impl Report {
    pub(super) fn new(
        log: &Log,
        filter: &dyn AnyFilter,
        options: &Options,
        outcome: &Outcome,
        bridged: Bridged,
        wall: Duration,
    ) -> Self {
        let parameters = outcome.parameters.iter().enumerate().map(|(index, parameter)| {
            let known = |value: f64| parameter.estimated.then_some(value);
            ParameterReport {
                name: parameter.info.block,
                component: parameter.info.component,
                value: known(parameter.value),
                sigma: known(parameter.sigma),
                unit: parameter.info.unit,
                prior_sigma: parameter.prior_sigma,
                converged_s: outcome.converged(index).and_then(known),
                estimated: parameter.estimated,
            }
        });
        let start = outcome.smoothed.as_ref().and_then(|smoothed| smoothed.first());
        let site = &log.description().site;
        Self {
            filter: filter.name(),
            with: filter.with(),
            without: filter.without(),
            states: outcome.states,
            samples: outcome.samples - bridged.rows,
            duration_s: outcome.duration,
            wall_s: wall.as_secs_f64(),
            nis_per_dof: outcome.statistics.nis_per_dof(),
            verdict: outcome.verdict().name(),
            parameters: parameters.collect(),
            r#final: Final::new(&outcome.attitude, outcome.position, outcome.velocity),
            passes: options.passes,
            form: options.form.name(),
            updates: outcome.statistics.updates,
            rejected: outcome.statistics.rejected,
            repeated: outcome.statistics.repeated,
            reopened: outcome.statistics.reopened,
            refused: outcome.refused.clone(),
            log_likelihood: outcome.statistics.log_likelihood,
            bridged_rows: bridged.rows,
            log: log.table().display().to_string(),
            reference_temperature_c: log.description().reference_temperature,
            assumed: log.assumed().to_vec(),
            coarse: log.coarse().map(CoarseReport::new),
            smoothed_start: start.map(|Smoothed { navigation, .. }| {
                Final::new(&navigation.attitude, navigation.position(site), navigation.velocity)
            }),
        }
    }

    /// The document, with a line end.
    pub(super) fn render(&self) -> Result<String> {
        Ok(serde_json::to_string_pretty(self).into_diagnostic()? + "\n")
    }
}
