//! `sinscal ablate`: the five filters of the paper side by side.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;
use logs::Log;
use miette::{IntoDiagnostic, Result, miette};
use runs::{AnyFilter, Calibrated, Flight, Options, Outcome, calibrate_all};
use serde::Serialize;

use sinscal::PAPER;

use crate::arguments::{self, ALIGNMENT, LogArgument, Results, alignment};
use crate::navigate::{errors, fly, section};
use crate::origin::{Documented as _, inputs};
use crate::setup::{self, Beginning};
use crate::source::{Source, fault};
use crate::vocabulary::vocabulary;
use reports::{Cell, Report as Page, Section, Table, Tone, number, text};

/// What its help ends with.
const EXAMPLES: &str = "\
Examples:
  sinscal ablate runs/unit-3
  sinscal ablate runs/unit-3 --swing runs/swing-3 --out results

With --out: report.html, ablation.json, ablation.txt, errors.csv (errors over time) and the figures.";

/// Compare the five filters of the paper on one log, and what their calibrations are worth on another
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    #[command(flatten)]
    log: LogArgument,
    #[command(flatten)]
    beginning: Beginning,
    /// A log to navigate on with each calibration
    #[arg(long, value_name = "LOG")]
    swing: Option<PathBuf>,
    /// Number of passes; each after the first linearises about the parameters found before
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=1000))]
    passes: u32,
    /// Align over the first so many seconds of the swing log, at most half of it
    #[arg(long, value_name = "SECONDS", default_value_t = ALIGNMENT, value_parser = alignment)]
    align: f64,
    #[command(flatten)]
    results: Results,
}

#[derive(Serialize)]
struct Report {
    filters: Vec<Row>,
    passes: u32,
    hours: Option<f64>,
    alignment_s: Option<f64>,
}

#[derive(Serialize)]
struct Row {
    filter: String,
    states: usize,
    nis_per_dof: f64,
    max_horizontal_nmi: Option<f64>,
    final_horizontal_nmi: Option<f64>,
    log_likelihood: f64,
    updates: usize,
    #[serde(skip)]
    fits: bool,
    verdict: &'static str,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<()> {
        let mut target = self.results.target()?;
        let filters = paper()?;
        let Some(first) = filters.first() else { return Ok(()) };
        let log = self.log.open_for(&**first, self.beginning)?;
        target.reads_log(&log)?;
        let swing = self
            .swing
            .as_deref()
            .map(|swing| arguments::open(swing, &self.log.columns.reading()))
            .transpose()?;
        swing.iter().try_for_each(|swing| target.reads_log(swing))?;
        let outcomes = calibrate(&log, &filters, self.passes)?;
        let calibrated = |(filter, outcome): (&Arc<dyn AnyFilter>, &Outcome)| Calibrated {
            filter: filter.clone(),
            values: outcome.estimates(),
            reference_temperature: Some(log.description().reference_temperature),
        };
        let calibrations: Vec<Calibrated> = filters.iter().zip(&outcomes).map(calibrated).collect();
        let flown = swing.as_ref().map(|log| fly(log, &calibrations, self.align)).transpose()?;
        let flights: &[Flight] = flown.as_ref().map_or(&[], |(flights, _)| flights);
        let rows = outcomes.iter().enumerate().map(|(i, outcome)| Row {
            filter: outcome.filter.clone(),
            states: outcome.states,
            nis_per_dof: outcome.statistics.nis_per_dof(),
            max_horizontal_nmi: flights.get(i).map(Flight::largest),
            final_horizontal_nmi: flights.get(i).map(Flight::last),
            log_likelihood: outcome.statistics.log_likelihood,
            updates: outcome.statistics.updates,
            fits: outcome.verdict().fits(),
            verdict: outcome.verdict().name(),
        });
        let report = Report {
            filters: rows.collect(),
            passes: self.passes,
            hours: flights.first().map(Flight::hours),
            alignment_s: flown.as_ref().map(|(_, seconds)| *seconds),
        };
        let json = serde_json::to_string_pretty(&report).into_diagnostic()? + "\n";
        target.write("ablation", &json, &table(&report), &verdict(&report), |files, folder| {
            if !flights.is_empty() {
                files.write(&folder.join("errors.csv"), |file| errors(flights, file))?;
            }
            let mut page = page(&report, log.table()).with_program();
            if !flights.is_empty() {
                page.sections.push(section(flights));
            }
            page.sections.push(inputs(&log)?.section());
            page = page.with("passes", self.passes.to_string()).with_log(&log);
            if let Some(swing) = &swing {
                page = page.with_log(swing);
            }
            page.write(files, folder)
        })
    }
}

/// The filters of the paper.
pub(crate) fn paper() -> Result<Vec<Arc<dyn AnyFilter>>> {
    PAPER.iter().map(|name| vocabulary().filter(name).map_err(|error| miette!("{error}"))).collect()
}

/// Runs every filter over `log`.
fn calibrate(log: &Log, filters: &[Arc<dyn AnyFilter>], passes: u32) -> Result<Vec<Outcome>> {
    let setup = setup::of(log, setup::initial(log)?);
    let filters: Vec<&dyn AnyFilter> = filters.iter().map(|filter| &**filter).collect();
    let Some(first) = filters.first() else { return Ok(Vec::new()) };
    let options = Options { passes, coarse: log.coarse().cloned(), ..Options::of(*first) };
    let source = Source::new(log, "calibrating");
    calibrate_all(&filters, &source, &setup, &options, &mut ()).map_err(|error| fault(log, error))
}

