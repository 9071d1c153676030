//! The figures: curves as SVG, their numbers as comma-separated text.

use std::io::{self, Write};
use std::path::Path;

use miette::Result;
use runs::{Flight, SPANS};
use sinscal::navigation::NAUTICAL_MILE;
use study::FilterResult;

use super::Findings;
use crate::observe::report::name;
use crate::output::Files;
use reports::{Curve, Figure, Style};

/// The filter whose parameters the figures show.
pub(super) const SHOWN: &str = "43d-b";
/// Files of the figures, and what they show by the names of the parameters in them.
const PARAMETERS: [(&str, &[&str]); 8] = [
    ("figure-07-gyro-scale", &["gyro-scale"]),
    ("figure-08-gyro-misalignment", &["gyro-misalignment"]),
    ("figure-09-accel-scale", &["accel-scale"]),
    ("figure-10-accel-misalignment", &["accel-misalignment"]),
    ("figure-11-accel-quadratic", &["accel-quadratic"]),
    ("figure-12-lever-arms", &["outer-lever-arm", "inner-lever-arm"]),
    ("figure-13-accel-delay", &["accel-delay"]),
    ("figure-14-accel-temperature-scale", &["accel-temperature-scale"]),
];

/// Writes all figures.
pub(super) fn write(findings: &Findings, files: &mut Files, folder: &Path) -> Result<()> {
    files.write(&folder.join("figure-05-observability.csv"), |out| figure_5(findings, out))?;
    let shown = findings.first.result.filters.iter().find(|filter| filter.filter == SHOWN);
    if let Some(shown) = shown {
        for (file, blocks) in PARAMETERS {
            files
                .write(&folder.join(format!("{file}.csv")), |out| parameters(findings, shown, blocks, out))?;
        }
    }
    files.write(&folder.join("figure-15-errors.csv"), |out| figure_15(findings, out))
}

/// Time, then estimate and sigma of each parameter of the filter shown.
fn estimates(findings: &Findings) -> impl Iterator<Item = (f64, &[(f64, f64)])> {
    let shown = findings.first.outcomes.iter().filter(|outcome| outcome.filter == SHOWN);
    shown.flat_map(|outcome| outcome.history.rows())
}

/// Figs. 7 to 14.
pub(super) fn convergences(findings: &Findings) -> Vec<Figure> {
    let shown = findings.first.result.filters.iter().find(|filter| filter.filter == SHOWN);
    let figures = |shown| PARAMETERS.map(|(file, blocks)| convergence(findings, shown, file, blocks));
    shown.map(figures).into_iter().flatten().collect()
}

/// Estimates of some parameters over time with their three sigmas and the truth (Figs. 7-14), in SI units.
fn convergence(findings: &Findings, shown: &FilterResult, file: &'static str, blocks: &[&str]) -> Figure {
    let mut curves = Vec::new();
    for (i, parameter) in shown.parameters.iter().enumerate() {
        if !blocks.contains(&parameter.name.as_str()) {
            continue;
        }
        let name = format!("{} {}", parameter.name, parameter.component);
        let estimates: Vec<_> = estimates(findings).collect();
        let points = estimates.iter().map(|(time, all)| (*time, all[i].0)).collect();
        let band = estimates.iter().map(|(_, all)| 3.0 * all[i].1).collect();
        curves.push(Curve::new(name.clone(), Style::Full, points).with_band(band));
        if let (Some((first, _)), Some((last, _))) = (estimates.first(), estimates.last()) {
            let truth = vec![(*first, parameter.truth), (*last, parameter.truth)];
            curves.push(Curve::new(format!("{name} truth"), Style::Dashed, truth));
        }
    }
    Figure {
        file: file.into(),
        title: format!("{}: estimates and three sigmas", blocks.join(", ")),
        axes: ["time, s", "estimate, SI"],
        curves,
    }
}

/// Horizontal error of free-inertial navigation with each filter's calibration (Fig. 15).
pub(super) fn navigation(findings: &Findings) -> Figure {
    let curves = findings.first.flights.iter().map(|flight| {
        let points = flight
            .track
            .iter()
            .map(|(time, east, north)| (time / 3600.0, east.hypot(*north) / NAUTICAL_MILE));
        Curve::new(flight.filter.clone(), Style::Full, points.collect())
    });
    Figure {
        file: "figure-15-errors".into(),
        title: "Horizontal error of free-inertial navigation".into(),
        axes: ["time, h", "horizontal error, nmi"],
        curves: curves.collect(),
    }
}

fn figure_5(findings: &Findings, out: &mut dyn Write) -> io::Result<()> {
    let spans: Vec<String> = (1..=SPANS).map(|span| format!("span_{span}")).collect();
    writeln!(out, "state,{},whole", spans.join(","))?;
    for state in &findings.observability.states {
        let degrees: Vec<String> = state.spans.iter().map(|degree| format!("{degree:e}")).collect();
        writeln!(out, "{},{},{:e}", name(&state.info), degrees.join(","), state.degree)?;
    }
    Ok(())
}

fn parameters(
    findings: &Findings,
    shown: &FilterResult,
    blocks: &[&str],
    out: &mut dyn Write,
) -> io::Result<()> {
    let which: Vec<usize> = (0..shown.parameters.len())
        .filter(|i| blocks.contains(&shown.parameters[*i].name.as_str()))
        .collect();
    write!(out, "time_s")?;
    for i in &which {
        let parameter = &shown.parameters[*i];
        let name = format!("{}.{}", parameter.name, parameter.component);
        write!(out, ",{name},{name}.three_sigma,{name}.truth")?;
    }
    writeln!(out)?;
    for (time, estimates) in estimates(findings) {
        write!(out, "{time}")?;
        for i in &which {
            let (value, sigma) = estimates[*i];
            write!(out, ",{value:e},{:e},{:e}", 3.0 * sigma, shown.parameters[*i].truth)?;
        }
        writeln!(out)?;
    }
    Ok(())
}

fn figure_15(findings: &Findings, out: &mut dyn Write) -> io::Result<()> {
    let flights = &findings.first.flights;
    write!(out, "time_s")?;
    for Flight { filter, .. } in flights {
        write!(out, ",{filter}.east_m,{filter}.north_m,{filter}.horizontal_m")?;
    }
    writeln!(out)?;
    let points = flights.iter().map(|flight| flight.track.len()).min().unwrap_or(0);
    for i in 0..points {
        write!(out, "{}", flights[0].track[i].0)?;
        for Flight { track, .. } in flights {
            let (_, east, north) = track[i];
            write!(out, ",{east:.3},{north:.3},{:.3}", east.hypot(north))?;
        }
        writeln!(out)?;
    }
    Ok(())
}
