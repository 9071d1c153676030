//! `sinscal navigate`: free-inertial navigation with a calibration applied.

mod read;
pub(crate) mod run;

use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;
use miette::{IntoDiagnostic, Result};
use serde::Serialize;
use sinscal::navigation::NAUTICAL_MILE;

use self::run::Flight;
use crate::draw::{Curve, Figure, Style};
use crate::log::Log;
use crate::output;

/// Length of the alignment that a log begins with, s, where nothing else is asked for.
pub(crate) const ALIGNMENT: f64 = 900.0;

/// Navigate without any reference, a calibration applied, and compare with where the unit stands
#[derive(Args)]
pub(crate) struct Arguments {
    /// The log: path of its table or description, with or without ending
    log: PathBuf,
    /// The calibration to apply: what `calibrate --json` wrote
    #[arg(long, value_name = "FILE")]
    calibration: PathBuf,
    /// Align over the first so many seconds, at most half the log
    #[arg(long, value_name = "SECONDS", default_value_t = ALIGNMENT, value_parser = alignment)]
    align: f64,
    /// Write the results as JSON; `-` writes them to standard output instead of the text
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write navigation.json, navigation.txt and the errors over time (errors.csv, errors.svg) to this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Seconds of an alignment.
pub(crate) fn alignment(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if (10.0..=86_400.0).contains(&seconds) => Ok(seconds),
        _ => Err("a number of seconds from 10 to 86400 was expected".into()),
    }
}

#[derive(Serialize)]
struct Report {
    filter: &'static str,
    hours: f64,
    max_horizontal_nmi: f64,
    final_horizontal_nmi: f64,
    alignment_s: f64,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<()> {
        let target = output::Target::new(self.json.as_deref(), self.out.as_deref())?;
        let calibrated = read::read(&self.calibration)?;
        let log = Log::open(&self.log)?;
        for warning in log.warnings() {
            output::remark(&format!("warning: {warning}"));
        }
        let (flights, alignment_s) = run::navigate(&log, &[calibrated], self.align)?;
        let Some(flight) = flights.first() else { return Ok(()) };
        let (hours, largest, last) = (flight.hours(), flight.largest(), flight.last());
        let report = Report {
            filter: flight.filter,
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
            figure(&flights).draw(files, folder)
        })
    }
}

/// Horizontal errors over time, as in figure 15 of the paper.
pub(crate) fn figure(flights: &[Flight]) -> Figure {
    let curves = flights.iter().map(|flight| {
        let start = flight.track.first().map_or(0.0, |(time, ..)| *time);
        let points = flight
            .track
            .iter()
            .map(|(time, east, north)| ((time - start) / 3600.0, east.hypot(*north) / NAUTICAL_MILE));
        Curve::new(flight.filter, Style::Full, points.collect())
    });
    Figure {
        file: "errors",
        title: "Horizontal error of free-inertial navigation".into(),
        axes: ["time, h", "horizontal error, nmi"],
        curves: curves.collect(),
    }
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
