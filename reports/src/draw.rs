//! Figures: curves as SVG and as data for the report's plots, with their numbers beside them.

use std::io::{self, Write};

use kuva::plot::{LinePlot, ScatterPlot};
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;
use serde_json::{Value, json};

use crate::typeset::symbols;

/// Colours that people with any kind of colour vision tell apart (Okabe and Ito).
const COLOURS: [&str; 7] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000"];
/// A curve is drawn with at most this many points; the numbers beside it are complete.
const DRAWN: usize = 1200;
/// Colour of bounds.
const GREY: &str = "#59616b";
/// Where there are bands, which begin as wide as the prior, a figure shows at first what is left after this part of it.
const SETTLED: f64 = 0.4;

/// A curve.
#[derive(Clone)]
pub struct Curve {
    name: String,
    points: Vec<(f64, f64)>,
    style: Style,
    /// Half the width of a band about the curve, point by point.
    band: Option<Vec<f64>>,
}

/// How a curve looks.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// A full line in a colour of its own.
    Full,
    /// A dashed line in the colour of the full one before it: its bound, its truth, its theory.
    Dashed,
    /// Points without a line, in a colour of their own.
    Points,
    /// A dashed grey line: a bound, a level.
    Bound,
}

impl Curve {
    /// A curve called `name` through `points`.
    pub fn new(name: impl Into<String>, style: Style, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.into(), points, style, band: None }
    }

    /// The same within a band of `half` its width to either side, point by point.
    pub fn with_band(self, half: Vec<f64>) -> Self {
        Self { band: Some(half), ..self }
    }

    /// Whether there is nothing to draw.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// The least of its values.
    pub fn lowest(&self) -> f64 {
        self.points.iter().map(|(_, y)| *y).fold(f64::INFINITY, f64::min)
    }

    /// Every so many points are drawn.
    fn step(&self) -> usize {
        self.points.len().div_ceil(DRAWN).max(1)
    }

    /// What is drawn of it: points, with half the band's width.
    fn drawn(&self) -> impl Iterator<Item = (f64, f64, f64)> + '_ {
        let half = |i: usize| self.band.as_ref().and_then(|band| band.get(i)).copied().unwrap_or(0.0);
        let points = self.points.iter().enumerate().map(move |(i, (x, y))| (*x, *y, half(i)));
        let last = self.points.len().saturating_sub(1);
        let step = self.step();
        points.enumerate().filter(move |(i, _)| i.is_multiple_of(step) || *i == last).map(|(_, point)| point)
    }
}

/// Curves over a common axis.
#[derive(Clone)]
pub struct Figure {
    /// Names of the files, without ending.
    pub file: String,
    /// What it shows.
    pub title: String,
    /// Axes with their units.
    pub axes: [&'static str; 2],
    /// The curves, in the order in which they are drawn.
    pub curves: Vec<Curve>,
}

impl Figure {
    /// What the report's script draws it from, with logarithmic axes or without.
    pub fn data(&self, logarithmic: bool) -> Value {
        let mut times: Vec<Vec<Value>> = Vec::new();
        let mut curves = Vec::new();
        for (curve, colour) in self.curves.iter().zip(self.colours()) {
            let drawn: Vec<(f64, f64, f64)> = curve.drawn().collect();
            let x: Vec<Value> = drawn.iter().map(|(x, _, _)| short(*x, 7)).collect();
            let at = times.iter().position(|known| *known == x).unwrap_or_else(|| {
                times.push(x);
                times.len() - 1
            });
            let y: Vec<Value> = drawn.iter().map(|(_, y, _)| short(*y, 5)).collect();
            let band: Option<Vec<Value>> =
                curve.band.as_ref().map(|_| drawn.iter().map(|(_, _, half)| short(*half, 3)).collect());
            let style = match curve.style {
                Style::Full => "full",
                Style::Dashed => "dashed",
                Style::Points => "points",
                Style::Bound => "bound",
            };
            curves.push(json!({
                "name": symbols(&curve.name), "style": style, "colour": colour, "x": at, "y": y, "band": band,
            }));
        }
        json!({
            "axes": self.axes.map(symbols), "x": times, "curves": curves, "view": self.view(),
            "logarithmic": logarithmic,
        })
    }

    /// Colours of the curves, as places in the list of them. Bounds take none of them.
    fn colours(&self) -> Vec<usize> {
        let mut colour = COLOURS.len() - 1;
        let next = |curve: &Curve| {
            if matches!(curve.style, Style::Full | Style::Points) {
                colour = (colour + 1) % COLOURS.len();
            }
            colour
        };
        self.curves.iter().map(next).collect()
    }

