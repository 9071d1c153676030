//! Measured units that were turned by hand, with nothing known but when they rest, or not even that. Skipped where they are absent.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;

use nalgebra::{Matrix3, Vector3};
use serde_json::Value;

use super::support::Done;

/// The folder of the cases, or `None` with a printed line.
pub(crate) fn cases() -> Option<PathBuf> {
    let root = std::env::var_os("SINSCAL_DATA").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/cases"),
        |data| PathBuf::from(data).join("../cases"),
    );
    if root.join("measured/mpu9150").is_dir() {
        return Some(root);
    }
    println!("skipped: no cases in {}", root.display());
    None
}

fn calibrate(log: &Path, map: &str) -> Result<Value, Box<dyn Error>> {
    let mut program = Command::new(env!("CARGO_BIN_EXE_sinscal"));
    program.arg("calibrate").arg(log).args(["--filter", "mems-30d", "--json", "-"]);
    if !map.is_empty() {
        program.args(["--map", map]);
    }
    let output = program.output()?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Ok(serde_json::from_slice(&output.stdout)?)
}

fn parameters<'a>(report: &'a Value, name: &'a str) -> impl Iterator<Item = &'a Value> {
    report["parameters"].as_array().into_iter().flatten().filter(move |parameter| parameter["name"] == name)
}

/// The values of an effect; those that the data do not show are zero.
fn values(report: &Value, name: &str) -> Vec<f64> {
    parameters(report, name).map(|parameter| parameter["value"].as_f64().unwrap_or(0.0)).collect()
}

/// What the calibrated accelerometers leave of gravity in the rests of a table whose columns 4 to 6 are forces and whose column 7 is
/// empty between rests: root mean square, m/s^2.
fn gravity_left(report: &Value, table: &Path, gravity: f64) -> Result<f64, Box<dyn Error>> {
    let (scale, turn) = (values(report, "accel-scale"), values(report, "accel-misalignment"));
    let sensor = Matrix3::new(
        1.0 + scale[0],
        turn[0],
        turn[1],
        turn[2],
        1.0 + scale[1],
        turn[3],
        turn[4],
        turn[5],
        1.0 + scale[2],
    );
    let inverse = sensor.try_inverse().ok_or("a matrix that cannot be inverted")?;
    let bias = Vector3::from_column_slice(&values(report, "accel-bias"));
    let text = std::fs::read_to_string(table)?;
    let (mut left, mut sum, mut rows) = (Vec::new(), Vector3::zeros(), 0.0);
    for line in text.lines().skip(1).chain([",,,,,,,,,"]) {
        let fields: Vec<&str> = line.split(',').collect();
        if fields.get(7).is_some_and(|velocity| !velocity.is_empty()) {
            for axis in 0..3 {
                sum[axis] += fields[4 + axis].parse::<f64>()?;
            }
            rows += 1.0;
        } else if rows > 0.0 {
            left.push((inverse * (sum / rows - bias)).norm() - gravity);
            (sum, rows) = (Vector3::zeros(), 0.0);
        }
    }
    Ok((left.iter().map(|off| off * off).sum::<f64>() / left.len() as f64).sqrt())
}

/// The table without the columns that say when it rests.
fn without_rests(log: &Path, folder: &Path) -> Result<PathBuf, Box<dyn Error>> {
    let text = std::fs::read_to_string(log.with_extension("csv"))?;
    let bare: Vec<String> =
        text.lines().map(|line| line.split(',').take(7).collect::<Vec<_>>().join(",")).collect();
    std::fs::write(folder.join("bare.csv"), bare.join("\n") + "\n")?;
    std::fs::write(folder.join("bare.toml"), std::fs::read_to_string(log.with_extension("toml"))?)?;
    Ok(folder.join("bare"))
}

const MILLI_G: f64 = 9.80665e-3;
const DEG_PER_HOUR: f64 = std::f64::consts::PI / 180.0 / 3600.0;

