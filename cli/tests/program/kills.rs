//! Programs that are killed, and programs that get into each other's way.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use crate::support::{DESCRIPTION, Done, Table};

/// A campaign of a second or two.
const SCENARIO: &str = "[motion]\npath = \"swing\"\nstart = \"ENU\"\nduration = \"120 s\"\n";
const UNITS: usize = 16;

fn campaign(folder: &Path, out: &str, more: &[&str]) -> std::io::Result<Child> {
    // not under the eyes of a campaign that is reading it
    let scenario = folder.join("s.toml");
    if !scenario.exists() {
        fs::write(scenario, SCENARIO)?;
    }
    Command::new(env!("CARGO_BIN_EXE_sinscal"))
        .args(["campaign", "--units", &UNITS.to_string(), "--scenario", "s.toml", "--hours", "0"])
        .args(["--filters", "36d-p,43d-b", "--out", out])
        .args(more)
        .current_dir(folder)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
}

/// Every file below a folder with its bytes.
fn contents(folder: &Path) -> Result<BTreeMap<String, Vec<u8>>, Box<dyn std::error::Error>> {
    let mut all = BTreeMap::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if entry.path().is_dir() {
            all.extend(
                contents(&entry.path())?.into_iter().map(|(inner, bytes)| (format!("{name}/{inner}"), bytes)),
            );
        } else {
            all.insert(name, fs::read(entry.path())?);
        }
    }
    Ok(all)
}

/// Starts a program again and again and kills it at moments all over its run, early ones too. A run that ends by itself was given
/// too much time: the machine has become faster.
fn killed(
    times: usize,
    mut whole: Duration,
    start: impl Fn() -> std::io::Result<Child>,
    mut then: impl FnMut() -> Done,
) -> Done {
    let mut state = 1_u64;
    let mut kills = 0;
    for round in 0..1000 {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let part = (state >> 33) as f64 / 2_f64.powi(31);
        let mut child = start()?;
        thread::sleep(whole.mul_f64(if round % 3 == 0 { 0.02 * part } else { part }));
        child.kill()?;
        if child.wait()?.success() {
            whole = whole.mul_f64(0.7);
        } else {
            kills += 1;
        }
        then()?;
        if kills == times {
            return Ok(());
        }
    }
    Err(format!("{kills} kills came in time").into())
}

/// Killed again and again, then let run to its end: not a bit differs from a campaign that was never killed.
#[test]
fn a_campaign_killed_many_times_ends_the_same() -> Done {
    // the same name in two places: reports hold the command line
    let (folder, other) = (tempfile::tempdir()?, tempfile::tempdir()?);
    let started = Instant::now();
    assert!(campaign(other.path(), "out", &[])?.wait()?.success());
    // a quarter of it, so that the campaign does not end after four rounds
    let there = folder.path().join("out");
    killed(
        20,
        started.elapsed() / 4,
        || campaign(folder.path(), "out", &[]),
        || {
            // whatever is there is whole
            for (name, bytes) in if there.exists() { contents(&there)? } else { BTreeMap::new() } {
                if name.ends_with(".json") {
                    serde_json::from_slice::<serde_json::Value>(&bytes)
                        .map_err(|error| format!("{name}: {error}"))?;
                }
            }
            Ok(())
        },
    )?;
    let last = campaign(folder.path(), "out", &[])?.wait_with_output()?;
    assert!(last.status.success(), "{}", String::from_utf8_lossy(&last.stderr));
    let (whole, killed) = (contents(&other.path().join("out"))?, contents(&folder.path().join("out"))?);
    assert!(whole.len() > UNITS && whole.contains_key("summary.json"), "{:?}", whole.keys());
    same(&whole, &killed)
}

/// Whether two folders hold the same files with the same bytes, apart from the time that a run took.
fn same(whole: &BTreeMap<String, Vec<u8>>, killed: &BTreeMap<String, Vec<u8>>) -> Done {
    let untimed = |bytes: &[u8]| {
        let text = String::from_utf8_lossy(bytes).into_owned();
        let lines = text.lines().filter(|line| !line.contains("\"wall_s\"") && !line.contains("computed in"));
        lines.collect::<Vec<_>>().join("\n")
    };
    assert_eq!(whole.keys().collect::<Vec<_>>(), killed.keys().collect::<Vec<_>>());
    for (name, bytes) in whole {
        let other = killed.get(name).ok_or("a file is missing")?;
        assert!(bytes == other || untimed(bytes) == untimed(other), "{name} differs");
    }
    Ok(())
}

