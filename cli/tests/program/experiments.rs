//! observe, navigate, ablate, campaign: what they write, and what they say when something is wrong.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

use crate::support::{DESCRIPTION, Done, Table};

fn sinscal(arguments: &[&str]) -> std::io::Result<Output> {
    Command::new(env!("CARGO_BIN_EXE_sinscal")).args(arguments).output()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn json(arguments: &[&str]) -> Result<Value, Box<dyn std::error::Error>> {
    let output = sinscal(arguments)?;
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    Ok(serde_json::from_slice(&output.stdout)?)
}

/// Two minutes at rest.
fn log(folder: &Path) -> Result<String, Box<dyn std::error::Error>> {
    fs::write(folder.join("log.toml"), DESCRIPTION)?;
    Table::at_rest(6000).write_parquet(&folder.join("log.parquet"), None)?;
    Ok(folder.join("log").display().to_string())
}

#[test]
fn bad_usage_is_exit_code_2() -> Done {
    for arguments in [
        &["observe", "log"][..],
        &["observe", "log", "--filter", "44d"],
        &["navigate", "log"],
        &["navigate", "log", "--calibration", "c.json", "--align", "1"],
        &["ablate"],
        &["campaign"],
        &["campaign", "--units", "0"],
        &["campaign", "--units", "4", "--shard", "5/4", "--out", "x"],
        &["campaign", "--units", "4", "--shard", "1/4"],
        &["campaign", "merge"],
        &["campaign", "map", "--factors", "1,-1"],
        &["paper", "--hours", "-1"],
    ] {
        let output = sinscal(arguments)?;
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", text(&output.stderr));
    }
    Ok(())
}

#[test]
fn a_unit_at_rest_shows_little() -> Done {
    let folder = tempfile::tempdir()?;
    let log = log(folder.path())?;
    let out = folder.path().join("out").display().to_string();
    let report = json(&["observe", &log, "--filter", "43d-b", "--json", "-", "--out", &out])?;
    let (rank, states) = (report["rank"].as_u64().ok_or("no rank")?, 43);
    assert!(rank < 30, "{rank}");
    assert_eq!(report["states"], states);
    assert_eq!(report["tolerance"], 1.0);
    let values = report["singular_values"].as_array().ok_or("no singular values")?;
    assert_eq!(values.len(), 43);
    assert!(values.windows(2).all(|pair| pair[0].as_f64() >= pair[1].as_f64()));
    let degrees = report["degrees"].as_array().ok_or("no degrees")?;
    assert_eq!(degrees[36]["state"], "inner-lever-arm x");
    assert_eq!(degrees[36]["spans"].as_array().map(Vec::len), Some(5));
    assert_eq!(report["unobservable"].as_array().map(Vec::len), Some(43 - rank as usize));
    assert!(
        text(&fs::read(Path::new(&out).join("observability.txt"))?)
            .contains("is not observable on this path")
    );
    // dither of constant amplitude, felt by a filter that does not know it
    let blind = json(&["observe", &log, "--filter", "43d-p", "--json", "-"])?;
    let confounded = blind["confounded"].to_string();
    assert!(confounded.contains("dither-size-effect"), "{confounded}");
    Ok(())
}

#[test]
fn a_calibration_is_applied_or_refused() -> Done {
    let folder = tempfile::tempdir()?;
    let log = log(folder.path())?;
    let path = folder.path().join("calibration.json");
    let calibration = path.display().to_string();
    let output = sinscal(&["calibrate", &log, "--filter", "40d-p", "--json", &calibration])?;
    assert!(output.status.success(), "{}", text(&output.stderr));
    let report = json(&["navigate", &log, "--calibration", &calibration, "--json", "-"])?;
    assert_eq!(report["filter"], "40d-p");
    // the alignment takes at most half the log
    assert!(report["alignment_s"].as_f64().is_some_and(|seconds| (seconds - 60.0).abs() < 0.1));
    assert!(report["hours"].as_f64().is_some_and(|hours| (hours - 120.0 / 3600.0).abs() < 1e-3));
    assert!(report["max_horizontal_nmi"].as_f64().is_some_and(|error| error < 0.01));

    let whole = fs::read_to_string(&path)?;
    for (from, to, wanted) in [
        ("\"40d-p\"", "\"40d-q\"", "field `filter`: there is no filter called 40d-q"),
        ("\"accel-delay\"", "\"accel-delays\"", "40d-p has no parameter `accel-delays tau`"),
        ("\"filter\"", "\"fitter\"", "field `filter`: is missing"),
    ] {
        fs::write(&path, whole.replacen(from, to, 1))?;
        let output = sinscal(&["navigate", &log, "--calibration", &calibration])?;
        assert_eq!(output.status.code(), Some(1));
        let said = text(&output.stderr);
        assert!(said.contains(wanted) && said.contains("calibration.json"), "{said}");
    }
    Ok(())
}

#[test]
fn five_filters_side_by_side() -> Done {
    let folder = tempfile::tempdir()?;
    let log = log(folder.path())?;
    let alone = json(&["ablate", &log, "--json", "-"])?;
    let names: Vec<&str> = alone["filters"]
        .as_array()
        .ok_or("no filters")?
        .iter()
        .filter_map(|row| row["filter"].as_str())
        .collect();
    assert_eq!(names, ["36d-p", "39d-p", "40d-p", "43d-p", "43d-b"]);
    assert!(alone["filters"][0]["max_horizontal_nmi"].is_null());
    let flown = json(&["ablate", &log, "--swing", &log, "--json", "-"])?;
    assert!(flown["filters"][4]["final_horizontal_nmi"].as_f64().is_some());
    assert_eq!(flown["filters"][4]["nis_per_dof"], alone["filters"][4]["nis_per_dof"]);
    Ok(())
}

#[test]
fn a_campaign_is_the_same_in_one_go_taken_up_again_and_in_shards() -> Done {
    let folder = tempfile::tempdir()?;
    let at = |name: &str| folder.path().join(name).display().to_string();
    fs::write(at("short.toml"), "[motion]\npath = \"still\"\nduration = \"120 s\"\n")?;
    let scenario = at("short.toml");
    let base =
        ["campaign", "--units", "3", "--filters", "36d-p,43d-b", "--hours", "0.05", "--scenario", &scenario];
    let run = |more: &[&str]| -> std::io::Result<Output> { sinscal(&[&base[..], more].concat()) };
    let whole = at("whole");
    assert!(run(&["--out", &whole])?.status.success());
    for i in 1..=2 {
        let output = run(&["--out", &at(&format!("part{i}")), "--shard", &format!("{i}/2")])?;
        assert!(output.status.success(), "{}", text(&output.stderr));
    }
    let merged = at("merged");
    assert!(sinscal(&["campaign", "merge", &at("part1"), &at("part2"), "--out", &merged])?.status.success());
    // killed: one unit is missing, another was cut off
    let again = at("again");
    assert!(run(&["--out", &again])?.status.success());
    fs::remove_file(Path::new(&again).join("units/unit-000001.json"))?;
    let cut = Path::new(&again).join("units/unit-000002.json");
    let bytes = fs::read(&cut)?;
    fs::write(&cut, &bytes[..bytes.len() / 2])?;
    let output = run(&["--out", &again])?;
    assert!(text(&output.stderr).contains("1 of 3 units were done before"), "{}", text(&output.stderr));
    for file in ["summary.json", "summary.txt", "filters.parquet", "parameters.parquet"] {
        let expected = fs::read(Path::new(&whole).join(file))?;
        assert!(fs::read(Path::new(&merged).join(file))? == expected, "{file} differs in shards");
        assert!(fs::read(Path::new(&again).join(file))? == expected, "{file} differs when taken up again");
    }
    let other = run(&["--out", &whole, "--passes", "1"])?;
    assert_eq!(other.status.code(), Some(1));
    assert!(text(&other.stderr).contains("field `passes`"), "{}", text(&other.stderr));
    Ok(())
}

#[test]
fn a_map_has_every_combination_of_sizes() -> Done {
    let folder = tempfile::tempdir()?;
    let scenario = folder.path().join("short.toml");
    fs::write(&scenario, "[motion]\npath = \"still\"\nduration = \"120 s\"\n")?;
    let base = ["campaign", "map", "--units", "1", "--hours", "0.1", "--factors", "0,1", "--json", "-"];
    let map = json(&[&base[..], &["--scenario", &scenario.display().to_string()]].concat())?;
    let cells = map["cells"].as_array().ok_or("no cells")?;
    assert_eq!(cells.len(), 8);
    for cell in cells {
        let medians: Vec<f64> =
            cell["median_m"].as_array().ok_or("none")?.iter().filter_map(Value::as_f64).collect();
        let worse = (1..5).filter(|f| medians[*f] > medians[f - 1]).count();
        assert_eq!((medians.len(), cell["worse"].as_array().map(Vec::len)), (5, Some(worse)), "{cell}");
    }
    Ok(())
}
