//! The report of a calibration.

use logs::Log;
use miette::Result;
use runs::{AnyFilter, Exact, Options, Outcome};
use sinscal::{Parameter, StateInfo};

use super::{budget, text};
use crate::origin::{Documented as _, inputs};
use reports::figures::significant;
use reports::{Item, Report, Tone, parts};

use crate::origin;

/// Everything about a calibration, in the order a reviewer reads.
pub(super) fn report(
    log: &Log,
    filter: &dyn AnyFilter,
    options: &Options,
    outcome: &Outcome,
    exact: Option<&Exact>,
) -> Result<Report> {
    let known = origin::truth_beside(log)?;
    let of = known.as_ref().map(|truth| move |info: &StateInfo| truth.of(info));
    let truth = of.as_ref().map(|of| of as &dyn Fn(&StateInfo) -> f64);
    // what is considered was not estimated: it stands in the budget
    let considered = filter.considers();
    let (places, parameters): (Vec<usize>, Vec<Parameter>) = outcome
        .parameters
        .iter()
        .copied()
        .enumerate()
        .filter(|(_, parameter)| !considered.contains(&parameter.info.block))
        .unzip();
    let parameters = &parameters;
    let lever = log.description().outer_lever;
    let centre = |info: &StateInfo| match (info.block, info.component) {
        ("outer-lever-arm", component) => {
            ["x", "y", "z"].iter().position(|c| *c == component).map_or(0.0, |i| lever[i])
        }
        _ => 0.0,
    };
    let estimated = parameters.iter().filter(|parameter| parameter.estimated).count();
    let statistics = &outcome.statistics;
    let updates = match statistics.rejected {
        0 => statistics.updates.to_string(),
        rejected => format!("{}, {rejected} outliers left out", statistics.updates),
    };
    let mut facts = vec![
        ("NIS per degree of freedom".into(), format!("{:.3}", statistics.nis_per_dof())),
        ("parameters estimated".into(), format!("{estimated} of {}", parameters.len())),
        ("updates".into(), updates),
        ("duration".into(), format!("{:.0} s", outcome.duration)),
    ];
    if let Some(truth) = truth {
        let errors =
            parameters.iter().filter(|p| p.estimated).map(|p| ((p.value - truth(&p.info)) / p.sigma).abs());
        let largest = study::statistics::largest(errors);
        facts.push(("largest error against the truth".into(), format!("{} sigma", significant(largest))));
    }
    let mut numbers = parts::numbers(parameters, &|i| outcome.converged(places[i]), truth);
    let limits = exact.map(|exact| [budget::exact(outcome, exact), budget::wander(outcome, exact)]);
    numbers.items.extend(limits.into_iter().flatten().flatten().map(Item::text));
    let mut sections = vec![parts::forest(parameters, &centre, truth), numbers];
    sections.extend(budget::section(outcome));
    sections.extend(outcome.residuals.as_deref().map(|channels| parts::residuals("Residuals", "", channels)));
    sections.push(parts::convergence(parameters, &places, &outcome.history, truth));
    sections.push(inputs(log)?.section());
    let report = Report {
        title: format!("Calibration of {} with {}", log.table().display(), filter.title()),
        verdict: text::verdict(outcome),
        tone: match outcome.verdict() {
            verdict if verdict.fits() => Tone::Good,
            verdict if verdict.contradicts() => Tone::Bad,
            _ => Tone::Neutral,
        },
        facts,
        sections,
        origin: Vec::new(),
        attachments: Vec::new(),
    };
    let measures = filter.measures().join(" and ");
    Ok(report
        .with_program()
        .with("filter", format!("{}: {} states, measures {measures}", filter.title(), outcome.states))
        .with("passes", options.passes.to_string())
        .with("log-likelihood", format!("{:.1}", statistics.log_likelihood))
        .with("covariance", options.form.name())
        .with_log(log))
}
