//! Sections that several subcommands have in common.

use sinscal::{ChannelInnovations, Parameter, StateInfo};

use super::{Cell, Interval, Item, Section, Table, number, text};
use crate::draw::{Curve, Figure, Style};
use crate::figures::{decimals, significant};
use runs::History;

/// Half the length of the axis of a forest plot, in prior sigmas, at least and at most.
const FOREST: [f64; 2] = [0.1, 3.0];
/// Half the length of the axis of normalised errors.
const ERRORS: f64 = 4.0;
/// Lags at which residuals are looked at for whiteness.
const LAGS: usize = 20;
/// What 95 % of normal numbers stay within.
const NORMAL_95: f64 = 1.96;

/// True values, where they are known.
pub type Truth<'a> = Option<&'a dyn Fn(&StateInfo) -> f64>;

/// Estimates with their intervals.
pub fn numbers(parameters: &[Parameter], converged: &dyn Fn(usize) -> Option<f64>, truth: Truth) -> Section {
    let mut head = vec!["parameter", "estimate", "95 % interval", "unit"];
    if truth.is_some() {
        head.extend(["truth", "error by sigma"]);
    }
    head.extend(["prior sigma", "converged after"]);
    let row = |(i, p): (usize, &Parameter)| {
        let info = &p.info;
        let sheet = |value: f64| value / info.sheet_scale;
        let digits = decimals(sheet(p.sigma));
        let figure = |value: f64| number(format!("{value:.digits$}"));
        let mut row = vec![text(name(info))];
        if p.estimated {
            let (low, high) = (p.value - NORMAL_95 * p.sigma, p.value + NORMAL_95 * p.sigma);
            row.push(figure(sheet(p.value)));
            row.push(number(format!("{:.digits$} to {:.digits$}", sheet(low), sheet(high))));
        } else {
            row.extend([number("not estimated"), number("")]);
        }
        row.push(text(info.sheet_unit));
        if let Some(truth) = truth {
            let true_value = truth(info);
            row.push(figure(sheet(true_value)));
            row.push(match p.estimated {
                true => number(format!("{:+.1}", (p.value - true_value) / p.sigma)),
                false => number(""),
            });
        }
        row.push(number(significant(sheet(p.prior_sigma))));
        row.push(match converged(i) {
            Some(time) if p.estimated => number(format!("{time:.0} s")),
            _ => number("\u{2013}"),
        });
        row
    };
    let rows = parameters.iter().enumerate().map(row).collect();
    let caption = "Estimates in data-sheet units; where the data say less than the prior, no figure is given. A parameter has \
                   converged once its sigma stays within twice its final value.";
    Section::new("Numbers", vec![Table::new(caption, &head, rows).into()])
}

/// All estimates on one axis, in standard deviations of their priors. `centre` is where a prior's mean lies.
pub fn forest(parameters: &[Parameter], centre: &dyn Fn(&StateInfo) -> f64, truth: Truth) -> Section {
    let reach = |p: &Parameter| {
        let truth = truth.map_or(p.value, |truth| truth(&p.info));
        let off = |value: f64| (value - centre(&p.info)).abs();
        off(p.value).max(off(truth)) / p.prior_sigma
    };
    let half = 1.1 * parameters.iter().filter(|p| p.estimated).map(reach).fold(0.0, f64::max);
    let half = half.clamp(FOREST[0], FOREST[1]);
    let row = |p: &Parameter| {
        let middle = centre(&p.info);
        let place = |value: f64| 0.5 + 0.5 * (value - middle) / (half * p.prior_sigma);
        let sigmas = (p.value - middle) / p.prior_sigma;
        let mut said = format!("{sigmas:.2} +- {} prior sigmas", significant(3.0 * p.sigma / p.prior_sigma));
        let error = truth.map(|truth| (truth(&p.info), (p.value - truth(&p.info)) / p.sigma));
        if let Some((true_value, _)) = error {
            said += &format!(", truth {:.2}", (true_value - middle) / p.prior_sigma);
        }
        let mut row = vec![
            text(name(&p.info)),
            Cell::Interval(Interval {
                prior: (place(middle - p.prior_sigma), place(middle + p.prior_sigma)),
                interval: (place(p.value - 3.0 * p.sigma), place(p.value + 3.0 * p.sigma)),
                estimate: place(p.value),
                truth: error.map(|(true_value, _)| place(true_value)),
                mark: Some(0.5),
                text: said,
            }),
            number(format!("{sigmas:+.2}")),
        ];
        if let Some((_, error)) = error {
            let place = |error: f64| 0.5 + 0.5 * error / ERRORS;
            row.push(Cell::Interval(Interval {
                prior: (place(-NORMAL_95), place(NORMAL_95)),
                interval: (place(error), place(error)),
                estimate: place(error),
                truth: None,
                mark: Some(0.5),
                text: format!("error of {error:+.2} sigma"),
            }));
            row.push(number(format!("{error:+.2}")));
        }
        row
    };
    let axis = format!("-{half:.2} to +{half:.2} prior sigmas");
    let mut head = vec!["parameter", axis.as_str(), "estimate"];
    let mut caption =
        String::from("Grey: one sigma of the prior. Dot and line: the estimate with three sigmas.");
    if truth.is_some() {
        head.extend(["-4 to +4 sigmas of the estimate", "error"]);
        caption +=
            " Upright line: the truth. On the right the error over its sigma; grey holds 95 % of them.";
    }
    let rows = parameters.iter().map(row).collect();
    let table = Table::new(caption, &head, rows).drawn_as("forest");
    Section::new("All parameters at a glance", vec![table.into()])
}

