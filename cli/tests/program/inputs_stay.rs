//! What a command reads it never writes over, by whatever name; links are followed, devices and pipes written to.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use crate::support::{DESCRIPTION, Done, Table};

const SCENARIO: &str = "[motion]\npath = \"still\"\nduration = \"60 s\"\n";

fn sinscal(folder: &Path, arguments: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sinscal"));
    command.args(arguments.split(' ')).current_dir(folder);
    command
}

fn run(folder: &Path, arguments: &str) -> std::io::Result<Output> {
    sinscal(folder, arguments).output()
}

/// A log, a calibration of it, a scenario, and a campaign's folder.
fn place() -> Result<tempfile::TempDir, Box<dyn std::error::Error>> {
    let folder = tempfile::tempdir()?;
    let at = folder.path();
    fs::write(at.join("m.toml"), DESCRIPTION)?;
    let table = Table::at_rest(3000);
    table.write_csv(&at.join("m.csv"))?;
    table.write_csv(&at.join("swing.csv"))?;
    fs::write(at.join("swing.toml"), DESCRIPTION)?;
    fs::write(at.join("m.truth.json"), "{ \"accel-bias\": [0.0, 0.0, 0.0] }\n")?;
    fs::write(at.join("s.toml"), SCENARIO)?;
    assert!(run(at, "calibrate m --filter 36d-p --json c.json -q")?.status.success());
    Ok(folder)
}

#[test]
fn no_command_writes_over_what_it_reads() -> Done {
    let folder = place()?;
    let at = folder.path();
    fs::hard_link(at.join("m.csv"), at.join("second.csv"))?;
    #[cfg(unix)]
    std::os::unix::fs::symlink("m.toml", at.join("link.toml"))?;
    let results = "history.csv";
    for (command, input) in [
        ("calibrate m --filter 36d-p --json m.csv", "m.csv"),
        ("calibrate m --filter 36d-p --json ./m.toml", "m.toml"),
        ("calibrate m --filter 36d-p --json m.truth.json", "m.truth.json"),
        ("calibrate m --filter 36d-p --json second.csv", "m.csv"),
        #[cfg(unix)]
        ("calibrate m --filter 36d-p --json link.toml", "m.toml"),
        ("observe m --filter 36d-p --json m.csv", "m.csv"),
        ("look m.csv --json m.csv", "m.csv"),
        ("look m --json m.toml", "m.toml"),
        ("diagnose m --filter 36d-p --json m.csv", "m.csv"),
        ("diagnose m --filter 36d-p --verify swing --json swing.csv", "swing.csv"),
        ("ablate m --json m.csv", "m.csv"),
        ("ablate m --swing swing --json swing.toml", "swing.toml"),
        ("navigate swing --calibration c.json --align 10 --json c.json", "c.json"),
        ("navigate swing --calibration c.json --align 10 --json swing.csv", "swing.csv"),
        ("export c.json --format c --out c.json", "c.json"),
        ("campaign --units 1 --scenario s.toml --hours 0 --json s.toml", "s.toml"),
        ("campaign --units 1 --swing s.toml --hours 0 --json s.toml", "s.toml"),
        ("campaign map --units 1 --factors 1 --hours 0.1 --scenario s.toml --json s.toml", "s.toml"),
        ("paper --units 1 --hours 0.1 --scenario s.toml --json s.toml", "s.toml"),
        ("simulate --scenario s.toml --out s", "s.toml"),
        ("calibrate results/history --filter 36d-p --out results", results),
    ] {
        if input == results {
            fs::create_dir(at.join("results"))?;
            fs::copy(at.join("m.csv"), at.join("results/history.csv"))?;
            fs::copy(at.join("m.toml"), at.join("results/history.toml"))?;
        }
        let input = if input == results { at.join("results/history.csv") } else { at.join(input) };
        let before = fs::read(&input)?;
        let done = run(at, command)?;
        let said = String::from_utf8_lossy(&done.stderr);
        assert_eq!(done.status.code(), Some(1), "{command}: {said}");
        assert!(said.contains("is read by this command"), "{command}: {said}");
        assert!(fs::read(&input)? == before, "{command}: the input is gone");
    }
    Ok(())
}

