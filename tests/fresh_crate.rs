//! A filter declared in a crate of its own, outside the workspace: it compiles and runs, and mistakes are all told.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::Instant;

/// Fewer than 15 lines, as the front page promises.
const PROGRAM: &str = r#"use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter(measures(velocity, position))]
struct Mine {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    gyro: GyroErrors,
    delay: AccelDelay,
    accel: AccelErrors,
}
fn main() { println!("{} {}", Mine::NAME, Mine::DIM) }
"#;

/// 43 states, and all that a pass over a log runs.
const WHOLE: &str = r#"use sinscal::prelude::*;
use sinscal::{Calibration, Sample, Setup};

#[derive(StateBlocks)]
#[filter(measures(velocity, position))]
struct Mine {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    gyro: GyroErrors,
    accel: AccelErrors,
    outer_lever: OuterLeverArm,
    inner_lever: InnerLeverArm,
    delay: AccelDelay,
    temperature: AccelTemperatureScale,
    dither: Dither,
}
fn pass(setup: &Setup, samples: &[Sample]) -> f64 {
    let mut run = Box::new(Calibration::<Mine>::new(setup).expect("a sound setup"));
    let whole = samples.iter().all(|sample| run.step(sample).is_ok());
    if whole { run.statistics().nis } else { f64::NAN }
}
fn main() { std::hint::black_box(pass as fn(&Setup, &[Sample]) -> f64); println!("{}", Mine::DIM) }
"#;

/// A block twice, a coupling without what it acts through, a measurement that does not exist.
const MISTAKEN: &str = r#"use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter(measures(velocity, range))]
struct Mine {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    gyro: GyroErrors,
    again: GyroErrors,
    dither: Dither,
}
fn main() {}
"#;

fn crate_with(name: &str, program: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let dir = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(dir.join("src")).expect("a folder for the crate");
    let manifest = format!(
        "[package]\nname = \"{name}\"\nversion = \"0.0.0\"\nedition = \"2024\"\n\n[dependencies]\nsinscal = {{ path = {root:?} }}\n\n[workspace]\n"
    );
    std::fs::write(dir.join("Cargo.toml"), manifest).expect("a manifest");
    std::fs::copy(root.join("Cargo.lock"), dir.join("Cargo.lock")).expect("the versions of the workspace");
    std::fs::write(dir.join("src/main.rs"), program).expect("a program");
    dir
}

fn run(dir: &Path) -> Output {
    cargo(dir, &["run", "--quiet"])
}

fn cargo(dir: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO"))
        .args(arguments)
        .current_dir(dir)
        .env("CARGO_TARGET_DIR", dir.join("target"))
        // what it takes to compile is not what it takes to find that nothing has changed
        .env("CARGO_INCREMENTAL", "0")
        .output()
        .expect("cargo runs")
}

#[test]
#[ignore = "builds two crates from scratch; run with `cargo test --test fresh_crate -- --ignored`"]
fn a_filter_of_ones_own_compiles_and_runs() {
    assert!(PROGRAM.lines().count() < 15);
    let output = run(&crate_with("fresh-filter", PROGRAM));
    let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{err}");
    assert_eq!(out.trim(), "mine 34");
    assert!(!err.contains("warning"), "{err}");
}

#[test]
#[ignore = "builds two crates from scratch; run with `cargo test --test fresh_crate -- --ignored`"]
fn three_mistakes_are_three_errors() {
    let output = run(&crate_with("mistaken-filter", MISTAKEN));
    let err = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success());
    // the last "error" is cargo's own summary
    let errors = err.lines().filter(|line| line.starts_with("error")).count();
    assert_eq!(errors, 4, "{err}");
}

#[test]
#[ignore = "builds a crate from scratch, twice; run with `cargo test --test fresh_crate -- --ignored --nocapture compile_time`"]
fn compile_time_of_43_states_on_built_dependencies() {
    let dir = crate_with("whole-filter", WHOLE);
    for profile in ["dev", "release"] {
        let build = || {
            let start = Instant::now();
            let output = cargo(&dir, &["build", "--quiet", "--profile", profile]);
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            start.elapsed().as_secs_f64()
        };
        build();
        // the least of three: other work on the machine only adds
        let mut least = f64::INFINITY;
        for change in 0..3 {
            std::fs::write(dir.join("src/main.rs"), format!("{WHOLE}// {change}\n")).expect("a program");
            least = least.min(build());
        }
        println!("{profile}: {least:.1} s");
    }
}
