//! Figures: curves as SVG, with their numbers beside them.

use std::io::{self, Write};
use std::path::Path;

use kuva::plot::LinePlot;
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;
use miette::Result;

use crate::output::Files;

/// Colours that people with any kind of colour vision tell apart (Okabe and Ito).
const COLOURS: [&str; 7] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000"];
/// A curve is drawn with at most this many points; the numbers beside it are complete.
const DRAWN: usize = 2000;

/// A curve.
pub(crate) struct Curve {
    name: String,
    points: Vec<(f64, f64)>,
    style: Style,
}

/// How a curve looks.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Style {
    /// A full line in a colour of its own.
    Full,
    /// A dashed line in the colour of the full one before it: its bound, its truth, its theory.
    Dashed,
}

impl Curve {
    pub(crate) fn new(name: impl Into<String>, style: Style, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.into(), points, style }
    }
}

/// Curves over a common axis.
pub(crate) struct Figure {
    /// Names of the files, without ending.
    pub(crate) file: &'static str,
    pub(crate) title: String,
    /// Axes with their units.
    pub(crate) axes: [&'static str; 2],
    pub(crate) curves: Vec<Curve>,
}

impl Figure {
    /// Writes `FILE.svg` to a folder.
    pub(crate) fn draw(&self, files: &mut Files, folder: &Path) -> Result<()> {
        files.write(&folder.join(format!("{}.svg", self.file)), |out| out.write_all(self.svg().as_bytes()))
    }

    /// Writes `FILE.svg` and `FILE.csv` to a folder.
    pub(crate) fn write(&self, files: &mut Files, folder: &Path) -> Result<()> {
        self.draw(files, folder)?;
        files.write(&folder.join(format!("{}.csv", self.file)), |out| self.csv(out))
    }

    fn svg(&self) -> String {
        let mut plots = Vec::new();
        let mut colour = COLOURS.len() - 1;
        for curve in &self.curves {
            if curve.style == Style::Full {
                colour = (colour + 1) % COLOURS.len();
            }
            let step = curve.points.len().div_ceil(DRAWN).max(1);
            let line = LinePlot::new()
                .with_data(curve.points.iter().copied().step_by(step))
                .with_color(COLOURS[colour])
                .with_legend(curve.name.clone());
            plots.push(Plot::Line(match curve.style {
                Style::Full => line.with_stroke_width(1.6),
                Style::Dashed => line.with_stroke_width(1.2).with_dashed(),
            }));
        }
        let mut layout = Layout::auto_from_plots(&plots)
            .with_title(self.title.clone())
            .with_x_label(self.axes[0])
            .with_y_label(self.axes[1]);
        // what hardly changes is shown as what hardly changes: from zero
        let values = || self.curves.iter().flat_map(|curve| curve.points.iter().map(|(_, y)| *y));
        let (low, high) = values().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), y| (l.min(y), h.max(y)));
        if high - low < 0.01 * low.abs().max(high.abs()) {
            layout = layout.with_y_axis_min(1.2 * low.min(0.0)).with_y_axis_max(1.2 * high.max(0.0));
        }
        kuva::render_to_svg(plots, layout)
    }

    /// One line for each point: curve, then its coordinates.
    fn csv(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "curve,{},{}", self.axes[0].replace(',', " "), self.axes[1].replace(',', " "))?;
        for curve in &self.curves {
            for (x, y) in &curve.points {
                writeln!(out, "{},{x},{y:e}", curve.name)?;
            }
        }
        Ok(())
    }
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
            file: "two-lines",
            title: "Two lines".into(),
            axes: ["time, s", "way, m"],
            curves: vec![curve(Style::Full, 1.0), curve(Style::Dashed, 2.0)],
        };
        let svg = figure.svg();
        assert!(svg.starts_with("<svg") || svg.contains("<svg"));
        for text in ["Two lines", "slope 1", "slope 2", COLOURS[0]] {
            assert!(svg.contains(text), "{text} is missing");
        }
        assert!(!svg.contains(COLOURS[1]), "a dashed curve keeps the colour of the one before");
        assert!(
            !svg.contains("http://")
                || svg.matches("http").count() == svg.matches("http://www.w3.org").count()
        );
        let mut csv = Vec::new();
        figure.csv(&mut csv).expect("memory");
        assert_eq!(String::from_utf8(csv).expect("text").lines().count(), 11);
    }
}
