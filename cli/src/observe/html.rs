//! The report of what a log can tell a filter.

use miette::Result;
use runs::{Analysis, AnyFilter, SPANS, State};
use sinscal::observability::{EXCITED, TOLERANCE};

use super::report::{name, only_position, verdict};
use crate::origin::{Documented as _, inputs};
use logs::Log;
use reports::figures::significant;
use reports::{Cell, Item, Report, Section, Table, Tone, number, text};
use reports::{Curve, Figure, Style};

/// Degrees from the first, the lightest field of the map, to the second, the darkest.
const SHADES: [f64; 2] = [1e-2, 1e4];

/// Everything about the observability, in the order a reviewer reads.
pub(super) fn report(log: &Log, filter: &dyn AnyFilter, analysis: &Analysis) -> Result<Report> {
    let (rank, states) = (analysis.rank, analysis.states.len());
    let smallest = analysis.singular_values.last().copied().unwrap_or(0.0);
    let report = Report {
        title: format!("What {} can tell {}", log.table().display(), filter.title()),
        verdict: verdict(&filter.title(), analysis),
        tone: if rank == states || only_position(analysis) { Tone::Good } else { Tone::Bad },
        facts: vec![
            ("rank".into(), format!("{rank} of {states}")),
            ("smallest singular value".into(), format!("{} sigma of a reading", significant(smallest))),
            ("segments".into(), format!("{}, {} of them turning", analysis.segments, analysis.turning)),
            ("weak combinations".into(), analysis.weak.len().to_string()),
        ],
        sections: vec![
            degrees(analysis),
            words(analysis),
            singular_values(analysis).folded(),
            inputs(log)?.section(),
        ],
        origin: Vec::new(),
        attachments: Vec::new(),
    };
    Ok(report
        .with_program()
        .with("filter", format!("{}: {} states", filter.title(), states))
        .with("tolerance", format!("{TOLERANCE} sigma of a reading; rounding {:.0e}", analysis.rounding))
        .with_log(log))
}

/// What cannot be found, in words.
pub(crate) fn words(analysis: &Analysis) -> Section {
    let mut items = Vec::new();
    let mut list = |title: &str, lines: Vec<String>| {
        if !lines.is_empty() {
            items.push(Item::text(title));
            items.push(Item::List(lines));
        }
    };
    let directions =
        |all: &[sinscal::observability::Direction]| all.iter().map(ToString::to_string).collect();
    list("These combinations of prior sigmas cannot be found:", directions(&analysis.unobservable));
    let weak = analysis
        .weak
        .iter()
        .map(|(direction, left)| format!("{direction} ({:.0} % of the prior sigma is left)", 100.0 * left));
    list("Weak: random walks included, the data say less than the prior about", weak.collect());
    list(
        "The filter leaves dither out, and on this log dither cannot be told apart:",
        directions(&analysis.confounded),
    );
    if items.is_empty() {
        items.push(Item::text("Every combination of states shows in the data, and none is weak."));
    }
    Section::new("What the data cannot show", items)
}

/// Degrees of observability as a map: states by time spans (Fig. 5 of the paper).
pub(crate) fn degrees(analysis: &Analysis) -> Section {
    let shade = |degree: f64| (degree / SHADES[0]).log10() / (SHADES[1] / SHADES[0]).log10();
    let figure = |degree: f64| match degree {
        large if large >= 1e4 => format!("{large:.0e}"),
        small if small < 0.01 => "< 0.01".into(),
        degree => significant(degree),
    };
    let head: Vec<String> =
        analysis.spans.windows(2).map(|pair| format!("{:.0} to {:.0} s", pair[0], pair[1])).collect();
    let mut names = vec!["state"];
    names.extend(head.iter().map(String::as_str));
    names.extend(["whole log", "prior sigma", "to expect", "unit", "left of the prior"]);
    let row = |state: &State| {
        let info = &state.info;
        let sheet = |sigma: f64| significant(sigma / info.sheet_scale);
        let mut row = vec![text(name(info))];
        row.extend(state.spans.iter().chain([&state.degree]).map(|degree| {
            let part = if *degree > 0.0 { shade(*degree) } else { 0.0 };
            Cell::Heat(part.clamp(0.0, 1.0), figure(*degree))
        }));
        row.push(number(sheet(state.prior_sigma)));
        row.push(number(state.expected_sigma.map_or("\u{2013}".into(), sheet)));
        row.push(text(info.sheet_unit));
        row.push(match state.expected_sigma.map(|sigma| sigma / state.prior_sigma) {
            Some(left) => number(format!("{} %", significant(100.0 * left))),
            None => number(""),
        });
        row
    };
    let caption = format!(
        "Degree of observability of each state in {SPANS} equal spans of the log and over all of it: what one prior sigma of the \
         state moves the readings by, in their sigmas, when every other state is free. Above {EXCITED} a span shows the state. \
         To expect: the sigma at the end, random walks included."
    );
    let rows = analysis.states.iter().map(row).collect();
    let table = Table::new(caption, &names, rows).drawn_as("degrees");
    Section::new("Degrees of observability", vec![table.into()])
}

fn singular_values(analysis: &Analysis) -> Section {
    let values = &analysis.singular_values;
    let points = values.iter().enumerate().filter(|(_, value)| **value > 0.0);
    let points = points.map(|(i, value)| ((i + 1) as f64, value.log10())).collect();
    let level = |y: f64| vec![(1.0, y.log10()), (values.len() as f64, y.log10())];
    let figure = Figure {
        file: "singular-values".into(),
        title: "Singular values, decimal logarithm".into(),
        axes: ["number", "log10, sigmas of a reading"],
        curves: vec![
            Curve::new("singular value", Style::Points, points),
            Curve::new("tolerance", Style::Bound, level(TOLERANCE)),
        ],
    };
    Section::new("Singular values", vec![figure.into()])
}
