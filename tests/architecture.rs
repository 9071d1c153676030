//! What docs/ARCHITECTURE.md says of the crates: who knows whom, and what is absent.

use std::fs;
use std::path::{Path, PathBuf};

/// Our crates, each after all that it may know, with its manifest's folder and that of its sources.
const CRATES: [(&str, &str, &str); 12] = [
    ("calib-core", "calib-core", "calib-core/src"),
    ("state-macro", "state-macro", "state-macro/src"),
    ("sinscal", ".", "models"),
    ("noise", "noise", "noise/src"),
    ("logs", "logs", "logs/src"),
    ("runs", "runs", "runs/src"),
    ("rig", "rig", "rig/src"),
    ("gap", "gap", "gap/src"),
    ("study", "study", "study/src"),
    ("plan", "plan", "plan/src"),
    ("reports", "reports", "reports/src"),
    ("sinscal-cli", "cli", "cli/src"),
];

/// What a crate does without, whatever else it comes to know.
const APART: [(&str, &[&str]); 10] = [
    ("calib-core", &["state-macro", "sinscal"]),
    ("sinscal", &["logs", "rig"]),
    ("noise", &["calib-core", "state-macro", "sinscal"]),
    ("logs", &["runs", "rig"]),
    ("runs", &["logs", "rig"]),
    ("rig", &["runs", "gap", "study"]),
    ("gap", &["logs"]),
    ("study", &["logs", "gap"]),
    ("plan", &["logs", "gap", "study"]),
    ("reports", &["logs", "rig"]),
];

/// What reaches outside of the program.
const OUTSIDE: [&str; 4] = ["std::fs", "std::net", "std::process", "tempfile"];

/// What the sources of a crate do not name, but in the files listed.
const UNNAMED: [(&str, &[&str], &[&str]); 11] = [
    ("calib-core", &OUTSIDE, &[]),
    ("sinscal", &OUTSIDE, &[]),
    // what a smoother writes to is told to it
    ("sinscal", &["std::io"], &["models/smoothing.rs"]),
    ("noise", &OUTSIDE, &["noise/src/record.rs"]),
    ("runs", &OUTSIDE, &["runs/src/tape.rs"]),
    ("gap", &OUTSIDE, &[]),
    ("study", &OUTSIDE, &[]),
    ("plan", &OUTSIDE, &[]),
    ("rig", &OUTSIDE, &[]),
    ("reports", &OUTSIDE, &[]),
    ("rig", &["Calibration<", "Kalman", "Sins36P", "Sins43B", "Mems30", "Tracked35"], &[]),
];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn manifest(folder: &str) -> toml::Table {
    let path = root().join(folder).join("Cargo.toml");
    let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    toml::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Those of our crates that a crate's library is built on, in the order of [`CRATES`], and whether each is optional.
fn known(folder: &str) -> Vec<(&'static str, bool)> {
    let manifest = manifest(folder);
    let sections = ["dependencies", "build-dependencies"].map(|section| manifest.get(section));
    let optional = |name: &str| {
        let found = sections.iter().flatten().find_map(|section| section.get(name))?;
        Some(found.get("optional").and_then(toml::Value::as_bool).unwrap_or(false))
    };
    CRATES.iter().filter_map(|(name, ..)| Some((*name, optional(name)?))).collect()
}

/// Every Rust file under a folder with its text, in order.
fn sources(folder: &str) -> Vec<(String, String)> {
    let mut folders: Vec<PathBuf> = vec![root().join(folder)];
    let mut found = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display())) {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "rs") {
                let name = path.strip_prefix(root()).expect("below the root").display().to_string();
                let text = fs::read_to_string(&path).expect("text");
                found.push((name.replace('\\', "/"), text));
            }
        }
    }
    found.sort();
    assert!(!found.is_empty(), "{folder} has no sources");
    found
}

#[test]
fn the_crates_are_those_of_the_workspace() {
    let workspace = manifest(".");
    let members = workspace["workspace"]["members"].as_array().expect("a list of members");
    let mut members: Vec<&str> = members.iter().filter_map(toml::Value::as_str).collect();
    let mut folders = CRATES.map(|(_, folder, _)| folder);
    members.sort_unstable();
    folders.sort_unstable();
    assert_eq!(members, folders);
    for (name, folder, _) in CRATES {
        assert_eq!(manifest(folder)["package"]["name"].as_str(), Some(name), "{folder}");
    }
}

#[test]
fn arrows_point_one_way_and_are_those_of_the_document() {
    let document = fs::read_to_string(root().join("docs/ARCHITECTURE.md")).expect("the document");
    for (at, (name, folder, sources)) in CRATES.iter().enumerate() {
        let known = known(folder);
        for (other, _) in &known {
            assert!(CRATES[..at].iter().any(|(earlier, ..)| earlier == other), "{name} knows {other}");
        }
        let listed = known.iter().map(|(other, optional)| match optional {
            true => format!("(`{other}`)"),
            false => format!("`{other}`"),
        });
        let listed: Vec<String> = listed.collect();
        let listed = if listed.is_empty() { "nothing".into() } else { listed.join(", ") };
        let folder = if *folder == "." { sources } else { folder };
        let row = format!("| `{name}` | `{folder}/` | {listed} |");
        assert!(document.lines().any(|line| line == row), "docs/ARCHITECTURE.md lacks the line\n{row}");
    }
}

#[test]
fn what_stands_apart_stays_apart() {
    for (name, apart) in APART {
        let (_, folder, _) = CRATES.iter().find(|(known, ..)| *known == name).expect("a crate");
        for (other, _) in known(folder) {
            assert!(!apart.contains(&other), "{name} is not to know {other}");
        }
    }
}

#[test]
fn sources_do_not_name_what_their_crate_does_without() {
    for (name, words, but) in UNNAMED {
        let (.., folder) = CRATES.iter().find(|(known, ..)| *known == name).expect("a crate");
        let all = sources(folder);
        for exception in but {
            let named =
                |(file, text): &(String, String)| file == exception && words.iter().any(|w| text.contains(w));
            assert!(all.iter().any(named), "{exception} is no exception any more");
        }
        for (file, text) in all.iter().filter(|(file, _)| !but.contains(&file.as_str())) {
            for (number, line) in
                text.lines().enumerate().filter(|(_, line)| !line.trim_start().starts_with("//"))
            {
                for word in words {
                    assert!(!line.contains(word), "{file}, line {}: `{word}` in\n{line}", number + 1);
                }
            }
        }
    }
    for (file, text) in sources("logs/src") {
        for word in ["Calibration<", "Kalman<"] {
            assert!(!text.contains(word), "{file}: reading a log runs no filter, `{word}`");
        }
    }
}

/// The program is a part of the house, and no room is most of it.
#[test]
fn no_crate_is_more_than_its_share() {
    let lines = |folder| sources(folder).iter().map(|(_, text)| text.lines().count()).sum::<usize>();
    let sizes = CRATES.map(|(name, _, folder)| (name, lines(folder)));
    let whole: usize = sizes.iter().map(|(_, lines)| lines).sum();
    for (name, lines) in sizes {
        let share = lines as f64 / whole as f64;
        let most = if name == "sinscal-cli" { 1.0 / 5.0 } else { 1.0 / 3.0 };
        assert!(share < most, "{name} is {:.0} % of {whole} lines", 100.0 * share);
    }
}
