//! `sinscal effects`: the vocabulary of error models.

use std::fmt::Write;

use clap::Args;
use sinscal::EffectInfo;

use crate::vocabulary::vocabulary;
use crate::{output, say};
use reports::figures::significant;

/// What the list ends with.
const LAWS: &str = "\nLaws are named by what an error goes with: accel-bias-by-temperature-rate-squared is d_f_i = k_i (dT_i/dt)^2, gyro-bias-by-temperature-times-rate-i is d_omega_i = k_i (T_i - T_ref) omega_i; --with, [prior] and [population] take them like effects.\n";

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
        text.push_str(LAWS);
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
