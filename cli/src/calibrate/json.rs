//! The results for machines.

use std::time::Duration;

use logs::units::DEGREE;
use logs::{Bridged, Log};
use miette::{IntoDiagnostic, Result};
use nalgebra::{UnitQuaternion, Vector3};
use runs::{AnyFilter, Exact, Options, Outcome, Pass, Stretch};
use serde::Serialize;
use sinscal::{CoarseCalibration, Parameter, SiteShown, Smoothed};

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
    /// Blocks whose states were considered.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    considered: Vec<&'static str>,
    states: usize,
    samples: u64,
    duration_s: f64,
    wall_s: f64,
    nis_per_dof: f64,
    verdict: &'static str,
    parameters: Vec<ParameterReport>,
    r#final: Final,
    /// What was found pass by pass, and by the shortened steps where a pass made it worse.
    passes: Vec<Pass>,
    /// By how many standard deviations another pass would move what moves most.
    #[serde(skip_serializing_if = "Option::is_none")]
    passes_agree_to_sigma: Option<f64>,
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
    /// What rests in several positions show of the site.
    #[serde(skip_serializing_if = "Option::is_none")]
    site_shown: Option<SiteReport>,
    /// What was taken as exact, and what the largest of it would do.
    #[serde(skip_serializing_if = "Option::is_none")]
    taken_as_exact: Option<String>,
    /// What the coarse stage took out of the samples; it is contained in the parameters.
    #[serde(skip_serializing_if = "Option::is_none")]
    coarse: Option<CoarseReport>,
    /// The smoothed navigation solution at the first update, with `--smooth`.
    #[serde(skip_serializing_if = "Option::is_none")]
    smoothed_start: Option<Final>,
}

/// Values and standard deviations.
#[derive(Serialize)]
struct SiteReport {
    positions: usize,
    latitude_deg: [f64; 2],
    earth_rate_deg_h: [f64; 2],
    gravity_m_s2: [f64; 2],
}

impl SiteReport {
    fn new(shown: &SiteShown) -> Self {
        let of = |(value, sigma): (f64, f64), scale: f64| [value / scale, sigma / scale];
        Self {
            positions: shown.positions,
            latitude_deg: of(shown.latitude, DEGREE),
            earth_rate_deg_h: of(shown.earth_rate, DEGREE / 3600.0),
            gravity_m_s2: of(shown.gravity, 1.0),
        }
    }
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
pub(super) struct ParameterReport {
    name: &'static str,
    component: &'static str,
    value: Option<f64>,
    /// The one to rely on.
    sigma: Option<f64>,
    /// That of the filter, were its model and noise exact.
    sigma_formal: Option<f64>,
    /// Between the halves of the log, in stated sigmas.
    halves: Option<f64>,
    unit: &'static str,
    prior_sigma: f64,
    converged_s: Option<f64>,
    estimated: bool,
    /// Between which values it went since it converged, where it changes in the course of a run.
    #[serde(skip_serializing_if = "Option::is_none")]
    range: Option<[f64; 2]>,
    /// What the sigma is made of, where something is considered.
    #[serde(flatten)]
    budget: Option<super::budget::Entry>,
    /// Wander of the biases over an hour that would double the sigma, where it was taken to be none.
    #[serde(skip_serializing_if = "Option::is_none")]
    doubled_by_wander: Option<Doubled>,
}

/// Standard deviations of Gauss-Markov processes.
#[derive(Serialize)]
struct Doubled {
    gyro_rad_s: Option<f64>,
    accel_m_s2: Option<f64>,
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

/// The passes; where nobody asked whether they agree they were all kept.
fn passes(options: &Options, outcome: &Outcome) -> Vec<Pass> {
    if outcome.passes.is_empty() {
        return vec![Pass { log_posterior: None, kept: true }; options.passes as usize];
    }
    outcome.passes.clone()
}

impl ParameterReport {
    fn new(index: usize, parameter: &Parameter, filter: &dyn AnyFilter, outcome: &Outcome) -> Self {
        let repeat = outcome.repeat.as_ref();
        let known = |value: f64| parameter.estimated.then_some(value);
        let factor = repeat.map_or(1.0, |repeat| repeat.factors[index]);
        Self {
            halves: repeat.and_then(|repeat| repeat.halves[index]).and_then(known),
            converged_s: outcome.converged(index).and_then(known),
            range: outcome.range(index, |name| filter.changes(name)).map(|(least, most)| [least, most]),
            budget: if parameter.estimated { super::budget::Entry::of(outcome, index) } else { None },
            ..Self::stated(parameter, factor)
        }
    }

    /// With the factor by which the stated sigma is larger than the formal one.
    pub(super) fn stated(parameter: &Parameter, factor: f64) -> Self {
        let known = |value: f64| parameter.estimated.then_some(value);
        Self {
            name: parameter.info.block,
            component: parameter.info.component,
            value: known(parameter.value),
            sigma: known(parameter.sigma),
            sigma_formal: known(parameter.sigma / factor),
            halves: None,
            unit: parameter.info.unit,
            prior_sigma: parameter.prior_sigma,
            converged_s: None,
            estimated: parameter.estimated,
            range: None,
            budget: None,
            doubled_by_wander: None,
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
        let parameters = outcome
            .parameters
            .iter()
            .enumerate()
            .map(|(index, parameter)| ParameterReport::new(index, parameter, filter, outcome));
        let start = outcome.smoothed.as_ref().and_then(|smoothed| smoothed.first());
        let site = &log.description().site;
        Self {
            filter: filter.name(),
            with: filter.with(),
            without: filter.without(),
            considered: filter.considers(),
            states: outcome.states,
            samples: outcome.samples - bridged.rows,
            duration_s: outcome.duration,
            wall_s: wall.as_secs_f64(),
            nis_per_dof: outcome.statistics.nis_per_dof(),
            verdict: outcome.verdict().name(),
            parameters: parameters.collect(),
            r#final: Final::new(&outcome.attitude, outcome.position, outcome.velocity),
            passes: passes(options, outcome),
            passes_agree_to_sigma: outcome.moved,
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
            site_shown: outcome.site.as_ref().map(SiteReport::new),
            taken_as_exact: None,
            coarse: log.coarse().map(CoarseReport::new),
            smoothed_start: start.map(|Smoothed { navigation, .. }| {
                Final::new(&navigation.attitude, navigation.position(site), navigation.velocity)
            }),
        }
    }

    /// With what was assumed of what is considered.
    pub(super) fn assuming(mut self, assumed: Vec<String>) -> Self {
        self.assumed.extend(assumed);
        self
    }

    /// With what was taken as exact.
    pub(super) fn with_exact(mut self, outcome: &Outcome, exact: &Exact) -> Self {
        self.taken_as_exact = super::budget::exact(outcome, exact);
        for (i, parameter) in self.parameters.iter_mut().enumerate().filter(|(_, p)| p.estimated) {
            let [gyro, accel] = exact.doubled_by(outcome, i);
            parameter.doubled_by_wander = Some(Doubled { gyro_rad_s: gyro, accel_m_s2: accel });
        }
        self
    }

    /// The document, with a line end.
    pub(super) fn render(&self) -> Result<String> {
        Ok(serde_json::to_string_pretty(self).into_diagnostic()? + "\n")
    }
}
