//! `sinscal navigate`: free-inertial navigation with a calibration applied.

pub(crate) mod read;

use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;
use logs::Log;
use miette::{IntoDiagnostic, Result};
use runs::{Calibrated, Flight, navigate};
use serde::Serialize;

use crate::arguments::{self, ALIGNMENT, LogArgument, Results, alignment};
use crate::origin::{Documented as _, inputs};
use crate::setup;
use crate::source::{Source, fault};
use reports::{Report as Page, Section, Tone, parts};

/// What its help ends with.
const EXAMPLES: &str = "\
Examples:
  sinscal calibrate runs/unit-3 --filter 43d-b --json unit-3.json
  sinscal navigate runs/swing-3 --calibration unit-3.json --out results

With --out: report.html, navigation.json, navigation.txt, errors.csv (errors over time) and the figures.";

/// Navigate without any reference, a calibration applied, and compare with where the unit stands
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    #[command(flatten)]
    log: LogArgument,
    /// The calibration to apply: what `calibrate --json` wrote
    #[arg(long, value_name = "FILE")]
    calibration: PathBuf,
    /// Align over the first so many seconds, at most half the log
    #[arg(long, value_name = "SECONDS", default_value_t = ALIGNMENT, value_parser = alignment)]
    align: f64,
    #[command(flatten)]
    results: Results,
}

#[derive(Serialize)]
struct Report {
    filter: String,
    hours: f64,
    max_horizontal_nmi: f64,
    final_horizontal_nmi: f64,
    alignment_s: f64,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<()> {
        let mut target = self.results.target()?;
        target.reads(&self.calibration)?;
        let (calibrated, _) = read::read(&self.calibration)?;
        let log = arguments::open(&self.log.log, &self.log.columns.reading_for(&*calibrated.filter))?;
        target.reads_log(&log)?;
        let (flights, alignment_s) = fly(&log, &[calibrated], self.align)?;
        let Some(flight) = flights.first() else { return Ok(()) };
        let (hours, largest, last) = (flight.hours(), flight.largest(), flight.last());
        let report = Report {
            filter: flight.filter.clone(),
            hours,
            max_horizontal_nmi: largest,
            final_horizontal_nmi: last,
            alignment_s,
        };
        let json = serde_json::to_string_pretty(&report).into_diagnostic()? + "\n";
        let verdict = format!(
            "{}: at most {largest:.3} nautical miles of horizontal error in {hours:.2} h of free-inertial navigation",
            flight.filter
        );
        let text = format!(
            "{verdict}\nat the end {last:.3} nautical miles\naligned over the first {alignment_s:.0} s, height held\n"
        );
        target.write("navigation", &json, &text, &verdict, |files, folder| {
            files.write(&folder.join("errors.csv"), |file| errors(&flights, file))?;
            let page = Page {
                title: format!("Navigation on {} with {}", log.table().display(), self.calibration.display()),
                verdict: verdict.clone(),
                tone: Tone::Neutral,
                facts: vec![
                    ("largest error".into(), format!("{largest:.3} nmi")),
                    ("at the end".into(), format!("{last:.3} nmi")),
                    ("duration".into(), format!("{hours:.2} h")),
                    ("alignment".into(), format!("{alignment_s:.0} s")),
                ],
                sections: vec![section(&flights), inputs(&log)?.section()],
                origin: Vec::new(),
                attachments: Vec::new(),
            };
            page.with_program()
                .with("filter", flight.filter.clone())
                .with_file("calibration", &self.calibration)
                .with_log(&log)
                .write(files, folder)
        })
    }
}

/// Navigates `log` with each of the calibrations, aligned over its first `align` seconds. Returns also the length of the
/// alignment: half the log where that is shorter.
pub(crate) fn fly(log: &Log, calibrations: &[Calibrated], align: f64) -> Result<(Vec<Flight>, f64)> {
    let setup = setup::of(log, setup::initial(log)?);
    let board = || calibrations.iter().map(|calibrated| calibrated.pilot(&setup)).collect();
    navigate(&Source::new(log, "navigating"), &board, align).map_err(|error| fault(log, error))
}

/// Errors over time as a section of a report.
pub(crate) fn section(flights: &[Flight]) -> Section {
    parts::navigation(flights.iter().map(|flight| (flight.filter.as_str(), flight.track.as_slice())))
}

/// Errors over time, as comma-separated text in SI units.
pub(crate) fn errors(flights: &[Flight], out: &mut dyn Write) -> io::Result<()> {
    write!(out, "time_s")?;
    for flight in flights {
        write!(out, ",{0}.east_m,{0}.north_m", flight.filter)?;
    }
    writeln!(out)?;
    let points = flights.iter().map(|flight| flight.track.len()).min().unwrap_or(0);
    for i in 0..points {
        write!(out, "{}", flights[0].track[i].0)?;
        for flight in flights {
            let (_, east, north) = flight.track[i];
            write!(out, ",{east:.4},{north:.4}")?;
        }
        writeln!(out)?;
    }
    Ok(())
}
