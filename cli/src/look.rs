//! `sinscal look`: what a log holds, before anything is calibrated.

use std::path::PathBuf;

use clap::Args;
use miette::{Result, miette};

use crate::arguments::Columns;
use crate::output::{self, Files, Target};

/// What its help ends with.
const EXAMPLES: &str = "\
Examples:
  sinscal look runs/unit-3
  sinscal look walk.csv --map gyro=w:rad/s,accel=a:g,time=t --write-description walk.toml
  sinscal look data.txt --columns t,wx,wy,wz,ax,ay,az --map gyro=w:deg/s,accel=a:g,time=t:ms

It needs no description; where one lies beside the log it is heeded. With --out: look.json and look.txt.";

/// Show what a log holds: how it is read, rate, gaps, rests, noise, clipping, likely axes, and the description it suggests
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The log: path of its table, with or without ending
    log: PathBuf,
    #[command(flatten)]
    columns: Columns,
    /// Write the results as JSON; `-` writes them to standard output instead of the text
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write look.json and look.txt to this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write the suggested description to this file, which must not be there yet
    #[arg(long, value_name = "FILE")]
    write_description: Option<PathBuf>,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<()> {
        let mut target = Target::new(self.json.as_deref(), self.out.as_deref())?;
        target.reads_named(&self.log)?;
        if let Some(path) = &self.write_description {
            output::check_file(path)?;
            if path.exists() {
                return Err(miette!(
                    "{}: is there already: what a person wrote is not replaced",
                    path.display()
                ));
            }
        }
        let look = logs::look(&self.log, &self.columns.reading())?;
        let json = serde_json::to_string_pretty(&look).map_err(|error| miette!("{error}"))? + "\n";
        let rests = look.rests.len();
        let verdict = format!("{rests} rests, {} warnings", look.warnings.len());
        target.write("look", &json, &look.to_string(), &verdict, |_, _| Ok(()))?;
        if let Some(path) = &self.write_description {
            let mut files = Files::default();
            files.write(path, |file| file.write_all(look.description.as_bytes()))?;
            files.commit_new()?;
        }
        Ok(())
    }
}
