//! What the program prints, where, and with which exit code.

use std::fs;
use std::io::Read;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use crate::support::{DESCRIPTION, Done, Table};

fn sinscal(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sinscal"));
    command.args(arguments);
    command
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Two minutes at rest.
fn log(folder: &Path, description: &str) -> Result<String, Box<dyn std::error::Error>> {
    fs::write(folder.join("log.toml"), description)?;
    Table::at_rest(6000).write_parquet(&folder.join("log.parquet"), None)?;
    Ok(folder.join("log").display().to_string())
}

fn calibrate(log: &str, more: &[&str]) -> std::io::Result<Output> {
    sinscal(&["calibrate", log, "--filter", "43d-b"]).args(more).output()
}

#[test]
fn bad_usage_is_exit_code_2() -> Done {
    for arguments in [
        &["calibrate"][..],
        &["calibrate", "log"],
        &["calibrate", "log", "--filter", "44d-x"],
        &["calibrate", "log", "--filter", "43d-b", "--passes", "0"],
        &["calibrate", "log", "--filter", "43d-b", "--form", "square-root"],
        &["calibrate", "log", "--filter", "43d-b", "--bridge-gaps", "-1"],
        &["calibrat"],
        &["filters", "--all"],
        &[],
    ] {
        let output = sinscal(arguments).output()?;
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", text(&output.stderr));
        assert!(!output.stderr.is_empty() && output.stdout.is_empty(), "{arguments:?}");
    }
    let unknown = text(&sinscal(&["calibrate", "log", "--filter", "44d-x"]).output()?.stderr);
    assert!(unknown.contains("43d-b") && unknown.contains("mems-30d"), "{unknown}");
    assert_eq!(sinscal(&["--help"]).output()?.status.code(), Some(0));
    Ok(())
}

#[test]
fn lists_name_every_filter_and_effect() -> Done {
    let filters = sinscal(&["filters"]).output()?;
    assert!(filters.status.success());
    for name in sinscal::FILTERS {
        assert!(text(&filters.stdout).contains(name.name), "{}", name.name);
    }
    let effects = sinscal(&["effects"]).output()?;
    assert!(effects.status.success());
    for effect in sinscal::EFFECTS {
        assert!(text(&effects.stdout).contains(effect.equation()), "{}", effect.name());
    }
    Ok(())
}

#[test]
fn json_on_standard_output_is_nothing_but_json() -> Done {
    let folder = tempfile::tempdir()?;
    let log = log(folder.path(), DESCRIPTION)?;
    let output = calibrate(&log, &["--json", "-"])?;
    assert!(output.status.success(), "{}", text(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout)?;
    assert_eq!(report["filter"], "43d-b");
    assert_eq!(report["states"], 43);
    assert_eq!(report["samples"], 6000);
    assert!(report["duration_s"].as_f64().is_some_and(|seconds| (seconds - 120.0).abs() < 1e-9));
    let parameters = report["parameters"].as_array().ok_or("no parameters")?;
    assert_eq!(parameters.len(), 34);
    for parameter in parameters {
        let estimated = parameter["estimated"].as_bool().ok_or("no `estimated`")?;
        for field in ["value", "sigma", "converged_s"] {
            assert_eq!(parameter[field].is_number(), estimated, "{parameter}");
            assert_eq!(parameter[field].is_null(), !estimated, "{parameter}");
        }
        assert!(parameter["prior_sigma"].is_number() && parameter["unit"].is_string());
    }
    // A unit at rest shows nothing of its delay.
    assert!(parameters.iter().any(|parameter| parameter["estimated"] == false));
    assert_eq!(report["final"]["attitude_quat_wxyz"].as_array().map(Vec::len), Some(4));
    assert_eq!(report["final"]["position_enu_m"].as_array().map(Vec::len), Some(3));
    assert_eq!(report["final"]["velocity_enu_m_s"].as_array().map(Vec::len), Some(3));
    Ok(())
}

#[test]
fn people_see_the_verdict_first_and_no_figure_for_what_is_not_estimated() -> Done {
    let folder = tempfile::tempdir()?;
    let log = log(folder.path(), DESCRIPTION)?;
    let output = calibrate(&log, &[])?;
    let table = text(&output.stdout);
    assert!(table.starts_with("43d-b cannot be judged"), "{table}");
    assert!(
        table.lines().any(|line| line.starts_with("accel-delay") && line.contains("not estimated")),
        "{table}"
    );
    assert!(output.stderr.is_empty(), "{}", text(&output.stderr));
    Ok(())
}

#[test]
fn results_go_to_files_and_forms_and_passes_agree_to_run() -> Done {
    let folder = tempfile::tempdir()?;
    let log = log(folder.path(), DESCRIPTION)?;
    let out = folder.path().join("deep/results");
    let json = folder.path().join("report.json");
    for form in ["conventional", "ud"] {
        let arguments = [
            "--form",
            form,
            "--passes",
            "2",
            "--json",
            &json.display().to_string(),
            "--out",
            &out.display().to_string(),
        ];
        let output = calibrate(&log, &arguments)?;
        assert!(output.status.success(), "{}", text(&output.stderr));
        let report: serde_json::Value = serde_json::from_slice(&fs::read(&json)?)?;
        assert_eq!(report["form"], form);
        let passes = report["passes"].as_array().map(Vec::as_slice).unwrap_or_default();
        assert!(passes.len() == 2 && passes.iter().all(|pass| pass["kept"] == true), "{passes:?}");
        assert_eq!(fs::read(&json)?, fs::read(out.join("calibration.json"))?);
        let history = fs::read_to_string(out.join("history.csv"))?;
        let width = |line: &str| line.split(',').count();
        assert!(history.starts_with("time_s,gyro-scale.x,gyro-scale.x.sigma,"));
        assert!(history.lines().all(|line| width(line) == 1 + 2 * 34));
        let mut written = fs::read_dir(&out)?
            .map(|entry| Ok(entry?.file_name().into_string().unwrap_or_default()))
            .collect::<std::io::Result<Vec<_>>>()?;
        written.sort();
        assert_eq!(written, ["calibration.json", "calibration.txt", "figures", "history.csv", "report.html"]);
        assert!(out.join("figures/gyro-scale.svg").is_file() && out.join("figures/gyro-scale.csv").is_file());
    }
    Ok(())
}

#[test]
fn without_an_initial_attitude_it_is_found_or_asked_for() -> Done {
    let folder = tempfile::tempdir()?;
    let initial = "[initial]\nquaternion_wxyz = [1.0, 0.0, 0.0, 0.0]\n\
                   level_sigma_deg = 0.05\nheading_sigma_deg = 0.2\n";
    assert!(DESCRIPTION.contains(initial));
    let found = log(folder.path(), &DESCRIPTION.replace(initial, ""))?;
    let output = calibrate(&found, &[])?;
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stdout).starts_with("43d-b cannot be judged"), "{}", text(&output.stdout));

    let noisy = DESCRIPTION.replace(initial, "").replace("sqrt_h = 0.001", "sqrt_h = 3.0");
    let asked = log(folder.path(), &noisy)?;
    let output = calibrate(&asked, &[])?;
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("[initial]"), "{}", text(&output.stderr));
    Ok(())
}