/// How each estimate came about, with its band of three sigmas: a figure for each effect.
pub fn convergence(parameters: &[Parameter], history: &History, truth: Truth) -> Section {
    let mut figures: Vec<Figure> = Vec::new();
    for (i, p) in parameters.iter().enumerate() {
        let info = &p.info;
        let sheet = |value: f64| value / info.sheet_scale;
        if figures.last().is_none_or(|figure| figure.file != info.block) {
            let axes = ["time, s", info.sheet_unit];
            figures.push(Figure {
                file: info.block.into(),
                title: info.block.into(),
                axes,
                curves: Vec::new(),
            });
        }
        let Some(figure) = figures.last_mut() else { continue };
        let points = history.rows().map(|(time, row)| (time, sheet(row[i].0))).collect();
        let band = history.rows().map(|(_, row)| sheet(3.0 * row[i].1)).collect();
        figure.curves.push(Curve::new(info.component, Style::Full, points).with_band(band));
        if let (Some(truth), Some((first, _)), Some((last, _))) =
            (truth, history.rows().next(), history.rows().last())
        {
            let level = sheet(truth(info));
            let points = vec![(first, level), (last, level)];
            figure.curves.push(Curve::new(format!("{} truth", info.component), Style::Dashed, points));
        }
    }
    let mut words = String::from(
        "Estimates with three sigmas of the last pass. The axis shows what is left when the wide beginning is over; a double click \
                 shows everything, a drag what it spans.",
    );
    if truth.is_some() {
        words += " Dashed: the truth.";
    }
    let mut items = vec![Item::text(words)];
    items.extend(figures.into_iter().map(Item::from));
    Section::new("Convergence", items)
}

/// Residuals, by what the filter said of them beforehand and in their units.
/// Names of files begin with `prefix`.
pub fn residuals(title: &str, prefix: &str, channels: &[ChannelInnovations]) -> Section {
    let measured: Vec<&ChannelInnovations> = channels.iter().filter(|c| c.points.len() > LAGS).collect();
    if measured.is_empty() {
        return Section::new(title, vec![Item::text("Too few updates to look at.")]);
    }
    let row = |channel: &&ChannelInnovations| {
        let bound = NORMAL_95 / (channel.points.len() as f64).sqrt();
        let inside = |limit| number(format!("{:.1} %", 100.0 * channel.inside(limit)));
        let white = (1..=LAGS).filter(|lag| channel.autocorrelation(*lag).abs() <= bound).count();
        vec![
            text(format!("{} {}", channel.group, channel.component)),
            number(channel.points.len().to_string()),
            number(format!("{:.3}", channel.rms())),
            inside(1.0),
            inside(2.0),
            inside(3.0),
            number(format!("{:+.3}", channel.autocorrelation(1))),
            number(format!("{white} of {LAGS}")),
        ]
    };
    let head = [
        "channel",
        "updates",
        "RMS by sigma",
        "in 1 sigma",
        "in 2",
        "in 3",
        "correlation, lag 1",
        "white lags",
    ];
    let caption = "Innovations of the last pass over their predicted sigma. A filter that fits: RMS 1, of them 68.3, 95.4 and \
                   99.7 % within one, two and three sigmas, 19 of 20 lags without correlation (within 1.96 by the root of \
                   their number).";
    let mut items: Vec<Item> = vec![Table::new(caption, &head, measured.iter().map(row).collect()).into()];
    for group in ["velocity", "position", "attitude"] {
        let of_group: Vec<&ChannelInnovations> =
            measured.iter().copied().filter(|channel| channel.group == group).collect();
        items.extend(innovations(group, prefix, &of_group).into_iter().flatten().map(Item::from));
    }
    let lags = |channel: &&ChannelInnovations| {
        let points = (1..=LAGS).map(|lag| (lag as f64, channel.autocorrelation(lag)));
        Curve::new(format!("{} {}", channel.group, channel.component), Style::Full, points.collect())
    };
    let mut curves: Vec<Curve> = measured.iter().map(lags).collect();
    let bound = NORMAL_95 / (measured[0].points.len() as f64).sqrt();
    for (name, sign) in [("95 % bound", 1.0), ("-95 % bound", -1.0)] {
        curves.push(Curve::new(name, Style::Bound, vec![(1.0, sign * bound), (LAGS as f64, sign * bound)]));
    }
    items.push(
        Figure {
            file: format!("{prefix}whiteness"),
            title: "Correlation of residuals over the updates between them".into(),
            axes: ["updates apart", "correlation"],
            curves,
        }
        .into(),
    );
    Section::new(title, items)
}