/// Every other command that takes its time: killed and started again it leaves what one that was never killed does, and nothing of
/// those that were.
#[test]
fn killed_runs_leave_nothing_and_change_nothing() -> Done {
    let (folder, other) = (tempfile::tempdir()?, tempfile::tempdir()?);
    for place in [&folder, &other] {
        fs::write(place.path().join("s.toml"), SCENARIO)?;
        fs::write(place.path().join("log.toml"), DESCRIPTION)?;
        Table::at_rest(3000).write_csv(&place.path().join("log.csv"))?;
    }
    let start = |place: &Path, arguments: &str| {
        Command::new(env!("CARGO_BIN_EXE_sinscal"))
            .args(arguments.split(' '))
            .current_dir(place)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
    };
    for command in [
        "calibrate log --filter 43d-b --smooth --out out --json c.json",
        "simulate --scenario s.toml --out out/log",
        "campaign map --units 1 --factors 1 --hours 0.1 --scenario s.toml --out out",
        "paper --units 1 --hours 0.1 --scenario s.toml --out out",
    ] {
        let started = Instant::now();
        assert!(start(other.path(), command)?.wait()?.success(), "{command}");
        killed(3, started.elapsed(), || start(folder.path(), command), || Ok(()))?;
        assert!(start(folder.path(), command)?.wait()?.success(), "{command}");
        same(&contents(other.path())?, &contents(folder.path())?)
            .map_err(|error| format!("{command}: {error}"))?;
        for place in [&folder, &other] {
            fs::remove_dir_all(place.path().join("out"))?;
        }
    }
    Ok(())
}

/// Whether the program that is started here will ignore a signal, as what a shell starts in the background ignores an interrupt.
#[cfg(target_os = "linux")]
fn inherits_ignored(signal: i32) -> Result<bool, Box<dyn std::error::Error>> {
    let status = fs::read_to_string("/proc/self/status")?;
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:")).ok_or("no SigIgn")?;
    Ok(u64::from_str_radix(ignored.trim(), 16)? >> (signal - 1) & 1 == 1)
}

/// Told to stop while a file is being written, a program leaves none behind and ends as others do; what it was started to ignore it
/// ignores.
#[cfg(target_os = "linux")]
#[test]
fn signals_leave_no_half_written_file() -> Done {
    use std::os::unix::process::{CommandExt, ExitStatusExt};

    let parts = |folder: &Path| -> Result<usize, Box<dyn std::error::Error>> {
        Ok(contents(folder)?.keys().filter(|name| name.ends_with(".part")).count())
    };
    let simulate = "simulate --out log";
    for (name, number) in [("INT", 2), ("TERM", 15), ("HUP", 1)] {
        for ignored in [false, true] {
            if !ignored && inherits_ignored(number)? {
                println!("skipped: SIG{name} is ignored where the tests were started");
                continue;
            }
            let folder = tempfile::tempdir()?;
            let trap = if ignored { format!("trap '' {name};") } else { String::new() };
            let script = format!("{trap} exec \"$0\" {simulate}");
            let mut child = Command::new("sh")
                .args(["-c", &script, env!("CARGO_BIN_EXE_sinscal")])
                .current_dir(folder.path())
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .process_group(0)
                .spawn()?;
            while parts(folder.path())? == 0 {
                assert!(child.try_wait()?.is_none(), "{name}: it ended before anything was seen of it");
                thread::sleep(Duration::from_millis(1));
            }
            assert!(
                Command::new("kill").arg(format!("-{name}")).arg(child.id().to_string()).status()?.success()
            );
            let status = child.wait()?;
            if ignored {
                assert!(status.success() && folder.path().join("log.parquet").exists(), "{name}: {status}");
            } else {
                assert_eq!(status.signal(), Some(number), "{name}: {status}");
                assert_eq!(parts(folder.path())?, 0, "{name}");
                assert!(!folder.path().join("log.parquet").exists());
            }
        }
    }
    Ok(())
}

