//! `sinscal observe`: what a log can tell a filter.

pub(crate) mod html;
pub(crate) mod report;

use clap::Args;
use miette::Result;

use runs::observe;

use crate::arguments::{FilterArgument, LogArgument, Results};
use crate::origin::Documented as _;
use crate::setup::Beginning;
use crate::source::{Source, fault};
use crate::{say, setup};

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
    beginning: Beginning,
    #[command(flatten)]
    results: Results,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<()> {
        let mut target = self.results.target()?;
        let filter = self.filter.filter()?;
        let log = self.log.open_for(&*filter, self.beginning)?;
        let filter = &*filter;
        target.reads_log(&log)?;
        self.filter.change.files().try_for_each(|path| target.reads(path))?;
        let setup = setup::of(&log, setup::initial(&log)?);
        let source = Source::new(&log, "observing");
        let analysis = observe(filter, &source, &setup).map_err(|error| fault(&log, error))?;
        drop(source);
        if let Some(error) = analysis.diverged {
            let table = log.table().display();
            say::warn(&format!("{table}: {error}; the sigmas to expect are left out"));
        }
        let title = filter.title();
        let json = report::Report::new(filter, &analysis).render()?;
        let text = report::table(&title, &analysis);
        let verdict = report::verdict(&title, &analysis);
        target.write("observability", &json, &text, &verdict, |files, folder| {
            html::report(&log, filter, &analysis)?.write(files, folder)
        })
    }
}
