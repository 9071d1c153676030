//! `sinscal export`: a calibration as files that other programs read.

mod certificate;
mod read;
mod write;

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use miette::{Result, miette};

use crate::output::{self, Files, Sources};

/// What its help ends with.
const EXAMPLES: &str = "\
Examples:
  sinscal export results/calibration.json --format c --out imu_calibration.h
  sinscal export results/calibration.json --format rust --out src/calibration.rs
  sinscal export results/calibration.json --format matlab --out calibration.m
  sinscal export results/calibration.json --format yaml
  sinscal export results/calibration.json --format certificate --out certificate.html
  sinscal export noise/noise.json --format kalibr --out imu.yaml

Every number reads back to the same bits. Only what was estimated is written.";

/// Write a calibration as YAML, MATLAB, C or Rust: values, sigmas, units and the equations that use them; as a certificate; or a
/// noise for Kalibr
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The calibration: what `calibrate --json` wrote; for `kalibr` the noise, what `noise --json` wrote
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
    /// A page to be printed and signed: unit, run, conditions, values with their uncertainties, verdict, sums
    Certificate,
    /// Kalibr's imu.yaml, of a noise
    Kalibr,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<()> {
        let mut sources = Sources::default();
        sources.add(&self.calibration);
        let mut files = Files::beside(sources);
        if let Some(path) = &self.out {
            files.check(path)?;
        }
        let text = self.text()?;
        let Some(path) = &self.out else { return output::print(&text) };
        files.write(path, |file| file.write_all(text.as_bytes()))?;
        files.commit()
    }

    fn text(&self) -> Result<String> {
        let path = &self.calibration;
        let noise = crate::noise::read(path)?;
        if let Format::Kalibr = self.format {
            return noise.map(|noise| crate::noise::kalibr(&noise)).ok_or_else(|| {
                miette!(
                    help = "`sinscal noise LOG --json FILE` writes one",
                    "{}: is no noise",
                    path.display()
                )
            });
        }
        if noise.is_some() {
            let help =
                "--format kalibr writes a noise; the others take what `sinscal calibrate --json` wrote";
            return Err(miette!(help = help, "{}: is a noise, a calibration was expected", path.display()));
        }
        if let Format::Certificate = self.format {
            return certificate::certificate(path);
        }
        let calibration = read::read(path)?;
        Ok(match self.format {
            Format::Matlab => write::matlab(&calibration),
            Format::C => write::c(&calibration),
            Format::Rust => write::rust(&calibration),
            Format::Yaml | Format::Certificate | Format::Kalibr => write::yaml(&calibration),
        })
    }
}
