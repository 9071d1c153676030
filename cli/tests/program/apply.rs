//! `apply`: what it writes against corrections made by hand, and what it refuses.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use arrow_array::Float64Array;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use serde_json::Value;

use crate::support::Done;

fn sinscal(folder: &Path, arguments: &str) -> std::io::Result<Output> {
    Command::new(env!("CARGO_BIN_EXE_sinscal")).args(arguments.split(' ')).current_dir(folder).output()
}

const DESCRIBED: &str = "[imu]\nrate_hz = 50\n[site]\nlatitude_deg = 32\nlongitude_deg = 118\nheight_m = 20\n[noise]\n\
                         gyro_arw_deg_sqrt_h = 3.0\naccel_vrw_ug_sqrt_hz = 1500.0\n";
const MAP: &str = "--map gyro=w:deg/s,accel=a:g,time=t --axes imu=frd";

/// Degrees per second and g, forward right down, decimal commas, a remark above and a text beside: with numbers changed by `change`.
fn text(change: impl Fn(usize, f64) -> f64) -> String {
    let mut text = String::from("made by a logger\nt;wx;wy;wz;ax;ay;az;state\n");
    for row in 1..=3000 {
        let scatter = |of: usize| ((row * row * (of + 3)) as f64 * 0.37).sin();
        let values = (0..6).map(|of| {
            let (mean, size) = if of < 3 { (0.3, 0.02) } else { ([0.01, -0.02, -1.0][of - 3], 1e-3) };
            change(of, mean + size * scatter(of)).to_string().replace('.', ",")
        });
        let time = format!("{:.2}", row as f64 * 0.02).replace('.', ",");
        text += &format!("{time};{};still\r\n", values.collect::<Vec<_>>().join(";"));
    }
    text
}

/// A calibration of nothing but what is said.
fn calibration(folder: &Path, said: &[(&str, &str, f64)]) -> Done {
    let output = sinscal(folder, &format!("calibrate log.csv --filter mems-30d {MAP} --json -"))?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let mut document: Value = serde_json::from_slice(&output.stdout)?;
    for parameter in document["parameters"].as_array_mut().expect("parameters") {
        let of = |(name, component, _): &&(&str, &str, f64)| {
            parameter["name"] == *name && parameter["component"] == *component
        };
        parameter["value"] = said.iter().find(of).map_or(0.0, |(_, _, value)| *value).into();
    }
    fs::write(folder.join("c.json"), document.to_string())?;
    Ok(())
}

#[test]
fn errors_are_taken_out_in_the_units_and_axes_of_the_file() -> Done {
    let folder = tempfile::tempdir()?;
    let folder = folder.path();
    fs::write(folder.join("log.csv"), text(|_, value| value))?;
    fs::write(folder.join("log.toml"), DESCRIBED)?;
    // ours are right, forward, up: y is the file's x, z is against its z
    calibration(folder, &[("gyro-bias", "y", 0.01), ("accel-scale", "z", 0.02), ("gyro-scale", "x", -0.01)])?;
    let output = sinscal(folder, &format!("apply log.csv --calibration c.json {MAP} --out out.csv"))?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let found = fs::read_to_string(folder.join("out.csv"))?;
    let expected = text(|of, value| match of {
        0 => value - 0.01_f64.to_degrees(),
        1 => value / 0.99,
        5 => value / 1.02,
        _ => value,
    });
    assert_eq!(found.lines().count(), expected.lines().count());
    for (found, expected) in found.lines().zip(expected.lines()) {
        for (found, expected) in found.trim_end().split(';').zip(expected.trim_end().split(';')) {
            let [a, b] = [found, expected].map(|field| field.replace(',', ".").parse::<f64>());
            match (a, b) {
                (Ok(a), Ok(b)) => assert!((a - b).abs() < 1e-9 * (1.0 + b.abs()), "{found} {expected}"),
                _ => assert_eq!(found, expected),
            }
        }
    }
    assert!(found.starts_with("made by a logger\nt;wx") && found.contains(";still\r\n"));
    // the result is read like the log, by the description that was copied
    let again = sinscal(folder, &format!("look out.csv {MAP} --json -"))?;
    let again: Value = serde_json::from_slice(&again.stdout)?;
    assert_eq!(again["samples"], 3000);
    Ok(())
}

const UNIT: &str = "[motion]\npath = \"turns\"\nstill = \"20 s\"\nturns = [ { axis = \"y\", angle = \"90 deg\", dwell = \"10 s\" } ]\n\
                    [dither]\nmode = \"off\"\n[gyro]\nquantum = \"0 arcsec\"\n[accelerometer]\nquantum = \"0 um/s\"\n[population]\n";