#[test]
fn units_that_are_merged_stay() -> Done {
    let folder = place()?;
    let at = folder.path();
    let campaign = "campaign --units 1 --filters 36d-p --scenario s.toml --hours 0 --out runs -q";
    assert!(run(at, campaign)?.status.success());
    for input in ["runs/units/unit-000001.json", "runs/plan.json"] {
        let before = fs::read(at.join(input))?;
        let done = run(at, &format!("campaign merge runs --json {input}"))?;
        assert_eq!(done.status.code(), Some(1), "{}", String::from_utf8_lossy(&done.stderr));
        assert!(fs::read(at.join(input))? == before);
    }
    Ok(())
}

/// Simulating again replaces what was simulated before, and nothing else.
#[test]
fn simulate_replaces_only_what_it_wrote() -> Done {
    let folder = place()?;
    let at = folder.path();
    for _ in 0..2 {
        let done = run(at, "simulate --scenario s.toml --out mine")?;
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    }
    for (ending, content) in [
        ("toml", DESCRIPTION),
        ("parquet", "PAR1 a log that took a week PAR1"),
        ("truth.json", "{ \"measured by hand\": [1.0] }"),
        ("html", "<html><title>My notes</title></html>"),
    ] {
        let other = at.join("other").with_extension(ending);
        fs::write(&other, content)?;
        let done = run(at, "simulate --scenario s.toml --out other")?;
        let said = String::from_utf8_lossy(&done.stderr);
        assert_eq!(done.status.code(), Some(1), "{ending}: {said}");
        assert!(
            said.contains(&format!("other.{ending}")) && said.contains("did not write this file"),
            "{said}"
        );
        assert_eq!(fs::read_to_string(&other)?, content, "{ending}");
        fs::remove_file(&other)?;
    }
    assert!(!at.join("other.parquet").exists());
    Ok(())
}

#[cfg(unix)]
#[test]
fn links_are_followed_and_pipes_are_written_to() -> Done {
    use std::os::unix::fs::symlink;

    let folder = place()?;
    let at = folder.path();
    let calibrate = |to: &str| format!("calibrate m --filter 36d-p -q --json {to}");
    // an existing file behind a link, and one that is not there yet
    fs::create_dir(at.join("far"))?;
    fs::write(at.join("far/old.json"), "old")?;
    symlink("far/old.json", at.join("old"))?;
    symlink("far/new.json", at.join("new"))?;
    symlink("old", at.join("twice"))?;
    for (link, file) in [("old", "far/old.json"), ("new", "far/new.json"), ("twice", "far/old.json")] {
        fs::write(at.join("far/old.json"), "old")?;
        assert!(run(at, &calibrate(link))?.status.success());
        assert!(at.join(link).is_symlink(), "{link} was replaced");
        assert!(fs::read_to_string(at.join(file))?.contains("\"nis_per_dof\""), "{file}");
    }
    // a circle leads nowhere
    symlink("a", at.join("b"))?;
    symlink("b", at.join("a"))?;
    assert_eq!(run(at, &calibrate("a"))?.status.code(), Some(1));

    // standard output by another name, as a pipe and as a file: the table follows the JSON
    symlink("/proc/self/fd/1", at.join("so"))?;
    let piped = run(at, &calibrate("so"))?;
    let both = String::from_utf8(piped.stdout)?;
    assert!(both.starts_with('{') && both.contains("\n36d-p "), "{both}");
    let out = fs::File::create(at.join("out.txt"))?;
    assert!(sinscal(at, &calibrate("so")).stdout(Stdio::from(out)).status()?.success());
    let untimed = |text: &str| -> Vec<String> {
        let lines = text.lines().filter(|line| !line.contains("wall_s") && !line.contains("computed in"));
        lines.map(str::to_owned).collect()
    };
    assert_eq!(untimed(&fs::read_to_string(at.join("out.txt"))?), untimed(&both));
    assert!(at.join("so").is_symlink());
    assert!(run(at, &calibrate("/dev/null"))?.status.success());
    Ok(())
}