#[test]
fn places_that_cannot_be_written_are_refused() -> Done {
    let folder = tempfile::tempdir()?;
    let log = log(folder.path(), DESCRIPTION)?;
    let missing = folder.path().join("none/report.json").display().to_string();
    let a_folder = folder.path().display().to_string();
    let a_file = folder.path().join("log.toml/results").display().to_string();
    for (arguments, expected) in [
        (["--json", missing.as_str()], "is not there"),
        (["--json", a_folder.as_str()], "is a folder"),
        (["--out", a_file.as_str()], "is a file, a folder was expected"),
    ] {
        let output = calibrate(&log, &arguments)?;
        assert_eq!(output.status.code(), Some(1), "{arguments:?}");
        assert!(text(&output.stderr).contains(expected), "{}", text(&output.stderr));
    }
    assert_eq!(fs::read_dir(folder.path())?.count(), 2);
    Ok(())
}

#[test]
fn a_full_disk_is_reported() -> Done {
    let full = Path::new("/dev/full");
    if !full.exists() {
        println!("skipped: this system has no /dev/full");
        return Ok(());
    }
    let folder = tempfile::tempdir()?;
    let log = log(folder.path(), DESCRIPTION)?;
    let output = calibrate(&log, &["--json", "/dev/full"])?;
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("/dev/full: cannot be written"), "{}", text(&output.stderr));
    let stdout = fs::File::options().write(true).open(full)?;
    let output = sinscal(&["effects"]).stdout(stdout).stderr(Stdio::piped()).spawn()?.wait_with_output()?;
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("standard output cannot be written"), "{}", text(&output.stderr));
    Ok(())
}

