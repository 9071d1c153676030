//! The noise of a unit as JSON.

use std::path::Path;

use ::noise::{Component, Identified, Process};
use miette::{IntoDiagnostic, Result, miette};
use serde::Serialize;
use serde_json::Value;

use super::{Found, Sensor};

const AXES: [&str; 3] = ["x", "y", "z"];
/// Such files are small; what is larger is some other file.
const LARGEST: u64 = 16 << 20;

#[derive(Serialize)]
struct Document {
    duration_s: f64,
    rate_hz: f64,
    gyro: Vec<Axis>,
    accel: Vec<Axis>,
}

#[derive(Serialize)]
struct Axis {
    axis: &'static str,
    processes: Vec<Entry>,
    /// Allan deviations in SI.
    allan: Vec<Point>,
}

#[derive(Serialize)]
struct Entry {
    kind: &'static str,
    value: f64,
    low: f64,
    high: f64,
    unit: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    tau_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tau_low_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tau_high_s: Option<f64>,
}

#[derive(Serialize)]
struct Point {
    tau_s: f64,
    deviation: f64,
    low: f64,
    high: f64,
    edf: f64,
    terms: u64,
}

fn entry(sensor: Sensor, component: &Component) -> Entry {
    let naming = sensor.naming(component.process.kind);
    Entry {
        kind: naming.kind,
        value: component.process.size,
        low: component.size.0,
        high: component.size.1,
        unit: naming.unit,
        tau_s: component.process.kind.time(),
        tau_low_s: component.time.map(|(low, _)| low),
        tau_high_s: component.time.map(|(_, high)| high),
    }
}

fn axis((name, channel): (&'static str, &Identified), sensor: Sensor) -> Axis {
    let point = |scale: &::noise::Scale| {
        let (low, high) = scale.bounds();
        Point {
            tau_s: scale.tau,
            deviation: scale.deviation(),
            low,
            high,
            edf: scale.edf,
            terms: scale.terms,
        }
    };
    Axis {
        axis: name,
        processes: channel.components.iter().map(|component| entry(sensor, component)).collect(),
        allan: channel.scales.iter().map(point).collect(),
    }
}

/// The document.
pub(super) fn text(found: &Found) -> Result<String> {
    let sensor = |of: usize| {
        let (sensor, channels) = found.sensors()[of];
        AXES.into_iter().zip(channels).map(|channel| axis(channel, sensor)).collect()
    };
    let document = Document {
        duration_s: found.duration(),
        rate_hz: 1.0 / found.interval,
        gyro: sensor(0),
        accel: sensor(1),
    };
    Ok(serde_json::to_string_pretty(&document).into_diagnostic()? + "\n")
}

/// What such a document says: the rate, Hz, and the processes of each axis of gyros and accelerometers.
pub(crate) type Read = (f64, [Vec<Vec<Process>>; 2]);

/// Reads such a document; nothing where it is another one.
pub(crate) fn read(path: &Path) -> Result<Option<Read>> {
    let at = path.display();
    let metadata = std::fs::metadata(path).map_err(|error| miette!("{at}: cannot be read: {error}"))?;
    if !metadata.is_file() || metadata.len() > LARGEST {
        return Ok(None);
    }
    let bytes = std::fs::read(path).map_err(|error| miette!("{at}: cannot be read: {error}"))?;
    let Ok(document) = serde_json::from_slice::<Value>(&bytes) else { return Ok(None) };
    if document.get("gyro").is_none() || document.get("accel").is_none() {
        return Ok(None);
    }
    let whole = || {
        let rate = document.get("rate_hz")?.as_f64().filter(|rate| *rate > 0.0)?;
        let mut sensors = [Vec::new(), Vec::new()];
        for (sensor, axes) in Sensor::BOTH.into_iter().zip(&mut sensors) {
            for axis in document.get(sensor.name())?.as_array()? {
                axes.push(
                    axis.get("processes")?
                        .as_array()?
                        .iter()
                        .map(process)
                        .collect::<Option<Vec<Process>>>()?,
                );
            }
        }
        Some((rate, sensors))
    };
    match whole() {
        Some(found) => Ok(Some(found)),
        None => Err(miette!(
            help = "it is what `sinscal noise --json` writes",
            "{at}: is no complete document of noise: rate_hz, and for each axis kind and value (above 0) of its processes"
        )),
    }
}

fn process(entry: &Value) -> Option<Process> {
    let number = |key: &str| entry.get(key)?.as_f64().filter(|number| number.is_finite() && *number > 0.0);
    let name = entry.get("kind")?.as_str()?;
    let time = if name == "gauss-markov" { number("tau_s")? } else { 0.0 };
    Some(Process { kind: Sensor::kind(name, time)?, size: number("value")? })
}
