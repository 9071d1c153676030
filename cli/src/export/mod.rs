//! `sinscal export`: a calibration as files that other programs read.

mod read;
mod write;

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use miette::Result;

use crate::output::{self, Files, Sources};

/// What its help ends with.
const EXAMPLES: &str = "\
Examples:
  sinscal export results/calibration.json --format c --out imu_calibration.h
  sinscal export results/calibration.json --format rust --out src/calibration.rs
  sinscal export results/calibration.json --format matlab --out calibration.m
  sinscal export results/calibration.json --format yaml

Every number reads back to the same bits. Only what was estimated is written.";

/// Write a calibration as YAML, MATLAB, C or Rust: values, sigmas, units and the equations that use them
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The calibration: what `calibrate --json` wrote
    #[arg(value_name = "FILE.json")]
    calibration: PathBuf,
    /// What to write
    #[arg(long, value_enum)]
    format: Format,
    /// The file to write; standard output if not given
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// A form of the same numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Parameters by effect, and Kalibr's matrices M and biases
    Yaml,
    /// A script that fills the struct `calibration`
    Matlab,
    /// A header of macros
    C,
    /// A module of constants
    Rust,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<()> {
        let mut sources = Sources::default();
        sources.add(&self.calibration);
        let mut files = Files::beside(sources);
        if let Some(path) = &self.out {
            files.check(path)?;
        }
        let calibration = read::read(&self.calibration)?;
        let text = match self.format {
            Format::Yaml => write::yaml(&calibration),
            Format::Matlab => write::matlab(&calibration),
            Format::C => write::c(&calibration),
            Format::Rust => write::rust(&calibration),
        };
        let Some(path) = &self.out else { return output::print(&text) };
        files.write(path, |file| file.write_all(text.as_bytes()))?;
        files.commit()
    }
}
