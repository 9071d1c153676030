//! What several logs of one unit say together.

use std::fmt::Write;

use logs::Log;
use miette::{IntoDiagnostic, Result, miette};
use reports::figures::significant;
use runs::{AnyFilter, Together, Verdict};
use serde::Serialize;

use super::json::{ParameterReport, Report};
use super::{Ran, text};
use crate::output::Target;

/// `calibrate LOG LOG... --json`: the common parameters, and what each log says by itself.
#[derive(Serialize)]
struct Several {
    filter: &'static str,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    with: Vec<&'static str>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    without: Vec<&'static str>,
    states: usize,
    samples: u64,
    duration_s: f64,
    nis_per_dof: f64,
    verdict: &'static str,
    /// How much more than their sigmas the logs differ, and what chance does not exceed.
    #[serde(skip_serializing_if = "Option::is_none")]
    logs_differ: Option<Differ>,
    parameters: Vec<ParameterReport>,
    reference_temperature_c: f64,
    logs: Vec<Report>,
}

#[derive(Serialize)]
struct Differ {
    ratio: f64,
    chance: f64,
}

/// The worst of the verdicts: one log that contradicts the filter is enough.
fn verdict(all: &[Ran]) -> Verdict {
    let verdicts = || all.iter().map(|ran| ran.outcome.verdict());
    let worst = verdicts().find(|verdict| verdict.contradicts());
    worst.or_else(|| verdicts().find(|verdict| !verdict.fits())).unwrap_or(Verdict::Fits)
}

/// Refuses logs that do not add up: one that is named twice, and, as they are taken to be independent, what is considered of all.
pub(super) fn check(logs: &[Log], considers: bool) -> Result<()> {
    let [first, others @ ..] = logs else { return Ok(()) };
    if others.is_empty() {
        return Ok(());
    }
    for (i, log) in logs.iter().enumerate() {
        if logs[..i]
            .iter()
            .any(|before| same_file::is_same_file(before.table(), log.table()).unwrap_or(false))
        {
            return Err(miette!("{} is named twice: a log counts once", log.table().display()));
        }
    }
    if considers || logs.iter().any(|log| !log.description().uncertainty.is_empty()) {
        return Err(miette!(
            help = "calibrate each log by itself with its budget, and compare them: `sinscal compare A.json B.json`",
            "what is considered, [uncertainty] or --budget or --consider, is common to logs of one unit, and several logs are added up \
             as if they were independent"
        ));
    }
    let reference = first.description().reference_temperature;
    if let Some(other) = others.iter().find(|log| log.description().reference_temperature != reference) {
        return Err(miette!(
            help = "state the same temperature for all logs of a unit: what vanishes there is not the same parameter otherwise",
            "{}: the reference temperature is {} C, and {reference} C in {}",
            other.table().display(),
            other.description().reference_temperature,
            first.table().display()
        ));
    }
    Ok(())
}

/// Writes what the logs say together, and each by itself.
pub(super) fn write(all: &[Ran], filter: &dyn AnyFilter, target: Target<'_>) -> Result<()> {
    let outcomes: Vec<_> = all.iter().map(|ran| &ran.outcome).collect();
    let together = Together::of(filter, &outcomes).ok_or_else(|| {
        miette!("the logs cannot be added up: one of them knows a parameter to no finite sigma")
    })?;
    let freedom = |ran: &Ran| ran.outcome.statistics.degrees_of_freedom as f64;
    let total: f64 = all.iter().map(freedom).sum();
    let nis = all.iter().map(|ran| ran.outcome.statistics.nis_per_dof() * freedom(ran)).sum::<f64>() / total;
    let differ = together.scatter.map(|s| Differ { ratio: s.ratio.sqrt(), chance: s.limit.sqrt() });
    let verdict = verdict(all);
    let stated = together.parameters.iter().zip(&together.factors);
    let document = Several {
        filter: filter.name(),
        with: filter.with(),
        without: filter.without(),
        states: outcomes[0].states,
        samples: all.iter().map(|ran| ran.outcome.samples - ran.bridged.rows).sum(),
        duration_s: outcomes.iter().map(|outcome| outcome.duration).sum(),
        nis_per_dof: nis,
        verdict: verdict.name(),
        logs_differ: differ,
        parameters: stated.map(|(parameter, factor)| ParameterReport::stated(parameter, *factor)).collect(),
        reference_temperature_c: all[0].log.description().reference_temperature,
        logs: all.iter().map(|ran| ran.report(filter)).collect(),
    };
    let json = serde_json::to_string_pretty(&document).into_diagnostic()? + "\n";
    let sentence = format!(
        "{} {verdict}: {} logs together, NIS per degree of freedom {nis:.2}; {}",
        filter.title(),
        all.len(),
        agreement(&together)
    );
    let text = table(&sentence, all, &together);
    target.write("calibration", &json, &text, &sentence, |_, _| Ok(()))
}

fn agreement(together: &Together) -> String {
    match together.scatter {
        None => "no parameter is known in two of them".into(),
        Some(scatter) => format!(
            "they differ {:.1} times as much as their sigmas allow (chance: {:.1}){}",
            scatter.ratio.sqrt(),
            scatter.limit.sqrt(),
            if together.contradict() { ", and the sigmas contain that" } else { "" }
        ),
    }
}

/// The parameters, common and of each log. Writing to a string does not fail.
fn table(sentence: &str, all: &[Ran], together: &Together) -> String {
    let mut text = format!("{sentence}\n\n");
    for (number, ran) in all.iter().enumerate() {
        let _ = writeln!(
            text,
            "log {}: {}, {}",
            number + 1,
            ran.log.table().display(),
            text::verdict(&ran.outcome)
        );
    }
    let _ = write!(text, "\n{:30} {:>14}   {:10} {:10}", "parameter", "together", "+- sigma", "unit");
    for number in 1..=all.len() {
        let _ = write!(text, " {:>24}", format!("log {number}"));
    }
    text.push('\n');
    for (parameter, place) in together.parameters.iter().zip(&together.places) {
        let info = &parameter.info;
        let [estimate, sigma] = text::figures(parameter);
        let name = format!("{} {}", info.block, info.component);
        let _ = write!(text, "{name:30} {estimate:>14}   {sigma:10} {:10}", info.sheet_unit);
        for ran in all {
            let own = &ran.outcome.parameters[*place];
            let [estimate, _] = text::figures(own);
            let own = if own.estimated {
                format!("{estimate} +- {}", significant(own.sigma / info.sheet_scale))
            } else {
                "-".into()
            };
            let _ = write!(text, " {own:>24}");
        }
        text.push('\n');
    }
    text
}
