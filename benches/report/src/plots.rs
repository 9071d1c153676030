//! Plots, as SVG on white: legible on a dark page too.

use kuva::plot::{LegendPosition, LinePlot, ScatterPlot};
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;

use crate::run::{Error, Place, replace};

/// Colours that people with any kind of colour vision tell apart (Okabe and Ito).
const COLOURS: [&str; 4] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7"];
const WIDTH: f64 = 720.0;

fn write(place: &Place, file: &str, plots: Vec<Plot>, layout: Layout) -> Result<(), Error> {
    replace(&place.file(&format!("docs/performance/{file}.svg")), &kuva::render_to_svg(plots, layout))
}

/// Named curves through their points, from zero on.
pub(crate) fn curves(
    place: &Place,
    file: &str,
    (title, x, y): (&str, &str, &str),
    curves: &[(&str, Vec<(f64, f64)>)],
) -> Result<(), Error> {
    let mut plots = Vec::new();
    for ((name, points), colour) in curves.iter().zip(COLOURS) {
        let line = LinePlot::new().with_data(points.clone()).with_color(colour).with_stroke_width(1.6);
        plots.push(Plot::Line(line.with_legend(*name)));
        plots.push(Plot::Scatter(
            ScatterPlot::new().with_data(points.clone()).with_color(colour).with_size(3.0),
        ));
    }
    let layout = Layout::auto_from_plots(&plots)
        .with_width(WIDTH)
        .with_height(420.0)
        .with_legend_position(LegendPosition::InsideTopLeft)
        .with_title(title)
        .with_x_label(x)
        .with_y_label(y)
        .with_x_axis_min(0.0)
        .with_y_axis_min(0.0);
    write(place, file, plots, layout)
}

/// A bar for each value of each row, from 1 on along a logarithmic axis or else from 0.
pub(crate) fn bars(
    place: &Place,
    file: &str,
    (title, axis, logarithmic): (&str, &str, bool),
    series: &[&str],
    rows: &[(String, Vec<f64>)],
) -> Result<(), Error> {
    let mut plots = Vec::new();
    let height = 24.0;
    let start = if logarithmic { 1.0 } else { 0.0 };
    let most = rows.iter().flat_map(|(_, values)| values).fold(start, |most, value| value.max(most));
    for (s, (name, colour)) in series.iter().zip(COLOURS).enumerate() {
        for (i, (_, values)) in rows.iter().enumerate() {
            // rows go down, the axis goes up
            let at = (rows.len() - i) as f64 + 0.4 * ((series.len() - 1) as f64 / 2.0 - s as f64);
            let bar = LinePlot::new().with_data([(start, at), (values[s], at)]).with_color(colour);
            let bar = bar.with_stroke_width(0.7 * height / series.len() as f64);
            plots.push(Plot::Line(if i == 0 && series.len() > 1 { bar.with_legend(*name) } else { bar }));
        }
    }
    let mut layout = Layout::auto_from_plots(&plots)
        .with_width(WIDTH)
        .with_height(110.0 + height * rows.len() as f64)
        .with_legend_position(LegendPosition::InsideTopRight)
        .with_title(title)
        .with_x_label(axis)
        .with_y_categories(rows.iter().rev().map(|(name, _)| name.clone()).collect())
        .with_x_axis_min(start)
        .with_x_axis_max(1.1 * most)
        .with_y_axis_min(0.4)
        .with_y_axis_max(rows.len() as f64 + 0.6);
    if logarithmic {
        layout = layout.with_log_x().with_x_tick_format(TickFormat::Auto);
    }
    write(place, file, plots, layout)
}
