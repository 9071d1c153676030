//! What a log cannot prove is not said.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

use crate::support::{DESCRIPTION, Done, Table};

/// A turntable with what 43d-b has, dither and temperature included.
const SCENARIO: &str = r#"[motion]
path = "eighteen-rotations"
still = "100 s"
dwell = "30 s"
[reference]
kind = "KIND"
[population]
accel-bias = "50 ug"
accel-scale = "50 ppm"
gyro-bias = "0.03 deg/h"
outer-lever-arm = { mean = ["0.2 m", "0.15 m", "-0.12 m"], sigma = "10 mm" }
inner-lever-arm = { mean = ["40 mm", "45 mm", "35 mm"], sigma = "10 mm" }
accel-delay = { mean = "0.5 ms", sigma = "0.1 ms" }
accel-temperature-scale = "8 ppm/K"
"#;

fn run(folder: &Path, arguments: &str) -> std::io::Result<Output> {
    Command::new(env!("CARGO_BIN_EXE_sinscal")).args(arguments.split(' ')).current_dir(folder).output()
}

fn json(output: &Output) -> Result<Value, Box<dyn std::error::Error>> {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Ok(serde_json::from_slice(&output.stdout)?)
}

fn simulated(kind: &str) -> Result<tempfile::TempDir, Box<dyn std::error::Error>> {
    let folder = tempfile::tempdir()?;
    fs::write(folder.path().join("s.toml"), SCENARIO.replace("KIND", kind))?;
    let done = run(folder.path(), "simulate --scenario s.toml --out unit -q")?;
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    Ok(folder)
}

/// With a fixed point residuals judge nobody; with readings the right filter fits and one that lacks effects does not.
#[test]
fn verdicts_have_power_or_say_that_they_have_none() -> Done {
    let fixed = simulated("fixed-point")?;
    let verdict = |folder: &Path, filter: &str| -> Result<String, Box<dyn std::error::Error>> {
        let report = json(&run(folder, &format!("calibrate unit --filter {filter} --json -"))?)?;
        Ok(report["verdict"].as_str().unwrap_or_default().to_owned())
    };
    for filter in ["40d-p", "43d-p", "43d-b"] {
        let said = verdict(fixed.path(), filter)?;
        assert!(["no-power", "does-not-fit"].contains(&said.as_str()), "{filter}: {said}");
    }
    assert_eq!(verdict(fixed.path(), "43d-b")?, "no-power");
    let readings = simulated("readings")?;
    assert_eq!(verdict(readings.path(), "43d-b")?, "fits");
    assert_eq!(verdict(readings.path(), "36d-p")?, "does-not-fit");
    Ok(())
}

/// A fixed point has no readings that could be outliers: a wrong latitude moves the unit away from it.
#[test]
fn a_fixed_point_has_no_outliers() -> Done {
    let folder = simulated("fixed-point")?;
    let description = folder.path().join("unit.toml");
    let text = fs::read_to_string(&description)?;
    let line = text.lines().find(|line| line.starts_with("latitude_deg")).ok_or("a latitude")?;
    fs::write(&description, text.replace(line, "latitude_deg = 32.9"))?;
    let done = run(folder.path(), "calibrate unit --filter 43d-b")?;
    let (table, said) = (String::from_utf8(done.stdout)?, String::from_utf8(done.stderr)?);
    assert!(!table.contains("outlier") && !table.starts_with("43d-b fits"), "{table}");
    assert!(!said.contains("frame of the reference"), "{said}");
    Ok(())
}

/// A calibration is applied at the temperature that it was made for.
#[test]
fn navigate_takes_the_reference_temperature_of_the_calibration() -> Done {
    let folder = simulated("readings")?;
    let at = folder.path();
    fs::copy(at.join("unit.parquet"), at.join("cold.parquet"))?;
    let text = fs::read_to_string(at.join("unit.toml"))?;
    let line = text.lines().find(|line| line.starts_with("reference_c")).ok_or("a temperature")?;
    fs::write(at.join("cold.toml"), text.replace(line, "reference_c = -20.0"))?;
    for log in ["unit", "cold"] {
        json(&run(at, &format!("calibrate {log} --filter 43d-b --json -"))?)?;
        assert!(run(at, &format!("calibrate {log} --filter 43d-b --json {log}.json -q"))?.status.success());
    }
    let largest = |log: &str, calibration: &str| -> Result<f64, Box<dyn std::error::Error>> {
        let arguments = format!("navigate {log} --calibration {calibration}.json --align 100 --json -");
        json(&run(at, &arguments)?)?["max_horizontal_nmi"].as_f64().ok_or("a number".into())
    };
    let (own, other) = (largest("unit", "unit")?, largest("unit", "cold")?);
    assert!((own / other - 1.0).abs() < 0.05, "{own} {other}");
    // and what is no temperature is refused
    let broken = fs::read_to_string(at.join("unit.json"))?;
    let broken = broken.replace("\"reference_temperature_c\": 25.0", "\"reference_temperature_c\": \"warm\"");
    fs::write(at.join("broken.json"), broken)?;
    for command in ["navigate unit --calibration broken.json", "export broken.json --format c"] {
        let done = run(at, command)?;
        let said = String::from_utf8(done.stderr)?;
        assert!(
            done.status.code() == Some(1) && said.contains("`reference_temperature_c`: is text"),
            "{said}"
        );
    }
    Ok(())
}

#[test]
fn without_a_reading_nothing_is_observable() -> Done {
    let folder = tempfile::tempdir()?;
    let at = folder.path();
    fs::write(at.join("log.toml"), DESCRIPTION)?;
    let mut table = Table::at_rest(3000);
    table.map("ref_*", |_, _| f64::NAN);
    table.write_csv(&at.join("log.csv"))?;
    let done = run(at, "observe log --filter 43d-b")?;
    let said = String::from_utf8(done.stderr)?;
    assert!(done.status.code() == Some(1) && said.contains("no update was made"), "{said}");

    // of a log without positions nothing says where the unit is
    let rank = |table: &Table| -> Result<u64, Box<dyn std::error::Error>> {
        table.write_csv(&at.join("log.csv"))?;
        json(&run(at, "observe log --filter 36d-p --json -")?)?["rank"].as_u64().ok_or("a rank".into())
    };
    let mut table = Table::at_rest(3000);
    let both = rank(&table)?;
    table.drop("ref_pos_*");
    assert_eq!(rank(&table)? + 3, both);
    Ok(())
}
