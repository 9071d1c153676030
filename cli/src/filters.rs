//! `sinscal filters`: the filters that can be named.

use std::fmt::Write;

use clap::Args;
use runs::AnyFilter;

use crate::vocabulary::vocabulary;
use crate::{output, say};

/// List the filters: states, measurements, what they hold
#[derive(Args)]
pub(crate) struct Arguments {}

impl Arguments {
    pub(crate) fn run(self) -> miette::Result<()> {
        let mut text = format!("{:14} {:>6}  {:22} {}\n", "filter", "states", "measures", "holds");
        for filter in vocabulary().filters() {
            let (states, measures) = (filter.states().len(), filter.measures().join(", "));
            // Writing to a string does not fail.
            let _ = writeln!(text, "{:14} {states:>6}  {measures:22} {}", filter.name(), filter.about());
        }
        text.push_str("\nstates, with the equation in `sinscal effects`:\n");
        for filter in vocabulary().filters() {
            let _ = writeln!(text, "{:14} {}", filter.name(), blocks(&**filter));
        }
        output::print(&say::folded(&text, 15))
    }
}

/// The blocks of a filter with their numbers of states, in order.
fn blocks(filter: &dyn AnyFilter) -> String {
    let mut blocks: Vec<(&str, usize)> = Vec::new();
    for state in filter.states() {
        match blocks.last_mut() {
            Some((name, count)) if *name == state.block => *count += 1,
            _ => blocks.push((state.block, 1)),
        }
    }
    blocks.iter().map(|(name, count)| format!("{name} {count}")).collect::<Vec<_>>().join(", ")
}
