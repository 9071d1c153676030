//! Tests of files that others wrote, and of the column map. `tests/formats/check.py --fixtures` wrote the files.

use std::fs;
use std::path::{Path, PathBuf};

use sinscal::Sample;

use super::tests::support::{Done, Table};
use super::{ColumnMap, Log, LogError, Reading};

const DESCRIPTION: &str =
    "[imu]\nrate_hz = 10.0\n[site]\nlatitude_deg = 32.06\nlongitude_deg = 118.8\nheight_m = 20.0\n";

/// What is read here with the features of this build.
const READABLE: &[&str] = &[
    #[cfg(feature = "mat")]
    "v5.mat",
    #[cfg(feature = "mat")]
    "v7.mat",
    #[cfg(feature = "hdf5")]
    "v73.mat",
    #[cfg(feature = "hdf5")]
    "plain.h5",
    #[cfg(feature = "hdf5")]
    "packed.h5",
    #[cfg(feature = "npz")]
    "plain.npz",
    #[cfg(feature = "npz")]
    "packed.npz",
];

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../cli/tests/formats").join(name)
}

/// The samples of a table with this description beside it.
fn samples(bytes: &[u8], name: &str, map: &str, description: &str) -> Result<Vec<Sample>, LogError> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    fs::write(&path, bytes).expect("a table");
    fs::write(path.with_extension("toml"), description).expect("a description");
    let map = if map.is_empty() { ColumnMap::default() } else { map.parse().expect("a map") };
    Log::open(&path, &Reading { map, ..Reading::default() })?.samples()?.collect()
}

fn of_fixture(name: &str, map: &str) -> Result<Vec<Sample>, LogError> {
    samples(&fs::read(fixture(name)).expect("a fixture"), name, map, DESCRIPTION)
}

fn shown(samples: &[Sample]) -> Vec<String> {
    samples.iter().map(|sample| format!("{sample:?}")).collect()
}

fn refusal(result: Result<Vec<Sample>, LogError>) -> String {
    match result {
        Ok(samples) => format!("accepted with {} samples", samples.len()),
        Err(fault) => fault.messages().join("\n"),
    }
}

#[test]
fn psins_is_read_from_every_format_to_the_bit() -> Done {
    let expected = shown(&of_fixture("small.csv", "")?);
    assert_eq!(expected.len(), 30);
    for ending in READABLE {
        assert_eq!(shown(&of_fixture(&format!("small-{ending}"), "")?), expected, "{ending}");
    }
    #[cfg(feature = "npz")]
    assert_eq!(shown(&of_fixture("small.npy", "")?), expected);
    Ok(())
}

#[test]
fn arrays_by_map_with_whatever_stands_beside_them() -> Done {
    let expected = shown(&of_fixture("small.csv", "")?);
    for name in ["workspace-v5.mat", "workspace-v7.mat", "workspace.npz", "workspace.h5"] {
        if READABLE.iter().any(|ending| name.ends_with(ending.rsplit('.').next().unwrap_or_default())) {
            assert_eq!(shown(&of_fixture(name, "gyro=wm,accel=vm,time=t")?), expected, "{name}");
        }
    }
    #[cfg(feature = "hdf5")]
    assert_eq!(shown(&of_fixture("workspace.h5", "gyro=wm,accel=vm,time=group/t")?), expected);
    Ok(())
}

