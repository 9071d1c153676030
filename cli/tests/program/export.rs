//! `sinscal export`: every form holds the numbers of the calibration to the bit, and a module of Rust compensates as the
//! library does. `tests/formats/check.py` reads the YAML with PyYAML.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use nalgebra::Vector3;
use serde_json::Value;
use sinscal::{Block, Compensator, Reference, Sample, Sins43B};

use crate::support::Done;

/// What `export --format rust` wrote of `calibration.json`; a test below says so.
#[path = "../formats/calibration.rs"]
#[allow(dead_code, missing_docs, unreachable_pub, reason = "not everything is compensated with")]
mod exported;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/formats")
}

fn export(arguments: &[&str]) -> Result<Output, std::io::Error> {
    Command::new(env!("CARGO_BIN_EXE_sinscal")).current_dir(folder()).arg("export").args(arguments).output()
}

fn text(format: &str) -> Result<String, Box<dyn std::error::Error>> {
    let output = export(&["calibration.json", "--format", format])?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Ok(String::from_utf8(output.stdout)?)
}

/// Name, component, value and sigma.
type Estimate = (String, String, f64, f64);

/// Whatever was estimated.
fn estimates() -> Result<Vec<Estimate>, Box<dyn std::error::Error>> {
    let document: Value = serde_json::from_slice(&fs::read(folder().join("calibration.json"))?)?;
    let parameters = document["parameters"].as_array().ok_or("no parameters")?;
    let read = |parameter: &Value| {
        let text = |key: &str| parameter[key].as_str().map(str::to_owned);
        Some((text("name")?, text("component")?, parameter["value"].as_f64()?, parameter["sigma"].as_f64()?))
    };
    let estimates: Vec<_> = parameters.iter().filter_map(read).collect();
    assert_eq!((parameters.len(), estimates.len()), (34, 33));
    Ok(estimates)
}

/// The value that follows `start` in a text.
fn after(text: &str, start: &str, ends: &[char]) -> Option<f64> {
    let at = text.find(start)? + start.len();
    text[at..].split(ends).next()?.trim().parse().ok()
}

/// `SINSCAL_GOLDEN=write cargo test -p sinscal-cli --test program export` writes the module anew.
#[test]
fn the_module_in_the_tree_is_what_is_written() -> Done {
    let path = folder().join("calibration.rs");
    let written = text("rust")?;
    if std::env::var("SINSCAL_GOLDEN").is_ok_and(|what| what == "write") {
        fs::write(&path, &written)?;
    }
    assert!(fs::read_to_string(&path)? == written, "calibration.rs is not what `export` writes");
    Ok(())
}

#[test]
fn every_form_holds_every_estimate_to_the_bit_and_nothing_else() -> Done {
    let (c, rust, matlab, yaml) = (text("c")?, text("rust")?, text("matlab")?, text("yaml")?);
    let estimates = estimates()?;
    for (name, component, value, sigma) in &estimates {
        let constant = format!("{name}_{component}").replace('-', "_");
        let upper = constant.to_uppercase();
        let block = yaml.split_once(&format!("\n  {name}:\n")).map_or("", |(_, rest)| rest);
        let line = block.split_once(&format!("\"{component}\": {{")).map_or("", |(_, rest)| rest);
        let of_yaml = |key: &str| after(line, key, &[',', '}']);
        let found = [
            after(&c, &format!("#define SINSCAL_{upper} ("), &[')']),
            after(&rust, &format!("pub const {upper}: f64 = "), &[';']),
            after(&matlab, &format!("calibration.{constant} = "), &[';']),
            of_yaml("value: "),
        ];
        assert_eq!(found, [Some(*value); 4], "{name} {component}");
        let found = [
            after(&c, &format!("#define SINSCAL_{upper}_SIGMA ("), &[')']),
            after(&rust, &format!("pub const {upper}_SIGMA: f64 = "), &[';']),
            after(&matlab, &format!("calibration.{constant}_sigma = "), &[';']),
            of_yaml("sigma: "),
        ];
        assert_eq!(found, [Some(*sigma); 4], "{name} {component} sigma");
    }
    for text in [&c, &rust, &matlab, &yaml] {
        assert!(text.contains("SHA-256") && text.contains("filter 43d-b, log unit.parquet"), "{text}");
        assert!(!text.to_lowercase().contains("temperature_scale_z"), "what was not estimated is written");
    }
    Ok(())
}

