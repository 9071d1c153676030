//! `noise`: its files, what reads them, and what it refuses.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

use crate::support::Done;

fn sinscal(folder: &Path, arguments: &str) -> std::io::Result<Output> {
    Command::new(env!("CARGO_BIN_EXE_sinscal")).args(arguments.split(' ')).current_dir(folder).output()
}

/// Noise that is the same every time.
struct Normal(u64);

impl Normal {
    fn next(&mut self) -> f64 {
        let uniform = (0..12).map(|_| {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        });
        uniform.sum::<f64>() - 6.0
    }
}

/// A unit of 0.3 deg/sqrt(h) and 150 ug/sqrt(Hz) at 50 Hz; `turned` says when it is moved.
fn log(path: &Path, seconds: usize, turned: impl Fn(f64) -> bool) -> Done {
    let mut normal = Normal(1);
    let (gyro, accel) = (0.3_f64.to_radians() / 60.0 * 50_f64.sqrt(), 150e-6 * 9.80665 * 50_f64.sqrt());
    let mut text = String::from("t,wx,wy,wz,ax,ay,az,T\n");
    for row in 1..=seconds * 50 {
        let time = row as f64 * 0.02;
        let motion = if turned(time) { (time * 9.0).sin() } else { 0.0 };
        let rate: Vec<String> = (0..3).map(|_| (0.01 + motion + gyro * normal.next()).to_string()).collect();
        let force: Vec<String> =
            [0.1, 0.2, 9.8].iter().map(|at| (at + motion + accel * normal.next()).to_string()).collect();
        text += &format!("{time:.2},{},{},{:.1}\n", rate.join(","), force.join(","), 25.0);
    }
    fs::write(path, text)?;
    Ok(())
}

const MAP: &str = "--map gyro=w:rad/s,accel=a:m/s^2,time=t,temp=T";

#[test]
fn white_noise_is_measured_and_read_again() -> Done {
    let folder = tempfile::tempdir()?;
    let folder = folder.path();
    log(&folder.join("still.csv"), 120, |_| false)?;
    let output = sinscal(folder, &format!("noise still.csv {MAP} --out n --json -"))?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(output.stdout, fs::read(folder.join("n/noise.json"))?);
    let found: Value = serde_json::from_slice(&output.stdout)?;
    let duration = found["duration_s"].as_f64().expect("a duration");
    assert!((duration - 120.0).abs() < 1e-9, "{duration}");
    for (sensor, unit, truth) in
        [("gyro", "rad/sqrt(s)", 0.3_f64.to_radians() / 60.0), ("accel", "m/s/sqrt(s)", 150e-6 * 9.80665)]
    {
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let channel = &found[sensor][axis];
            assert_eq!(channel["axis"], name);
            let processes = channel["processes"].as_array().expect("processes");
            assert_eq!(processes.len(), 1, "{processes:?}");
            assert_eq!((&processes[0]["kind"], &processes[0]["unit"]), (&"white".into(), &unit.into()));
            let [value, low, high] =
                ["value", "low", "high"].map(|key| processes[0][key].as_f64().expect("a number"));
            // 95 % of one axis: wider than that for six
            assert!(
                low < value && value < high && (value / truth - 1.0).abs() < 0.04,
                "{low} {value} {high} {truth}"
            );
            assert!((high - low) / value > 0.01 && (high - low) / value < 0.1, "{low} {high}");
        }
    }
    let text = fs::read_to_string(folder.join("n/noise.txt"))?;
    for said in ["continuous-time densities", "deg/sqrt(h)", "rad/sqrt(s)", "ug/sqrt(Hz)", "Earth rate"] {
        assert!(text.contains(said), "{said}: {text}");
    }
    for file in ["report.html", "figures/allan-gyro-x.svg", "figures/allan-accel-z.csv"] {
        assert!(folder.join("n").join(file).is_file(), "{file}");
    }
    // the same bits, and others where the random numbers are others
    let again = sinscal(folder, &format!("noise still.csv {MAP} --json -"))?;
    assert_eq!(again.stdout, output.stdout);
    let other = sinscal(folder, &format!("noise still.csv {MAP} --seed 2 --json -"))?;
    assert_ne!(other.stdout, output.stdout);

    // read where a log is filtered: what is 10 000 times too large makes every innovation small
    fs::write(
        folder.join("still.toml"),
        "[imu]\nrate_hz = 50\n[site]\nlatitude_deg = 32\nlongitude_deg = 118\nheight_m = 20\n[noise]\n\
         gyro_arw_deg_sqrt_h = 3000.0\naccel_vrw_ug_sqrt_hz = 150000.0\n",
    )?;
    let calibrated = |more: &str| -> Result<f64, Box<dyn std::error::Error>> {
        let output = sinscal(folder, &format!("calibrate still --filter mems-30d {MAP} --json -{more}"))?;
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let found: Value = serde_json::from_slice(&output.stdout)?;
        Ok(found["nis_per_dof"].as_f64().expect("a ratio"))
    };
    let (stated, measured) = (calibrated("")?, calibrated(" --noise n/noise.toml")?);
    assert!(measured > 100.0 * stated && measured < 3.0, "{measured} {stated}");

    let kalibr = sinscal(folder, "export n/noise.json --format kalibr")?;
    let kalibr = String::from_utf8(kalibr.stdout)?;
    let density = kalibr.lines().find_map(|line| line.strip_prefix("gyroscope_noise_density: "));
    let density: f64 = density.and_then(|line| line.split(' ').next()).expect("a density").parse()?;
    assert!((density / (0.3_f64.to_radians() / 60.0) - 1.0).abs() < 0.02, "{kalibr}");
    Ok(())
}