/// Normalised and physical residuals of a group of channels.
fn innovations(group: &str, prefix: &str, channels: &[&ChannelInnovations]) -> Option<[Figure; 2]> {
    let first = channels.first()?;
    let [files, axis] = match group {
        "velocity" => [["velocity-normalised", "velocity"], ["innovation by sigma", "innovation, m/s"]],
        "position" => [["position-normalised", "position"], ["innovation by sigma", "innovation, m"]],
        _ => [["attitude-normalised", "attitude"], ["innovation by sigma", "innovation, rad"]],
    };
    let ends = (first.points.first()?[0], first.points.last()?[0]);
    let mut normalised: Vec<Curve> = Vec::new();
    let mut physical: Vec<Curve> = Vec::new();
    for channel in channels {
        let over = |of: fn(&[f64; 3]) -> f64| channel.points.iter().map(|p| (p[0], of(p))).collect();
        normalised.push(Curve::new(channel.component, Style::Points, over(|p| p[1] / p[2])));
        physical.push(Curve::new(channel.component, Style::Points, over(|p| p[1])));
    }
    for sign in [1.0, -1.0] {
        let name = if sign > 0.0 { "+3 sigma" } else { "-3 sigma" };
        normalised.push(Curve::new(name, Style::Bound, vec![(ends.0, 3.0 * sign), (ends.1, 3.0 * sign)]));
    }
    let zero = first.points.iter().map(|p| (p[0], 0.0)).collect();
    let band = first.points.iter().map(|p| 3.0 * p[2]).collect();
    physical.push(Curve::new(format!("3 sigma of {}", first.component), Style::Bound, zero).with_band(band));
    let figure = |file: &str, title: String, axis, curves| Figure {
        file: format!("{prefix}{file}"),
        title,
        axes: ["time, s", axis],
        curves,
    };
    Some([
        figure(files[0], format!("{group}: innovations by their sigma"), axis[0], normalised),
        figure(files[1], format!("{group}: innovations"), axis[1], physical),
    ])
}

/// Horizontal errors of free-inertial navigation: name and track (time, east, north; s and m).
pub fn navigation<'a>(tracks: impl Iterator<Item = (&'a str, &'a [(f64, f64, f64)])> + Clone) -> Section {
    let start = |track: &[(f64, f64, f64)]| track.first().map_or(0.0, |(time, _, _)| *time);
    let horizontal = tracks.clone().map(|(name, track)| {
        let from = start(track);
        let points =
            track.iter().map(|(time, east, north)| ((time - from) / 3600.0, east.hypot(*north) / 1852.0));
        Curve::new(name, Style::Full, points.collect())
    });
    let mut figures = vec![Figure {
        file: "navigation".into(),
        title: "Horizontal error of free-inertial navigation".into(),
        axes: ["time, h", "error, nautical miles"],
        curves: horizontal.collect(),
    }];
    for (file, title, pick) in [("east", "Error to the east", 0), ("north", "Error to the north", 1)] {
        let curves = tracks.clone().map(|(name, track)| {
            let from = start(track);
            let of =
                |p: &(f64, f64, f64)| ((p.0 - from) / 3600.0, if pick == 0 { p.1 } else { p.2 } / 1852.0);
            Curve::new(name, Style::Full, track.iter().map(of).collect())
        });
        let axes = ["time, h", "error, nautical miles"];
        figures.push(Figure { file: file.into(), title: title.into(), axes, curves: curves.collect() });
    }
    Section::new("Navigation", figures.into_iter().map(Item::from).collect())
}

/// Name of a parameter.
pub fn name(info: &StateInfo) -> String {
    format!("{} {}", info.block, info.component).trim_end().to_owned()
}
