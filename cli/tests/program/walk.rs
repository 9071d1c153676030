//! A measured walk whose heading nobody knows: every guess and every number of passes come to the same. Skipped where it is absent.

use std::fs;
use std::path::Path;
use std::process::Command;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use serde_json::Value;

use super::rests::cases;
use super::support::Done;

const ATTITUDE: [f64; 4] = [0.0, -0.0084805, -0.0034940, 0.9999579];
const MAP: &str = "gyro=w:rad/s,accel=a:g,time=t,ref_pos_e=p_e,ref_pos_n=p_n,ref_pos_u=p_u";

/// Calibrates with the guess of the heading turned by `turned` degrees.
fn calibrate(log: &Path, turned: f64, passes: &str) -> Result<Value, Box<dyn std::error::Error>> {
    let folder = tempfile::tempdir()?;
    let [w, x, y, z] = ATTITUDE;
    let turn = UnitQuaternion::from_scaled_axis(Vector3::z() * turned.to_radians());
    let guess = turn.into_inner() * Quaternion::new(w, x, y, z);
    let table = |q: &Quaternion<f64>| format!("[{:.7}, {:.7}, {:.7}, {:.7}]", q.w, q.i, q.j, q.k);
    let text = fs::read_to_string(log.with_extension("toml"))?;
    let turned = text.replace(&table(&Quaternion::new(w, x, y, z)), &table(&guess));
    fs::copy(log.with_extension("csv"), folder.path().join("walk.csv"))?;
    fs::write(folder.path().join("walk.toml"), turned)?;
    let output = Command::new(env!("CARGO_BIN_EXE_sinscal"))
        .arg("calibrate")
        .arg(folder.path().join("walk"))
        .args(["--filter", "tracked-35d", "--map", MAP, "--bridge-gaps", "0.02", "--json", "-"])
        .args(["--passes", passes])
        .output()?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Ok(serde_json::from_slice(&output.stdout)?)
}

#[test]
fn any_guess_of_the_heading_and_any_number_of_passes_come_to_the_same() -> Done {
    let Some(cases) = cases() else { return Ok(()) };
    let log = cases.join("measured/gnss-walk/walk");
    let reports = [calibrate(&log, 0.0, "2")?, calibrate(&log, 90.0, "3")?, calibrate(&log, 180.0, "5")?];
    for report in &reports {
        assert_eq!(report["verdict"], "does-not-fit");
        let parameters = report["parameters"].as_array().ok_or("no parameters")?;
        let first = reports[0]["parameters"].as_array().ok_or("no parameters")?;
        let mut compared = 0;
        for (parameter, first) in parameters.iter().zip(first) {
            assert_eq!(parameter["estimated"], first["estimated"], "{}", parameter["name"]);
            let (Some(a), Some(b)) = (parameter["value"].as_f64(), first["value"].as_f64()) else { continue };
            let sigma = parameter["sigma"].as_f64().ok_or("no sigma")?;
            assert!((a - b).abs() < 3.0 * sigma, "{}: {a} and {b}, +- {sigma}", parameter["name"]);
            assert!(parameter["name"] != "accel-scale" || a.abs() < 0.01, "a scale of {a}");
            compared += 1;
        }
        assert!(compared > 2, "nothing is estimated");
        let passes = report["passes"].as_array().ok_or("no passes")?;
        assert!(passes.iter().any(|pass| pass["kept"] == false), "the pass that makes it worse is kept");
    }
    Ok(())
}