/// Compiles the header, where there is a compiler, and compares what a C program makes of it.
#[test]
fn the_header_compiles_and_holds_the_same_numbers() -> Done {
    if Command::new("gcc").arg("--version").output().is_err() {
        println!("skipped: no gcc");
        return Ok(());
    }
    let place = tempfile::tempdir()?;
    let header = place.path().join("calibration.h");
    let output = export(&["calibration.json", "--format", "c", "--out", header.to_str().ok_or("no text")?])?;
    assert!(output.status.success() && output.stdout.is_empty());
    let estimates = estimates()?;
    let name = |(name, component, ..): &Estimate| {
        format!("SINSCAL_{name}_{component}").replace('-', "_").to_uppercase()
    };
    let prints =
        estimates.iter().map(|estimate| format!("printf(\"%a %a\\n\", {0}, {0}_SIGMA);", name(estimate)));
    let prints: Vec<String> = prints.collect();
    let program = format!(
        "#include <stdio.h>\n#include \"calibration.h\"\nint main(void) {{\n{}\nreturn 0;\n}}\n",
        prints.join("\n")
    );
    let program = program.replace("%a %a", "%.17g %.17g");
    fs::write(place.path().join("main.c"), program)?;
    let built = Command::new("gcc")
        .current_dir(place.path())
        .args(["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "main.c", "-o", "main"])
        .output()?;
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    let printed = Command::new(place.path().join("main")).output()?;
    let printed = String::from_utf8(printed.stdout)?;
    assert_eq!(printed.lines().count(), estimates.len());
    for (line, (name, component, value, sigma)) in printed.lines().zip(&estimates) {
        let numbers: Vec<f64> = line.split(' ').map(str::parse).collect::<Result<_, _>>()?;
        assert_eq!(numbers, [*value, *sigma], "{name} {component}");
    }
    Ok(())
}

/// Compensation written out by hand from the exported numbers and the equations in the comments of the module. How the specific
/// force changes in n, along the axes of b, is for whoever compensates to find; here it is `change`.
fn compensated(
    sample: &Sample,
    dt: f64,
    dither: Vector3<f64>,
    change: Vector3<f64>,
) -> (Vector3<f64>, Vector3<f64>) {
    use exported::*;
    let (rate, force) = (sample.dtheta / dt, sample.dvel / dt);
    let temperature = sample.temperature.add_scalar(-REFERENCE_TEMPERATURE);
    let half = dither.component_mul(&dither) * 0.5;
    let (mut omega, mut f) = (rate, force);
    for _ in 0..4 {
        let gyro = Vector3::new(
            GYRO_SCALE_X * omega.x + GYRO_BIAS_X,
            GYRO_SCALE_Y * omega.y + GYRO_MISALIGNMENT_YX * omega.x + GYRO_BIAS_Y,
            GYRO_SCALE_Z * omega.z
                + GYRO_MISALIGNMENT_ZX * omega.x
                + GYRO_MISALIGNMENT_ZY * omega.y
                + GYRO_BIAS_Z,
        );
        let linear = Vector3::new(
            ACCEL_SCALE_X * f.x + ACCEL_MISALIGNMENT_XY * f.y + ACCEL_MISALIGNMENT_XZ * f.z + ACCEL_BIAS_X,
            ACCEL_SCALE_Y * f.y + ACCEL_MISALIGNMENT_YX * f.x + ACCEL_MISALIGNMENT_YZ * f.z + ACCEL_BIAS_Y,
            ACCEL_SCALE_Z * f.z + ACCEL_MISALIGNMENT_ZX * f.x + ACCEL_MISALIGNMENT_ZY * f.y + ACCEL_BIAS_Z,
        );
        let quadratic = Vector3::new(ACCEL_QUADRATIC_X, ACCEL_QUADRATIC_Y, ACCEL_QUADRATIC_Z)
            .component_mul(&f.component_mul(&f));
        // the parameter of z was not estimated
        let by_temperature = Vector3::new(ACCEL_TEMPERATURE_SCALE_X, ACCEL_TEMPERATURE_SCALE_Y, 0.0)
            .component_mul(&temperature)
            .component_mul(&f);
        let square = omega.component_mul(&omega) + half;
        let lever = Vector3::new(INNER_LEVER_ARM_X, INNER_LEVER_ARM_Y, INNER_LEVER_ARM_Z);
        let size = -lever.component_mul(&square.map(|own| square.sum() - own));
        let delay = -ACCEL_DELAY_TAU * (change + f.cross(&omega));
        omega = rate - gyro;
        f = force - (linear + quadratic + by_temperature + size + delay);
    }
    (omega, f)
}

#[test]
fn the_module_compensates_as_the_library_does() -> Done {
    let mut parameters = [0.0; 43];
    let estimates = estimates()?;
    let mut index = 0;
    Sins43B::states(&mut |info| {
        let known = estimates.iter().find(|(n, c, ..)| n == info.block && c == info.component);
        parameters[index] = known.map_or(0.0, |(.., value, _)| *value);
        index += 1;
    });
    let dt = 0.02;
    let dither = Vector3::new(0.07, 0.08, 0.09);
    let mut compensator = Compensator::new(25.0);
    for row in 0..100 {
        let t = f64::from(row) * dt;
        let sample = Sample {
            time: t,
            dtheta: Vector3::new((3.0 * t).sin(), -0.5, t.cos()) * dt,
            dvel: Vector3::new(3.0, 9.8 * t.sin(), -4.0) * dt,
            temperature: Vector3::new(31.0, 20.0, 40.0),
            gyro_temperature: Vector3::repeat(f64::NAN),
            dither,
            reference: Reference::default(),
        };
        compensator.read(&sample);
        let (library, signals) = compensator.compensate::<Sins43B>(&sample, dt, &parameters);
        let change = signals.force_rate - signals.force.cross(&signals.rate);
        let (omega, f) = compensated(&sample, dt, dither, change);
        assert!(
            (library.dtheta / dt - omega).norm() < 1e-14,
            "{row}: {}",
            (library.dtheta / dt - omega).norm()
        );
        // the library stops when a round moves the force by less than 1e-10 of it; what is left is a thousandth of that
        assert!(
            (library.dvel / dt - f).norm() < 1e-13 * f.norm(),
            "{row}: {}",
            (library.dvel / dt - f).norm()
        );
    }
    Ok(())
}

#[test]
fn what_is_no_calibration_is_refused() -> Done {
    let place = tempfile::tempdir()?;
    let path = place.path().join("x.json");
    let sound = fs::read_to_string(folder().join("calibration.json"))?;
    let mut document: Value = serde_json::from_str(&sound)?;
    for parameter in document["parameters"].as_array_mut().ok_or("no parameters")? {
        parameter["value"] = Value::Null;
    }
    let nothing = document.to_string();
    let negative = sound.replacen("\"sigma\": ", "\"sigma\": -", 1);
    for (content, part) in [
        ("{}", "field `filter`: is missing"),
        (sound.get(..2000).unwrap_or_default(), "is not valid JSON"),
        (&nothing, "nothing was estimated"),
        (&negative, "field `parameters[0].sigma`: a number above 0 was expected for `gyro-scale x`"),
    ] {
        fs::write(&path, content)?;
        let out = place.path().join("x.h");
        let arguments = [path.to_str(), Some("--format"), Some("c"), Some("--out"), out.to_str()];
        let output = export(&arguments.map(Option::unwrap_or_default))?;
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{message}");
        assert!(message.contains("x.json") && message.contains(part), "{message}");
        assert!(!out.exists());
    }
    assert_eq!(export(&["calibration.json", "--format", "json"])?.status.code(), Some(2));
    Ok(())
}