/// Gravity left is at most 1.2 times what nine parameters by least squares leave of each rest when it is left out; the gyros' biases
/// are those of the rests within their scatter from rest to rest.
#[test]
fn a_unit_turned_by_hand_is_calibrated_by_its_rests_given_or_found() -> Done {
    let Some(root) = cases() else { return Ok(()) };
    let log = root.join("measured/mpu9150/m2");
    let folder = tempfile::tempdir()?;
    let bare = without_rests(&log, folder.path())?;
    for (path, map) in
        [(&log, "gyro=w:rad/s,accel=f:m/s^2,time=t,ref_vel=v"), (&bare, "gyro=w:rad/s,accel=f:m/s^2,time=t")]
    {
        let report = calibrate(path, map)?;
        let left = gravity_left(&report, &log.with_extension("csv"), 9.8196)?;
        assert!(left < 0.7 * MILLI_G, "{} mg", left / MILLI_G);
        let biases = values(&report, "gyro-bias");
        for ((found, rests), scatter) in biases.iter().zip([2097.0, -1349.0, 4649.0]).zip([39.0, 41.0, 59.0])
        {
            assert!((found / DEG_PER_HOUR - rests).abs() < scatter, "{} for {rests}", found / DEG_PER_HOUR);
        }
        assert!(report["assumed"].to_string().contains("at rest 19 times"), "{}", report["assumed"]);
        assert_ne!(report["verdict"], "does-not-fit");
    }
    Ok(())
}

/// The figures of a Ferraris calibration, from the rate of the samples and the site alone.
#[test]
fn six_positions_and_three_turns_are_a_ferraris_calibration() -> Done {
    let Some(root) = cases() else { return Ok(()) };
    let report = calibrate(&root.join("measured/nilspod/raw"), "gyro=gyr:deg/s,accel=acc:m/s^2")?;
    for (name, figures, tolerance, sigmas) in [
        ("gyro-bias", [-2159.0, -1331.0, 212.0].map(|bias| bias * DEG_PER_HOUR), 30.0 * DEG_PER_HOUR, 0.0),
        ("gyro-scale", [0.0279, -0.0176, -0.0017], 0.0, 3.0),
        ("accel-bias", [0.537, -0.616, 0.399], MILLI_G, 0.0),
        ("accel-scale", [-3250e-6, 2440e-6, 23_400e-6], 300e-6, 0.0),
    ] {
        for (parameter, figure) in parameters(&report, name).zip(figures) {
            let (value, sigma) = (parameter["value"].as_f64(), parameter["sigma"].as_f64());
            let (value, sigma) = value.zip(sigma).ok_or("an estimate")?;
            assert!((value - figure).abs() < tolerance + sigmas * sigma, "{name}: {value} for {figure}");
        }
    }
    Ok(())
}

#[test]
fn a_unit_on_a_table_shows_its_gyro_biases_and_no_more() -> Done {
    let Some(root) = cases() else { return Ok(()) };
    let report = calibrate(&root.join("logs/static-z-bias/log"), "")?;
    for (parameter, truth) in parameters(&report, "gyro-bias").zip([825.1, -1237.6, 618.8]) {
        let (value, sigma) = (parameter["value"].as_f64(), parameter["sigma"].as_f64());
        let (value, sigma) = value.zip(sigma).ok_or("an estimate")?;
        assert!((value / DEG_PER_HOUR - truth).abs() < 3.0 * sigma / DEG_PER_HOUR, "{value} for {truth}");
        assert!(sigma < 190.0 * DEG_PER_HOUR);
    }
    for parameter in parameters(&report, "accel-scale") {
        assert!(parameter["value"].is_null(), "{parameter}");
    }
    let bias = parameters(&report, "accel-bias").nth(2).ok_or("z")?;
    let (value, sigma) = bias["value"].as_f64().zip(bias["sigma"].as_f64()).ok_or("an estimate")?;
    assert!((value - 0.2004).abs() < 3.0 * sigma, "{value} +- {sigma}");
    assert_ne!(report["verdict"], "fits");
    Ok(())
}

#[test]
fn a_unit_that_is_carried_from_rest_to_rest_needs_no_reference() -> Done {
    let Some(root) = cases() else { return Ok(()) };
    let report = calibrate(&root.join("logs/carried-unit/log"), "")?;
    let truth = [("gyro-scale", 1, -4000e-6), ("accel-bias", 0, 15_296e-6 * 9.80665)];
    for (name, axis, truth) in truth {
        let parameter = parameters(&report, name).nth(axis).ok_or("a parameter")?;
        let (value, sigma) =
            parameter["value"].as_f64().zip(parameter["sigma"].as_f64()).ok_or("an estimate")?;
        assert!((value - truth).abs() < 3.0 * sigma, "{name}: {value} +- {sigma}");
    }
    // without an attitude it begins level, with any heading
    let report = calibrate(&root.join("logs/no-heading/log"), "")?;
    assert!(report["assumed"].to_string().contains("any heading"), "{}", report["assumed"]);
    assert_eq!(values(&report, "gyro-bias").len(), 3);
    Ok(())
}
