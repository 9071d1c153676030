//! `sinscal noise`: what the sensors of a unit scatter by at rest, and which processes that is.

mod json;
mod report;
mod text;
mod units;

pub(crate) use json::read;
pub(crate) use units::kalibr;
use units::{Sensor, stated};

use std::path::PathBuf;

use ::noise::{Channel, Identified};
use clap::Args;
use logs::{LogError, Quiet};
use miette::{Result, miette};
use rayon::prelude::*;

use crate::arguments::{Columns, Results};

/// Where temperature moved by so much, K, the readings are freed of it.
const WARMED: f64 = 1.0;
/// Rests of fewer rows say nothing.
const FEWEST: u64 = 100;

/// What its help ends with.
const EXAMPLES: &str = "\
Examples:
  sinscal noise night.parquet --out noise
  sinscal calibrate walk --filter mems-30d --noise noise/noise.toml
  sinscal noise still.csv --map gyro=w:deg/s,accel=a:g,time=t --json -
  sinscal export noise/noise.json --format kalibr --out imu.yaml

It needs no description. A log at rest is used as a whole, of any other its rests. Hours tell bias instability, a minute the random
walks alone. With --out: noise.json, noise.txt, noise.toml, report.html and each figure as SVG and CSV.";

/// Measure the noise of a unit in its rests: Allan deviation, and the noise processes with their intervals
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The log: path of its table, with or without ending
    log: PathBuf,
    #[command(flatten)]
    columns: Columns,
    /// Random numbers that the intervals are simulated with
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    results: Results,
}

/// What was found of one log.
struct Found {
    notes: Vec<String>,
    /// Rows that were used.
    rows: u64,
    interval: f64,
    /// x, y, z of the gyros, then of the accelerometers.
    channels: Vec<Identified>,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<()> {
        let mut target = self.results.target()?;
        target.reads_named(&self.log)?;
        let quiet = Quiet::of(&self.log, &self.columns.reading())?;
        let found = find(&quiet, self.seed)?;
        let verdict = text::verdict(&found);
        target.write("noise", &json::text(&found)?, &text::text(&found), &verdict, |files, folder| {
            let name = quiet.path().file_name().unwrap_or_default().to_string_lossy();
            let toml = stated(&found.sensors(), &name);
            files.write(&folder.join("noise.toml"), |file| file.write_all(toml.as_bytes()))?;
            report::write(&found, &quiet, &verdict, files, folder)
        })
    }
}

impl Found {
    /// Channels by sensor.
    fn sensors(&self) -> Vec<(Sensor, &[Identified])> {
        Sensor::BOTH.into_iter().zip(self.channels.chunks(3)).collect()
    }

    fn duration(&self) -> f64 {
        self.rows as f64 * self.interval
    }
}

fn find(quiet: &Quiet, seed: u64) -> Result<Found> {
    let interval = quiet.interval();
    let full = |error: std::io::Error| {
        let folder = std::env::temp_dir();
        miette!(
            help = "TMPDIR names another folder; eight bytes for each reading and temperature are needed",
            "temporary files in {}: {error}",
            folder.display()
        )
    };
    let channels: std::io::Result<Vec<Channel>> = (0..6).map(|_| Channel::new(interval)).collect();
    let mut channels = channels.map_err(full)?;
    let mut rows = 0;
    let mut failure = None;
    quiet
        .each(|row| {
            rows += 1;
            for (at, channel) in channels.iter_mut().enumerate() {
                let (sensor, axis) = (at / 3, at % 3);
                let temperature = row.temperatures[sensor].map(|at| at[axis]);
                if let Err(error) = channel.push(row.begins, row.readings[sensor][axis], temperature) {
                    failure = Some(error);
                    return Err(LogError::file(quiet.path(), "cannot be kept"));
                }
            }
            Ok(())
        })
        .map_err(|fault| failure.take().map_or_else(|| fault.into(), full))?;
    if rows < FEWEST {
        return Err(miette!(
            help = "noise shows where a unit lies still: some hours tell bias instability, a minute the random walks alone",
            "{}: rests for {rows} rows only",
            quiet.path().display()
        ));
    }
    let channels: std::io::Result<Vec<Identified>> = channels
        .into_par_iter()
        .enumerate()
        .map(|(at, channel)| channel.finish(WARMED)?.identify(seed, at as u64))
        .collect();
    Ok(Found { notes: quiet.notes(), rows, interval, channels: channels.map_err(full)? })
}
