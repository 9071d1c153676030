//! What is not a log may be broken too: calibrations, scenarios, places to write to; and every command that reads a log
//! refuses a broken one.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::{Value, json};

use crate::support::{DESCRIPTION, Done, Table};

fn sinscal(folder: &Path, arguments: &[&str]) -> std::io::Result<Output> {
    Command::new(env!("CARGO_BIN_EXE_sinscal")).args(arguments).current_dir(folder).output()
}

/// A folder with a sound log of ten seconds.
fn folder() -> Result<tempfile::TempDir, Box<dyn std::error::Error>> {
    let folder = tempfile::tempdir()?;
    fs::write(folder.path().join("log.toml"), DESCRIPTION)?;
    Table::at_rest(500).write_csv(&folder.path().join("log.csv"))?;
    Ok(folder)
}

/// What is wrong with a refusal: exit code 1, the pieces in the message, nothing on standard output, `results` not made.
fn complaint(folder: &Path, arguments: &[&str], expected: &[&str]) -> Result<Option<String>, std::io::Error> {
    let output = sinscal(folder, arguments)?;
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    let mut wrong = Vec::new();
    if output.status.code() != Some(1) {
        wrong.push(format!("exit code {:?}", output.status.code()));
    }
    let unsaid = expected.iter().filter(|part| !message.contains(**part));
    wrong.extend(unsaid.map(|part| format!("{part:?} is not said")));
    if message.contains("panicked") || !output.stdout.is_empty() || folder.join("results").exists() {
        wrong.push("it panicked, printed or left something".into());
    }
    Ok((!wrong.is_empty()).then(|| format!("{arguments:?}: {}\n{message}", wrong.join("; "))))
}

/// Which of two logs is too short is said with its file.
#[test]
fn a_log_too_short_to_diagnose_is_named() -> Done {
    let folder = folder()?;
    for (name, rows) in [("short", 250), ("long", 7500)] {
        Table::at_rest(rows).write_csv(&folder.path().join(name).with_extension("csv"))?;
        fs::write(folder.path().join(name).with_extension("toml"), DESCRIPTION)?;
    }
    let first = &["diagnose", "short", "--filter", "36d-p"];
    let complaints = complaint(folder.path(), first, &["short.csv: ", "in the log are too few to judge by"])?;
    assert!(complaints.is_none(), "{complaints:?}");
    // a second one is left out with a word
    let second = sinscal(folder.path(), &["diagnose", "long", "--filter", "36d-p", "--verify", "short"])?;
    let said =
        String::from_utf8_lossy(&second.stdout).into_owned() + &String::from_utf8_lossy(&second.stderr);
    assert!(
        second.status.success() && said.contains("the second log cannot be used, and was left out"),
        "{said}"
    );
    Ok(())
}

