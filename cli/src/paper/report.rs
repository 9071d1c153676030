//! The report: the paper's values beside ours, and why they differ. Writing to a string does not fail.

use std::fmt::Write;

use serde::Serialize;
use sinscal::navigation::NAUTICAL_MILE;
use sinscal::observability::{EXCITED, TOLERANCE};
use sinscal::path::{EIGHTEEN_ROTATIONS, attitude};
use study::{FilterSummary, Summary};

use super::Findings;
use reports::figures::significant;

use crate::{campaign, observe};
use runs::{Analysis, SPANS};

/// Largest horizontal errors that the paper prints, nmi.
const PRINTED: [Option<f64>; 5] = [Some(18.7), None, None, None, Some(11.2)];
/// When the paper's covariances begin to converge, s.
const PRINTED_CONVERGENCE: f64 = 2000.0;
/// The states that the paper adds: inner lever arm, delay, temperature.
const NEW: usize = 7;

/// `paper --json`.
#[derive(Serialize)]
pub(super) struct Numbers<'a> {
    table_1: Vec<Rotation>,
    figure_3_position_n_m: f64,
    figure_3_simulated_position_n_m: f64,
    rank: usize,
    states: usize,
    new_states_excited: bool,
    printed_max_horizontal_nmi: [Option<f64>; 5],
    median_max_horizontal_nmi: Vec<Option<f64>>,
    printed_convergence_s: f64,
    median_convergence_s: Option<f64>,
    hours: f64,
    wall_s: f64,
    summary: &'a Summary,
}

#[derive(Serialize)]
struct Rotation {
    number: usize,
    axis: char,
    angle_deg: f64,
    before: String,
    after: String,
}

impl<'a> Numbers<'a> {
    pub(super) fn new(findings: &'a Findings) -> Self {
        let end = findings.delay_errors.last();
        Self {
            table_1: rotations(),
            figure_3_position_n_m: end.map_or(f64::NAN, |errors| errors.position.y),
            figure_3_simulated_position_n_m: end.map_or(f64::NAN, |errors| errors.simulated_position.y),
            rank: findings.observability.rank,
            states: findings.observability.states.len(),
            new_states_excited: excited(&findings.observability),
            printed_max_horizontal_nmi: PRINTED,
            median_max_horizontal_nmi: findings.summary.filters.iter().map(miles).collect(),
            printed_convergence_s: PRINTED_CONVERGENCE,
            median_convergence_s: convergence(&findings.summary),
            hours: findings.plan.hours,
            wall_s: findings.seconds,
            summary: &findings.summary,
        }
    }
}

fn miles(filter: &FilterSummary) -> Option<f64> {
    filter.max_horizontal_m.map(|errors| errors.p50 / NAUTICAL_MILE)
}

/// Median over the parameters of the full filter of their times of convergence.
fn convergence(summary: &Summary) -> Option<f64> {
    let full = summary.filters.last()?;
    let times: Vec<f64> = full.parameters.iter().map(|parameter| parameter.converged_s).collect();
    Some(study::statistics::median(&times))
}

fn excited(analysis: &Analysis) -> bool {
    let new = analysis.states.iter().rev().take(NEW);
    new.into_iter().all(|state| state.spans.iter().any(|degree| *degree > EXCITED))
}

/// Table 1 with the attitudes before and after each rotation.
fn rotations() -> Vec<Rotation> {
    let mut now = attitude(b"NED").unwrap_or_default();
    let rotation = |(i, turn): (usize, &sinscal::path::Turn)| {
        let before = letters(&now);
        now *= turn.rotation();
        Rotation {
            number: i + 1,
            axis: ['X', 'Y', 'Z'][turn.axis],
            angle_deg: turn.angle.to_degrees(),
            before,
            after: letters(&now),
        }
    };
    EIGHTEEN_ROTATIONS.iter().enumerate().map(rotation).collect()
}

