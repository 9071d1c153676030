//! `sinscal simulate` and `sinscal demo`.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn sinscal(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sinscal")).args(arguments).output().expect("the program runs")
}

fn text(path: &Path) -> String {
    path.to_str().expect("a path in UTF-8").to_owned()
}

/// A run of some minutes instead of an hour.
const SHORT: &str = "[motion]\nstill = \"60 s\"\ndwell = \"10 s\"\n";

#[test]
fn a_simulated_log_is_one_the_program_reads() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = folder.path().join("short.toml");
    fs::write(&scenario, SHORT).expect("a scenario");
    let log = folder.path().join("logs/unit");
    let output = sinscal(&[
        "simulate",
        "--out",
        &text(&log),
        "--scenario",
        &text(&scenario),
        "--seed",
        "5",
        "--rate",
        "100",
    ]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let output = sinscal(&["calibrate", &text(&log), "--filter", "43d-b", "--json", "-"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let nis = report["nis_per_dof"].as_f64().expect("a number");
    assert!((0.85..1.15).contains(&nis), "{nis}");
    let truth: Value =
        serde_json::from_slice(&fs::read(log.with_extension("truth.json")).expect("truth")).expect("JSON");
    let lever =
        report["parameters"].as_array().expect("a list").iter().filter(|p| p["name"] == "outer-lever-arm");
    for (found, expected) in lever.zip(truth["outer-lever-arm"].as_array().expect("a list")) {
        let error = found["value"].as_f64().expect("a number") - expected.as_f64().expect("a number");
        assert!(error.abs() < 5.0 * found["sigma"].as_f64().expect("a number"), "{error}");
    }
}

#[test]
fn the_same_seed_gives_the_same_bytes() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = folder.path().join("short.toml");
    fs::write(&scenario, SHORT).expect("a scenario");
    let simulate = |name: &str, seed: &str| {
        let log = folder.path().join(name);
        let arguments = ["simulate", "--out", &text(&log), "--scenario", &text(&scenario), "--seed", seed];
        assert!(sinscal(&arguments).status.success());
        ["parquet", "toml", "truth.json"].map(|ending| fs::read(log.with_extension(ending)).expect("a file"))
    };
    let (first, again, other) = (simulate("a", "7"), simulate("b", "7"), simulate("c", "8"));
    assert!(first == again);
    assert!(first[0] != other[0] && first[2] != other[2]);
}

#[test]
fn what_is_wrong_with_a_scenario_is_said_and_nothing_is_left() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = folder.path().join("bad.toml");
    for (content, wanted) in [
        ("[motion]\nrate = \"-3 deg/s\"\n", &["bad.toml", "line 2", "motion.rate", "more than 0"][..]),
        ("[motion]\npath = \"circle\"\n", &["line 2", "motion.path", "eighteen-rotations"]),
        ("[populaton]\n", &["line 1", "populaton", "population"]),
        ("[population]\ngyro-scael = \"20 ppm\"\n", &["line 2", "gyro-scale"]),
        ("[population]\ngyro-scale = \"20 deg\"\n", &["line 2", "ppm"]),
        ("[imu]\nrate = \"33.3 Hz\"\n", &["imu.rate", "33 Hz"]),
        ("[imu]\nrate = \n", &["bad.toml", "line 2"]),
    ] {
        fs::write(&scenario, content).expect("a scenario");
        let output = sinscal(&[
            "simulate",
            "--out",
            &text(&folder.path().join("x/y")),
            "--scenario",
            &text(&scenario),
        ]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{content}: {said}");
        for part in wanted {
            assert!(said.contains(part), "{content}: {part} is missing in {said}");
        }
        assert!(!folder.path().join("x").exists());
    }
}

#[test]
fn the_default_scenario_is_printed_and_understood() {
    let output = sinscal(&["simulate", "--print-scenario"]);
    assert!(output.status.success());
    let printed = String::from_utf8(output.stdout).expect("text");
    assert_eq!(rig::Scenario::parse(&printed).expect("a scenario"), rig::Scenario::default());
    assert_eq!(sinscal(&["simulate"]).status.code(), Some(2));
}

#[test]
fn the_demo_hides_only_what_its_filter_lacks() {
    for effect in ["gyro-scale", "no-such-effect"] {
        let output = sinscal(&["demo", "--hide", effect]);
        assert_eq!(output.status.code(), Some(2));
        let said = String::from_utf8(output.stderr).expect("text");
        assert!(said.contains("accel-delay") && said.contains("dither-size-effect"), "{said}");
    }
}

/// The whole demonstration, seed 4: a minute or two in a debug build.
#[test]
#[ignore = "runs a whole demonstration: a minute or two"]
fn the_demo_finds_what_is_hidden_and_navigates_better() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = text(folder.path());
    let output = sinscal(&["demo", "--seed", "4", "--out", &out]);
    assert!(output.status.success());
    let said = String::from_utf8(output.stdout).expect("text");
    assert!(said.lines().count() <= 12, "{said}");
    let number = |start: &str, after: &str| -> f64 {
        let line = said.lines().find(|line| line.starts_with(start)).expect(start);
        let rest = line.split(after).nth(1).expect(after);
        rest.split_whitespace().next().and_then(|word| word.parse().ok()).expect("a number")
    };
    // 34 parameters of a right filter: none is 4.5 sigmas off; of one that lacks the delay, some are
    assert!(number("36d-p, which lacks it", "largest error") > 10.0, "{said}");
    assert!(number("36d-p + accel-delay", "largest error") < 4.5, "{said}");
    let (before, after) = (number("free-inertial", "at most"), number("free-inertial", "before,"));
    assert!(after < 0.5 * before, "{said}");
    for name in ["report.html", "diagnosis.json", "extended_filter.rs", "figures/navigation.svg"] {
        assert!(folder.path().join(name).is_file(), "{name}");
    }
    assert!(said.contains(&format!("{out}/report.html")), "{said}");
}
