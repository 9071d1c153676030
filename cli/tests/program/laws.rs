//! What no library holds, from the log to a filter that has it: at run time and as a project.

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::outside_logs::{json, run};
use crate::support::Done;

/// Where the accelerometers go wrong: `d_f_i = k_i (T_i - T_ref) f_i^2`.
const LAW: &str = "accel-bias-by-temperature-times-force-i-squared";
const VALUES: [f64; 3] = [6e-7, -4e-7, 5e-7];

/// A unit that has a law beside what 36d-p models.
fn scenario(path: &str) -> String {
    format!(
        r#"[imu]
rate = "20 Hz"
[motion]
path = "{path}"
still = "60 s"
dwell = "40 s"
[dither]
mode = "off"
[population]
gyro-scale = "20 ppm"
gyro-misalignment = "20 arcsec"
gyro-bias = "0.03 deg/h"
accel-scale = "50 ppm"
accel-misalignment = "20 arcsec"
accel-bias = "50 ug"
accel-quadratic = "10 ug/g^2"
outer-lever-arm = {{ mean = ["0.2 m", "0.15 m", "-0.12 m"], sigma = "10 mm" }}
{LAW} = {{ mean = [{}], sigma = "0 m/s^2/(K (m/s^2)^2)" }}
"#,
        VALUES.map(|value| format!("\"{value:e} m/s^2/(K (m/s^2)^2)\"")).join(", ")
    )
}

fn sinscal(at: &Path, arguments: &[&str]) -> Result<String, String> {
    let output = Command::new(env!("CARGO_BIN_EXE_sinscal")).args(arguments).current_dir(at).output();
    let output = output.map_err(|error| error.to_string())?;
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    if output.status.success() { Ok(text(&output.stdout)) } else { Err(text(&output.stderr)) }
}

fn numbers(list: &Value) -> Vec<f64> {
    list.as_array().into_iter().flatten().filter_map(Value::as_f64).collect()
}

#[test]
fn a_law_is_found_run_on_the_next_log_and_written_as_a_project() -> Done {
    let at = Path::new(env!("CARGO_TARGET_TMPDIR")).join("laws");
    let _ = fs::remove_dir_all(&at);
    fs::create_dir_all(&at)?;
    for (name, path, seed) in
        [("a", "two-axis", "5"), ("b", "nineteen-positions", "5"), ("c", "two-axis", "6")]
    {
        fs::write(at.join(format!("{name}.toml")), scenario(path))?;
        sinscal(
            &at,
            &[
                "simulate",
                "--scenario",
                &format!("{name}.toml"),
                "--out",
                &format!("log-{name}"),
                "--seed",
                seed,
                "-q",
            ],
        )?;
    }
    assert!(fs::read_to_string(at.join("log-a.truth.json"))?.contains(LAW));

    let second = at.join("log-b").display().to_string();
    let findings = at.join("findings").display().to_string();
    let found =
        json(&run("diagnose", &at.join("log-a"), "36d-p", &["--verify", &second, "--out", &findings, "-q"]));
    assert_eq!(found["verdict"], "outside-library", "{}", found["sentence"]);
    let law = &found["laws"][0];
    assert_eq!((law["name"].as_str(), found["laws"][1].is_null()), (Some(LAW), true), "{law}");
    let (estimate, sigma) = (numbers(&law["estimate"]), numbers(&law["sigma"]));
    for (i, truth) in VALUES.iter().enumerate() {
        assert!((estimate[i] - truth).abs() < 4.0 * sigma[i], "{estimate:?} +- {sigma:?}");
        assert!(sigma[i] < 0.1 * truth.abs(), "{sigma:?}");
    }
    // really run: the gap closes on both logs, the one that was not used for the choice too
    for log in ["fit", "verify"] {
        let gap = &found["gap"][log];
        let of = |field: &str| gap[field].as_f64().unwrap_or(f64::NAN);
        assert!(of("rms_before") > 1.1 && (of("rms_after") - 1.0).abs() < 0.05, "{log}: {gap}");
        let gained = of("log_likelihood_after") - of("log_likelihood_before");
        assert!((gained / of("log_likelihood_gain_priced") - 1.0).abs() < 0.05, "{log}: {gap}");
    }
    let source = fs::read_to_string(at.join("findings/extended_filter.rs"))?;
    assert!(
        source.contains("put(sinscal::FORCE + i, i, signals.temperature[i] * signals.force[i].powi(2));")
    );

    // on another unit of the kind: without it nothing fits, with it all is well, whether it is named or read
    let before = sinscal(&at, &["calibrate", "log-c", "--filter", "36d-p", "-q"])?;
    assert!(before.contains("does not fit"), "{before}");
    let read = json(&run(
        "calibrate",
        &at.join("log-c"),
        "36d-p",
        &["--with", &format!("{findings}/diagnosis.json"), "-q"],
    ));
    let named = json(&run("calibrate", &at.join("log-c"), "36d-p", &["--with", LAW, "-q"]));
    assert_eq!(read["parameters"], named["parameters"]);
    assert_eq!((read["with"][0].as_str(), read["verdict"].as_str()), (Some(LAW), Some("fits")));
    let of_law: Vec<&Value> =
        read["parameters"].as_array().into_iter().flatten().filter(|p| p["name"] == LAW).collect();
    assert_eq!(of_law.len(), 3);
    for (parameter, truth) in of_law.iter().zip(VALUES) {
        let of = |field: &str| parameter[field].as_f64().unwrap_or(f64::NAN);
        assert!((of("value") - truth).abs() < 4.0 * of("sigma"), "{parameter}");
    }

    sinscal(&at, &["new", "with-law", "--from", "findings/diagnosis.json"])?;
    let project = at.join("with-law");
    let lib = fs::read_to_string(project.join("src/lib.rs"))?;
    assert!(
        lib.contains("mod laws;") && lib.contains("accel_bias_by_temperature_times_force_i_squared: "),
        "{lib}"
    );
    assert!(source.contains(
        &fs::read_to_string(project.join("src/laws.rs"))?.lines().last().unwrap_or("?").to_owned()
    ));
    assert!(fs::read_to_string(project.join("tests/blocks.rs"))?.contains("_is_what_it_is_at_run_time"));
    Ok(())
}
