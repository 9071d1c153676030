//! Sections that several subcommands have in common.

use sinscal::navigation::NAUTICAL_MILE;
use sinscal::{ChannelInnovations, Parameter, StateInfo};

use super::{Cell, Interval, Item, Section, Table, number, text};
use crate::draw::{Curve, Figure, Style};
use crate::figures::{decimals, significant};
use runs::History;

/// Half the length of the axis of a forest plot, in prior sigmas, at least and at most: what was believed must be seen to end.
const FOREST: [f64; 2] = [1.5, 3.0];
/// A band is drawn from where it is narrower than this part of the prior: before, those of all axes cover each other.
const NARROW: f64 = 0.1;
/// Half the length of the axis of normalised errors.
const ERRORS: f64 = 4.0;
/// Lags at which residuals are looked at for whiteness.
const LAGS: usize = 20;
/// What 95 % of normal numbers stay within.
const NORMAL_95: f64 = 1.96;

/// An hour, s.
const HOUR: f64 = 3600.0;

/// True values, where they are known.
pub type Truth<'a> = Option<&'a dyn Fn(&StateInfo) -> f64>;

/// Estimates with their intervals.
pub fn numbers(parameters: &[Parameter], converged: &dyn Fn(usize) -> Option<f64>, truth: Truth) -> Section {
    let mut head = vec!["parameter", "estimate", "unit", "95 % interval"];
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
            row.extend([figure(sheet(p.value)), text(info.sheet_unit)]);
            row.push(number(format!("{:.digits$} to {:.digits$}", sheet(low), sheet(high))));
        } else {
            row.extend([number("not estimated"), text(info.sheet_unit), number("")]);
        }
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
/// `places` has where each parameter stands in the history.
pub fn convergence(parameters: &[Parameter], places: &[usize], history: &History, truth: Truth) -> Section {
    let mut figures: Vec<Figure> = Vec::new();
    for (p, &i) in parameters.iter().zip(places) {
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
        let wide = history.rows().take_while(|(_, row)| row[i].1 > NARROW * p.prior_sigma).count();
        // what never becomes narrow is shown whole
        let wide = if history.rows().nth(wide).is_some() { wide } else { 0 };
        let seen = || history.rows().skip(wide);
        let points = seen().map(|(time, row)| (time, sheet(row[i].0))).collect();
        let band = seen().map(|(_, row)| sheet(3.0 * row[i].1)).collect();
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
        "Estimates with three sigmas of the last pass, from where sigma is below a tenth of its prior. The axis shows what is left when \
         the wide beginning is over; a double click shows everything, a drag what it spans.",
    );
    if truth.is_some() {
        words += " Dashed: the truth.";
    }
    let mut items = vec![Item::text(words)];
    items.extend(figures.into_iter().map(Item::from));
    Section::new("Convergence", items).folded()
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
        let points = track
            .iter()
            .map(|(time, east, north)| ((time - from) / HOUR, east.hypot(*north) / NAUTICAL_MILE));
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
            let of = |p: &(f64, f64, f64)| {
                ((p.0 - from) / HOUR, if pick == 0 { p.1 } else { p.2 } / NAUTICAL_MILE)
            };
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

#[cfg(test)]
mod tests {
    use super::*;

    const INFO: StateInfo = StateInfo {
        block: "gyro-scale",
        component: "x",
        unit: "1",
        prior_sigma: 3e-4,
        sheet_unit: "ppm",
        sheet_scale: 1e-6,
    };
    const PARAMETER: Parameter =
        Parameter { info: INFO, value: 1.2e-5, sigma: 4e-7, prior_sigma: 1e-4, estimated: true };

    fn table(section: &Section) -> &Table {
        let tables = section
            .items
            .iter()
            .filter_map(|item| if let Item::Table(table) = item { Some(table) } else { None });
        tables.into_iter().next().expect("a table")
    }

    fn figures(section: &Section) -> Vec<String> {
        let figures = section
            .items
            .iter()
            .filter_map(|item| if let Item::Curves(figure) = item { Some(figure) } else { None });
        figures.map(|figure| String::from_utf8(figure.csv()).expect("text")).collect()
    }

    #[test]
    fn errors_of_navigation_are_in_nautical_miles_and_hours() {
        let track = [(100.0, 0.0, 0.0), (1900.0, 1852.0, 0.0), (3700.0, -3.0 * 1852.0, 4.0 * 1852.0)];
        let section = navigation([("a", &track[..])].into_iter());
        let [horizontal, east, north] = &figures(&section)[..] else { panic!("three figures") };
        assert!(horizontal.ends_with("a,0,0e0\na,0.5,1e0\na,1,5e0\n"), "{horizontal}");
        assert!(east.ends_with("a,0.5,1e0\na,1,-3e0\n"), "{east}");
        assert!(north.ends_with("a,0.5,0e0\na,1,4e0\n"), "{north}");
    }

    #[test]
    fn estimates_stand_in_data_sheet_units_with_their_intervals() {
        let vague = Parameter { estimated: false, ..PARAMETER };
        let truth = |_: &StateInfo| 1.1e-5;
        let section = numbers(&[PARAMETER, vague], &|_| Some(715.2), Some(&truth));
        let told: Vec<Vec<&str>> = table(&section)
            .rows
            .iter()
            .map(|row| {
                row.iter()
                    .map(|cell| if let Cell::Text(t) | Cell::Number(t) = cell { t } else { "?" })
                    .collect()
            })
            .collect();
        // 12 ppm within 1.96 times 0.4 ppm; 2.5 sigma from 11 ppm
        assert_eq!(
            told[0],
            ["gyro-scale x", "12.00", "ppm", "11.22 to 12.78", "11.00", "+2.5", "100", "715 s"]
        );
        assert_eq!(told[1][1..4], ["not estimated", "ppm", ""]);
    }

    #[test]
    fn a_forest_shows_where_the_prior_ends() {
        let truth = |_: &StateInfo| 1.1e-5;
        let section = forest(&[PARAMETER], &|_| 0.0, Some(&truth));
        let Cell::Interval(drawn) = &table(&section).rows[0][1] else { panic!("an interval") };
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
        // the axis reaches to 1.5 prior sigmas, the estimate is 0.12 of one, three of its sigmas 0.012
        close(drawn.prior.0, 0.5 - 0.5 / 1.5);
        close(drawn.prior.1, 0.5 + 0.5 / 1.5);
        close(drawn.estimate, 0.54);
        close(drawn.interval.0, 0.536);
        close(drawn.interval.1, 0.544);
        close(drawn.truth.unwrap_or(f64::NAN), 0.5 + 0.5 * 0.11 / 1.5);
        let Cell::Interval(error) = &table(&section).rows[0][3] else { panic!("an error") };
        close(error.estimate, 0.5 + 0.5 * 2.5 / 4.0);
    }

    #[test]
    fn a_band_begins_where_it_is_narrow() {
        let mut history = History::new(1, 0.0);
        for (time, sigma) in [(1.0, 1e-4), (2.0, 2e-5), (3.0, 1e-5), (4.0, 5e-6)] {
            history.push(time, [(1e-6 * time, sigma)].into_iter());
        }
        let section = convergence(&[PARAMETER], &[0], &history, None);
        // from a tenth of the prior, with three sigmas, in ppm
        let told = figures(&section);
        let rows: Vec<&str> = told[0].lines().skip(1).collect();
        let [third, fourth] = rows[..] else { panic!("two points: {rows:?}") };
        for (row, begins, half) in [(third, "x,3,3e0,", 30.0), (fourth, "x,4,4e0,", 15.0)] {
            let band: f64 = row.strip_prefix(begins).and_then(|band| band.parse().ok()).expect("a band");
            assert!((band / half - 1.0).abs() < 1e-12, "{row}");
        }
        // what never becomes so narrow is shown whole
        let wide = Parameter { prior_sigma: 1e-6, ..PARAMETER };
        assert!(figures(&convergence(&[wide], &[0], &history, None))[0].contains("x,1,1e0,"), "all of it");
    }

    #[test]
    fn residuals_are_counted_in_their_sigmas() {
        let points = (0..40).map(|k| [f64::from(k), if k % 2 == 0 { 0.2 } else { -0.2 }, 0.1]).collect();
        let channel = ChannelInnovations { group: "velocity", component: "e", unit: "m/s", points };
        let section = residuals("Residuals", "", &[channel]);
        let told: Vec<&str> = table(&section).rows[0]
            .iter()
            .map(|cell| if let Cell::Text(t) | Cell::Number(t) = cell { t.as_str() } else { "?" })
            .collect();
        // all two sigmas off, and each against the one before: 39 products of -1 over 40 squares
        assert_eq!(told[..7], ["velocity e", "40", "2.000", "0.0 %", "100.0 %", "100.0 %", "-0.975"]);
        let [normalised, physical, ..] = &figures(&section)[..] else { panic!("two figures") };
        assert!(normalised.contains("e,0,2e0") && normalised.contains("e,1,-2e0"), "{normalised}");
        assert!(physical.contains("e,0,2e-1") && physical.contains(",3.0000000000000004e-1"), "{physical}");
    }
}