#[test]
fn a_reader_that_goes_away_is_no_accident() -> Done {
    let folder = tempfile::tempdir()?;
    let log = log(folder.path(), DESCRIPTION)?;
    for arguments in [
        &["filters"][..],
        &["effects"],
        &["--help"],
        &["calibrate", &log, "--filter", "36d-p", "--json", "-"],
    ] {
        let mut child = sinscal(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()?;
        drop(child.stdout.take());
        let mut message = String::new();
        if let Some(stderr) = child.stderr.as_mut() {
            stderr.read_to_string(&mut message)?;
        }
        let status = child.wait()?;
        assert_eq!(status.code(), Some(0), "{arguments:?}: {message}");
        assert!(!message.contains("panicked"), "{message}");
    }
    Ok(())
}

/// What a filter lacks looks like outliers in a single pass, and is said; a second pass knows better. A reference that contradicts
/// itself is no fit, however well half of it does.
#[test]
fn a_reference_that_is_left_out_is_no_fit() -> Done {
    let folder = tempfile::tempdir()?;
    let run = |arguments: &str| -> Result<(String, String), Box<dyn std::error::Error>> {
        let output = Command::new(env!("CARGO_BIN_EXE_sinscal"))
            .args(arguments.split(' '))
            .current_dir(folder.path())
            .output()?;
        let text = |bytes| String::from_utf8_lossy(bytes).into_owned();
        assert!(output.status.success(), "{arguments}: {}", text(&output.stderr));
        Ok((text(&output.stdout), text(&output.stderr)))
    };
    let scenario = "[imu]\nrate = \"10 Hz\"\n[motion]\nstill = \"60 s\"\ndwell = \"20 s\"\nrate = \"60 deg/s\"\n\
                    acceleration = \"60 deg/s^2\"\n[population]\naccel-delay = \"2 ms\"\n";
    fs::write(folder.path().join("s.toml"), scenario)?;
    run("simulate --scenario s.toml --out delayed")?;
    let (once, said) = run("calibrate delayed --filter 36d-p --passes 1")?;
    assert!(
        once.contains("outliers of the reference left out") && once.contains("readings far off, from "),
        "{once}"
    );
    for told in ["warning: ", " readings of the reference (", " s; a single pass cannot tell", "--passes 2"] {
        assert!(said.contains(told), "{told}: {said}");
    }
    let (twice, said) = run("calibrate delayed --filter 36d-p --passes 2")?;
    assert!(
        twice.contains("does not fit") && !twice.contains("left out") && !said.contains("left out"),
        "{twice}{said}"
    );

    fs::write(folder.path().join("moving.toml"), DESCRIPTION)?;
    let mut table = Table::at_rest(1000);
    table.map("ref_vel_*", |_, _| 3.6);
    table.write_csv(&folder.path().join("moving.csv"))?;
    let (verdict, said) = run("calibrate moving --filter 36d-p")?;
    assert!(verdict.starts_with("36d-p does not fit: most readings of position contradict it"), "{verdict}");
    assert!(said.contains("check unit, sign and frame of the reference"), "{said}");
    Ok(())
}

#[test]
fn several_logs_of_a_unit_give_common_parameters_and_their_own() -> Done {
    let folder = tempfile::tempdir()?;
    let at = |name: &str| folder.path().join(name).display().to_string();
    fs::write(at("short.toml"), super::guide::TURNS)?;
    for name in ["monday", "friday"] {
        let output =
            sinscal(&["simulate", "--scenario", &at("short.toml"), "--seed", "3", "--out", &at(name)])
                .output()?;
        assert!(output.status.success(), "{}", text(&output.stderr));
    }
    let output = calibrate(&at("monday"), &[&at("friday"), "--out", &at("both"), "--json", "-"])?;
    assert!(output.status.success(), "{}", text(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout)?;
    let list = |value: &serde_json::Value| value.as_array().cloned().unwrap_or_default();
    let (common, logs) = (list(&report["parameters"]), list(&report["logs"]));
    assert!(common.len() == 34 && logs.len() == 2);
    // the same log twice: the same figures where the prior says little, with 1/sqrt(2) of the sigma
    let own = list(&logs[0]["parameters"]);
    let mut compared = 0;
    for (common, own) in common.iter().zip(&own) {
        let (Some(sigma), Some(alone)) = (common["sigma"].as_f64(), own["sigma"].as_f64()) else { continue };
        if alone < 0.01 * own["prior_sigma"].as_f64().ok_or("no prior")? {
            assert!((sigma / alone - 0.5_f64.sqrt()).abs() < 0.05, "{own}");
            compared += 1;
        }
    }
    assert!(compared > 5, "{compared}");
    let written = fs::read_to_string(folder.path().join("both/calibration.txt"))?;
    assert!(written.contains("2 logs together") && written.contains("log 2: "), "{written}");
    for (more, expected) in [
        (&[&*at("monday")][..], "is named twice"),
        (&[&*at("friday"), "--budget"], "is common to logs of one unit"),
    ] {
        let output = calibrate(&at("monday"), more)?;
        let said = text(&output.stderr);
        assert!(output.status.code() == Some(1) && said.contains(expected), "{more:?}: {said}");
    }
    Ok(())
}
