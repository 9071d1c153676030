//! How the program behaves at a terminal: help, width, colours, and how much it says.

use std::fs;
use std::process::{Command, Output};

use crate::support::{DESCRIPTION, Done, Table};

fn sinscal(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sinscal"));
    command.args(arguments);
    command
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

const COMMANDS: [&str; 12] = [
    "demo",
    "simulate",
    "calibrate",
    "diagnose",
    "ablate",
    "observe",
    "navigate",
    "campaign",
    "paper",
    "filters",
    "effects",
    "completions",
];

#[test]
fn every_help_has_examples_and_exit_codes_are_told() -> Done {
    let help = text(&sinscal(&["--help"]).output()?.stdout);
    for told in
        ["Exit codes: 0", "1 bad input", "2 bad usage", "NO_COLOR", "--quiet", "--verbose", "Examples:"]
    {
        assert!(help.contains(told), "{told}: {help}");
    }
    for command in COMMANDS {
        assert!(help.contains(command), "{command}");
        let help = text(&sinscal(&[command, "--help"]).output()?.stdout);
        let plain = ["filters", "effects"].contains(&command);
        assert!(plain || help.contains(&format!("  sinscal {command}")), "{command}: {help}");
    }
    Ok(())
}

#[test]
fn lines_are_as_wide_as_the_terminal() -> Done {
    for arguments in [&["calibrate", "--help"][..], &["effects"], &["filters"]] {
        let of = |columns: &str| sinscal(arguments).env("COLUMNS", columns).output();
        let widest =
            |output: &Output| text(&output.stdout).lines().map(|l| l.chars().count()).max().unwrap_or(0);
        let (narrow, wide) = (of("70")?, of("200")?);
        // examples are to be copied and stay in one line
        let allowed = if arguments[0] == "calibrate" { 125 } else { 70 };
        assert!(widest(&narrow) <= allowed, "{arguments:?}: {}", text(&narrow.stdout));
        assert!(text(&narrow.stdout).lines().count() > text(&wide.stdout).lines().count(), "{arguments:?}");
    }
    // into a file or a pipe each entry stays in its line
    let piped = sinscal(&["filters"]).env_remove("COLUMNS").output()?;
    assert!(text(&piped.stdout).lines().any(|line| line.len() > 120));
    Ok(())
}

#[test]
fn quiet_and_verbose() -> Done {
    let folder = tempfile::tempdir()?;
    let at = |name: &str| folder.path().join(name).display().to_string();
    fs::write(folder.path().join("log.toml"), DESCRIPTION)?;
    Table::at_rest(6000).write_csv(&folder.path().join("log.csv"))?;
    let (log, out) = (at("log"), at("out"));
    let run =
        |more: &[&str]| sinscal(&[&["calibrate", &log, "--filter", "36d-p"][..], more].concat()).output();

    let usual = run(&["--json", "-"])?;
    assert!(text(&usual.stderr).contains("36d-p cannot be judged"), "{}", text(&usual.stderr));
    let quiet = run(&["--json", "-", "--quiet"])?;
    assert!(quiet.status.success() && quiet.stderr.is_empty(), "{}", text(&quiet.stderr));
    let verbose = run(&["-v", "--out", &out])?;
    let said = text(&verbose.stderr);
    for told in ["reading", "log.csv", "pass 1 of 2", "pass 2 of 2", "wrote", "report.html"] {
        assert!(said.contains(told), "{told}: {said}");
    }

    // what is wrong is said however quiet
    fs::write(folder.path().join("log.toml"), DESCRIPTION.replace("rate_hz = 50.0", "rate_hz = \"fast\""))?;
    let wrong = run(&["-q"])?;
    assert_eq!(wrong.status.code(), Some(1));
    assert!(text(&wrong.stderr).contains("rate_hz"), "{}", text(&wrong.stderr));
    assert_eq!(run(&["-q", "-v"])?.status.code(), Some(2));
    Ok(())
}

/// What the program writes to a terminal of its own, where the system can give it one.
fn at_a_terminal(arguments: &str, environment: &[(&str, &str)]) -> Option<String> {
    let call = format!("{} {arguments}", env!("CARGO_BIN_EXE_sinscal"));
    let mut script = Command::new("script");
    script.args(["-qec", &call, "/dev/null"]).env("TERM", "xterm-256color").env_remove("NO_COLOR");
    let output = script.envs(environment.iter().copied()).output().ok()?;
    Some(text(&output.stdout))
}

#[test]
fn colours_only_where_they_are_wanted() -> Done {
    let Some(coloured) = at_a_terminal("calibrate nowhere --filter 36d-p", &[]) else {
        println!("skipped: `script` is not there to make a terminal");
        return Ok(());
    };
    assert!(coloured.contains("nowhere") && coloured.contains("\u{1b}[31m"), "{coloured:?}");
    for arguments in ["calibrate nowhere --filter 36d-p", "calibrate --filter"] {
        let plain = at_a_terminal(arguments, &[("NO_COLOR", "1")]).unwrap_or_default();
        assert!(!plain.is_empty() && !plain.contains("\u{1b}["), "{plain:?}");
    }
    let piped = sinscal(&["calibrate", "nowhere", "--filter", "36d-p"]).output()?;
    assert!(!text(&piped.stderr).contains('\u{1b}'));
    Ok(())
}