#[test]
fn every_command_refuses_a_broken_log() -> Done {
    let folder = folder()?;
    let mut table = Table::at_rest(500);
    table.set("dvel_y", 77, f64::INFINITY);
    table.write_csv(&folder.path().join("bad.csv"))?;
    fs::write(folder.path().join("bad.toml"), DESCRIPTION)?;
    let calibration = sinscal(folder.path(), &["calibrate", "log", "--filter", "36d-p", "--json", "c.json"])?;
    assert!(calibration.status.success());
    let row = "bad.csv, line 78, row 77, column `dvel_y`: is inf, a velocity increment in m/s was expected";
    let mut complaints = Vec::new();
    for (arguments, expected) in [
        (&["calibrate", "bad", "--filter", "43d-b", "--smooth"][..], row),
        (&["calibrate", "bad", "--filter", "43d-b", "--form", "ud"], row),
        (&["observe", "bad", "--filter", "43d-b"], row),
        (&["diagnose", "bad", "--filter", "36d-p"], row),
        (&["diagnose", "log", "--filter", "36d-p", "--verify", "bad"], row),
        (&["ablate", "bad"], row),
        (&["ablate", "log", "--swing", "bad"], row),
        (&["navigate", "bad", "--calibration", "c.json"], row),
        (&["calibrate", "none", "--filter", "43d-b"], "none: there is neither none.parquet nor none.csv"),
        (&["observe", "none", "--filter", "43d-b"], "there is neither"),
        (&["diagnose", "none", "--filter", "36d-p"], "there is neither"),
        (&["ablate", "none"], "there is neither"),
        (&["navigate", "none", "--calibration", "c.json"], "there is neither"),
    ] {
        complaints.extend(complaint(
            folder.path(),
            &[arguments, &["--out", "results"]].concat(),
            &[expected],
        )?);
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
    Ok(())
}

#[test]
fn broken_calibrations() -> Done {
    let folder = folder()?;
    let output = sinscal(folder.path(), &["calibrate", "log", "--filter", "36d-p", "--json", "-"])?;
    let sound: Value = serde_json::from_slice(&output.stdout)?;
    let changed = |pointer: &str, value: Value| {
        let mut document = sound.clone();
        if let Some(place) = document.pointer_mut(pointer) {
            *place = value;
        }
        document.to_string()
    };
    let list = sound["parameters"].as_array().ok_or("no parameters")?.clone();
    let twice: Vec<Value> = list.iter().chain(&list[..1]).cloned().collect();
    let cases: Vec<(Vec<u8>, &[&str])> = vec![
        (Vec::new(), &["c.json: is not valid JSON: EOF"]),
        (b"\xff\xfe".into(), &["c.json: is not valid JSON", "line 1"]),
        (DESCRIPTION.into(), &["c.json: is not valid JSON", "`sinscal calibrate --json` writes"]),
        (vec![b'['; 100_000], &["c.json: is not valid JSON: recursion limit"]),
        (sound.to_string().as_bytes()[..700].into(), &["is not valid JSON: EOF", "column 700"]),
        ("[]".into(), &["c.json: holds a list, an object was expected"]),
        ("{}".into(), &["field `filter`: is missing, the name of a filter was expected"]),
        (changed("/filter", json!("36d-q")).into(), &["field `filter`", "did you mean `36d-p`?"]),
        (changed("/filter", json!("43d-b")).into(), &["field `parameters`: `", "of 43d-b is missing"]),
        (changed("/parameters", json!(3)).into(), &["field `parameters`: is a number, a list"]),
        (
            changed("/parameters", json!(twice)).into(),
            &["`parameters[27]`: `gyro-scale x` stands there twice"],
        ),
        (changed("/parameters", json!(list[1..])).into(), &["`gyro-scale x` of 36d-p is missing"]),
        (
            changed("/parameters/0/name", json!("gyro-scal")).into(),
            &["field `parameters[0]`: 36d-p has no parameter `gyro-scal x`", "did you mean `gyro-scale`?"],
        ),
        (
            changed("/parameters/3/component", json!("xx")).into(),
            &["has no parameter `gyro-misalignment xx`", "did you mean `yx`?"],
        ),
        (
            changed("/parameters/0/value", json!("1e-6")).into(),
            &["field `parameters[0].value`: is text, a number"],
        ),
        (changed("/parameters/0/value", json!(1e9)).into(), &["`parameters[0].value`: is 1e9 1, beyond any"]),
        (
            changed("/parameters/0/unit", json!("ppm")).into(),
            &["field `parameters[0].unit`: is \"ppm\", `gyro-scale` is read in \"1\"", "SI units"],
        ),
    ];
    let mut complaints = Vec::new();
    for (bytes, expected) in &cases {
        fs::write(folder.path().join("c.json"), bytes)?;
        let arguments = ["navigate", "log", "--calibration", "c.json", "--out", "results"];
        complaints.extend(complaint(folder.path(), &arguments, expected)?);
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
    fs::write(folder.path().join("c.json"), sound.to_string())?;
    assert!(sinscal(folder.path(), &["navigate", "log", "--calibration", "c.json"])?.status.success());
    Ok(())
}

#[test]
fn broken_scenarios() -> Done {
    let folder = tempfile::tempdir()?;
    let cases: &[(&[u8], &[&str])] = &[
        (b"[imu", &["s.toml: line 1: not valid TOML"]),
        (b"\xff\xfe", &["s.toml: is not text"]),
        (b"[imuu]", &["line 1: imuu is not known", "did you mean `imu`?"]),
        (
            b"[imu]\nrat = \"50 Hz\"",
            &["line 2: imu.rat is not known", "accepted: rate (did you mean `rate`?)"],
        ),
        (b"[imu]\nrate = 50", &["imu.rate is an integer", "a number, a space and its unit in quotes"]),
        (b"[imu]\nrate = \"50Hz\"", &["imu.rate is \"50Hz\"", "a space"]),
        (b"[imu]\nrate = \"50 hz\"", &["one of the units Hz, kHz (did you mean `Hz`?)"]),
        (b"[imu]\nrate = \"nan Hz\"", &["imu.rate is \"nan Hz\"; accepted: more than 0"]),
        (b"[site]\nlatitude = \"95 deg\"", &["line 2: site.latitude", "from -89.9 deg to 89.9 deg"]),
        (
            b"[population]\ngyro-bais = \"1 deg/h\"",
            &["gyro-bais is not an effect", "did you mean `gyro-bias`?"],
        ),
        (b"[population]\ngyro-bias = \"1 deg/hr\"", &["did you mean `deg/h`?"]),
        (b"[population]\ngyro-bias = \"-1 deg/h\"", &["accepted: from 0 to ", " deg/h"]),
        (b"[dither]\namplitude = \"80 rad/s\"", &["dither.amplitude", "from 0 to 4 rad/s"]),
        (b"[temperature]\nstart = \"300 degC\"", &["temperature.start", "from -80 degC to 150 degC"]),
        (b"[motion]\npath = \"eighteen\"", &["did you mean `eighteen-rotations`?"]),
    ];
    let mut complaints = Vec::new();
    for (text, expected) in cases {
        fs::write(folder.path().join("s.toml"), text)?;
        let simulate = ["simulate", "--out", "results/log", "--scenario", "s.toml"];
        complaints.extend(complaint(folder.path(), &simulate, expected)?);
        let campaign = ["campaign", "--units", "1", "--out", "results", "--scenario", "s.toml"];
        complaints.extend(complaint(folder.path(), &campaign, expected)?);
    }
    fs::write(folder.path().join("s.toml"), vec![b'#'; 2 << 20])?;
    let huge = ["simulate", "--out", "results/log", "--scenario", "s.toml"];
    complaints.extend(complaint(folder.path(), &huge, &["s.toml: is larger than 1 MiB"])?);
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
    Ok(())
}

/// Byte order mark, line ends of another system, quotes and spaces are no faults.
#[test]
fn harmless_spellings_are_read() -> Done {
    let folder = folder()?;
    let plain = fs::read_to_string(folder.path().join("log.csv"))?;
    let spelled = plain.replace(',', " , ").replace("dvel_x", "\"dvel_x\"").replace('\n', "\r\n");
    let arguments = ["calibrate", "log", "--filter", "36d-p", "--json", "-"];
    let estimates = || -> Result<Value, Box<dyn std::error::Error>> {
        let output = sinscal(folder.path(), &arguments)?;
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        Ok(serde_json::from_slice::<Value>(&output.stdout)?["parameters"].take())
    };
    let before = estimates()?;
    fs::write(folder.path().join("log.csv"), format!("\u{feff}{spelled}"))?;
    fs::write(folder.path().join("log.toml"), format!("\u{feff}{}", DESCRIPTION.replace('\n', "\r\n")))?;
    assert_eq!(before, estimates()?);
    // and a calibration that an editor has begun with a byte order mark
    assert!(
        sinscal(folder.path(), &["calibrate", "log", "--filter", "36d-p", "--json", "c.json"])?
            .status
            .success()
    );
    let calibration = fs::read_to_string(folder.path().join("c.json"))?;
    fs::write(folder.path().join("c.json"), format!("\u{feff}{calibration}"))?;
    let navigate = sinscal(folder.path(), &["navigate", "log", "--calibration", "c.json"])?;
    assert!(navigate.status.success(), "{}", String::from_utf8_lossy(&navigate.stderr));
    Ok(())
}

/// A filter that reckons with the dither says so where a log tells none.
#[test]
fn a_log_without_dither_is_pointed_out() -> Done {
    let folder = folder()?;
    let warned = |filter: &str| -> Result<bool, Box<dyn std::error::Error>> {
        let output = sinscal(folder.path(), &["calibrate", "log", "--filter", filter])?;
        assert!(output.status.success());
        Ok(String::from_utf8_lossy(&output.stderr)
            .contains("reckons with the dither, and the log tells none"))
    };
    assert_eq!((warned("43d-b")?, warned("43d-p")?), (false, false));
    let mut table = Table::at_rest(500);
    table.drop("dither*");
    table.write_csv(&folder.path().join("log.csv"))?;
    assert_eq!((warned("43d-b")?, warned("43d-p")?), (true, false));
    Ok(())
}

#[test]
fn places_that_cannot_be_written() -> Done {
    let folder = folder()?;
    fs::create_dir(folder.path().join("made"))?;
    let mut complaints = Vec::new();
    for (place, expected) in [
        (["--json", "none/out.json"], "none/out.json: the folder none is not there"),
        (["--json", "made"], "made: is a folder, a file was expected"),
        (["--out", "log.csv"], "log.csv is a file, a folder was expected"),
        (["--json", "/dev/full"], "/dev/full: cannot be written: No space left on device"),
    ] {
        if place[1].starts_with('/') && !Path::new(place[1]).exists() {
            println!("skipped: {} is not here", place[1]);
            continue;
        }
        let arguments = [&["calibrate", "log", "--filter", "36d-p"][..], &place].concat();
        complaints.extend(complaint(folder.path(), &arguments, &[expected])?);
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
    assert_eq!(fs::read_dir(folder.path())?.count(), 3);
    Ok(())
}

/// A full disk behind standard output is a failure; a reader that went away has seen enough.
#[test]
fn standard_output_full_or_closed() -> Done {
    let folder = folder()?;
    let run = |stdout: Stdio| {
        Command::new(env!("CARGO_BIN_EXE_sinscal"))
            .args(["calibrate", "log", "--filter", "36d-p"])
            .current_dir(folder.path())
            .stdin(Stdio::null())
            .stdout(stdout)
            .output()
    };
    if let Ok(full) = fs::File::options().write(true).open("/dev/full") {
        let output = run(full.into())?;
        assert_eq!(output.status.code(), Some(1));
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(message.contains("standard output cannot be written: No space"), "{message}");
    } else {
        println!("skipped: /dev/full is not here");
    }
    let (reader, writer) = std::io::pipe()?;
    drop(reader);
    let output = run(writer.into())?;
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    Ok(())
}