#[test]
fn what_is_no_array_of_numbers_is_refused_by_name() {
    let everywhere = [
        ("text", "holds text"),
        ("complex", "holds complex values"),
        ("flags", "holds true/false values"),
        ("cube", "holds an array of 3 dimensions"),
        ("empty", "holds nothing"),
        ("short", "has 29 rows"),
        ("t", "has 1 column, `accel` needs 3"),
        ("vn", "is not in the file, but --map accel=vn asks for it"),
        ("vm[1:4]", "has 3 columns, counted from 0: there is no [3]"),
        ("wm", "is asked for twice"),
    ];
    let matlab =
        [("cells", "holds cells"), ("struct", "holds a struct"), ("sparse", "holds a sparse matrix")];
    for name in ["workspace-v5.mat", "workspace-v7.mat", "workspace.npz", "workspace.h5"] {
        let ending = name.rsplit('.').next().unwrap_or_default();
        if !READABLE.iter().any(|readable| readable.ends_with(ending) && *readable != "v73.mat") {
            continue;
        }
        let of_matlab = matlab.iter().filter(|_| ending == "mat");
        for (variable, part) in everywhere.iter().chain(of_matlab) {
            let message = refusal(of_fixture(name, &format!("gyro=wm,accel={variable},time=t")));
            let variable = variable.split('[').next().unwrap_or_default();
            let told = message.contains(name) && message.contains(&format!("variable `{variable}`"));
            assert!(told && message.contains(part), "{name} {variable}: {message}");
        }
        let message = refusal(of_fixture(name, ""));
        assert!(message.contains("none of its variables is one of the log format"), "{message}");
        assert!(message.contains("`wm` (3 columns)") && message.contains("--map gyro=wm"), "{message}");
    }
}

#[test]
fn damaged_and_foreign_files_are_refused_by_name() {
    for ending in READABLE.iter().copied().chain(cfg!(feature = "npz").then_some("npy")) {
        let name = if ending == "npy" { "small.npy".to_owned() } else { format!("small-{ending}") };
        let sound = fs::read(fixture(&name)).expect("a fixture");
        let csv = fs::read(fixture("small.csv")).expect("a fixture");
        let half = sound.len() / 2;
        for (what, bytes) in [
            ("empty", &[][..]),
            ("cut", &sound[..half]),
            ("short", &sound[..sound.len() - 9]),
            ("text", &csv),
        ] {
            let message = refusal(samples(bytes, &name, "", DESCRIPTION));
            assert!(message.contains(&name) && message.contains("help: "), "{ending}, {what}: {message}");
        }
    }
}

#[test]
fn a_build_without_a_format_says_how_to_get_it() {
    for (name, feature) in
        [("small-v5.mat", "mat"), ("small-v73.mat", "hdf5"), ("small-plain.h5", "hdf5"), ("small.npy", "npz")]
    {
        let readable = READABLE.iter().any(|ending| name.ends_with(ending))
            || cfg!(feature = "npz") && name == "small.npy";
        if !readable {
            let message = refusal(of_fixture(name, ""));
            assert!(message.contains(&format!("--features {feature}`")), "{message}");
        }
    }
}

/// The golden way there: rates in foreign units under foreign names become the increments of the format.
#[test]
fn a_table_with_foreign_names_and_units_is_mapped() -> Done {
    let mut table = Table::at_rest(200);
    table.map("dtheta_x", |row, _| 1e-2 * (row as f64 * 0.7).sin());
    table.drop("temp*");
    table.drop("dither*");
    table.drop("ref_pos*");
    let description = DESCRIPTION.replace("10.0", "50.0");
    let expected = samples(table.csv().as_bytes(), "log.csv", "", &description)?;
    table.map("time_s", |_, time| time * 1e3);
    table.map("dtheta_*", |_, value| (value * 50.0).to_degrees());
    table.map("dvel_*", |_, value| value * 50.0 / 9.80665);
    table.map("dvel_z", |_, value| -value);
    for (from, to) in [
        ("time_s", "stamp [ms]"),
        ("dtheta_x", "wX"),
        ("dtheta_y", "wY"),
        ("dtheta_z", "wZ"),
        ("dvel_x", "f.x"),
        ("dvel_y", "f.y"),
        ("dvel_z", "down"),
        ("ref_quat_w", "q0"),
    ] {
        table.rename(from, to);
    }
    table.columns.push(("remark".into(), vec![f64::NAN; 200]));
    let map = "time=stamp [ms]:ms,gyro=w:deg/s,dvel_x=f.x:g,dvel_y=f.y:g,dvel_z=-down:g,ref_quat_w=q0";
    let folder = tempfile::tempdir()?;
    table.write_csv(&folder.path().join("a.csv"))?;
    table.write_parquet(&folder.path().join("b.parquet"), Some("remark"))?;
    for name in ["a.csv", "b.parquet"] {
        let bytes = fs::read(folder.path().join(name))?;
        let found = samples(&bytes, name, map, &description)?;
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found.time - expected.time).abs() < 1e-12);
            assert!(
                (found.dtheta - expected.dtheta).norm() < 1e-15
                    && (found.dvel - expected.dvel).norm() < 1e-12
            );
            assert_eq!(found.reference.attitude, expected.reference.attitude);
        }
        let mistaken = refusal(samples(&bytes, name, &map.replace(":deg/s", ":rad/s"), &description));
        assert!(mistaken.contains("`dtheta_x` is wX of the file"), "{mistaken}");
        let unknown = refusal(samples(&bytes, name, &map.replace("gyro=w", "gyro=v"), &description));
        assert!(unknown.contains("column `v`: is not in the file"), "{unknown}");
        let twice = refusal(samples(&bytes, name, &map.replace("dvel_y=f.y", "dvel_y=f.x"), &description));
        assert!(twice.contains("column `f.x`: is asked for twice"), "{twice}");
    }
    let without = refusal(samples(&fs::read(folder.path().join("a.csv"))?, "a.csv", "", &description));
    assert!(without.contains("column `wX`: is not a column of the log format"), "{without}");
    Ok(())
}

