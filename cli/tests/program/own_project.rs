//! A project that `sinscal new` writes, outside of the workspace: it builds, its tests pass, and with a filter, an effect and a
//! measurement of its own it does everything that the program does.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use nalgebra::Vector3;
use rig::{Scenario, Simulation};

use crate::support::Done;

/// The filter of the project with a measurement of its own: how far the observed point is from a beacon 3 m north.
const LIB: &str = r#"//! What our unit may have wrong, and how it is measured.

mod spin;

use nalgebra::Vector3;
use sinscal::prelude::*;
use sinscal::{Point, channel};

pub use spin::Spin;

/// Distance to a beacon that stands 3 m north of the site origin.
pub struct Range;

fn from_beacon<T: Real>(at: &Point<T>) -> Vector3<T> {
    at.point_position - Vector3::new(T::zero(), T::of(3.0), T::zero())
}

impl Measurement for Range {
    type Dynamics = Strapdown;
    const INFO: MeasurementInfo = MeasurementInfo {
        name: "range",
        components: &["r"],
        unit: "m",
        columns: &["range_m"],
        sigma: 1e-3,
        channels: None,
    };
    fn residual<T: Real>(at: &Point<T>, reading: &[T], put: &mut impl FnMut(usize, T)) {
        put(0, from_beacon(at).norm() - reading[0]);
    }
    fn jacobian<T: Real>(at: &Point<T>, put: &mut impl FnMut(usize, usize, T)) {
        let way = from_beacon(at).normalize();
        for i in 0..3 {
            put(0, channel::POSITION + i, way[i]);
        }
    }
}

/// The filter.
#[derive(Debug, StateBlocks)]
#[filter(name = "own-unit", measures(velocity, Range))]
pub struct OwnUnit {
    #[base]
    base: sinscal::Sins36P,
    spin: Spin,
}
"#;

/// Laws that the project is written with: each becomes a block, and a test that it does what it does at run time.
const LAWS: &str = "accel-bias-by-temperature-rate-squared,gyro-bias-by-time-times-temperature,accel-bias-by-dither-times-force-i,\
gyro-bias-by-size-of-rate-times-force-k,accel-bias-by-rate-j-cubed";

/// Two short runs of one unit that has `spin` beside what 36d-p models.
const SCENARIO: &str = r#"[imu]
rate = "20 Hz"
[motion]
path = "PATH"
still = "60 s"
dwell = "30 s"
[temperature]
profile = "constant"
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
outer-lever-arm = { mean = ["0.2 m", "0.15 m", "-0.12 m"], sigma = "10 mm" }
spin = { mean = ["3e-3 m/s", "-2e-3 m/s", "1e-3 m/s"], sigma = "0 m/s" }
"#;

struct Project {
    folder: PathBuf,
    target: PathBuf,
}

impl Project {
    fn cargo(&self, arguments: &[&str]) -> Result<String, String> {
        let output = Command::new(env!("CARGO"))
            .args(arguments)
            .current_dir(&self.folder)
            .env("CARGO_TARGET_DIR", &self.target)
            .output()
            .map_err(|error| error.to_string())?;
        let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        if output.status.success() {
            Ok(out.into_owned())
        } else {
            Err(format!("{arguments:?}\n{out}\n{err}"))
        }
    }

    /// Runs the project's program.
    fn run(&self, call: &str) -> Result<String, String> {
        let mut arguments = vec!["run", "--quiet", "--"];
        arguments.extend(call.split_whitespace());
        self.cargo(&arguments)
    }
}

/// A log whose reference is the velocity of the observed point and its range, as a person would write it.
fn write_ranges(path: &Path) -> Done {
    let known = SCENARIO.lines().filter(|line| !line.starts_with("spin")).collect::<Vec<_>>().join("\n");
    let read = "[reference]\nkind = \"readings\"\nrate = \"1 Hz\"\nposition_sigma = \"1 mm\"\n";
    let scenario = Scenario::parse(&format!("{read}{}", known.replace("PATH", "two-axis")))?;
    let simulation = Simulation::new(&scenario, 7)?;
    let description = simulation.description().clone();
    let mut text = String::from(
        "time_s,dtheta_x,dtheta_y,dtheta_z,dvel_x,dvel_y,dvel_z,ref_vel_e,ref_vel_n,ref_vel_u,range_m\n",
    );
    for sample in simulation {
        let numbers =
            sample.dtheta.iter().chain(&sample.dvel).map(f64::to_string).collect::<Vec<_>>().join(",");
        let read = sample.reference.velocity.zip(sample.reference.position);
        let reading = read.map_or(",,,".to_owned(), |(velocity, position)| {
            let range = (position - Vector3::new(0.0, 3.0, 0.0)).norm();
            format!("{},{},{},{range}", velocity.x, velocity.y, velocity.z)
        });
        writeln!(text, "{},{numbers},{reading}", sample.time)?;
    }
    fs::write(path.with_extension("csv"), text)?;
    fs::write(path.with_extension("toml"), description.to_toml())?;
    Ok(())
}

