//! Logs of other people: an independent simulator's, with truth, and measured ones. Skipped where they are absent.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

/// The folder of the logs, or `None` with a printed line.
fn logs() -> Option<PathBuf> {
    let root = std::env::var_os("SINSCAL_DATA")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data"), PathBuf::from);
    if root.join("rig").is_dir() {
        return Some(root);
    }
    println!("skipped: no logs in {} (set SINSCAL_DATA)", root.display());
    None
}

/// Runs a command that did its work and wrote JSON to standard output.
pub(crate) fn run(command: &str, log: &Path, filter: &str, more: &[&str]) -> Output {
    let output = Command::new(env!("CARGO_BIN_EXE_sinscal"))
        .arg(command)
        .arg(log)
        .args(["--filter", filter, "--json", "-"])
        .args(more)
        .output()
        .expect("the program runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    output
}

/// What such a run wrote.
pub(crate) fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).expect("JSON and nothing else")
}

fn calibrate(log: &Path, filter: &str, more: &[&str]) -> Value {
    json(&run("calibrate", log, filter, more))
}

fn parameters<'a>(report: &'a Value, name: &'a str) -> impl Iterator<Item = &'a Value> {
    let all = report["parameters"].as_array().expect("a list");
    all.iter().filter(move |parameter| parameter["name"] == name)
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("a number, not {value}"))
}

/// Every parameter within `sigmas` of the truth beside the log; returns how many there were.
fn assert_true(report: &Value, log: &Path, sigmas: f64) -> usize {
    let truth = log.with_extension("truth.json");
    let truth: Value = serde_json::from_str(&std::fs::read_to_string(truth).expect("truth")).expect("JSON");
    let mut seen = std::collections::HashMap::<&str, usize>::new();
    for parameter in report["parameters"].as_array().expect("a list") {
        let name = parameter["name"].as_str().expect("a name");
        let index = seen.entry(name).or_default();
        let expected = truth[name][*index].as_f64().unwrap_or(0.0);
        *index += 1;
        let error = (number(&parameter["value"]) - expected) / number(&parameter["sigma"]);
        assert!(error.abs() < sigmas, "{name} {}: {error:.1} sigma", parameter["component"]);
    }
    seen.values().sum()
}

/// Largest sigma of each group that the first issue of this project asked for on unit A; SI.
const WANTED: [(&str, f64); 11] = [
    ("gyro-scale", 4e-7),
    ("gyro-misalignment", 1.4e-6),
    ("gyro-bias", 7.4e-9),
    ("accel-scale", 7.4e-7),
    ("accel-misalignment", 1.3e-6),
    ("accel-bias", 5.7e-6),
    ("accel-quadratic", 5.6e-8),
    ("outer-lever-arm", 3.4e-4),
    ("inner-lever-arm", 2.9e-4),
    ("accel-delay", 3.6e-6),
    ("accel-temperature-scale", 7.5e-8),
];

#[test]
fn unit_a_is_found_with_the_sigmas_it_allows() {
    let Some(root) = logs() else { return };
    let log = root.join("rig/unit-a");
    for more in [&[][..], &["--form", "ud"][..], &["--passes", "1"][..]] {
        let report = calibrate(&log, "43d-b", more);
        assert_eq!(assert_true(&report, &log, 4.0), 34);
        let nis = number(&report["nis_per_dof"]);
        assert!((0.9..1.1).contains(&nis), "NIS per degree of freedom {nis}");
        for (name, wanted) in WANTED {
            let largest = parameters(&report, name).map(|p| number(&p["sigma"])).fold(0.0, f64::max);
            assert!(largest < 1.3 * wanted && largest > wanted / 1.3, "{name}: sigma {largest:e}");
        }
    }
}

#[test]
fn other_units_are_found_by_the_filter_that_knows_them() {
    let Some(root) = logs() else { return };
    for (log, filter) in
        [("unit-a-verify", "43d-b"), ("unit-b", "40d-p"), ("unit-b-verify", "40d-p"), ("unit-c", "36d-p")]
    {
        let log = root.join("rig").join(log);
        let report = calibrate(&log, filter, &[]);
        assert_true(&report, &log, 4.0);
        assert!(number(&report["nis_per_dof"]) < 1.1);
    }
}