/// Where the body axes x, y, z point: three of `N E D S W U`.
fn letters(attitude: &nalgebra::UnitQuaternion<f64>) -> String {
    let c = attitude.to_rotation_matrix();
    let point = |axis: usize| {
        let column = c.matrix().column(axis);
        let largest = column.iamax();
        let pair = [['E', 'W'], ['N', 'S'], ['U', 'D']][largest];
        pair[usize::from(column[largest] < 0.0)]
    };
    (0..3).map(point).collect()
}

/// How the main finding compares, in one line.
pub(super) fn verdict(findings: &Findings) -> String {
    campaign::text::verdict(&findings.summary)
}

/// The whole report.
pub(super) fn text(findings: &Findings) -> String {
    let mut text = format!(
        "{}\nThe paper's tables and figures on the simulated rig: {} units, {} h of navigation, computed in {:.0} s\n",
        verdict(findings),
        findings.summary.units,
        findings.plan.hours,
        findings.seconds
    );
    table_1(&mut text);
    table_2(&mut text, findings);
    figure_3(&mut text, findings);
    figure_5(&mut text, findings);
    figures_7_to_14(&mut text, findings);
    table_3(&mut text, findings);
    text
}

fn table_1(text: &mut String) {
    text.push_str(
        "\nTable 1, rotation path, as corrected\n\
         The paper's column \"attitude after rotation\" is the attitude before each rotation: read as printed, the z axis would be\n\
         vertical in every rotation about it, and its gyro's scale factor could not be found.\n",
    );
    let _ = writeln!(text, "{:>3} {:>6} {:4}  {:6}  after", "", "angle", "axis", "before");
    for row in rotations() {
        let _ = writeln!(
            text,
            "{:>3} {:>+6.0} {:4}  {:6}  {}",
            row.number, row.angle_deg, row.axis, row.before, row.after
        );
    }
}

fn table_2(text: &mut String, findings: &Findings) {
    text.push_str(
        "\nTable 2, swing\n\
         The amplitudes are lost in the copy of the paper at hand: 6 deg about each axis is a choice, and so is a quarter period\n\
         between x and z, which makes the unit cone. Frequencies as printed: x 0.4, y 0.3, z 0.4 Hz.\n",
    );
    let _ = writeln!(
        text,
        "Each calibration is aligned over the first {:.0} s of the swing; the paper does not say how it aligned.",
        findings.plan.alignment
    );
}

fn figure_3(text: &mut String, findings: &Findings) {
    let Some(end) = findings.delay_errors.last() else { return };
    let _ = writeln!(
        text,
        "\nFig. 3, delay of the accelerometers: {:.1} ms late, {:.0} deg/s about the level east axis, after {:.0} s\n\
         north velocity {:.4} m/s by Eq. 20, {:.4} m/s simulated; north position {:.3} m and {:.3} m. The paper's figure has no\n\
         legible rate; its shape, linear in velocity and quadratic in position, is this one.",
        1e3 * findings.delay.delay,
        findings.delay.rate.to_degrees(),
        end.time,
        end.velocity.y,
        end.simulated_velocity.y,
        end.position.y,
        end.simulated_position.y
    );
}

fn figure_5(text: &mut String, findings: &Findings) {
    let analysis = &findings.observability;
    let _ = writeln!(
        text,
        "\nFigs. 4 and 5, observability of 43d-b: rank {} of {} (paper: 43), tolerance {TOLERANCE} sigma of a reading",
        analysis.rank,
        analysis.states.len()
    );
    let _ = writeln!(
        text,
        "each of the {NEW} new states above {EXCITED} in at least one of {SPANS} spans: {} (paper: yes). The scales differ: the paper\n\
         does not state units or scaling, here states count in prior sigmas and readings in theirs.",
        if excited(analysis) { "yes" } else { "no" }
    );
    let table = observe::report::table("43d-b", analysis);
    // the last thirteen states and the head of their columns
    let lines: Vec<&str> = table.lines().collect();
    if let Some(head) = lines.iter().find(|line| line.starts_with("state ")) {
        let _ = writeln!(text, "{head}");
    }
    for line in lines.iter().skip(lines.len().saturating_sub(13)) {
        let _ = writeln!(text, "{line}");
    }
}