#[test]
#[ignore = "builds everything once more, for a project outside of the workspace: minutes"]
fn a_project_of_ones_own_does_everything() -> Done {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize()?;
    let place = Path::new(env!("CARGO_TARGET_TMPDIR"));
    // the target folder of the workspace: crates of the registry are built already
    let project = Project { folder: place.join("own-unit"), target: place.join("..") };
    let _ = fs::remove_dir_all(&project.folder);
    let output = Command::new(env!("CARGO_BIN_EXE_sinscal"))
        .args(["new", "own-unit", "--filter", "36d-p", "--with", LAWS, "--sinscal"])
        .arg(&root)
        .current_dir(place)
        .output()?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));

    // what its own measurement needs, and a feature that the benchmark has switched on: tests, benchmark and program are one build
    let manifest = fs::read_to_string(project.folder.join("Cargo.toml"))?.replace(
        "[dependencies]\n",
        "[dependencies]\nnalgebra = { version = \"0.35\", default-features = false }\neither = \"1\"\n",
    );
    fs::write(project.folder.join("Cargo.toml"), manifest)?;

    // as it is written: its tests pass, and its benchmark's check that covariances are equal
    project.cargo(&["test", "--quiet"])?;
    project.cargo(&["bench", "--quiet", "--profile", "dev", "--", "--test"])?;
    assert!(project.run("filters")?.contains("own-unit"));
    assert!(project.run("effects")?.contains("d_f_i = k_i |omega|"));

    // with a measurement of its own
    fs::write(project.folder.join("src/lib.rs"), LIB)?;
    let main = fs::read_to_string(project.folder.join("src/main.rs"))?;
    assert!(main.lines().count() <= 10, "{main}");

    fs::write(project.folder.join("a.toml"), SCENARIO.replace("PATH", "two-axis"))?;
    fs::write(project.folder.join("b.toml"), SCENARIO.replace("PATH", "nineteen-positions"))?;
    project.run("simulate --scenario a.toml --out first --seed 5 -q")?;
    project.run("simulate --scenario b.toml --out second --seed 5 -q")?;
    assert!(fs::read_to_string(project.folder.join("first.truth.json"))?.contains("\"spin\""));

    // priors of its own effect are read
    let described = fs::read_to_string(project.folder.join("second.toml"))?;
    let stated = "[prior]\nspin = { sigma = 5.0, unit = \"mm/s\" }\n";
    assert!(!described.contains("[prior]"), "{described}");
    fs::write(project.folder.join("second.toml"), format!("{described}\n{stated}"))?;

    let found = project.run("diagnose first --filter 36d-p --verify second --out findings -q")?;
    assert!(found.starts_with("Missing: spin (") && found.contains("spin, d_f_i = k_i |omega|"), "{found}");
    let before = project.run("calibrate second --filter 36d-p -q")?;
    let after = project.run(
        "calibrate second --filter 36d-p --with findings/diagnosis.json --json c.json --out calibrated -q",
    )?;
    assert!(before.contains("does not fit") && after.contains("36d-p + spin fits"), "{before}\n{after}");
    let document: serde_json::Value = serde_json::from_slice(&fs::read(project.folder.join("c.json"))?)?;
    assert_eq!((document["filter"].as_str(), document["with"][0].as_str()), (Some("36d-p"), Some("spin")));
    let of_spin = document["parameters"].as_array().into_iter().flatten().find(|p| p["name"] == "spin");
    assert_eq!(of_spin.map(|parameter| &parameter["prior_sigma"]), Some(&5e-3.into()));
    project.run("navigate first --calibration c.json --align 100 --out navigated -q")?;
    project.run("export c.json --format c --out c.h")?;
    assert!(fs::read_to_string(project.folder.join("c.h"))?.contains("SPIN_X"));

    write_ranges(&project.folder.join("ranges"))?;
    let own = project.run("calibrate ranges --filter own-unit --out ranged -q")?;
    assert!(own.contains("own-unit fits") && own.contains("spin x"), "{own}");
    project.run("observe ranges --filter own-unit --out observed -q")?;
    project.run("diagnose ranges --filter own-unit --out own-findings -q")?;
    let noisy =
        project.run("campaign --units 4 --filters own-unit --hours 0 --scenario a.toml --out campaign -q")?;
    assert!(noisy.contains("own-unit"), "{noisy}");
    for report in ["findings", "calibrated", "navigated", "ranged", "observed", "own-findings", "campaign"] {
        let page = fs::read_to_string(project.folder.join(report).join("report.html"))?;
        assert!(page.contains("</html>"), "{report}");
    }
    Ok(())
}
