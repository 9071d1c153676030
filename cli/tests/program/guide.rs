//! The guide and the README do what they say: every command is run, on short logs, and every error message of the chapter on
//! failures is what the program prints. A long test runs the guide as it is written and compares what is printed.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::support::{Done, Table};

/// Turns about all axes in four minutes.
pub(crate) const TURNS: &str = r#"
[imu]
rate = "10 Hz"
[motion]
path = "turns"
still = "60 s"
dwell = "20 s"
turns = [
  { axis = "x", angle = "90 deg" }, { axis = "y", angle = "90 deg" }, { axis = "z", angle = "90 deg" },
  { axis = "x", angle = "180 deg" }, { axis = "y", angle = "180 deg" }, { axis = "z", angle = "180 deg" },
]
"#;
/// What takes minutes is tested elsewhere.
const LONG: [&str; 4] = ["demo", "campaign", "paper", "diagnose --self-test"];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Chapters of the guide by name, in order.
fn chapters() -> Result<Vec<(String, String)>, Box<dyn Error>> {
    let mut chapters = Vec::new();
    for entry in fs::read_dir(root().join("docs/guide"))? {
        let path = entry?.path();
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default().to_owned();
        chapters.push((name, fs::read_to_string(&path)?));
    }
    chapters.sort();
    assert!(chapters.len() > 10);
    Ok(chapters)
}

/// Fenced blocks of a text: what they are, and their lines.
fn blocks(text: &str) -> Vec<(&str, Vec<&str>)> {
    let mut blocks = Vec::new();
    let mut open: Option<(&str, Vec<&str>)> = None;
    for line in text.lines() {
        match (line.strip_prefix("```"), open.as_mut()) {
            (Some(kind), None) => open = Some((kind, Vec::new())),
            (Some(_), Some(_)) => blocks.extend(open.take()),
            (None, Some((_, lines))) => lines.push(line),
            (None, None) => {}
        }
    }
    blocks
}

/// The commands of a block of shell lines, without their comments.
fn commands<'a>(block: &(&str, Vec<&'a str>)) -> Vec<Vec<&'a str>> {
    let call = |line: &&'a str| {
        let line = line.split(" #").next().unwrap_or_default().trim();
        let words = line.strip_prefix("sinscal ").or_else(|| line.strip_prefix("cargo run --release -- "))?;
        Some(words.split_whitespace().collect())
    };
    if block.0 == "sh" { block.1.iter().filter_map(call).collect() } else { Vec::new() }
}

fn run(folder: &Path, words: &[&str]) -> std::io::Result<Output> {
    Command::new(env!("CARGO_BIN_EXE_sinscal")).args(words).current_dir(folder).output()
}

fn said(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

/// The folder that the second chapter ends with: `mine.csv` with its columns and `mine.toml` as it stands there.
fn mine(folder: &Path, chapter: &str) -> Done {
    let all = blocks(chapter);
    let block =
        |kind: &str| all.iter().find(|block| block.0 == kind).map(|block| &block.1).ok_or("no such block");
    let header: Vec<&str> = block("csv")?[0].split(',').collect();
    let mut table = Table::at_rest(3000);
    table.columns.retain(|(name, _)| header.contains(&name.as_str()));
    assert_eq!(table.columns.len(), header.len(), "columns of no log: {header:?}");
    table.write_csv(&folder.join("mine.csv"))?;
    Ok(fs::write(folder.join("mine.toml"), block("toml")?.join("\n"))?)
}

/// Runs what a text says, each in order, where its files are; simulations are cut short.
fn run_all(text: &str, folder: &Path) -> Done {
    simulated(folder, "turned", "")?;
    for words in blocks(text).iter().flat_map(commands) {
        if LONG.iter().any(|long| words.join(" ").starts_with(long)) {
            continue;
        }
        // so short a log confirms nothing; the long test runs it
        if words.iter().any(|word| word.ends_with("diagnosis.json")) {
            continue;
        }
        // a log that rests and turns, for what asks for one
        let coarse = words.contains(&"--coarse");
        // names that stand for something
        let mut words: Vec<&str> = words
            .iter()
            .map(|word| match *word {
                "LOG" | "LOG2" => "runs/unit-3",
                "monday" => "mine",
                "friday" => "turned",
                "FILE.json" | "A.json" | "B.json" => "results/calibration.json",
                "DIR" => "results",
                "DIR/NAME" => "runs/unit-3",
                "mine" if coarse => "turned",
                "941s" | "30min" => "200s",
                word => word,
            })
            .collect();
        match words[0] {
            "simulate" if !words.contains(&"--scenario") => words.extend(["--scenario", "short.toml"]),
            "plan" if words.contains(&"--duration") => words.extend(["--evaluations", "64", "--verify", "1"]),
            "navigate" | "ablate" => words.extend(["--align", "30"]),
            _ => {}
        }
        let output = run(folder, &words)?;
        assert!(output.status.success(), "{words:?}: {}", said(&output));
    }
    Ok(())
}

#[test]
fn every_command_of_the_guide_runs() -> Done {
    for (name, chapter) in chapters()? {
        let folder = tempfile::tempdir()?;
        if name.starts_with("02") {
            mine(folder.path(), &chapter)?;
        }
        run_all(&chapter, folder.path()).map_err(|error| format!("{name}: {error}"))?;
    }
    Ok(())
}

#[test]
fn every_command_of_the_readme_runs() -> Done {
    let folder = tempfile::tempdir()?;
    run_all(
        &format!(
            "```sh\nsinscal simulate --out DIR/NAME\n```\n{}",
            fs::read_to_string(root().join("README.md"))?
        ),
        folder.path(),
    )
}

/// The name by which a heading is linked to.
fn anchor(heading: &str) -> String {
    let kept = heading.trim_start_matches('#').trim().to_lowercase();
    kept.chars()
        .filter(|c| c.is_alphanumeric() || " -_".contains(*c))
        .map(|c| if c == ' ' { '-' } else { c })
        .collect()
}

#[test]
fn every_link_of_the_guide_leads_somewhere() -> Done {
    for (name, chapter) in chapters()? {
        for target in chapter.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            if target.contains("://") {
                continue;
            }
            let (file, place) = target.split_once('#').unwrap_or((target, ""));
            let text = fs::read_to_string(root().join("docs/guide").join(file))
                .map_err(|error| format!("{name}: {target}: {error}"))?;
            let there = |line: &str| line.starts_with('#') && anchor(line) == place;
            assert!(place.is_empty() || text.lines().any(there), "{name}: no heading for {target}");
        }
    }
    Ok(())
}