/// The comparison as a page, without curves.
fn page(report: &Report, log: &Path) -> Page {
    let all = || report.filters.iter();
    let largest = all().filter_map(|row| row.max_horizontal_nmi).fold(0.0, f64::max);
    let best = all().map(|row| row.log_likelihood).fold(f64::NEG_INFINITY, f64::max);
    let row = |row: &Row| {
        let mut cells = vec![
            text(row.filter.clone()),
            number(row.states.to_string()),
            number(format!("{:.3}", row.nis_per_dof)),
            number(format!("{:.1}", row.log_likelihood - best)),
        ];
        if let (Some(error), Some(last)) = (row.max_horizontal_nmi, row.final_horizontal_nmi) {
            cells.push(number(format!("{last:.3}")));
            cells.push(Cell::Bar(error / largest, format!("{error:.3}")));
        }
        cells
    };
    let mut head = vec!["filter", "states", "NIS per degree of freedom", "log-likelihood below the best"];
    let mut caption = String::from("NIS per degree of freedom is 1 for a filter that explains the log.");
    if let (Some(hours), Some(seconds)) = (report.hours, report.alignment_s) {
        head.extend(["error at the end, nmi", "largest error, nmi"]);
        caption += &format!(
            " Horizontal errors of {hours:.2} h of free-inertial navigation, height held, aligned over the first {seconds:.0} s \
             with each calibration."
        );
    }
    let table = Table::new(caption, &head, report.filters.iter().map(row).collect()).drawn_as("side-by-side");
    Page {
        title: format!("The five filters on {}", log.display()),
        verdict: verdict(report),
        tone: Tone::Neutral,
        facts: Vec::new(),
        sections: vec![Section::new("Side by side", vec![table.into()])],
        origin: Vec::new(),
        attachments: Vec::new(),
    }
}

fn verdict(report: &Report) -> String {
    let flown = |row: &&Row| row.max_horizontal_nmi.is_some();
    let by_error = |a: &&Row, b: &&Row| {
        a.max_horizontal_nmi.unwrap_or(0.0).total_cmp(&b.max_horizontal_nmi.unwrap_or(0.0))
    };
    if let Some(best) = report.filters.iter().filter(flown).min_by(by_error) {
        return format!(
            "{} navigates best: at most {:.3} nautical miles in {:.2} h",
            best.filter,
            best.max_horizontal_nmi.unwrap_or(0.0),
            report.hours.unwrap_or(0.0)
        );
    }
    let off = |row: &Row| (row.nis_per_dof - 1.0).abs();
    match report.filters.iter().min_by(|a, b| off(a).total_cmp(&off(b))) {
        Some(best) if report.filters.iter().any(|row| row.fits) => {
            format!("{} fits best: NIS per degree of freedom {:.3}", best.filter, best.nis_per_dof)
        }
        Some(nearest) => format!(
            "none of them is shown to fit; {} comes nearest to 1 with a NIS per degree of freedom of {:.3}",
            nearest.filter, nearest.nis_per_dof
        ),
        None => String::new(),
    }
}

/// Verdict and table. Writing to a string does not fail.
fn table(report: &Report) -> String {
    let mut text = verdict(report) + "\n\n";
    let flown = report.hours.is_some();
    let _ = write!(text, "{:8} {:>6} {:>12} {:>16}", "filter", "states", "NIS per dof", "log-likelihood");
    let _ = writeln!(text, "{}", if flown { "    largest [nmi]    at the end [nmi]" } else { "" });
    for row in &report.filters {
        let _ = write!(
            text,
            "{:8} {:>6} {:>12.3} {:>16.0}",
            row.filter, row.states, row.nis_per_dof, row.log_likelihood
        );
        if let (Some(largest), Some(last)) = (row.max_horizontal_nmi, row.final_horizontal_nmi) {
            let _ = write!(text, " {largest:>16.3} {last:>19.3}");
        }
        text.push('\n');
    }
    if let Some(seconds) = report.alignment_s {
        let _ = writeln!(
            text,
            "\nhorizontal errors of free-inertial navigation, height held, aligned over the first {seconds:.0} s with each calibration"
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(filter: &str, nis_per_dof: f64, largest: Option<f64>, fits: bool) -> Row {
        Row {
            filter: filter.into(),
            states: 36,
            nis_per_dof,
            max_horizontal_nmi: largest,
            final_horizontal_nmi: largest,
            log_likelihood: 0.0,
            updates: 1,
            fits,
            verdict: "",
        }
    }

    fn said(filters: [Row; 3]) -> String {
        verdict(&Report { filters: filters.into(), passes: 2, hours: Some(4.0), alignment_s: None })
    }

    #[test]
    fn the_best_navigates_with_the_smallest_error() {
        let text = said([
            row("a", 1.0, Some(0.9), true),
            row("b", 3.0, Some(0.2), false),
            row("c", 1.0, Some(0.5), true),
        ]);
        assert!(text.starts_with("b navigates best: at most 0.200 nautical miles in 4.00 h"), "{text}");
    }

    #[test]
    fn the_best_fits_nearest_to_one_on_either_side() {
        let text = said([row("a", 1.4, None, false), row("b", 0.9, None, true), row("c", 0.2, None, true)]);
        assert!(text.starts_with("b fits best"), "{text}");
        let text = said([row("a", 1.4, None, false), row("b", 0.1, None, false), row("c", 5.0, None, false)]);
        assert!(text.starts_with("none of them is shown to fit; a comes nearest"), "{text}");
    }
}
