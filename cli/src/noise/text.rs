//! The noise of a unit as text for people.

use std::fmt::Write;

use ::noise::{Component, Identified, Kind, typical};
use reports::figures::significant;

use super::units::Naming;
use super::{Found, Sensor};

const AXES: [&str; 3] = ["x", "y", "z"];

/// The white noise of a channel as averages over seconds show it, in the unit of data sheets: with what forgets faster than that.
fn white(sensor: Sensor, channel: &Identified) -> Option<f64> {
    let all = typical(&[channel.processes()]);
    let white = all.iter().find(|process| process.kind == Kind::White)?;
    Some(white.size / sensor.naming(white.kind).sheet.1)
}

/// The same where it is not one of the processes: what it is, how much, and the unit.
pub(super) fn as_white(sensor: Sensor, channel: &Identified) -> Option<(String, String, &'static str)> {
    channel.processes().iter().any(|process| process.kind.is_fast()).then_some(())?;
    let Naming { title, sheet: (unit, _), .. } = sensor.naming(Kind::White);
    Some((format!("beyond a second: {title}"), significant(white(sensor, channel)?), unit))
}

/// The finding in a sentence.
pub(super) fn verdict(found: &Found) -> String {
    let white = |of: usize| {
        let (sensor, channels) = found.sensors()[of];
        let sizes = channels.iter().map(|channel| white(sensor, channel).map(significant));
        let sizes: Vec<Option<String>> = sizes.collect();
        sizes.iter().any(Option::is_some).then(|| {
            let all = sizes.into_iter().map(|size| size.unwrap_or_else(|| "-".to_owned()));
            all.collect::<Vec<_>>().join(" ")
        })
    };
    let said = |of: usize, name: &str, unit: &str| match white(of) {
        Some(sizes) => format!("{name} {sizes} {unit} (x y z)"),
        None => format!("no {name}"),
    };
    format!(
        "White noise: {}, {}, from {:.1} s of rest",
        said(0, "angle random walk", "deg/sqrt(h)"),
        said(1, "velocity random walk", "ug/sqrt(Hz)"),
        found.duration()
    )
}

/// A size as people read it.
pub(super) struct Cells {
    /// What the process is.
    pub(super) title: String,
    /// In the unit of data sheets, and in SI.
    pub(super) sheet: Sized,
    pub(super) si: Sized,
}

/// A value with its interval and unit.
pub(super) struct Sized {
    pub(super) value: String,
    pub(super) interval: String,
    pub(super) unit: &'static str,
}

impl Sized {
    fn new(component: &Component, unit: &'static str, shown: impl Fn(f64) -> String) -> Self {
        let (low, high) = component.size;
        let interval = format!("{} to {}", shown(low), shown(high));
        Self { value: shown(component.process.size), interval, unit }
    }

    fn line(&self) -> String {
        format!("{} ({}) {}", self.value, self.interval, self.unit)
    }
}

/// How a process reads.
pub(super) fn cells(sensor: Sensor, component: &Component) -> Cells {
    let naming = sensor.naming(component.process.kind);
    let mut title = naming.title.to_owned();
    if let Some((time, (low, high))) = component.process.kind.time().zip(component.time) {
        let _ = write!(title, ", {} s ({} to {})", significant(time), significant(low), significant(high));
    }
    let (unit, size) = naming.sheet;
    Cells {
        title,
        sheet: Sized::new(component, unit, |number| significant(number / size)),
        si: Sized::new(component, naming.unit, |number| format!("{number:.3e}")),
    }
}

/// What was taken out of a channel before.
pub(super) fn taken(sensor: Sensor, axis: usize, channel: &Identified) -> Option<String> {
    let (slope, span) = channel.taken?;
    let (_, (unit, size)) = sensor.reading();
    Some(format!(
        "{} {}: temperature moved by {span:.1} K; {} {unit}/K that go with it were taken out first",
        sensor.name(),
        AXES[axis],
        significant(slope / size)
    ))
}

/// What holds for all of it.
pub(super) const CONSTANTS: &str =
    "Earth rate, gravity and bias are constants of a rest: they are taken out first";
pub(super) const DENSITIES: &str = "values are continuous-time densities and sizes, with their 95 % intervals: the mean of white noise \
                                    over T seconds has the standard deviation value/sqrt(T)";

/// The whole text.
pub(super) fn text(found: &Found) -> String {
    let mut text = format!("{}\n", verdict(found));
    let mut line = |line: &str| {
        text.push_str(line);
        text.push('\n');
    };
    found.notes.iter().for_each(|note| line(&format!("  {note}")));
    line(&format!("  {CONSTANTS}"));
    for (sensor, channels) in found.sensors() {
        channels
            .iter()
            .enumerate()
            .filter_map(|(axis, channel)| taken(sensor, axis, channel))
            .for_each(|said| line(&format!("  {said}")));
    }
    line(&format!("  {DENSITIES}"));
    for (sensor, channels) in found.sensors() {
        for (axis, channel) in AXES.into_iter().zip(channels) {
            line(&format!("{} {axis}", sensor.name()));
            for component in &channel.components {
                let Cells { title, sheet, si } = cells(sensor, component);
                line(&format!("  {title:60} {:44} {}", sheet.line(), si.line()));
            }
            if let Some((title, value, unit)) = as_white(sensor, channel) {
                line(&format!("  {title:60} {value} {unit}"));
            }
            if let Some((deviation, tau)) = channel.floor() {
                let (_, (unit, size)) = sensor.reading();
                line(&format!(
                    "  lowest Allan deviation {} {unit} at {} s",
                    significant(deviation / size),
                    significant(tau)
                ));
            }
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use ::noise::Process;

    use super::*;

    #[test]
    fn what_forgets_within_a_second_is_white_beyond_it() {
        let channel = |time: f64| {
            let process = Process { kind: Kind::GaussMarkov { time }, size: 1.2e-6 };
            let component =
                Component { process, size: (1.1e-6, 1.3e-6), time: Some((0.9 * time, 1.1 * time)) };
            Identified { scales: Vec::new(), components: vec![component], taken: None }
        };
        // 1.2e-6 rad/s sqrt(2 0.04 s) = 3.394e-7 rad/sqrt(s) = 1.167e-3 deg/sqrt(h)
        let (title, value, unit) = as_white(Sensor::Gyro, &channel(0.04)).expect("it forgets");
        assert_eq!((value.as_str(), unit), ("0.00117", "deg/sqrt(h)"));
        assert_eq!(title, "beyond a second: angle random walk (white noise)");
        assert_eq!(
            (as_white(Sensor::Gyro, &channel(40.0)), white(Sensor::Gyro, &channel(40.0))),
            (None, None)
        );
    }
}