#[test]
fn rests_of_a_carried_unit_are_used_each_by_itself() -> Done {
    let folder = tempfile::tempdir()?;
    let folder = folder.path();
    log(&folder.join("carried.csv"), 120, |time| time % 20.0 > 16.0)?;
    let output = sinscal(folder, &format!("noise carried.csv {MAP}"))?;
    let text = String::from_utf8(output.stdout)?;
    assert!(text.contains("6 rests of 9"), "{text}");
    let white = text.lines().find(|line| line.contains("angle random walk (white")).expect("a line");
    let value: f64 = white.split_whitespace().nth(5).expect("a value").parse()?;
    assert!((value / 0.3 - 1.0).abs() < 0.05, "{text}");
    Ok(())
}

#[test]
fn what_is_no_noise_is_refused() -> Done {
    let folder = tempfile::tempdir()?;
    let folder = folder.path();
    log(&folder.join("moved.csv"), 20, |_| true)?;
    fs::write(folder.join("some.json"), "{\"filter\": \"43d-b\", \"parameters\": []}")?;
    fs::write(folder.join("half.json"), "{\"gyro\": [], \"accel\": 3}")?;
    fs::write(folder.join("empty.toml"), "[imu]\nrate_hz = 5\n")?;
    fs::write(
        folder.join("half.toml"),
        "[noise]\ngyro_arw_deg_sqrt_h = 0.3\naccel_vrw_ug_sqrt_hz = 100\ngyro_bias_instability_deg_h = 5\n",
    )?;
    fs::write(
        folder.join("moved.toml"),
        "[imu]\nrate_hz = 50\n[site]\nlatitude_deg = 32\nlongitude_deg = 118\nheight_m = 20\n",
    )?;
    for (arguments, expected) in [
        (format!("noise moved.csv {MAP}"), "moved.csv: never rests for a second"),
        ("export some.json --format kalibr".into(), "some.json: is no noise"),
        ("export half.json --format kalibr".into(), "half.json: is no complete document of noise"),
        (format!("calibrate moved --filter mems-30d {MAP} --noise empty.toml"), "field `noise`: is missing"),
        (
            format!("calibrate moved --filter mems-30d {MAP} --noise none.toml"),
            "none.toml: the description of noise is not there",
        ),
        (
            format!("calibrate moved --filter mems-30d {MAP} --noise half.toml"),
            "noise.gyro_bias_correlation_s",
        ),
    ] {
        let output = sinscal(folder, &arguments)?;
        let said = String::from_utf8(output.stderr)?;
        assert!(!output.status.success() && said.contains(expected), "{arguments}: {said}");
    }
    Ok(())
}
