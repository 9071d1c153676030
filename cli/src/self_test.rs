//! `sinscal diagnose --self-test N`: how often a diagnosis is right, on units with something hidden in them.

use std::fmt::Write as _;

use gap::Options;
use gap::blind::{Grade, Table, Trial, trial};
use miette::{IntoDiagnostic, Result};
use rayon::prelude::*;
use serde::Serialize;

use crate::output::Target;
use crate::say::progress_bar;

/// What `--json` writes.
#[derive(Serialize)]
struct Document<'a> {
    first_seed: u64,
    table: &'a Table,
    trials: &'a [Trial],
}

/// Diagnoses `cases` units from seed `first` on.
pub(crate) fn run(cases: u64, first: u64, target: Target<'_>) -> Result<()> {
    let bar = progress_bar(cases, "diagnosing");
    let options = Options { rerun: false, ..Options::default() };
    let trials: Vec<Trial> = (first..first.saturating_add(cases))
        .into_par_iter()
        .map(|seed| {
            let done = trial(seed, &options);
            bar.inc(1);
            done
        })
        .collect::<Result<_, _>>()
        .into_diagnostic()?;
    bar.finish_and_clear();
    let table = Table::of(&trials);
    let document = Document { first_seed: first, table: &table, trials: &trials };
    let json = serde_json::to_string_pretty(&document).into_diagnostic()? + "\n";
    let verdict = format!("score {:.3} over {} cases", table.score, table.cases());
    target.write("self_test", &json, &text(&table, &trials), &verdict, |_, _| Ok(()))
}

/// The table, and every case that did not go right.
fn text(table: &Table, trials: &[Trial]) -> String {
    let mut text = format!("{table}\n");
    for trial in trials.iter().filter(|t| t.grade != Grade::Right) {
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "\n{:?}, seed {}: {} hidden from {}\n  {}",
            trial.grade, trial.seed, trial.hidden, trial.filter, trial.sentence
        );
    }
    text
}
