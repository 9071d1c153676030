//! The same bits on any number of threads.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

use crate::support::Done;

const SCENARIO: &str =
    "[motion]\nstill = \"60 s\"\ndwell = \"20 s\"\nrate = \"30 deg/s\"\nacceleration = \"60 deg/s^2\"\n";

fn sinscal(folder: &Path, threads: &str, arguments: &[&str]) -> Result<Output, Box<dyn std::error::Error>> {
    let output = Command::new(env!("CARGO_BIN_EXE_sinscal"))
        .args(arguments)
        .env("RAYON_NUM_THREADS", threads)
        .current_dir(folder)
        .output()?;
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {message}");
    Ok(output)
}

/// A document without what a clock put into it.
fn without_times(bytes: &[u8]) -> Result<Value, Box<dyn std::error::Error>> {
    let mut document: Value = serde_json::from_slice(bytes)?;
    if let Some(fields) = document.as_object_mut() {
        fields.retain(|name, _| !name.ends_with("wall_s"));
    }
    Ok(document)
}

#[test]
fn any_number_of_threads_gives_the_same_bits() -> Done {
    let folder = tempfile::tempdir()?;
    let folder = folder.path();
    fs::write(folder.join("s.toml"), SCENARIO)?;
    sinscal(folder, "1", &["simulate", "--out", "log", "--scenario", "s.toml", "--seed", "5"])?;
    sinscal(folder, "1", &["simulate", "--out", "other", "--scenario", "s.toml", "--seed", "6"])?;
    let campaign = ["campaign", "--units", "5", "--scenario", "s.toml", "--hours", "0.05", "--align", "60"];
    let commands: [&[&str]; 6] = [
        &["calibrate", "log", "--filter", "43d-b"],
        &["calibrate", "log", "--filter", "43d-b", "--form", "ud", "--smooth"],
        &["ablate", "log", "--swing", "other"],
        &["observe", "log", "--filter", "43d-b"],
        &["diagnose", "log", "--filter", "36d-p"],
        &campaign,
    ];
    for command in commands {
        let run = |threads| -> Result<Value, Box<dyn std::error::Error>> {
            without_times(&sinscal(folder, threads, &[command, &["--json", "-"]].concat())?.stdout)
        };
        let one = run("1")?;
        // a diagnosis takes its time: once is enough
        for threads in if command[0] == "diagnose" { &["4"][..] } else { &["2", "4"] } {
            // text to the digit, so that also the sign of zero counts
            assert_eq!(run(threads)?.to_string(), one.to_string(), "{command:?} on {threads} threads");
        }
    }
    Ok(())
}
