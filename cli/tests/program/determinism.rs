//! The same bits on any number of threads.

use std::collections::BTreeMap;
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

/// Every file below a folder with its bytes, without what a clock put into it.
fn files(folder: &Path, prefix: &str) -> Result<BTreeMap<String, Vec<u8>>, Box<dyn std::error::Error>> {
    let mut all = BTreeMap::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
        if entry.path().is_dir() {
            all.extend(files(&entry.path(), &format!("{name}/"))?);
            continue;
        }
        let bytes = fs::read(entry.path())?;
        let bytes = match name.rsplit('.').next() {
            Some("json") => without_times(&bytes)?.to_string().into_bytes(),
            Some("txt" | "html") => {
                let text = String::from_utf8(bytes)?;
                let lines = text.lines().map(|line| line.split("computed in ").next().unwrap_or_default());
                lines.collect::<Vec<_>>().join("\n").into_bytes()
            }
            _ => bytes,
        };
        all.insert(name, bytes);
    }
    Ok(all)
}

/// What a command writes to the folder `out`, by 1, 2 and 4 threads; the rest of the folder is there for each of them.
fn written_alike(arguments: &[&str], sources: &Path) -> Done {
    let run = |threads: &str| -> Result<BTreeMap<String, Vec<u8>>, Box<dyn std::error::Error>> {
        let folder = tempfile::tempdir()?;
        for entry in fs::read_dir(sources)? {
            let entry = entry?;
            fs::copy(entry.path(), folder.path().join(entry.file_name()))?;
        }
        sinscal(folder.path(), threads, &[arguments, &["--out", "out"]].concat())?;
        files(&folder.path().join("out"), "")
    };
    let one = run("1")?;
    assert!(one.len() > 1, "{arguments:?} wrote {:?}", one.keys());
    for threads in ["2", "4"] {
        let other = run(threads)?;
        assert_eq!(other.keys().collect::<Vec<_>>(), one.keys().collect::<Vec<_>>());
        let differing = one.iter().filter(|(name, bytes)| other[*name] != **bytes);
        let differing: Vec<&String> = differing.map(|(name, _)| name).collect();
        assert!(differing.is_empty(), "{arguments:?} on {threads} threads: {differing:?} differ");
    }
    Ok(())
}

#[test]
fn any_number_of_threads_writes_the_same_files() -> Done {
    let folder = tempfile::tempdir()?;
    let quick = format!("[imu]\nrate = \"10 Hz\"\n{}", SCENARIO.replace("20 s", "4 s"));
    fs::write(folder.path().join("s.toml"), quick)?;
    for command in [
        "paper --units 2 --hours 0.1 --scenario s.toml",
        "campaign map --units 2 --factors 1 --hours 0.1 --scenario s.toml",
    ] {
        written_alike(&command.split(' ').collect::<Vec<_>>(), folder.path())?;
    }
    Ok(())
}

#[test]
#[ignore = "a minute with --release"]
fn any_number_of_threads_tells_the_same_story() -> Done {
    let folder = tempfile::tempdir()?;
    fs::write(folder.path().join("s.toml"), SCENARIO)?;
    for (name, seed) in [("log", "5"), ("other", "6")] {
        let simulate = ["simulate", "--out", name, "--scenario", "s.toml", "--seed", seed];
        sinscal(folder.path(), "1", &simulate)?;
    }
    written_alike(&["demo"], folder.path())?;
    written_alike(&["diagnose", "log", "--filter", "36d-p", "--verify", "other"], folder.path())
}

/// The compiler may not reorder or fuse what the source says, whatever the profile: `target/debug` and `target/release` give the
/// same bits. Both are built before: `cargo build -p sinscal-cli && cargo build --release -p sinscal-cli`.
#[test]
#[ignore = "seconds, once both profiles are built"]
fn both_profiles_give_the_same_bits() -> Done {
    let this = Path::new(env!("CARGO_BIN_EXE_sinscal"));
    let target = this.parent().and_then(Path::parent).ok_or("no target folder")?;
    let name = this.file_name().ok_or("no name")?;
    let log = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/turns.csv");
    for (filter, form) in [("36d-p", "conventional"), ("43d-b", "conventional"), ("43d-b", "ud")] {
        let run = |profile: &str| -> Result<String, Box<dyn std::error::Error>> {
            let program = target.join(profile).join(name);
            let output = Command::new(&program)
                .args(["calibrate", "--filter", filter, "--form", form, "--json", "-"])
                .arg(&log)
                .output()
                .map_err(|error| format!("{}: {error}; build it first", program.display()))?;
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            Ok(without_times(&output.stdout)?.to_string())
        };
        assert_eq!(run("debug")?, run("release")?, "{filter}, {form}");
    }
    Ok(())
}
