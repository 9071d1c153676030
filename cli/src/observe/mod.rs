//! `sinscal observe`: what a log can tell a filter.

pub(crate) mod analysis;
pub(crate) mod html;
pub(crate) mod report;

use clap::Args;
use miette::{Result, miette};

use crate::arguments::{FilterArgument, LogArgument, Results};

/// What its help ends with.
const EXAMPLES: &str = "\
Examples:
  sinscal observe runs/unit-3 --filter 43d-b
  sinscal observe runs/unit-3 --filter 43d-b --out results

With --out: report.html, observability.json, observability.txt and the figures.";

/// Show what a log can tell a filter: rank, degrees of observability, combinations that cannot be found
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    #[command(flatten)]
    log: LogArgument,
    #[command(flatten)]
    filter: FilterArgument,
    #[command(flatten)]
    results: Results,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<()> {
        let target = self.results.target()?;
        let filter = self.filter.filter;
        let log = self.log.open()?;
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
