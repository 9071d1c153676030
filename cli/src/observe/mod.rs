//! `sinscal observe`: what a log can tell a filter.

pub(crate) mod analysis;
pub(crate) mod html;
pub(crate) mod report;

use std::path::PathBuf;

use clap::Args;
use clap::builder::PossibleValuesParser;
use miette::{Result, miette};
use sinscal::FILTERS;

use crate::log::{ColumnMap, Log};
use crate::output;
use crate::setup;

/// Show what a log can tell a filter: rank, degrees of observability, combinations that cannot be found
#[derive(Args)]
pub(crate) struct Arguments {
    /// The log: path of its table or description, with or without ending
    log: PathBuf,
    #[command(flatten)]
    columns: ColumnMap,
    /// The filter that would be run; `sinscal filters` lists them
    #[arg(long, value_name = "NAME", ignore_case = true,
          value_parser = PossibleValuesParser::new(FILTERS.iter().map(|filter| filter.name)))]
    filter: String,
    /// Write the results as JSON; `-` writes them to standard output instead of the table
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write report.html, observability.json, observability.txt and figures to this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<()> {
        let target = output::Target::new(self.json.as_deref(), self.out.as_deref())?;
        let filter = setup::filter(&self.filter)?;
        let log = Log::open(&self.log, &self.columns)?;
        for warning in log.warnings() {
            output::remark(&format!("warning: {warning}"));
        }
        let analysis = analysis::analyse(&log, filter.name)?
            .ok_or_else(|| miette!("there is no filter called {}", filter.name))?;
        let json = report::Report::new(filter, &analysis).render()?;
        let text = report::table(filter.name, &analysis);
        target.write(
            "observability",
            &json,
            &text,
            &report::verdict(filter.name, &analysis),
            |files, folder| html::report(&log, filter, &analysis)?.write(files, folder),
        )
    }
}
