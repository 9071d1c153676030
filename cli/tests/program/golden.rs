//! A small log kept in the tree, and what the program made of it: a change of a figure is a diff to be reviewed.
//!
//! `golden/turns.csv` is 19 s of a simulated unit, turned twice. After a change that is meant,
//! `SINSCAL_GOLDEN=write cargo test -p sinscal-cli --test program golden` writes `golden/turns.json` anew.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::{Value, json};

use crate::support::Done;

/// Relative to the figure, and to the standard deviation for an estimate. The two forms of the covariance, which round quite
/// differently, are 3e-11 apart on this log; what is further away is another computation.
const TOLERANCE: f64 = 1e-9;

/// What is kept of a calibration: whatever is a number and not a time that the run took.
fn calibrate(log: &Path, filter: &str, form: &str) -> Result<Value, Box<dyn std::error::Error>> {
    let output = Command::new(env!("CARGO_BIN_EXE_sinscal"))
        .args(["calibrate", "--filter", filter, "--form", form, "--json", "-"])
        .arg(log)
        .output()?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout)?;
    let estimates = report["parameters"].as_array().ok_or("no parameters")?.iter();
    let estimates = estimates.filter(|parameter| parameter["estimated"] == true).map(|parameter| {
        let name = format!("{} {}", parameter["name"].as_str()?, parameter["component"].as_str()?);
        Some(json!([name, parameter["value"], parameter["sigma"]]))
    });
    Ok(json!({
        "nis_per_dof": report["nis_per_dof"],
        "log_likelihood": report["log_likelihood"],
        "updates": report["updates"],
        "estimates": estimates.collect::<Option<Vec<_>>>().ok_or("a parameter without a name")?,
    }))
}

fn close(found: &Value, expected: &Value, scale: f64) -> bool {
    match (found.as_f64(), expected.as_f64()) {
        (Some(a), Some(b)) => (a - b).abs() <= TOLERANCE * b.abs().max(scale),
        _ => false,
    }
}

#[test]
fn golden_log_gives_the_figures_it_gave() -> Done {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden");
    let path = folder.join("turns.json");
    let log = folder.join("turns.csv");
    let mut found = serde_json::Map::new();
    for filter in ["36d-p", "43d-b"] {
        found.insert(filter.into(), calibrate(&log, filter, "conventional")?);
    }
    if std::env::var("SINSCAL_GOLDEN").is_ok_and(|what| what == "write") {
        fs::write(&path, serde_json::to_string_pretty(&found)? + "\n")?;
    }
    let expected: Value = serde_json::from_slice(&fs::read(&path)?)?;
    for (filter, found) in &found {
        let expected = &expected[filter];
        assert_eq!(found["updates"], expected["updates"], "{filter}");
        for figure in ["nis_per_dof", "log_likelihood"] {
            let (found, expected) = (&found[figure], &expected[figure]);
            assert!(close(found, expected, 0.0), "{filter}, {figure}: {found}, it was {expected}");
        }
        let list = |value: &Value| value["estimates"].as_array().cloned().unwrap_or_default();
        let (found, expected) = (list(found), list(expected));
        assert_eq!(found.len(), expected.len(), "{filter}: what is estimated");
        for (found, expected) in found.iter().zip(&expected) {
            let sigma = expected[2].as_f64().ok_or("no sigma")?;
            let same = found[0] == expected[0]
                && close(&found[1], &expected[1], sigma)
                && close(&found[2], &expected[2], 0.0);
            assert!(same, "{filter}: {found}, it was {expected}");
        }
    }
    Ok(())
}
