//! The noise of a unit as a page.

use std::path::Path;

use ::noise::Identified;
use logs::Quiet;
use miette::Result;
use reports::{Curve, Figure, Item, Report, Section, Style, Table, Tone, number, text as words};

use super::text::{CONSTANTS, Cells, DENSITIES, as_white, cells, taken};
use super::{Found, Sensor};
use crate::origin::Documented as _;
use crate::output::Files;

const AXES: [&str; 3] = ["x", "y", "z"];

/// Writes it, with its figures.
pub(super) fn write(
    found: &Found,
    quiet: &Quiet,
    verdict: &str,
    files: &mut Files,
    folder: &Path,
) -> Result<()> {
    let mut notes = found.notes.clone();
    notes.push(CONSTANTS.into());
    let mut sections = Vec::new();
    for (sensor, channels) in found.sensors() {
        notes.extend(channels.iter().enumerate().filter_map(|(axis, channel)| taken(sensor, axis, channel)));
        let mut rows = Vec::new();
        let mut items = vec![Item::text(DENSITIES)];
        for (axis, channel) in AXES.into_iter().zip(channels) {
            for component in &channel.components {
                let Cells { title, sheet, si } = cells(sensor, component);
                let si = format!("{} {}", si.value, si.unit);
                rows.push(vec![
                    words(axis),
                    words(title),
                    number(sheet.value),
                    number(sheet.interval),
                    words(sheet.unit),
                    number(si),
                ]);
            }
            if let Some((title, value, unit)) = as_white(sensor, channel) {
                let none = || words(String::new());
                rows.push(vec![words(axis), words(title), number(value), none(), words(unit), none()]);
            }
        }
        let head = ["axis", "process", "value", "95 % interval", "unit", "SI"];
        items.push(Table::new("Noise processes and their 95 % intervals", &head, rows).into());
        items.extend(
            AXES.into_iter().zip(channels).map(|(axis, channel)| Item::LogLog(figure(sensor, axis, channel))),
        );
        let title = match sensor {
            Sensor::Gyro => "Gyros",
            Sensor::Accel => "Accelerometers",
        };
        sections.push(Section::new(title, items));
    }
    sections.push(Section::new("How the log was read", vec![Item::List(notes)]));
    let page = Report {
        title: format!("Noise of {}", quiet.path().display()),
        verdict: verdict.to_owned(),
        tone: Tone::Neutral,
        facts: vec![
            ("at rest".into(), format!("{:.1} s", found.duration())),
            ("rate".into(), format!("{:.4} Hz", 1.0 / found.interval)),
        ],
        sections,
        origin: Vec::new(),
        attachments: Vec::new(),
    };
    page.with_program().with_file("log", quiet.path()).write(files, folder)
}

/// Allan deviation of one channel with its bounds and what the processes make of it.
fn figure(sensor: Sensor, axis: &str, channel: &Identified) -> Figure {
    let (_, (_, size)) = sensor.reading();
    let points = |of: &dyn Fn(&::noise::Scale) -> f64| {
        channel.scales.iter().map(|scale| (scale.tau, of(scale) / size)).collect::<Vec<_>>()
    };
    let mut curves = vec![
        Curve::new("measured", Style::Full, points(&|scale| scale.deviation())),
        Curve::new("95 % below", Style::Bound, points(&|scale| scale.bounds().0)),
        Curve::new("95 % above", Style::Bound, points(&|scale| scale.bounds().1)),
        Curve::new("all processes", Style::Full, points(&|scale| channel.explained(scale.tau))),
    ];
    for component in &channel.components {
        let name = sensor.naming(component.process.kind).kind;
        let alone = points(&|scale| component.process.variance(scale.tau).sqrt());
        // what is far below everything else only stretches the picture
        let floor = 0.1 * curves[0].lowest();
        let seen: Vec<(f64, f64)> = alone.into_iter().filter(|(_, deviation)| *deviation > floor).collect();
        if seen.len() > 1 {
            curves.push(Curve::new(name, Style::Full, seen));
        }
    }
    Figure {
        file: format!("allan-{}-{axis}", sensor.name()),
        title: format!("Allan deviation, {} {axis}", sensor.name()),
        axes: match sensor {
            Sensor::Gyro => ["averaging time, s", "Allan deviation, deg/h"],
            Sensor::Accel => ["averaging time, s", "Allan deviation, ug"],
        },
        curves,
    }
}
