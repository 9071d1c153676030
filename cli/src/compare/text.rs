//! A comparison in words.

use std::fmt::Write as _;

use reports::figures::{decimals, significant};
use study::compare::{Agreement, Estimate};

use super::{Comparison, Row};
use crate::say;

/// All agreements, one after the other.
pub(super) fn verdict(found: &Comparison) -> String {
    let others = found.calibrations.iter().skip(1).zip(&found.agreements);
    let said = others.map(|(other, (agreement, name))| judgement(other.letter, agreement, name));
    said.collect::<Vec<_>>().join("; ")
}

fn judgement(letter: char, agreement: &Agreement, name: &str) -> String {
    let Agreement { compared, largest, limit, beyond, .. } = agreement;
    if agreement.agrees() {
        format!(
            "{letter} agrees with A: none of {compared} parameters differs by more than {limit:.1} sigma, {name} by {:.1} most",
            largest.abs()
        )
    } else {
        format!(
            "{letter} differs from A: {beyond} of {compared} parameters by more than {limit:.1} sigma, {name} by {:.1} most",
            largest.abs()
        )
    }
}

/// An estimate with its sigma, in units of the sheet.
pub(super) fn figure(row: &Row, estimate: Option<&Estimate>) -> String {
    let Some(estimate) = estimate else { return "-".into() };
    let (value, sigma) = (estimate.value / row.info.sheet_scale, estimate.sigma / row.info.sheet_scale);
    let digits = decimals(sigma);
    format!("{value:.digits$} +- {sigma:.digits$}")
}

/// A difference in sigmas.
pub(super) fn sigmas(difference: Option<f64>) -> String {
    difference.map_or("-".into(), |difference| format!("{difference:+.1}"))
}

/// What is meant by so many sigmas.
pub(super) fn limit(agreement: &Agreement) -> String {
    format!(
        "Of {} differences between calibrations that agree, the largest reaches {:.1} sigma in one of a hundred comparisons.",
        agreement.compared, agreement.limit
    )
}

/// Verdict, key, numbers. Writing to a string does not fail.
pub(super) fn text(found: &Comparison) -> String {
    let mut text = say::folded(&(verdict(found) + "\n"), 0) + "\n";
    for one in &found.calibrations {
        let log = one.log.as_ref().map_or(String::new(), |log| format!(", {log}"));
        let _ = writeln!(text, "{}  {}: {}{log}", one.letter, one.path.display(), one.filter);
    }
    found.notes.iter().for_each(|note| text += &say::folded(&format!("- {note}\n"), 2));
    let _ = write!(text, "\n{:28} {:8}", "parameter", "unit");
    for (place, one) in found.calibrations.iter().enumerate() {
        let _ = write!(text, " {:>22}", one.letter);
        if place > 0 {
            let _ = write!(text, " {:>9}", format!("{} - A", one.letter));
        }
    }
    text.push('\n');
    for row in &found.rows {
        let _ = write!(text, "{:28} {:8}", reports::parts::name(&row.info), row.info.sheet_unit);
        for (place, estimate) in row.estimates.iter().enumerate() {
            let _ = write!(text, " {:>22}", figure(row, estimate.as_ref()));
            if place > 0 {
                let _ = write!(text, " {:>9}", sigmas(row.difference(place)));
            }
        }
        text.push('\n');
    }
    text += "\nvalues with one sigma; differences in sigmas of the difference\n";
    for (one, (agreement, _)) in found.calibrations.iter().skip(1).zip(&found.agreements) {
        let _ = writeln!(text, "{} - A: root mean square {} sigma", one.letter, significant(agreement.rms));
    }
    if let Some((agreement, _)) = found.agreements.first() {
        text += &say::folded(&(limit(agreement) + "\n"), 0);
    }
    text
}
