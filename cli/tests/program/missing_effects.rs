//! Logs that once were given a wrong name, or none, for what their filter lacks. Skipped where they are absent.

use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::outside_logs::{json, run};

/// The folder of the cases, or `None` with a printed line.
fn cases() -> Option<PathBuf> {
    let root = std::env::var_os("SINSCAL_DATA").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/cases"),
        |data| PathBuf::from(data).join("../cases"),
    );
    if root.join("logs").is_dir() {
        return Some(root);
    }
    println!("skipped: no cases in {}", root.display());
    None
}

fn diagnose(log: &Path, filter: &str, more: &[&str]) -> Value {
    json(&run("diagnose", log, filter, more))
}

/// The effects that were found, each with its values.
fn effects(found: &Value) -> Vec<(&str, Vec<f64>)> {
    let values = |effect: &Value| -> Vec<f64> {
        effect["estimate"].as_array().into_iter().flatten().filter_map(Value::as_f64).collect()
    };
    let all = found["effects"].as_array().into_iter().flatten();
    all.map(|effect| (effect["name"].as_str().unwrap_or(""), values(effect))).collect()
}

fn near(found: &[f64], truth: &[f64], tolerance: f64) -> bool {
    found.len() == truth.len() && found.iter().zip(truth).all(|(f, t)| (f - t).abs() < tolerance)
}

#[test]
fn a_reference_that_is_late_by_a_quarter_of_a_second_is_told_so_with_its_lever_arm() {
    let Some(root) = cases() else { return };
    let log = root.join("logs/reference-late-by-250-ms/log");
    let found = diagnose(&log, "tracked-35d", &[]);
    let effects = effects(&found);
    assert_eq!(found["verdict"], "effects-found", "{}", found["sentence"]);
    let [(arm, arms), (delay, delays)] = effects.as_slice() else { panic!("{effects:?}") };
    assert_eq!((*arm, *delay), ("outer-lever-arm", "reference-delay"));
    // what the log was simulated with
    assert!(near(arms, &[0.1, -0.05, 0.08], 2e-3) && near(delays, &[0.25], 1e-3), "{effects:?}");
    let said = run("calibrate", &log, "tracked-35d", &[]).stderr;
    let said = String::from_utf8_lossy(&said).replace(['\n', ' '], "");
    assert!(said.contains("250ms") && said.contains("stamps"), "{said}");
}

#[test]
fn what_dominates_a_measured_log_is_named_though_something_remains() {
    let Some(root) = cases() else { return };
    let map = "gyro=imu_gyr:rad/s,accel=imu_acc:m/s^2,ref_pos=opt_pos,ref_quat=opt_quat,time=t";
    let found = diagnose(&root.join("measured/broad-24/b24"), "tracked-35d", &["--map", map]);
    let effects = effects(&found);
    assert_eq!(
        (&found["verdict"], &found["complete"]),
        (&"effects-found".into(), &false.into()),
        "{}",
        found["sentence"]
    );
    let names: Vec<&str> = effects.iter().map(|effect| effect.0).collect();
    assert_eq!(names, ["outer-lever-arm", "reference-delay"]);
    // windowed double differences over the whole trial, +- 0.05 mm; this part of it, tapped at, leaves a millimetre or two
    let sigma = found["effects"][0]["sigma"].as_array().expect("a list");
    for ((found, truth), sigma) in effects[0].1.iter().zip([1.15e-3, -1.86e-3, -8.19e-3]).zip(sigma) {
        let sigma = sigma.as_f64().expect("a number");
        assert!(
            (found - truth).abs() < 3.0 * sigma && sigma < 2.5e-3,
            "{found:e} +- {sigma:e} for {truth:e}"
        );
    }
    let share = found["remainder"]["share"].as_f64().expect("a share");
    assert!(share > 0.0 && share < 0.2, "{}", found["remainder"]);
}

#[test]
fn a_warm_up_of_a_unit_turned_by_hand_shows_no_sensitivity_to_force() {
    let Some(root) = cases() else { return };
    let found = diagnose(&root.join("logs/false-g-sensitivity/log"), "mems-30d", &[]);
    let effects = effects(&found);
    let names: Vec<&str> = effects.iter().map(|effect| effect.0).collect();
    assert_eq!(names, ["gyro-temperature-bias"], "{}", found["sentence"]);
}
