//! `sinscal compare` and certificates, on the calibration of `tests/formats`.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

use crate::support::Done;

fn sinscal(folder: &Path, arguments: &str) -> std::io::Result<Output> {
    let words = arguments.split(' ');
    Command::new(env!("CARGO_BIN_EXE_sinscal")).current_dir(folder).args(words).arg("--quiet").output()
}

fn said(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A folder with `a.json`, and `b.json`, which is the same but for what was changed.
fn pair(change: impl Fn(&mut Value)) -> Result<tempfile::TempDir, Box<dyn std::error::Error>> {
    let folder = tempfile::tempdir()?;
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/formats/calibration.json");
    let mut document: Value = serde_json::from_slice(&fs::read(from)?)?;
    fs::write(folder.path().join("a.json"), document.to_string())?;
    change(&mut document);
    fs::write(folder.path().join("b.json"), document.to_string())?;
    Ok(folder)
}

#[test]
fn a_calibration_agrees_with_itself() -> Done {
    let folder = pair(|_| ())?;
    let output = sinscal(folder.path(), "compare a.json b.json --json -")?;
    assert!(output.status.success(), "{}", said(&output.stderr));
    let found: Value = serde_json::from_slice(&output.stdout)?;
    let against = &found["against_first"][0];
    assert_eq!((against["agrees"].as_bool(), against["rms_sigma"].as_f64()), (Some(true), Some(0.0)));
    // both are of one log, and that is said
    assert!(found["notes"][0].as_str().is_some_and(|note| note.contains("name the same log")), "{found:#}");
    Ok(())
}

#[test]
fn differences_are_told_in_sigmas() -> Done {
    // by so much that the difference is 5 of its standard deviations, of which each calibration has half the variance
    let folder = pair(|document| {
        let bias = &mut document["parameters"][6];
        assert_eq!((bias["name"].as_str(), bias["component"].as_str()), (Some("gyro-bias"), Some("x")));
        let (value, sigma) = (bias["value"].as_f64().unwrap_or(0.0), bias["sigma"].as_f64().unwrap_or(0.0));
        bias["value"] = (value + 5.0 * 2.0_f64.sqrt() * sigma).into();
        document["log"] = "another".into();
        document["parameters"][0]["value"] = Value::Null;
    })?;
    let output = sinscal(folder.path(), "compare a.json b.json --out change")?;
    assert!(output.status.success(), "{}", said(&output.stderr));
    let text = said(&output.stdout);
    assert!(text.starts_with("B differs from A: 1 of "), "{text}");
    assert!(text.contains("gyro-bias x by 5.0 most"), "{text}");
    let found: Value = serde_json::from_slice(&fs::read(folder.path().join("change/comparison.json"))?)?;
    let difference = found["parameters"][6]["differences_sigma"][0].as_f64().ok_or("no difference")?;
    assert!((difference - 5.0).abs() < 1e-9, "{difference}");
    assert!(found["parameters"][0]["differences_sigma"][0].is_null());
    let page = fs::read_to_string(folder.path().join("change/report.html"))?;
    assert!(page.contains("5 sigma, gyro-bias x") && page.contains("+5.0"), "the page");
    Ok(())
}

#[test]
fn what_cannot_be_compared_is_refused() -> Done {
    let nothing = |document: &mut Value| {
        let all = document["parameters"].as_array_mut().into_iter().flatten();
        all.for_each(|parameter| parameter["value"] = Value::Null);
    };
    let folder = pair(nothing)?;
    let output = sinscal(folder.path(), "compare a.json b.json")?;
    assert_eq!(output.status.code(), Some(1));
    assert!(said(&output.stderr).contains("no parameter is estimated in both"), "{}", said(&output.stderr));
    assert_eq!(sinscal(folder.path(), "compare a.json")?.status.code(), Some(2));
    let output = sinscal(folder.path(), "compare a.json b.json --json b.json")?;
    assert!(said(&output.stderr).contains("is read by this command"), "{}", said(&output.stderr));
    Ok(())
}

#[test]
fn a_certificate_states_values_with_their_uncertainties() -> Done {
    let folder = pair(|document| {
        document["verdict"] = "fits".into();
        let scale = &mut document["parameters"][0];
        scale["value"] = 1.234e-5.into();
        scale["sigma"] = 2.5e-7.into();
    })?;
    let output = sinscal(folder.path(), "export b.json --format certificate --out certificate.html")?;
    assert!(output.status.success(), "{}", said(&output.stderr));
    let page = fs::read_to_string(folder.path().join("certificate.html"))?;
    // 12.34 ppm, u = 0.25 ppm, U = 0.50 ppm
    for cell in [
        ">12.34<",
        ">0.25<",
        ">0.50<",
        ">ppm<",
        "A, formal",
        "SHA-256",
        "Approved by",
        "its filter fits its log",
    ] {
        assert!(page.contains(cell), "{cell}");
    }
    Ok(())
}
