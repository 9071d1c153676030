//! `sinscal filters`: the filters that can be named.

use std::fmt::Write;

use clap::Args;
use sinscal::FILTERS;

use crate::output;

/// List the filters: states, measurements, what they hold
#[derive(Args)]
pub(crate) struct Arguments {}

impl Arguments {
    pub(crate) fn run(self) -> miette::Result<()> {
        let mut text = format!("{:14} {:>6}  {:22} {}\n", "filter", "states", "measures", "holds");
        for filter in FILTERS {
            let measures = filter.measures().collect::<Vec<_>>().join(", ");
            // Writing to a string does not fail.
            let _ = writeln!(text, "{:14} {:>6}  {measures:22} {}", filter.name, filter.states, filter.about);
        }
        output::print(&text)
    }
}