/// Whether a line is printed but for its last digits, which depend on the machine.
fn alike(line: &str, printed: &str) -> bool {
    let number = |word: &str| word.trim_end_matches([',', ':']).parse::<f64>().ok();
    let (a, b): (Vec<&str>, Vec<&str>) =
        (line.split_whitespace().collect(), printed.split_whitespace().collect());
    // a line of the guide may end before the printed one does
    a.len() <= b.len()
        && a.iter().zip(b).all(|(a, b)| match (number(a), number(b)) {
            (Some(a), Some(b)) => (a - b).abs() <= 0.03 * a.abs().max(b.abs()).max(0.1),
            _ => *a == b || (a.ends_with(',') && b.starts_with(a.trim_end_matches(','))),
        })
}

/// As it is written, with whole logs: a minute in a release build.
#[test]
#[ignore = "runs the guide as it is written: a minute in a release build"]
fn the_guide_prints_what_it_says() -> Done {
    for (name, chapter) in chapters()?.into_iter().take(6) {
        let folder = tempfile::tempdir()?;
        let mut printed = String::new();
        for block in blocks(&chapter) {
            for words in commands(&block) {
                if words.iter().any(|word| ["mine", "monday"].contains(word))
                    || LONG.iter().any(|long| words.join(" ").starts_with(long))
                {
                    continue;
                }
                let output = run(folder.path(), &words)?;
                assert!(output.status.success(), "{name}: {words:?}: {}", said(&output));
                printed = said(&output);
            }
            if block.0 == "text" && !printed.is_empty() {
                for line in block.1.iter().filter(|line| !line.is_empty() && **line != "...") {
                    let found = printed.lines().any(|printed| alike(line, printed));
                    let within = printed.contains(line.trim_end_matches(','));
                    assert!(found || within, "{name}: `{line}` is not in\n{printed}");
                }
            }
        }
    }
    Ok(())
}

/// A mistake of the chapter on failures.
type Mistake = fn(&Path) -> Result<Vec<&'static str>, Box<dyn Error>>;

/// A sound log `mine`, with its table and its description changed.
fn change(folder: &Path, table: impl Fn(&mut Table), description: impl Fn(String) -> String) -> Done {
    let mut log = Table::at_rest(3000);
    log.drop("ref_*");
    table(&mut log);
    log.write_csv(&folder.join("mine.csv"))?;
    let sound = "[imu]\nrate_hz = 50.0\n[site]\nlatitude_deg = 32.06\nlongitude_deg = 118.8\nheight_m = 20.0\n\
                 [noise]\ngyro_arw_deg_sqrt_h = 0.001\naccel_vrw_ug_sqrt_hz = 5.0\n";
    Ok(fs::write(folder.join("mine.toml"), description(sound.into()))?)
}

const CALIBRATE: &[&str] = &["calibrate", "mine", "--filter", "36d-p"];