/// A second campaign is refused while the first is at work in the folder; shards share it.
#[test]
fn two_campaigns_do_not_share_a_folder_but_shards_do() -> Done {
    let folder = tempfile::tempdir()?;
    assert!(campaign(folder.path(), "out", &[])?.wait()?.success());
    // as a campaign at work holds it
    let plan = fs::File::open(folder.path().join("out/plan.json"))?;
    plan.lock()?;
    let second = campaign(folder.path(), "out", &[])?.wait_with_output()?;
    let message = String::from_utf8_lossy(&second.stderr);
    assert_eq!(second.status.code(), Some(1));
    assert!(message.contains("out: another campaign is at work in this folder"), "{message}");
    assert!(message.contains("--shard"), "{message}");
    plan.unlock()?;

    let shards = ["1/2", "2/2"].map(|part| campaign(folder.path(), "shared", &["--shard", part]));
    for shard in shards {
        let done = shard?.wait_with_output()?;
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    }
    let merge = Command::new(env!("CARGO_BIN_EXE_sinscal"))
        .args(["campaign", "merge", "shared", "--out", "merged"])
        .current_dir(folder.path())
        .output()?;
    assert!(merge.status.success(), "{}", String::from_utf8_lossy(&merge.stderr));
    let (out, merged) = (folder.path().join("out"), folder.path().join("merged"));
    for name in ["summary.json", "summary.txt", "filters.parquet", "parameters.parquet"] {
        assert!(fs::read(out.join(name))? == fs::read(merged.join(name))?, "{name} differs");
    }
    Ok(())
}

/// Calibrations that end in one folder at the same time leave the files of one of them.
#[test]
fn results_of_two_runs_are_not_mixed() -> Done {
    let folder = tempfile::tempdir()?;
    fs::write(folder.path().join("log.toml"), DESCRIPTION)?;
    Table::at_rest(500).write_csv(&folder.path().join("log.csv"))?;
    let run = |filter: &str| {
        Command::new(env!("CARGO_BIN_EXE_sinscal"))
            .args(["calibrate", "log", "--filter", filter, "--out", "out"])
            .current_dir(folder.path())
            .stdout(Stdio::null())
            .spawn()
    };
    for _ in 0..5 {
        for child in [run("36d-p")?, run("43d-b")?, run("36d-p")?, run("43d-b")?].iter_mut() {
            assert!(child.wait()?.success());
        }
        let calibration: serde_json::Value =
            serde_json::from_slice(&fs::read(folder.path().join("out/calibration.json"))?)?;
        let history = fs::read_to_string(folder.path().join("out/history.csv"))?;
        let columns = history.lines().next().map_or(0, |line| line.split(',').count());
        assert_eq!(calibration["parameters"].as_array().map(|list| 1 + 2 * list.len()), Some(columns));
    }
    let there = contents(&folder.path().join("out"))?;
    assert!(there.keys().all(|name| !name.contains(".part")), "{:?}", there.keys());
    Ok(())
}

/// A file that is still being written is not taken for one that was left behind.
#[test]
fn what_is_at_work_is_not_swept() -> Done {
    let folder = tempfile::tempdir()?;
    fs::write(folder.path().join("log.toml"), DESCRIPTION)?;
    Table::at_rest(500).write_csv(&folder.path().join("log.csv"))?;
    let (left, at_work) =
        (folder.path().join(".sinscal-left.part"), folder.path().join(".sinscal-busy.part"));
    fs::write(&left, "half a")?;
    fs::write(folder.path().join(".other.part"), "somebody else's")?;
    let busy = fs::File::create(&at_work)?;
    busy.lock()?;
    let run = Command::new(env!("CARGO_BIN_EXE_sinscal"))
        .args(["calibrate", "log", "--filter", "36d-p", "--json", "c.json"])
        .current_dir(folder.path())
        .output()?;
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    assert!(!left.exists() && at_work.exists() && folder.path().join(".other.part").exists());
    Ok(())
}
