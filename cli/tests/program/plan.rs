//! `sinscal plan`: what it writes, the other commands take as it is.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

use crate::support::Done;

fn sinscal(folder: &Path, arguments: &str) -> std::io::Result<Output> {
    Command::new(env!("CARGO_BIN_EXE_sinscal"))
        .args(arguments.split_whitespace())
        .current_dir(folder)
        .output()
}

fn json(folder: &Path, arguments: &str) -> Result<Value, Box<dyn std::error::Error>> {
    let output = sinscal(folder, arguments)?;
    assert!(output.status.success(), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
    Ok(serde_json::from_slice(&output.stdout)?)
}

fn sigmas(answer: &Value, list: &str) -> Vec<f64> {
    answer[list].as_array().into_iter().flatten().filter_map(|entry| entry["sigma"].as_f64()).collect()
}

#[test]
fn a_plan_is_simulated_calibrated_and_evaluated() -> Done {
    let folder = tempfile::tempdir()?;
    let at = folder.path();
    fs::write(at.join("base.toml"), "[imu]\nrate = \"20 Hz\"\n[motion]\nacceleration = \"30 deg/s^2\"\n")?;
    let plan = json(
        at,
        "plan --filter 43d-b --duration 5min --evaluations 64 --verify 2 --known --scenario base.toml --json - --out p",
    )?;
    assert_eq!(plan["duration_s"], 300.0);
    let turns = plan["turns"].as_array().ok_or("no turns")?;
    assert!(turns.iter().all(|turn| turn["dwell_s"].as_f64().is_some_and(|dwell| dwell >= 1.0)));
    let planned = sigmas(&plan, "sigma");
    assert_eq!(planned.len(), 34);
    assert_eq!(plan["effects"].as_array().map(Vec::len), Some(11));
    assert!(plan["verified"]["nees_per_dof"].as_f64().is_some_and(|nees| (0.3..3.0).contains(&nees)));
    let known = plan["known"].as_array().ok_or("no known paths")?;
    let criterion = plan["criterion"].as_f64().ok_or("no criterion")?;
    assert!(plan["bound"].as_f64().is_some_and(|bound| 0.0 < bound && bound < criterion));
    assert!(known.iter().all(|known| known["criterion"].as_f64().is_some_and(|other| criterion <= other)));
    let page = fs::read_to_string(at.join("p/report.html"))?;
    assert!(page.contains("<polygon") && at.join("p/figures/stands.svg").is_file());
    let judged = json(at, "plan --filter 43d-b --evaluate p/scenario.toml --json -")?;
    for (a, b) in planned.iter().zip(sigmas(&judged, "sigma")) {
        // nothing is rounded but the numbers of the file
        assert!((a / b - 1.0).abs() < 1e-6, "{a} {b}");
    }
    let output = sinscal(at, "simulate --scenario p/scenario.toml --out log --seed 1")?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(plan["rank"], json(at, "observe log --filter 43d-b --json -")?["rank"]);
    // of a log it is the first pass, to the bit
    let judged = json(at, "plan --filter 43d-b --evaluate log --json -")?;
    let stated = json(at, "calibrate log --filter 43d-b --passes 1 --json -")?;
    let stated = sigmas(&stated, "parameters");
    assert_eq!(sigmas(&judged, "sigma"), stated);
    Ok(())
}

#[test]
fn what_is_asked_for_is_what_is_made_small() -> Done {
    let folder = tempfile::tempdir()?;
    let at = folder.path();
    fs::write(at.join("base.toml"), "[imu]\nrate = \"20 Hz\"\n[motion]\nacceleration = \"30 deg/s^2\"\n")?;
    fs::write(at.join("wanted.toml"), "gyro-scale = \"3 ppm\"\naccel-bias = \"20 ug\"\n")?;
    let plan = |arguments: &str| {
        json(
            at,
            &format!(
                "plan --filter 36d-p --scenario base.toml --evaluations 100 --verify 0 {arguments} --json -"
            ),
        )
    };
    let worst = |answer: &Value, name: &str| {
        let list = answer["sigma"].as_array().into_iter().flatten();
        let sigmas = list.filter(|entry| entry["name"] == name).filter_map(|entry| entry["sigma"].as_f64());
        sigmas.fold(0.0, f64::max)
    };
    // 3 ppm and 20 ug
    let ratio = |answer: &Value| {
        (worst(answer, "gyro-scale") / 3e-6).max(worst(answer, "accel-bias") / (20e-6 * 9.80665))
    };
    let required = plan("--duration 5min --require wanted.toml")?;
    let criterion = required["criterion"].as_f64().ok_or("no criterion")?;
    assert!((criterion / ratio(&required) - 1.0).abs() < 1e-9, "{criterion} {}", ratio(&required));
    let shortest = plan("--duration 12min --target wanted.toml")?;
    assert!(ratio(&shortest) <= 1.0, "{}", ratio(&shortest));
    let lasts = shortest["duration_s"].as_f64().ok_or("no duration")?;
    assert!(lasts < 700.0, "{lasts}");
    // sigmas that no path reaches
    fs::write(at.join("never.toml"), "gyro-scale = \"0.001 ppm\"\n")?;
    let output = sinscal(
        at,
        "plan --filter 36d-p --scenario base.toml --evaluations 64 --verify 0 --duration 5min --target never.toml",
    )?;
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(1) && error.contains("are not reached in 300 s"), "{error}");
    let apart = plan("--duration 10min --separate accel-cubic,accel-scale")?;
    let criterion = apart["criterion"].as_f64().ok_or("no criterion")?;
    let prior = |name: &str| {
        let list = apart["effects"].as_array().into_iter().flatten();
        list.filter(|effect| effect["name"] == name).filter_map(|effect| effect["to_asked"].as_f64()).next()
    };
    // both have states, and both are seen
    let (cubic, scale) = (prior("accel-cubic").ok_or("no cubic")?, prior("accel-scale").ok_or("no scale")?);
    assert_eq!(criterion, cubic.max(scale));
    assert!(criterion < 0.5, "{criterion}");
    Ok(())
}

