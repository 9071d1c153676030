//! A log of any length is read in the same memory.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

use crate::support::Done;

/// Largest resident size of a run so far, MiB.
fn peak(process: u32) -> Option<f64> {
    let status = fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.split_whitespace().next()?.parse::<f64>().ok()? / 1024.0)
}

/// Runs the program and watches its memory. What it takes in its last milliseconds may be missed.
fn run(folder: &Path, arguments: &str) -> Result<f64, Box<dyn std::error::Error>> {
    let mut child = Command::new(env!("CARGO_BIN_EXE_sinscal"))
        .args(arguments.split(' '))
        .current_dir(folder)
        .stdout(Stdio::null())
        .spawn()?;
    let mut largest = 0.0_f64;
    loop {
        largest = largest.max(peak(child.id()).unwrap_or_default());
        if let Some(status) = child.try_wait()? {
            assert!(status.success(), "{arguments}");
            return Ok(largest);
        }
        thread::sleep(Duration::from_millis(2));
    }
}

/// 50 thousand rows and 400 thousand: the second takes at most 16 MiB more. `diagnose` is not among them: it remembers
/// every update, ten thousand at most.
#[test]
#[ignore = "a minute"]
fn memory_does_not_grow_with_the_log() -> Done {
    if peak(std::process::id()).is_none() {
        println!("skipped: this system does not tell the memory of a process");
        return Ok(());
    }
    let folder = tempfile::tempdir()?;
    let folder = folder.path();
    for (name, seconds) in [("short", 1000), ("long", 8000)] {
        let scenario =
            format!("[imu]\nrate = \"50 Hz\"\n[motion]\npath = \"swing\"\nduration = \"{seconds} s\"\n");
        fs::write(folder.join("s.toml"), scenario)?;
        run(folder, &format!("simulate --scenario s.toml --out {name}"))?;
    }
    run(folder, "calibrate short --filter 43d-b --json c.json")?;
    for command in [
        "calibrate LOG --filter 43d-b",
        "calibrate LOG --filter 43d-b --smooth --out out",
        "observe LOG --filter 43d-b",
        "navigate LOG --calibration c.json --align 100",
        "ablate LOG",
    ] {
        let [short, long] = ["short", "long"].map(|log| run(folder, &command.replace("LOG", log)));
        let (short, long) = (short?, long?);
        println!("{command}: {short:.1} MiB, {long:.1} MiB");
        assert!(short < 64.0 && long < short + 16.0, "{command}: {short:.1} MiB, {long:.1} MiB");
    }
    Ok(())
}