/// Rates last from the row before; the first row, and the row after a gap, one interval.
#[test]
fn rates_become_increments_by_the_time_between_rows() -> Done {
    let mut table = Table { columns: Table::at_rest(100).columns.split_off(0) };
    table.columns.truncate(7);
    table.map("time_s", |row, time| if row % 2 == 0 { time + 0.002 } else { time });
    table.map("dvel_*", |_, value| value * 50.0);
    let description = DESCRIPTION.replace("10.0", "50.0");
    let found = samples(
        table.csv().as_bytes(),
        "log.csv",
        "dvel_x=dvel_x,dvel_y=dvel_y,dvel_z=dvel_z:m/s^2",
        &description,
    )?;
    let expected = |seconds: f64| move |sample: &Sample| (sample.dvel.z - 9.7946 * seconds).abs() < 1e-9;
    assert!(expected(0.02)(&found[0]));
    assert!(found.iter().skip(1).step_by(2).all(expected(0.022)));
    assert!(found.iter().skip(2).step_by(2).all(expected(0.018)));
    Ok(())
}

#[cfg(any(feature = "mat", feature = "npz", feature = "hdf5"))]
mod damage {
    use proptest::prelude::*;

    use super::*;
    use crate::fuzz::damage::damaged;

    /// Reads a damaged table to its end or its first fault.
    fn survives(damaged: &[u8], name: &str) -> Result<(), TestCaseError> {
        for map in ["", "gyro=imu[0:3],accel=imu[3:6]:g,time=imu[6]"] {
            match samples(damaged, name, map, DESCRIPTION) {
                Ok(samples) => prop_assert!(samples.len() < 100_000),
                Err(fault) => prop_assert!(!fault.messages().is_empty()),
            }
        }
        Ok(())
    }

    macro_rules! fuzz {
        ($($feature:literal $test:ident $name:literal;)+) => {
            proptest! {
                $(
                    #[cfg(feature = $feature)]
                    #[test]
                    fn $test(damaged in damaged(fs::read(fixture($name)).expect("a fixture"))) {
                        survives(&damaged, $name)?;
                    }
                )+
            }
        };
    }

    fuzz! {
        "mat" fuzz_mat_v5 "small-v5.mat";
        "mat" fuzz_mat_v7 "small-v7.mat";
        "hdf5" fuzz_mat_v73 "small-v73.mat";
        "hdf5" fuzz_hdf5_packed "small-packed.h5";
        "hdf5" fuzz_hdf5_plain "small-plain.h5";
        "npz" fuzz_npz_packed "small-packed.npz";
        "npz" fuzz_npz_plain "small-plain.npz";
        "npz" fuzz_npy "small.npy";
    }
}
