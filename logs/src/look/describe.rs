//! The description that a log suggests: what it shows itself is filled in, the rest is left to whoever knows it.

use std::fmt::Write;

use super::Look;
use crate::description::Description;
use crate::reading::Reading;

/// Digits that a measured figure is worth.
fn figure(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

/// The text of a description.
pub(super) fn suggest(look: &Look, reading: &Reading, known: Option<&Description>) -> String {
    let mut text = String::from(
        "# Suggested by `sinscal look`; lines that begin with # are to be filled in or left out.\n",
    );
    let mut line = |line: std::fmt::Arguments<'_>| {
        // writing to a string does not fail
        let _ = text.write_fmt(line);
        text.push('\n');
    };
    let nearest = look.rate_hz.round();
    let whole = (look.rate_hz / nearest - 1.0).abs() < 1e-3;
    let rate =
        known.map_or(if whole { nearest } else { (look.rate_hz * 1e4).round() / 1e4 }, |known| known.rate);
    line(format_args!("[imu]\nrate_hz = {rate:?}"));
    match known {
        Some(Description { site, .. }) => line(format_args!(
            "[site]\nlatitude_deg = {:?}\nlongitude_deg = {:?}\nheight_m = {:?}",
            (site.latitude.to_degrees() * 1e9).round() / 1e9,
            (site.longitude.to_degrees() * 1e9).round() / 1e9,
            site.height
        )),
        None => line(format_args!(
            "[site]\n# latitude_deg = 52.5   # where it was taken\n# longitude_deg = 13.3\n# height_m = 40.0"
        )),
    }
    if let Some(noise) = &look.noise {
        let mean = |axes: [f64; 3]| figure(axes.iter().sum::<f64>() / 3.0);
        line(format_args!(
            "# the scatter in the rests\n[noise]\ngyro_arw_deg_sqrt_h = {:?}\naccel_vrw_ug_sqrt_hz = {:?}",
            mean(noise.gyro_arw_deg_sqrt_h),
            mean(noise.accel_vrw_ug_sqrt_hz)
        ));
    }
    if let Some([low, high]) = look.temperature_c {
        line(format_args!("[temperature]\nreference_c = {:?}", (0.5 * (low + high)).round()));
    }
    if let Some(axes) = &look.likely_axes {
        let (name, value) = axes.split_once('=').unwrap_or(("imu", axes));
        line(format_args!("# specific force points against z at rest\n[axes]\n{name} = \"{value}\""));
    }
    if let Some(stamps) = reading.stamps {
        line(format_args!("[time]\nstamps = \"{}\"", crate::stamps::Stamps::NAMES[stamps as usize]));
    }
    let map = reading.map.text();
    if !map.is_empty() || reading.columns.is_some() {
        line(format_args!("[table]"));
        if let Some(columns) = &reading.columns {
            line(format_args!("columns = {}", quoted(&columns.join(","))));
        }
        if !map.is_empty() {
            line(format_args!("map = {}", quoted(&map)));
        }
    }
    text
}

/// A text as TOML has it.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}