#[test]
fn a_filter_that_lacks_something_shows_it() {
    let Some(root) = logs() else { return };
    let nis =
        |log: &str, filter: &str| number(&calibrate(&root.join("rig").join(log), filter, &[])["nis_per_dof"]);
    assert!(nis("unit-a", "36d-p") > 5.0);
    assert!(nis("unit-b", "36d-p") > 1.5);
}

#[test]
fn a_hand_held_unit_leads_back_to_its_data_sheet() {
    let Some(root) = logs() else { return };
    let report = calibrate(&root.join("real/imu-tk-xsens"), "mems-30d", &[]);
    // counts per m/s^2 and per rad/s; the log was converted with 405 and 4700
    for (name, guess, sheet, tolerance) in [
        ("accel-scale", 405.0, [415.0, 413.0, 415.0], 2.5e-3),
        ("gyro-scale", 4700.0, [4778.0, 4758.0, 4766.0], 4e-3),
    ] {
        for (parameter, sheet) in parameters(&report, name).zip(sheet) {
            let found = guess * (1.0 + number(&parameter["value"]));
            assert!((found / sheet - 1.0).abs() < tolerance, "{name} {found} for {sheet}");
        }
    }
}

#[test]
fn what_a_log_cannot_show_has_no_number() {
    let Some(root) = logs() else { return };
    // no temperature was recorded, and nothing there is precise enough for the quadratic terms
    let report = calibrate(&root.join("real/imu-tk-xsens"), "43d-b", &[]);
    for name in ["accel-temperature-scale", "accel-quadratic"] {
        for parameter in parameters(&report, name) {
            assert_eq!((&parameter["value"], &parameter["sigma"]), (&Value::Null, &Value::Null));
        }
    }
}

#[test]
fn a_tracked_unit_is_calibrated_alike_in_two_trials() {
    let Some(root) = logs() else { return };
    let slow = calibrate(&root.join("real/broad-01"), "tracked-35d", &[]);
    let fast = calibrate(&root.join("real/broad-06"), "tracked-35d", &[]);
    // one unit, two trials on one day. The filter has no lever arm and no delay, and says so by its NIS on the fast trial;
    // what the gyros do is decided by the attitude and must agree far below the 3e-3 that is found.
    for (name, tolerance) in [("gyro-scale", 5e-4), ("gyro-bias", 1e-3)] {
        for (a, b) in parameters(&slow, name).zip(parameters(&fast, name)) {
            let (a, b) = (number(&a["value"]), number(&b["value"]));
            assert!((a - b).abs() < tolerance, "{name}: {a:e} and {b:e}");
        }
    }
    assert!(number(&fast["nis_per_dof"]) > 5.0);
}

#[test]
fn what_a_filter_lacks_is_named_and_nothing_else() {
    let Some(root) = logs() else { return };
    let diagnose = |log: &str, filter: &str, verify: Option<&str>| -> Value {
        let mut command = Command::new(env!("CARGO_BIN_EXE_sinscal"));
        command.arg("diagnose").arg(root.join("rig").join(log)).args(["--filter", filter, "--json", "-"]);
        if let Some(second) = verify {
            command.arg("--verify").arg(root.join("rig").join(second));
        }
        let output = command.output().expect("the program runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).expect("JSON and nothing else")
    };
    let found = diagnose("unit-b", "36d-p", Some("unit-b-verify"));
    assert_eq!((&found["verdict"], &found["verified"]), (&"effects-found".into(), &true.into()));
    let effects = found["effects"].as_array().expect("a list");
    assert_eq!(effects.len(), 1);
    assert_eq!(effects[0]["name"], "accel-delay");
    let error = number(&effects[0]["estimate"][0]) - 4.95e-4;
    assert!(error.abs() < 4.0 * number(&effects[0]["sigma"][0]), "{error:e}");
    assert_eq!(diagnose("unit-c", "36d-p", None)["verdict"], "nothing-missing");
    // four effects are hidden here, and rocking alone cannot tell all of them from others: no name may be confirmed
    let rocking = diagnose("unit-a-swing", "36d-p", None);
    assert_ne!(rocking["verdict"], "effects-found");
    assert_eq!(rocking["effects"], Value::Array(Vec::new()));
}
