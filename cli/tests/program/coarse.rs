//! Pulses of unknown size: what `calibrate` makes of them, against the same log with increments.

use std::fs::{self, File};
use std::path::Path;
use std::process::Command;

use arrow_array::{Array, Float64Array};
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use serde_json::Value;

use crate::support::{Done, Table};

/// Sizes of pulses: unlike on each axis, two of them counting backwards.
const GYRO: [f64; 3] = [4.8e-8, 5.2e-8, -9.0e-8];
const ACCEL: [f64; 3] = [-1.1e-6, 1.0e-6, 0.7e-6];

/// The table of a log.
fn read(path: &Path) -> Result<Table, Box<dyn std::error::Error>> {
    let mut columns: Vec<(String, Vec<f64>)> = Vec::new();
    for batch in ParquetRecordBatchReaderBuilder::try_new(File::open(path)?)?.build()? {
        let batch = batch?;
        for (i, field) in batch.schema().fields().iter().enumerate() {
            if columns.len() <= i {
                columns.push((field.name().clone(), Vec::new()));
            }
            let values = batch.column(i).as_any().downcast_ref::<Float64Array>().ok_or("not a number")?;
            columns[i].1.extend(values.iter().map(|value| value.unwrap_or(f64::NAN)));
        }
    }
    Ok(Table { columns })
}

/// The log `from` in counts, as `to`.
fn count(from: &Path, to: &Path, sizes: [[f64; 3]; 2]) -> Done {
    let mut table = read(&from.with_extension("parquet"))?;
    for (increments, pulses, sizes) in [("dtheta", "gyro_pulse", sizes[0]), ("dvel", "accel_pulse", sizes[1])]
    {
        for (axis, size) in ["x", "y", "z"].iter().zip(sizes) {
            let name = format!("{increments}_{axis}");
            table.map(&name, |_, value| value / size);
            table.rename(&name, &format!("{pulses}_{axis}"));
        }
    }
    table.write_parquet(&to.with_extension("parquet"), None)?;
    fs::copy(from.with_extension("toml"), to.with_extension("toml"))?;
    Ok(())
}

fn calibrate(log: &Path, filter: &str) -> Result<Value, Box<dyn std::error::Error>> {
    let output = Command::new(env!("CARGO_BIN_EXE_sinscal"))
        .args(["calibrate", &log.display().to_string(), "--filter", filter, "--json", "-"])
        .output()?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Ok(serde_json::from_slice(&output.stdout)?)
}

/// Compares every parameter of the two runs, in sigmas.
fn compare(known: &Value, counted: &Value, sizes: [[f64; 3]; 2], limit: f64) -> Done {
    let found = ["gyro_rad_per_pulse", "accel_m_s_per_pulse"].map(|name| &counted["coarse"][name]);
    let rows = |value: &Value| value["parameters"].as_array().cloned().unwrap_or_default();
    assert!(!rows(known).is_empty() && rows(known).len() == rows(counted).len());
    for (a, b) in rows(known).iter().zip(&rows(counted)) {
        let name = format!("{} {}", a["name"], a["component"]);
        let number = |row: &Value, field: &str| row[field].as_f64().ok_or(format!("{name}: no {field}"));
        let (one, mut other) = (number(a, "value")?, number(b, "value")?);
        // the axis it reads on is the first letter of the component
        let (effect, component) = (a["name"].as_str().unwrap_or(""), a["component"].as_str().unwrap_or(""));
        let axis = ["x", "y", "z"].iter().position(|axis| component.starts_with(axis));
        let triad = ["gyro-", "accel-"].iter().position(|triad| effect.starts_with(triad));
        if let (Some(axis), Some(triad)) = (axis, triad) {
            // what is found is a part of a reading, and the size of its pulse has taken the scale factor in
            let size = found[triad][axis].as_f64().ok_or("no size")? / sizes[triad][axis];
            other = if effect.ends_with("-scale") && !effect.contains("temperature") {
                (1.0 + other) / size - 1.0
            } else {
                other / size
            };
        }
        let apart = (one - other).abs() / number(a, "sigma")?;
        assert!(apart < limit, "{name}: {one:e} and {other:e}, {apart:.2} sigmas apart");
    }
    Ok(())
}

#[test]
fn pulses_of_unknown_size_end_where_increments_do() -> Done {
    let folder = tempfile::tempdir()?;
    let (log, counts) = (folder.path().join("log"), folder.path().join("counts"));
    let simulate = ["simulate", "--seed", "6", "--out", &log.display().to_string()].map(str::to_owned);
    assert!(Command::new(env!("CARGO_BIN_EXE_sinscal")).args(simulate).status()?.success());
    count(&log, &counts, [GYRO, ACCEL])?;
    compare(&calibrate(&log, "43d-b")?, &calibrate(&counts, "43d-b")?, [GYRO, ACCEL], 0.1)
}

/// A real unit carried by hand, as if it had counted pulses; its z gyro counts backwards.
#[test]
fn a_hand_carried_unit_finds_the_size_of_its_pulses() -> Done {
    let log = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/real/imu-tk-xsens");
    if !log.with_extension("parquet").exists() {
        println!("skipped: {} is not there", log.display());
        return Ok(());
    }
    let folder = tempfile::tempdir()?;
    let counts = folder.path().join("counts");
    // 405 counts per m/s^2, 4700 per rad/s, 100 Hz
    let sizes = [[1e-2 / 4700.0, 1e-2 / 4700.0, -1e-2 / 4700.0], [1e-2 / 405.0; 3]];
    count(&log, &counts, sizes)?;
    compare(&calibrate(&log, "mems-30d")?, &calibrate(&counts, "mems-30d")?, sizes, 0.3)
}

/// Errors far beyond the priors are noticed, and the coarse stage deals with them.
#[test]
fn large_errors_are_noticed_and_captured() -> Done {
    let folder = tempfile::tempdir()?;
    let log = folder.path().join("log").display().to_string();
    let scenario = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/large-errors.toml");
    let run = |arguments: &[&str]| Command::new(env!("CARGO_BIN_EXE_sinscal")).args(arguments).output();
    assert!(run(&["simulate", "--scenario", scenario, "--out", &log])?.status.success());
    let without = run(&["calibrate", &log, "--filter", "43d-b", "--passes", "1"])?;
    assert!(String::from_utf8_lossy(&without.stderr).contains("try --coarse"));
    let with =
        run(&["calibrate", &log, "--filter", "43d-b", "--coarse", "--smooth", "--out", &format!("{log}.d")])?;
    assert!(with.status.success() && with.stderr.is_empty(), "{}", String::from_utf8_lossy(&with.stderr));
    let said = String::from_utf8_lossy(&with.stdout).into_owned();
    assert!(said.contains("43d-b fits") && said.contains("19 still positions and 18 turns"), "{said}");
    let trajectory = fs::read_to_string(format!("{log}.d/trajectory.csv"))?;
    assert!(trajectory.starts_with("time_s,quat_w,") && trajectory.contains("pos_u.sigma\n"));
    for line in trajectory.lines().skip(1) {
        let numbers: Vec<f64> = line.split(',').map(str::parse).collect::<Result<_, _>>()?;
        assert!(numbers.len() == 20 && numbers[11..].iter().all(|sigma| *sigma > 0.0), "{line}");
    }
    Ok(())
}