fn figures_7_to_14(text: &mut String, findings: &Findings) {
    let Some(full) = findings.first.result.filters.last() else { return };
    let _ = writeln!(
        text,
        "\nFigs. 7 to 14, parameters of unit {} by {} (over time: figure-07 to figure-14 of --out)",
        findings.first.result.unit, full.filter
    );
    let _ = writeln!(
        text,
        "{:30} {:>12} {:>12} {:>10} {:9}  {:>11}  converged",
        "parameter", "truth", "estimate", "3 sigma", "unit", "error/sigma"
    );
    for parameter in &full.parameters {
        let (unit, scale) = (parameter.sheet_unit.as_str(), parameter.sheet_scale);
        let _ = writeln!(
            text,
            "{:30} {:>12.4} {:>12.4} {:>10} {unit:9}  {:>+11.2}  {:.0} s",
            format!("{} {}", parameter.name, parameter.component),
            parameter.truth / scale,
            parameter.value / scale,
            significant(3.0 * parameter.sigma / scale),
            (parameter.value - parameter.truth) / parameter.sigma,
            parameter.converged_s
        );
    }
    if let Some(time) = convergence(&findings.summary) {
        let _ = writeln!(
            text,
            "median time of convergence (sigma within twice the final one) {time:.0} s; paper: covariances begin to converge after\n\
             about {PRINTED_CONVERGENCE:.0} s. Each parameter converges with the turn that shows it, so the path's timing decides, and the paper's\n\
             is not printed."
        );
    }
}

fn table_3(text: &mut String, findings: &Findings) {
    let summary = &findings.summary;
    let _ = writeln!(
        text,
        "\nTable 3 and Fig. 15, largest horizontal error in {} h of free-inertial navigation, nautical miles\n\
         {:8} {:>8} {:>8} {:>8} {:>8}  {:22} {:>12} {:>12}",
        findings.plan.hours,
        "filter",
        "paper",
        "5 %",
        "median",
        "95 %",
        "of 36d-p (95 %)",
        "NIS per dof",
        "NEES per dof"
    );
    for (filter, printed) in summary.filters.iter().zip(PRINTED) {
        let Some(errors) = filter.max_horizontal_m else { continue };
        let miles = |metres: f64| format!("{:.2}", metres / NAUTICAL_MILE);
        let ratio = match (filter.ratio_to_first, filter.ratio_interval_95) {
            (Some(ratio), Some([low, high])) => format!("{ratio:.2} ({low:.2} to {high:.2})"),
            _ => String::new(),
        };
        let _ = writeln!(
            text,
            "{:8} {:>8} {:>8} {:>8} {:>8}  {ratio:22} {:>12.3} {:>12.3}",
            filter.filter,
            printed.map_or("-".into(), |printed| printed.to_string()),
            miles(errors.p05),
            miles(errors.p50),
            miles(errors.p95),
            filter.nis_per_dof,
            filter.nees_per_dof
        );
    }
    let paper = ["43d-b", "43d-p", "40d-p", "39d-p", "36d-p"];
    let same = summary.order.iter().eq(paper.iter());
    let _ = writeln!(
        text,
        "order here {}; in the paper {}: {}. The paper's 43d-b has 0.60 of the error of its 36d-p.\n\
         A filter that lacks an effect puts part of it into the parameters it has, and adding one effect of several can make\n\
         navigation worse: it then absorbs what is still missing. The sizes of the effects, which the paper does not print, decide\n\
         over the order of the middle three; so do sensors' random walks and bias instability over the level of all of them.",
        summary.order.join(" < "),
        paper.join(" < "),
        if same { "the same" } else { "not the same" }
    );
}
