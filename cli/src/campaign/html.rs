//! The report of a campaign.

use crate::origin::Documented as _;
use sinscal::navigation::NAUTICAL_MILE;
use study::{FilterSummary, Summary, UnitResult};

use super::text::verdict;
use reports::figures::significant;
use reports::{Cell, Interval, Report, Section, Table, Tone, number, text};
use reports::{Curve, Figure, Style};

/// Everything that many units say together, in the order a reviewer reads.
pub(super) fn report(summary: &Summary, results: &[UnitResult]) -> Report {
    let consistent = summary.filters.iter().filter(|filter| filter.consistent).count();
    let mut sections = Vec::new();
    if !summary.order.is_empty() {
        sections.push(navigation(summary, results));
    }
    sections.push(consistency(summary));
    sections.extend(summary.filters.iter().map(parameters));
    let first = results.iter().map(|result| result.unit).min().unwrap_or(0);
    let last = results.iter().map(|result| result.unit).max().unwrap_or(0);
    Report {
        title: format!("Campaign over {} units", summary.units),
        verdict: verdict(summary),
        tone: Tone::Neutral,
        facts: vec![
            ("units".into(), summary.units.to_string()),
            ("filters".into(), summary.filters.len().to_string()),
            ("of them consistent".into(), consistent.to_string()),
        ],
        sections,
        origin: vec![("seeds".into(), format!("{first} to {last}"))],
        attachments: Vec::new(),
    }
    .with_program()
}

/// Largest horizontal errors: percentiles, and all of them.
pub(crate) fn navigation(summary: &Summary, results: &[UnitResult]) -> Section {
    let miles = |metres: f64| metres / NAUTICAL_MILE;
    let end = summary.filters.iter().filter_map(|filter| filter.max_horizontal_m).map(|errors| errors.p95);
    let end = 1.05 * study::statistics::largest(end);
    let row = |filter: &FilterSummary| {
        let errors = filter.max_horizontal_m?;
        let ratio = match (filter.ratio_to_first, filter.ratio_interval_95) {
            (Some(ratio), Some([low, high])) => format!("{ratio:.2} ({low:.2} to {high:.2})"),
            _ => String::new(),
        };
        let figure = |metres: f64| number(format!("{:.3}", miles(metres)));
        Some(vec![
            text(&filter.filter),
            Cell::Interval(Interval {
                prior: (errors.p05 / end, errors.p95 / end),
                interval: (errors.p25 / end, errors.p75 / end),
                estimate: errors.p50 / end,
                truth: None,
                mark: None,
                text: format!("median {:.3} nautical miles", miles(errors.p50)),
            }),
            figure(errors.p05),
            figure(errors.p50),
            figure(errors.p95),
            filter.final_horizontal_m.map_or(number(""), |errors| figure(errors.p50)),
            number(ratio),
            number(format!("{:.0} %", 100.0 * filter.best.unwrap_or(0.0))),
        ])
    };
    let axis = format!("0 to {:.2} nmi", miles(end));
    let head = [
        "filter",
        axis.as_str(),
        "5 %",
        "median",
        "95 %",
        "median at the end",
        "of the first (95 %)",
        "best for",
    ];
    let caption = "Largest horizontal error of free-inertial navigation, nautical miles. Grey: 5 to 95 % of the units, line: 25 to 75 \
                   %, dot: median. The ratio of the medians to the first filter's has its 95 % interval.";
    let table = Table::new(caption, &head, summary.filters.iter().filter_map(row).collect());
    let table = table.drawn_as("spread");
    let curve = |(f, filter): (usize, &FilterSummary)| {
        let mut errors: Vec<f64> =
            results.iter().filter_map(|unit| unit.filters.get(f)?.max_horizontal_m).collect();
        errors.sort_by(f64::total_cmp);
        let count = errors.len() as f64;
        let points =
            errors.iter().enumerate().map(|(i, error)| (miles(*error), 100.0 * (i + 1) as f64 / count));
        Curve::new(&filter.filter, Style::Full, points.collect())
    };
    let figure = Figure {
        file: "largest-errors".into(),
        title: "Units whose largest error is at most so large".into(),
        axes: ["largest horizontal error, nmi", "units, %"],
        curves: summary.filters.iter().enumerate().map(curve).collect(),
    };
    Section::new("Navigation", vec![table.into(), figure.into()])
}

/// Whether the filters know their errors.
pub(crate) fn consistency(summary: &Summary) -> Section {
    let row = |filter: &FilterSummary| {
        let [low, high] = filter.nees_band_99;
        vec![
            text(&filter.filter),
            number(format!("{:.3}", filter.nis_per_dof)),
            number(format!("{:.3}", filter.nees_per_dof)),
            number(format!("{low:.3} to {high:.3}")),
            text(if filter.consistent { "yes" } else { "no" }),
        ]
    };
    let head = [
        "filter",
        "NIS per degree of freedom",
        "NEES per degree of freedom",
        "99 % band",
        "knows its errors",
    ];
    let caption = "Mean squares of innovations and of estimation errors over what the filter says of them: 1 when it is right. \
                   The band holds 99 % of such campaigns of a filter that knows its errors.";
    let rows = summary.filters.iter().map(row).collect();
    Section::new("Consistency", vec![Table::new(caption, &head, rows).into()])
}

/// Errors of a filter's parameters over all units.
pub(crate) fn parameters(filter: &FilterSummary) -> Section {
    let rows = filter.parameters.iter().map(|parameter| {
        let (unit, scale) = (parameter.sheet_unit.as_str(), parameter.sheet_scale);
        let sign = if parameter.bias < 0.0 { "-" } else { "" };
        let mut row = vec![
            text(format!("{} {}", parameter.name, parameter.component)),
            number(format!("{sign}{}", significant(parameter.bias.abs() / scale))),
            number(significant(parameter.rms / scale)),
            number(significant(parameter.sigma / scale)),
            text(unit.to_owned()),
            number(format!("{:.2}", parameter.nees)),
        ];
        let inside = parameter.coverage.iter().map(|part| number(format!("{:.0} %", 100.0 * part)));
        row.extend(inside);
        row.push(number(format!("{:.0} s", parameter.converged_s)));
        row
    });
    let head = [
        "parameter",
        "bias",
        "RMS error",
        "its sigma",
        "unit",
        "NEES",
        "in 1 sigma",
        "in 2",
        "in 3",
        "converged after",
    ];
    let caption = "Bias and root mean square of the errors over the units, and what the filter says of them. Right: 68.3, 95.4 and \
                   99.7 % within one, two and three sigmas.";
    Section::new(
        format!("Parameters of {}", filter.filter),
        vec![Table::new(caption, &head, rows.collect()).into()],
    )
}