/// What a default plan is to reach, as parts of the sigmas of the paper's path: gyro bias, temperature scale, all the others.
const ASKED: [(f64, [f64; 3]); 3] =
    [(941.0, [2.9, 2.6, 0.83]), (1883.0, [1.6, 1.25, 0.65]), (3765.0, [1.0, 0.6, 0.55])];

/// The worst sigma of each effect.
fn effects(answer: &Value, list: &str) -> std::collections::BTreeMap<String, f64> {
    let mut worst = std::collections::BTreeMap::new();
    for entry in answer[list].as_array().into_iter().flatten() {
        if let (Some(name), Some(sigma)) = (entry["name"].as_str(), entry["sigma"].as_f64()) {
            let so_far: &mut f64 = worst.entry(name.to_owned()).or_default();
            *so_far = so_far.max(sigma);
        }
    }
    worst
}

#[test]
#[ignore = "plans, simulates and calibrates at three durations: ten minutes in a release build; 941 s are not reached yet"]
fn default_plans_show_more_than_the_papers_path() -> Done {
    let folder = tempfile::tempdir()?;
    let at = folder.path();
    let run = |arguments: &str| -> Done {
        let output = sinscal(at, arguments)?;
        assert!(output.status.success(), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
        Ok(())
    };
    run("simulate --seed 5 --out paper")?;
    let paper = effects(&json(at, "calibrate paper --filter 43d-b --json -")?, "parameters");
    for (duration, [bias, temperature, others]) in ASKED {
        let start = std::time::Instant::now();
        let plan = json(
            at,
            &format!("plan --filter 43d-b --duration {duration}s --verify 16 --json - --out p{duration}"),
        )?;
        println!("{duration} s: planned in {:.0?}, criterion {}", start.elapsed(), plan["criterion"]);
        assert_eq!(plan["rank"], 43);
        assert_eq!(plan["verified"]["consistent"], true, "{}", plan["verified"]);
        run(&format!("simulate --seed 6 --scenario p{duration}/scenario.toml --out l{duration}"))?;
        let flown =
            effects(&json(at, &format!("calibrate l{duration} --filter 43d-b --json -"))?, "parameters");
        for (name, sigma) in flown {
            let limit = match name.as_str() {
                "gyro-bias" => bias,
                "accel-temperature-scale" => temperature,
                _ => others,
            };
            println!("  {name}: {:.3} of the paper's path, at most {limit}", sigma / paper[&name]);
            assert!(sigma <= limit * paper[&name], "{duration} s, {name}: {} {limit}", sigma / paper[&name]);
        }
    }
    Ok(())
}

#[test]
fn a_description_beside_a_table_of_any_kind_is_no_scenario() -> Done {
    let folder = tempfile::tempdir()?;
    let at = folder.path();
    fs::write(at.join("log.toml"), "[imu]\nrate = \"50 Hz\"\n")?;
    fs::write(at.join("log.mat"), "no table")?;
    let output = sinscal(at, "plan --filter 43d-b --evaluate log.toml")?;
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{error}");
    assert!(error.contains("is not a name of the log format"), "{error}");
    Ok(())
}

/// Where the tests themselves run in the background, children inherit interrupts as ignored: not this one.
#[cfg(target_os = "linux")]
#[test]
fn an_interrupt_leaves_the_best_path_so_far() -> Done {
    let folder = tempfile::tempdir()?;
    let at = folder.path();
    let plan = "plan --filter 36d-p --duration 3min --evaluations 10000000 --verify 0 --out p";
    let mut child = Command::new("env")
        .args(["--default-signal=INT", env!("CARGO_BIN_EXE_sinscal")])
        .args(plan.split_whitespace())
        .current_dir(at)
        .stdout(std::process::Stdio::null())
        .spawn()?;
    std::thread::sleep(std::time::Duration::from_secs(3));
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status()?;
    assert!(kill.success() && child.wait()?.success());
    let written: Value = serde_json::from_str(&fs::read_to_string(at.join("p/plan.json"))?)?;
    assert!(written["turns"].as_array().is_some_and(|turns| !turns.is_empty()));
    assert!(at.join("p/scenario.toml").is_file());
    Ok(())
}

#[test]
fn what_is_wrong_is_named() -> Done {
    let folder = tempfile::tempdir()?;
    let at = folder.path();
    fs::write(at.join("wanted.toml"), "gyro-scal = \"2 ppm\"\n")?;
    fs::write(at.join("unit.toml"), "gyro-scale = \"2 deg\"\n")?;
    for (arguments, said) in [
        ("--duration 5min --require wanted.toml", "field `gyro-scal`: 43d-b has no such effect"),
        ("--duration 5min --require unit.toml", "field `gyro-scale`: "),
        ("--duration 5min --separate nonsense", "--separate"),
        ("--duration 40s --table hand --evaluations 16", "fits into 40 s"),
    ] {
        let output = sinscal(at, &format!("plan --filter 43d-b {arguments}"))?;
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{arguments}: {error}");
        assert!(error.contains(said), "{arguments}: {error}");
    }
    for arguments in ["", "--duration 5parsec", "--evaluate x --duration 5min"] {
        let output = sinscal(at, &format!("plan --filter 43d-b {arguments}"))?;
        assert_eq!(output.status.code(), Some(2), "{arguments}");
    }
    Ok(())
}
