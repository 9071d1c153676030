//! `sinscal effects`: the vocabulary of error models.

use std::fmt::Write;

use clap::Args;
use sinscal::EffectInfo;

use crate::vocabulary::vocabulary;
use crate::{output, say};
use reports::figures::significant;

/// List the effects: parameters, units, priors, equations
#[derive(Args)]
pub(crate) struct Arguments {}

impl Arguments {
    pub(crate) fn run(self) -> miette::Result<()> {
        let mut text =
            format!("{:27} {:>2}  {:14} {:18} equation\n", "effect", "n", "unit (SI)", "prior sigma");
        for effect in vocabulary().effects() {
            describe(effect.info(), &mut text);
        }
        output::print(&say::folded(&text, 31))
    }
}

fn describe(effect: &EffectInfo, text: &mut String) {
    let components = effect.components();
    let prior = if components.is_empty() {
        "-".to_owned()
    } else {
        format!("{} {}", significant(effect.prior_sigma / effect.sheet_scale), effect.sheet_unit)
    };
    // Writing to a string does not fail.
    let _ = writeln!(
        text,
        "{:27} {:>2}  {:14} {prior:18} {}",
        effect.name(),
        components.len(),
        effect.unit(),
        effect.equation()
    );
    let names = components.iter().filter(|name| !name.is_empty()).copied().collect::<Vec<_>>().join(" ");
    let names = if names.is_empty() { String::new() } else { format!(" ({names})") };
    let _ = writeln!(text, "{:27} {}{names}", "", effect.description());
}
