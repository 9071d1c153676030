//! A comparison as a page.

use reports::figures::significant;
use reports::{Cell, Interval, Item, Report, Section, Table, Tone, number, parts, text as words};

use super::text::{figure, limit, sigmas, verdict};
use super::{Comparison, Row};

/// Half the length of the axis of differences, sigmas, at least and at most.
const AXIS: [f64; 2] = [4.0, 12.0];
/// What 95 % of normal numbers stay within.
const NORMAL_95: f64 = 1.96;

/// The comparison, in the order a reviewer reads.
pub(super) fn page(found: &Comparison) -> Report {
    let mut facts = Vec::new();
    for (one, (agreement, name)) in found.calibrations.iter().skip(1).zip(&found.agreements).take(2) {
        let letter = one.letter;
        facts.push((
            format!("largest difference, {letter} - A"),
            format!("{} sigma, {name}", significant(agreement.largest.abs())),
        ));
        facts.push((
            format!("RMS of differences, {letter} - A"),
            format!("{} sigma", significant(agreement.rms)),
        ));
    }
    if let Some((agreement, _)) = found.agreements.first() {
        facts.push(("parameters compared".into(), agreement.compared.to_string()));
    }
    let agree = found.agreements.iter().all(|(agreement, _)| agreement.agrees());
    let mut sections = vec![differences(found)];
    if !found.notes.is_empty() {
        sections.push(Section::new("Before differences are read", vec![Item::List(found.notes.clone())]));
    }
    sections.extend([numbers(found), calibrations(found)]);
    Report {
        title: "Calibrations compared".into(),
        verdict: verdict(found).replace("; ", "\n"),
        tone: if agree { Tone::Good } else { Tone::Bad },
        facts,
        sections,
        origin: Vec::new(),
        attachments: Vec::new(),
    }
}

/// All differences on one axis.
fn differences(found: &Comparison) -> Section {
    let largest = found.agreements.iter().map(|(agreement, _)| agreement.largest.abs()).fold(0.0, f64::max);
    let half = (1.1 * largest).clamp(AXIS[0], AXIS[1]);
    let place = |sigmas: f64| 0.5 + 0.5 * sigmas / half;
    let cell = |row: &Row, at: usize| match row.difference(at) {
        Some(difference) => Cell::Interval(Interval {
            prior: (place(-NORMAL_95), place(NORMAL_95)),
            interval: (place(difference), place(difference)),
            estimate: place(difference),
            truth: None,
            mark: Some(0.5),
            text: format!("{difference:+.2} sigma"),
        }),
        None => words(""),
    };
    let mut head = vec!["parameter".to_owned()];
    for one in found.calibrations.iter().skip(1) {
        head.push(format!("{} - A, -{half:.0} to +{half:.0} sigma", one.letter));
        head.push(format!("{} - A, sigma", one.letter));
    }
    let row = |row: &Row| {
        let mut cells = vec![words(parts::name(&row.info))];
        for at in 1..row.estimates.len() {
            cells.extend([cell(row, at), number(sigmas(row.difference(at)))]);
        }
        cells
    };
    let mut caption =
        "Differences to the first calibration over their standard deviations; grey holds 95 % of those between calibrations that agree."
            .to_owned();
    if let Some((agreement, _)) = found.agreements.first() {
        caption += &format!(" {}", limit(agreement));
    }
    let head: Vec<&str> = head.iter().map(String::as_str).collect();
    let shared =
        found.rows.iter().filter(|row| (1..row.estimates.len()).any(|at| row.difference(at).is_some()));
    let table = Table::new(caption, &head, shared.map(row).collect()).drawn_as("differences");
    Section::new("Differences", vec![table.into()])
}

fn numbers(found: &Comparison) -> Section {
    let mut head = vec!["parameter".to_owned(), "unit".to_owned()];
    head.extend(found.calibrations.iter().map(|one| one.letter.to_string()));
    let row = |row: &Row| {
        let mut cells = vec![words(parts::name(&row.info)), words(row.info.sheet_unit)];
        cells.extend(row.estimates.iter().map(|estimate| match estimate {
            Some(estimate) => number(figure(row, Some(estimate))),
            None => number("\u{2013}"),
        }));
        cells
    };
    let head: Vec<&str> = head.iter().map(String::as_str).collect();
    let caption = "Estimates with one sigma; nothing where a log says less than the prior, or a filter lacks the parameter.";
    Section::new("Numbers", vec![Table::new(caption, &head, found.rows.iter().map(row).collect()).into()])
}

fn calibrations(found: &Comparison) -> Section {
    let rows = found.calibrations.iter().map(|one| {
        vec![
            words(one.letter.to_string()),
            words(one.path.display().to_string()),
            words(one.filter.clone()),
            words(one.log.clone().unwrap_or_default()),
            number(one.duration_s.map_or(String::new(), |seconds| format!("{seconds:.0} s"))),
            number(one.reference_temperature_c.map_or(String::new(), |t| format!("{t} degC"))),
            words(one.verdict.clone().unwrap_or_default()),
        ]
    });
    let head = ["", "file", "filter", "log", "duration", "reference temperature", "verdict"];
    Section::new("The calibrations", vec![Table::new("", &head, rows.collect()).into()])
}
