//! `sinscal apply`: a log with the errors that a calibration found taken out.

use std::path::{Path, PathBuf};
use std::{fs, io};

use clap::Args;
use logs::{Log, LogError};
use miette::{Result, miette};
use sinscal::{InitialAttitude, Sample};

use crate::arguments::{self, LogArgument};
use crate::navigate::read;
use crate::output::{Files, Sources};
use crate::{say, setup};

/// What its help ends with.
const EXAMPLES: &str = "\
Examples:
  sinscal apply walk.csv --calibration results/calibration.json --out corrected.csv
  sinscal apply data.txt --calibration c.json --map gyro=w:deg/s,accel=a:g,time=t --out corrected.txt

The result is of the format of the log, with its names, units, axes and lines; rates and forces alone are others. Of HDF5 and MATLAB's v7.3 the
datasets must stand in one piece, and what a bag or an MCAP file holds must not be packed (`rosbag decompress`, `mcap decompress`). The
description is copied beside the result, as OUT.toml.";

/// Endings of files that are no text.
const BINARY: [&str; 10] = ["parquet", "mat", "h5", "hdf5", "npz", "npy", "mcap", "bag", "ulg", "ulog"];

/// Write a log with the errors that a calibration found taken out, in the same format
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    #[command(flatten)]
    log: LogArgument,
    /// The calibration: what `calibrate --json` wrote
    #[arg(long, value_name = "FILE")]
    calibration: PathBuf,
    /// The table to write; its description is written beside it
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<()> {
        let (calibrated, _) = read::read(&self.calibration)?;
        let log = arguments::open(&self.log.log, &self.log.columns.reading_for(&*calibrated.filter))?;
        self.is_named_like(log.table())?;
        let mut sources = Sources::default();
        sources.add(&self.calibration);
        log.files().iter().for_each(|file| sources.add(file));
        let mut files = Files::beside(sources);
        files.check(&self.out)?;
        // what the sensors read too much does not depend on which way they point
        let initial = log.description().initial.unwrap_or(InitialAttitude::unknown_heading());
        let mut corrector = calibrated.corrector(&setup::of(&log, initial));
        let mut rows = 0_u64;
        let mut fault: Option<LogError> = None;
        let written = files.write(&self.out, |out| {
            let correct = &mut |sample: &Sample| {
                rows += 1;
                let corrected = corrector(sample);
                (corrected.dtheta, corrected.dvel)
            };
            log.rewrite(out, correct).unwrap_or_else(|error| {
                fault = Some(error);
                Err(io::Error::other("the log is faulty"))
            })
        });
        if let Some(fault) = fault {
            return Err(fault.into());
        }
        written?;
        self.describe(&log, &mut files)?;
        if rows == 0 {
            return Err(miette!("{}: has no rows", log.table().display()));
        }
        files.commit()?;
        say::remark(&format!("{rows} rows without the errors of {}", calibrated.filter.title()));
        Ok(())
    }

    /// Refuses a name that says another format than the log has: it would be read as that.
    fn is_named_like(&self, table: &Path) -> Result<()> {
        let ending =
            |path: &Path| path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
        let (Some(from), Some(to)) = (ending(table), ending(&self.out)) else { return Ok(()) };
        let is_text = |ending: &str| !BINARY.contains(&ending);
        if from == to || is_text(&from) && is_text(&to) {
            return Ok(());
        }
        Err(miette!(
            help = "the result is of the format of the log, and its ending says so",
            "{}: is to be named with .{from}, as {} is",
            self.out.display(),
            table.display()
        ))
    }

    /// Copies the description beside the result, where none is there yet.
    fn describe(&self, log: &Log, files: &mut Files) -> Result<()> {
        let copy = self.out.with_extension("toml");
        let stream = self.out.exists() && !self.out.is_file();
        if stream || copy == self.out {
            return Ok(());
        }
        let source = log.description_path();
        let text =
            fs::read(&source).map_err(|error| miette!("{}: cannot be read: {error}", source.display()))?;
        if !copy.exists() {
            return files.write(&copy, |out| out.write_all(&text));
        }
        if fs::read(&copy).is_ok_and(|there| there != text) {
            say::warn(&format!(
                "{}: is there already and stays as it is; the result is to be read with what {} says",
                copy.display(),
                source.display()
            ));
        }
        Ok(())
    }
}