const ERRORS: &str = "gyro-scale = \"200 ppm\"\ngyro-misalignment = \"200 arcsec\"\ngyro-bias = \"3 deg/h\"\naccel-scale = \"500 ppm\"\n\
                      accel-misalignment = \"200 arcsec\"\naccel-bias = \"500 ug\"\naccel-quadratic = \"10 ug/g^2\"\n\
                      accel-temperature-scale = \"8 ppm/K\"\n";

/// The columns of a Parquet file by name.
fn columns(path: &Path) -> Result<BTreeMap<String, Vec<f64>>, Box<dyn std::error::Error>> {
    let mut columns = BTreeMap::<String, Vec<f64>>::new();
    for batch in ParquetRecordBatchReaderBuilder::try_new(fs::File::open(path)?)?.build()? {
        let batch = batch?;
        for (field, array) in batch.schema().fields().iter().zip(batch.columns()) {
            let numbers = array.as_any().downcast_ref::<Float64Array>().ok_or("no numbers")?;
            columns.entry(field.name().clone()).or_default().extend(numbers.values());
        }
    }
    Ok(columns)
}

/// The same unit and noise, with errors and without: the truth makes the one of the other.
#[test]
fn a_simulated_unit_without_its_errors_is_noise_alone() -> Done {
    let folder = tempfile::tempdir()?;
    let folder = folder.path();
    for (name, errors) in [("bad", ERRORS), ("sound", "")] {
        fs::write(folder.join("s.toml"), format!("{UNIT}{errors}"))?;
        let output = sinscal(folder, &format!("simulate --scenario s.toml --out {name}"))?;
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
    let output = sinscal(folder, "calibrate bad --filter 43d-p --json -")?;
    let mut document: Value = serde_json::from_slice(&output.stdout)?;
    let mut truth: BTreeMap<String, Vec<f64>> =
        serde_json::from_str(&fs::read_to_string(folder.join("bad.truth.json"))?)?;
    for parameter in document["parameters"].as_array_mut().ok_or("no parameters")? {
        let values = truth.get_mut(parameter["name"].as_str().unwrap_or_default());
        parameter["value"] = values.map_or(0.0, |values| values.remove(0)).into();
    }
    fs::write(folder.join("c.json"), document.to_string())?;
    let output = sinscal(folder, "apply bad --calibration c.json --out out.parquet")?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(fs::read(folder.join("out.toml"))?, fs::read(folder.join("bad.toml"))?);
    let [bad, sound, out] =
        ["bad", "sound", "out"].map(|name| columns(&folder.join(format!("{name}.parquet"))));
    let (bad, sound, out) = (bad?, sound?, out?);
    assert_eq!(out.keys().collect::<Vec<_>>(), bad.keys().collect::<Vec<_>>());
    for (name, found) in &out {
        let rms = |of: &[f64]| {
            let squares = of.iter().zip(&sound[name]).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
            (squares / of.len() as f64).sqrt()
        };
        // of a row: 0.001 deg/sqrt(h) and 5 ug/sqrt(Hz) at 50 Hz
        let noise = if name.starts_with("dtheta") { 2.9e-7 } else { 4.9e-5 } / 50_f64.sqrt();
        match name.get(..4) {
            Some("dthe" | "dvel") => {
                assert!(rms(found) < 0.01 * noise, "{name}: {} {}", rms(found), noise);
                assert!(rms(&bad[name]) > 2.0 * noise, "{name}: {}", rms(&bad[name]));
            }
            _ => {
                let mut cells = found.iter().zip(&bad[name]);
                assert!(cells.all(|(a, b)| a.to_bits() == b.to_bits()), "{name}");
            }
        }
    }
    Ok(())
}

#[test]
fn what_cannot_be_written_is_refused_and_leaves_nothing() -> Done {
    let folder = tempfile::tempdir()?;
    let folder = folder.path();
    fs::write(folder.join("log.csv"), text(|_, value| value))?;
    fs::write(folder.join("log.toml"), DESCRIBED)?;
    calibration(folder, &[])?;
    fs::write(folder.join("bad.csv"), text(|_, value| value).replace("\n50,02;", "\n50,02;x"))?;
    fs::write(folder.join("bad.toml"), DESCRIBED)?;
    for (arguments, expected) in [
        (format!("apply bad.csv --calibration c.json {MAP} --out out"), "bad.csv, line 2503"),
        (format!("apply log.csv --calibration none.json {MAP} --out out"), "none.json: cannot be read"),
        (format!("apply log.csv --calibration c.json {MAP} --out log.csv"), "would be lost"),
        (
            format!("apply log.csv --calibration c.json {MAP} --out out.npz"),
            "out.npz: is to be named with .csv, as log.csv is",
        ),
    ] {
        let output = sinscal(folder, &arguments)?;
        let said = String::from_utf8(output.stderr)?;
        assert!(!output.status.success() && said.contains(expected), "{arguments}: {said}");
        assert!(!folder.join("out").exists() && !folder.join("out.npz").exists(), "{arguments}");
    }
    Ok(())
}
