//! The results for machines and for people.

use std::fmt::Write;

use miette::{IntoDiagnostic, Result};
use runs::{Analysis, AnyFilter, SPANS, State};
use serde::Serialize;
use sinscal::StateInfo;
use sinscal::observability::{Direction, EXCITED, TOLERANCE};

use reports::figures::significant;

/// The paper's figure shows the last thirteen states.
const LAST: usize = 13;

/// `observe --json`.
#[derive(Serialize)]
pub(super) struct Report {
    filter: &'static str,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    with: Vec<&'static str>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    without: Vec<&'static str>,
    rank: usize,
    states: usize,
    tolerance: f64,
    rounding: f64,
    singular_values: Vec<f64>,
    span_boundaries_s: [f64; SPANS + 1],
    degrees: Vec<Degree>,
    unobservable: Vec<String>,
    weak: Vec<Weak>,
    confounded: Vec<String>,
    segments: usize,
    turning_segments: usize,
}

#[derive(Serialize)]
struct Degree {
    state: String,
    spans: [f64; SPANS],
    whole: f64,
    unit: &'static str,
    prior_sigma: f64,
    bound_sigma: f64,
    expected_sigma: Option<f64>,
}

/// A combination of states that the data say less about than the prior.
#[derive(Serialize)]
struct Weak {
    combination: String,
    sigma_left: f64,
}

pub(crate) fn name(info: &StateInfo) -> String {
    format!("{} {}", info.block, info.component).trim_end().to_owned()
}

fn words(directions: &[Direction]) -> Vec<String> {
    directions.iter().map(ToString::to_string).collect()
}

impl Report {
    pub(super) fn new(filter: &dyn AnyFilter, analysis: &Analysis) -> Self {
        let degrees = analysis.states.iter().map(|state| Degree {
            state: name(&state.info),
            spans: state.spans,
            whole: state.degree,
            unit: state.info.unit,
            prior_sigma: state.prior_sigma,
            bound_sigma: state.bound_sigma,
            expected_sigma: state.expected_sigma,
        });
        let weak = analysis
            .weak
            .iter()
            .map(|(direction, left)| Weak { combination: direction.to_string(), sigma_left: *left });
        Self {
            filter: filter.name(),
            with: filter.with(),
            without: filter.without(),
            rank: analysis.rank,
            states: analysis.states.len(),
            tolerance: TOLERANCE,
            rounding: analysis.rounding,
            singular_values: analysis.singular_values.clone(),
            span_boundaries_s: analysis.spans,
            degrees: degrees.collect(),
            unobservable: words(&analysis.unobservable),
            weak: weak.collect(),
            confounded: words(&analysis.confounded),
            segments: analysis.segments,
            turning_segments: analysis.turning,
        }
    }

    /// The document, with a line end.
    pub(super) fn render(&self) -> Result<String> {
        Ok(serde_json::to_string_pretty(self).into_diagnostic()? + "\n")
    }
}

/// Whether all that cannot be found is the position: so it is wherever only velocity is read, and no calibration suffers.
pub(super) fn only_position(analysis: &Analysis) -> bool {
    let terms = || analysis.unobservable.iter().flat_map(|direction| &direction.terms);
    terms().next().is_some() && terms().all(|(info, _)| info.block == "position")
}

/// Whether everything can be found, in one line.
pub(super) fn verdict(filter: &str, analysis: &Analysis) -> String {
    let (rank, states) = (analysis.rank, analysis.states.len());
    if rank == states {
        format!("{filter} is observable: rank {rank} of {states}")
    } else if only_position(analysis) {
        format!(
            "{filter} can find all but its position, of which there are no readings: rank {rank} of {states}"
        )
    } else {
        format!(
            "{filter} is not observable on this path: rank {rank} of {states}, {} combinations cannot be found",
            states - rank
        )
    }
}

/// Verdict, what cannot be found, degrees. Writing to a string does not fail.
pub(crate) fn table(filter: &str, analysis: &Analysis) -> String {
    let mut text = verdict(filter, analysis) + "\n";
    let smallest = analysis.singular_values.last().copied().unwrap_or(0.0);
    let _ = writeln!(
        text,
        "{} segments, {} of them turning; smallest singular value {} sigma of a reading, tolerance {TOLERANCE}, \
         rounding {:.0e}",
        analysis.segments,
        analysis.turning,
        significant(smallest),
        analysis.rounding
    );
    list(&mut text, "cannot be found (combinations of prior sigmas):", &words(&analysis.unobservable));
    let weak: Vec<String> = analysis
        .weak
        .iter()
        .map(|(direction, left)| format!("{direction} ({:.0} % of the prior sigma is left)", 100.0 * left))
        .collect();
    list(&mut text, "weak: random walks included, the data say less than the prior about", &weak);
    list(
        &mut text,
        "the filter leaves dither out, and on this log dither cannot be told apart:",
        &words(&analysis.confounded),
    );
    let _ = writeln!(
        text,
        "\ndegree of observability in five spans of {:.0} s, * above {EXCITED}; sigma to expect at the end\n{:28} {:>9} {:>9} \
         {:>9} {:>9} {:>9} {:>9}  {:>12} {:>12} unit",
        (analysis.spans[SPANS] - analysis.spans[0]) / SPANS as f64,
        "state",
        "1",
        "2",
        "3",
        "4",
        "5",
        "whole",
        "prior sigma",
        "expected"
    );
    let last = analysis.states.len().saturating_sub(LAST);
    for (i, state) in analysis.states.iter().enumerate() {
        if i == last && i > 0 {
            let _ = writeln!(text, "the last {LAST} states:");
        }
        row(&mut text, state);
    }
    text
}

fn list(text: &mut String, title: &str, lines: &[String]) {
    if !lines.is_empty() {
        let _ = writeln!(text, "\n{title}");
        for line in lines {
            let _ = writeln!(text, "  {line}");
        }
    }
}

fn row(text: &mut String, state: &State) {
    let info = &state.info;
    let _ = write!(text, "{:28}", name(info));
    for degree in state.spans.iter().chain([&state.degree]) {
        let mark = if *degree > EXCITED { "*" } else { " " };
        let figure = if *degree >= 1e5 { format!("{degree:.1e}") } else { significant(*degree) };
        let _ = write!(text, " {figure:>8}{mark}");
    }
    let sheet = |sigma: f64| significant(sigma / info.sheet_scale);
    let expected = state.expected_sigma.map_or("-".into(), sheet);
    let _ = writeln!(text, "  {:>12} {expected:>12} {}", sheet(state.prior_sigma), info.sheet_unit);
}
