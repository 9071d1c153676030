//! A campaign's summary for people. Writing to a string does not fail.

use std::fmt::Write;

use sinscal::navigation::NAUTICAL_MILE;
use study::{FilterSummary, Summary};

use reports::figures::significant;

/// What the campaign says, in one line.
pub(crate) fn verdict(summary: &Summary) -> String {
    let best = summary.order.first().and_then(|name| summary.filters.iter().find(|f| f.filter == *name));
    if let Some((best, error)) = best.and_then(|best| Some((best, best.max_horizontal_m?))) {
        let mut text = format!(
            "{} navigates best over {} units: largest horizontal error {:.3} nautical miles in the median",
            best.filter,
            summary.units,
            error.p50 / NAUTICAL_MILE
        );
        if let (Some(ratio), Some([low, high]), Some(first)) =
            (best.ratio_to_first, best.ratio_interval_95, summary.filters.first())
        {
            let _ = write!(text, ", {ratio:.2} of {} (95 %: {low:.2} to {high:.2})", first.filter);
        }
        return text;
    }
    let consistent: Vec<&str> = summary
        .filters
        .iter()
        .filter(|filter| filter.consistent)
        .map(|filter| filter.filter.as_str())
        .collect();
    if consistent.is_empty() {
        format!("over {} units no filter knows its errors (NEES outside its 99 % band)", summary.units)
    } else {
        format!(
            "over {} units {} know their errors (NEES within its 99 % band)",
            summary.units,
            consistent.join(", ")
        )
    }
}

/// Verdict and tables.
pub(crate) fn table(summary: &Summary) -> String {
    let mut text = verdict(summary) + "\n\n";
    let flown = !summary.order.is_empty();
    let _ = write!(text, "{:8} {:>11} {:>12}  {:15}", "filter", "NIS per dof", "NEES per dof", "99 % band");
    if flown {
        let _ = write!(
            text,
            " {:>8} {:>8} {:20} {:>8}  {:>8}  {:20} {:>5}",
            "5 %", "median", "(95 %)", "95 %", "at end", "of the first (95 %)", "best"
        );
    }
    text.push('\n');
    for filter in &summary.filters {
        row(&mut text, filter);
    }
    if flown {
        let _ = writeln!(
            text,
            "\nlargest horizontal errors of free-inertial navigation and the median at the end, nautical miles; best: part of \
             the units\norder: {}",
            summary.order.join(" < ")
        );
    }
    text.push_str("\n! NEES outside its 99 % band\n");
    for filter in &summary.filters {
        parameters(&mut text, filter);
    }
    text
}

fn row(text: &mut String, filter: &FilterSummary) {
    let [low, high] = filter.nees_band_99;
    let band = format!("{low:.3} to {high:.3}");
    let mark = if filter.consistent { " " } else { "!" };
    let _ = write!(
        text,
        "{:8} {:>11.4} {:>12.4}{mark} {band:15}",
        filter.filter, filter.nis_per_dof, filter.nees_per_dof
    );
    if let (Some(largest), Some(last)) = (filter.max_horizontal_m, filter.final_horizontal_m) {
        let miles = |metres: f64| format!("{:.3}", metres / NAUTICAL_MILE);
        let ratio = match (filter.ratio_to_first, filter.ratio_interval_95) {
            (Some(ratio), Some([low, high])) => format!("{ratio:.2} ({low:.2} to {high:.2})"),
            _ => String::new(),
        };
        let interval = filter
            .median_interval_95_m
            .map_or(String::new(), |[low, high]| format!("({} to {})", miles(low), miles(high)));
        let _ = write!(
            text,
            " {:>8} {:>8} {interval:20} {:>8}  {:>8}  {ratio:20} {:>4.0}%",
            miles(largest.p05),
            miles(largest.p50),
            miles(largest.p95),
            miles(last.p50),
            100.0 * filter.best.unwrap_or(0.0)
        );
    }
    text.push('\n');
}

fn parameters(text: &mut String, filter: &FilterSummary) {
    let _ = writeln!(
        text,
        "\n{}\n{:30} {:>10} {:>10} {:>10} {:9} {:>7} {:>5} {:>5} {:>5}  {:>10}",
        filter.filter,
        "parameter",
        "bias",
        "RMS error",
        "its sigma",
        "unit",
        "NEES",
        "1 s",
        "2 s",
        "3 s",
        "converged"
    );
    for parameter in &filter.parameters {
        let (unit, scale) = (parameter.sheet_unit.as_str(), parameter.sheet_scale);
        let [low, high] = parameter.nees_band_99;
        let mark = if (low..=high).contains(&parameter.nees) { ' ' } else { '!' };
        let sign = if parameter.bias < 0.0 { "-" } else { "" };
        let _ = writeln!(
            text,
            "{:30} {:>10} {:>10} {:>10} {unit:9} {:>7.2}{mark}{:>5.2} {:>5.2} {:>5.2}  {:>8.0} s",
            format!("{} {}", parameter.name, parameter.component),
            format!("{sign}{}", significant(parameter.bias.abs() / scale)),
            significant(parameter.rms / scale),
            significant(parameter.sigma / scale),
            parameter.nees,
            parameter.coverage[0],
            parameter.coverage[1],
            parameter.coverage[2],
            parameter.converged_s
        );
    }
}