fn mistakes() -> Vec<Mistake> {
    vec![
        |folder| {
            change(folder, |_| {}, |text| text)?;
            fs::remove_file(folder.join("mine.toml"))?;
            Ok(CALIBRATE.into())
        },
        |_| Ok(vec!["calibrate", "nowhere", "--filter", "36d-p"]),
        |folder| {
            change(folder, |_| {}, |text| text)?;
            Table::at_rest(100).write_parquet(&folder.join("mine.parquet"), None)?;
            Ok(CALIBRATE.into())
        },
        |folder| {
            change(folder, |_| {}, |text| text)?;
            fs::remove_file(folder.join("mine.csv"))?;
            let whole = folder.join("whole.parquet");
            Table::at_rest(3000).write_parquet(&whole, None)?;
            let bytes = fs::read(whole)?;
            fs::write(folder.join("mine.parquet"), &bytes[..bytes.len() / 2])?;
            Ok(CALIBRATE.into())
        },
        |folder| {
            change(folder, |_| {}, |text| text.replace("rate_hz", "rate"))?;
            Ok(CALIBRATE.into())
        },
        |folder| {
            change(folder, |_| {}, |text| text.split("[site]").next().unwrap_or_default().into())?;
            Ok(CALIBRATE.into())
        },
        |folder| {
            change(folder, |_| {}, |text| text.replace("50.0", "100.0"))?;
            Ok(CALIBRATE.into())
        },
        |folder| {
            let prior = "[prior]\n\"accel-bias\" = { sigma = 3.0, unit = \"m/s2\" }\n";
            change(folder, |_| {}, |text| text + prior)?;
            Ok(CALIBRATE.into())
        },
        |folder| {
            change(folder, |table| table.set("dtheta_x", 17, f64::NAN), |text| text)?;
            Ok(CALIBRATE.into())
        },
        |folder| {
            change(folder, |table| table.drop_rows(101..=140), |text| text)?;
            Ok(CALIBRATE.into())
        },
        |folder| {
            change(folder, |table| table.map("dtheta_y", |_, value| 2e6 * value), |text| text)?;
            Ok(CALIBRATE.into())
        },
        |folder| {
            change(folder, |table| table.map("dvel_*", |_, value| 50.0 * value), |text| text)?;
            Ok(CALIBRATE.into())
        },
        |folder| {
            change(folder, |table| table.rename("time_s", "time"), |text| text)?;
            Ok(CALIBRATE.into())
        },
        |folder| {
            change(folder, |_| {}, |text| text.replace("sqrt_h = 0.001", "sqrt_h = 3.0"))?;
            Ok(CALIBRATE.into())
        },
        |folder| {
            let nothing = |table: &mut Table| {
                let rows = table.columns[0].1.len();
                for name in ["ref_vel_e", "ref_vel_n", "ref_vel_u"] {
                    table.columns.push((name.into(), vec![f64::NAN; rows]));
                }
            };
            change(folder, nothing, |text| text)?;
            Ok(vec!["calibrate", "mine", "--filter", "mems-30d"])
        },
        |folder| {
            simulated(folder, "mine", "")?;
            let path = folder.join("mine.toml");
            let text = fs::read_to_string(&path)?
                .replace("velocity_sigma_m_s = 0.001", "velocity_sigma_m_s = 0.00001");
            fs::write(path, text)?;
            Ok(CALIBRATE.into())
        },
        |folder| {
            simulated(folder, "mine", "[population]\naccel-delay = \"5 ms\"\n")?;
            Ok([CALIBRATE, &["--passes", "1"]].concat())
        },
        |folder| {
            simulated(folder, "mine", "[population]\naccel-scale = \"20000 ppm\"\n")?;
            Ok(CALIBRATE.into())
        },
        |folder| {
            change(folder, |_| {}, |text| text)?;
            Ok(vec!["calibrate", "mine", "--filter", "36d-p", "--coarse"])
        },
        |folder| {
            change(folder, |_| {}, |text| text)?;
            Ok(vec!["navigate", "mine", "--calibration", "mine.toml"])
        },
        |folder| {
            change(folder, |_| {}, |text| text)?;
            Ok(vec!["calibrate", "mine", "--filter", "36d-p", "--out", "mine.toml"])
        },
        |_| Ok(vec!["calibrate", "mine", "--filter", "43d-c"]),
    ]
}

/// A simulated log of four minutes; `more` is added to its scenario.
fn simulated(folder: &Path, name: &str, more: &str) -> Done {
    fs::write(folder.join("short.toml"), format!("{TURNS}{more}"))?;
    let output = run(folder, &["simulate", "--scenario", "short.toml", "--out", name])?;
    if output.status.success() { Ok(()) } else { Err(said(&output).into()) }
}

#[test]
fn error_messages_are_those_of_the_guide() -> Done {
    let chapters = chapters()?;
    let (_, text) =
        chapters.iter().find(|(name, _)| name.contains("failures")).ok_or("no chapter on failures")?;
    let quoted: Vec<Vec<&str>> =
        blocks(text).into_iter().filter(|block| block.0 == "text").map(|block| block.1).collect();
    let mistakes = mistakes();
    assert_eq!(quoted.len(), mistakes.len(), "a mistake for each quoted message, in the same order");
    for (quoted, mistake) in quoted.iter().zip(mistakes) {
        let folder = tempfile::tempdir()?;
        let words = mistake(folder.path())?;
        let said = said(&run(folder.path(), &words)?);
        for line in quoted {
            assert!(said.contains(line), "`{line}` is not in\n{said}");
        }
    }
    Ok(())
}