    /// What to show of the y axis at first.
    fn view(&self) -> Option<[f64; 2]> {
        let banded = self.curves.iter().any(|curve| curve.band.is_some());
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        let mut take = |y: f64| {
            if y.is_finite() {
                range = [range[0].min(y), range[1].max(y)];
            }
        };
        for curve in &self.curves {
            let settled = (SETTLED * curve.points.len() as f64) as usize;
            for (i, (_, y)) in curve.points.iter().enumerate().skip(settled) {
                let half = curve.band.as_ref().and_then(|band| band.get(i)).copied().unwrap_or(0.0);
                take(y - half);
                take(y + half);
            }
        }
        let margin = 0.15 * (range[1] - range[0]);
        (banded && margin > 0.0).then(|| [range[0] - margin, range[1] + margin])
    }

    /// The figure as SVG, with logarithmic axes or without.
    pub fn svg(&self, logarithmic: bool) -> String {
        let mut plots = Vec::new();
        let view = self.view();
        let seen = |y: f64| view.map_or(y, |[low, high]| y.clamp(low, high));
        for (curve, colour) in self.curves.iter().zip(self.colours()) {
            let colour = if curve.style == Style::Bound { GREY } else { COLOURS[colour] };
            let points = curve.drawn().map(|(x, y, _)| (x, seen(y)));
            if curve.style == Style::Points {
                let scatter = ScatterPlot::new().with_data(points).with_color(colour).with_size(1.5);
                plots.push(Plot::Scatter(scatter.with_legend(curve.name.clone())));
                continue;
            }
            let mut line =
                LinePlot::new().with_data(points).with_color(colour).with_legend(curve.name.clone());
            if curve.band.is_some() {
                let edge = |sign: f64| curve.drawn().map(move |(_, y, half)| seen(y + sign * half));
                line = line.with_band(edge(-1.0), edge(1.0));
            }
            plots.push(Plot::Line(match curve.style {
                Style::Dashed | Style::Bound => line.with_stroke_width(1.2).with_dashed(),
                _ => line.with_stroke_width(1.6),
            }));
        }
        let mut layout = Layout::auto_from_plots(&plots)
            .with_title(self.title.clone())
            .with_x_label(self.axes[0])
            .with_y_label(self.axes[1]);
        if logarithmic {
            return kuva::render_to_svg(plots, layout.with_log_x().with_log_y());
        }
        // what hardly changes is shown as what hardly changes: from zero
        let values = || self.curves.iter().flat_map(|curve| curve.points.iter().map(|(_, y)| *y));
        let (low, high) = values().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), y| (l.min(y), h.max(y)));
        if let Some([low, high]) = view {
            layout = layout.with_y_axis_min(low).with_y_axis_max(high);
        } else if high - low < 0.01 * low.abs().max(high.abs()) {
            layout = layout.with_y_axis_min(1.2 * low.min(0.0)).with_y_axis_max(1.2 * high.max(0.0));
        }
        kuva::render_to_svg(plots, layout)
    }

    /// The numbers, as comma-separated text.
    pub fn csv(&self) -> Vec<u8> {
        let mut out = Vec::new();
        // writing to memory does not fail
        let _ = self.write_csv(&mut out);
        out
    }

    fn write_csv(&self, out: &mut dyn Write) -> io::Result<()> {
        let banded = self.curves.iter().any(|curve| curve.band.is_some());
        let [x, y] = self.axes.map(|axis| axis.replace(',', " "));
        writeln!(out, "curve,{x},{y}{}", if banded { ",half band" } else { "" })?;
        for curve in &self.curves {
            for (i, (x, y)) in curve.points.iter().enumerate() {
                write!(out, "{},{x},{y:e}", curve.name)?;
                match curve.band.as_ref().and_then(|band| band.get(i)) {
                    Some(half) => writeln!(out, ",{half:e}")?,
                    None if banded => writeln!(out, ",")?,
                    None => writeln!(out)?,
                }
            }
        }
        Ok(())
    }
}

/// A number to so many figures, as short as it can be written; nothing for what is none.
fn short(number: f64, figures: usize) -> Value {
    format!("{number:.*e}", figures.saturating_sub(1)).parse::<f64>().map_or(Value::Null, Value::from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_has_its_curves_and_their_numbers() {
        let curve = |style, slope: f64| {
            Curve::new(
                format!("slope {slope}"),
                style,
                (0..5).map(|i| (f64::from(i), slope * f64::from(i))).collect(),
            )
        };
        let figure = Figure {
            file: "two-lines".into(),
            title: "Two lines".into(),
            axes: ["time, s", "way, m"],
            curves: vec![curve(Style::Full, 1.0), curve(Style::Dashed, 2.0)],
        };
        let svg = figure.svg(false);
        assert!(svg.starts_with("<svg") || svg.contains("<svg"));
        for text in ["Two lines", "slope 1", "slope 2", COLOURS[0]] {
            assert!(svg.contains(text), "{text} is missing");
        }
        assert!(!svg.contains(COLOURS[1]), "a dashed curve keeps the colour of the one before");
        assert!(
            !svg.contains("http://")
                || svg.matches("http").count() == svg.matches("http://www.w3.org").count()
        );
        let csv = figure.csv();
        assert_eq!(String::from_utf8(csv).expect("text").lines().count(), 11);
    }
}
