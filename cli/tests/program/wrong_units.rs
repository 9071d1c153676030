//! Logs whose every number is plausible and which are wrong as a whole: other units, other orders, other places. A unit that
//! stands still must feel gravity and the Earth's rate.

use std::fs;
use std::process::Command;

use crate::broken_inputs::{Break, check};
use crate::support::{DESCRIPTION, Done, RATE, Table};
use Break::{Both, Rows, Toml};

#[test]
fn units_of_angle_increments() -> Done {
    const DEGREES: &str =
        "the unit turns by 861.7897 deg/h, the Earth by 15.04: this looks like degrees, not rad";
    const COLUMNS: &str =
        "log.csv, column `dtheta_x`, `dtheta_y`, `dtheta_z`: standing still for its first 8 s";
    fn scaled(t: &mut Table, by: f64) {
        t.map("dtheta_*", |_, angle| angle * by);
    }
    check(vec![
        (
            Rows(|t| scaled(t, 57.295_78)),
            &[DEGREES, "angle increments over one interval are expected, in rad"],
        ),
        (Both(|text| text.into(), |t| scaled(t, 57.295_78)), &[COLUMNS]),
        (Rows(|t| scaled(t, 3_437.746_8)), &["looks like arc minutes"]),
        (Rows(|t| scaled(t, 206_264.8)), &["beyond what a turntable"]),
        (Rows(|t| scaled(t, 1e3)), &["looks like mrad"]),
        (Rows(|t| scaled(t, RATE)), &["looks like rates in rad/s, not increments; or like degrees"]),
        (Rows(|t| scaled(t, RATE * 57.295_78)), &["looks like rates in deg/s"]),
        (Rows(|t| t.map("dtheta_*", |_, angle| angle * RATE * 206_264.8)), &["beyond what a turntable"]),
        (Rows(|t| scaled(t, 1.0 / 57.295_78)), &["turns by 0.2625 deg/h", "the Earth's rate not taken out"]),
        (Rows(|t| scaled(t, 0.0)), &["turns by 0.0000 deg/h, the Earth by 15.04", "not taken out"]),
        // a gyro axis that points the other way
        (
            Rows(|t| t.map("dtheta_z", |_, angle| -angle)),
            &["field `site.latitude_deg`: is 32.06", "shows about -32"],
        ),
    ])
}

#[test]
fn units_of_velocity_increments() -> Done {
    fn scaled(t: &mut Table, by: f64) {
        t.map("dvel_*", |_, velocity| velocity * by);
    }
    check(vec![
        (
            Rows(|t| scaled(t, 1.0 / 9.80665)),
            &["0.999 m/s^2", "this looks like increments in g s, not in m/s"],
        ),
        (
            Rows(|t| scaled(t, 1.0 / 0.3048)),
            &["feels 32.135 m/s^2, gravity is 9.795: this looks like increments in ft/s"],
        ),
        (
            Rows(|t| scaled(t, RATE)),
            &["489.730 m/s^2", "this looks like accelerations in m/s^2, not increments"],
        ),
        (
            Rows(|t| scaled(t, RATE / 9.80665)),
            &["feels 49.939 m/s^2", "accelerations in g, not increments in m/s"],
        ),
        (Rows(|t| scaled(t, 1e3)), &["row 1, column `dvel_z`: 195.892", "in 0.02 s is 9794.6 m/s^2"]),
        (Rows(|t| scaled(t, 0.0)), &["0.000 m/s^2 on average"]),
        // every second row left out, and what it held
        (
            Rows(|t| scaled(t, 0.5)),
            &["feels 4.897 m/s^2, gravity is 9.795", "where rows were left out, theirs are to be added"],
        ),
    ])
}

#[test]
fn units_of_time() -> Done {
    check(vec![
        (
            Rows(|t| t.map("time_s", |_, time| time * 1e3)),
            &["column `time_s`", "looks like times in ms: seconds are expected"],
        ),
        (Rows(|t| t.map("time_s", |_, time| time * 1e6)), &["looks like times in us"]),
        (
            Rows(|t| t.map("time_s", |_, time| 1e9 * time)),
            &["2.000e7 s apart (5.000e-8 Hz)", "looks like times in ns"],
        ),
        (Rows(|t| t.map("time_s", |_, time| time / 60.0)), &["looks like times in minutes"]),
        (Rows(|t| t.map("time_s", |_, time| time / 86_400.0)), &["looks like times in days"]),
        (
            Rows(|t| t.map("time_s", |row, _| row as f64)),
            &["(1.000 Hz), the description says 50.000 Hz", "this looks like row numbers"],
        ),
        (
            Rows(|t| t.map("time_s", |_, time| f64::from((1.7e9 + time) as f32))),
            &[
                "counted from 1700000000 s",
                "row 2, column `time_s`: 0 s repeats",
                "written with too few digits",
            ],
        ),
        (
            Rows(|t| t.map("time_s", |_, time| time % 4.0)),
            &["row 200, column `time_s`: 0 s follows 3.98 s", "or a clock that began anew?"],
        ),
        (Toml("rate_hz = 50.0", "rate_hz = 0.02"), &["column `time_s`", "the description says 0.020 Hz"]),
        (Toml("rate_hz = 50.0", "rate_hz = 5000.0"), &["(50.000 Hz), the description says 5000.000 Hz"]),
    ])
}

#[test]
fn orders_and_places() -> Done {
    // y points up and z south
    fn tipped(t: &mut Table) {
        for triad in ["dtheta", "dvel"] {
            let (y, z) = (format!("{triad}_y"), format!("{triad}_z"));
            t.rename(&y, "aside");
            t.rename(&z, &y);
            t.rename("aside", &z);
        }
        t.map("dtheta_z", |_, angle| -angle);
        t.map("dvel_z", |_, velocity| -velocity);
    }
    check(vec![
        // right would be a quarter turn about x
        (
            Both(|text| text.replace("[1.0, 0.0, 0.0, 0.0]", "[0.7071068, 0.0, 0.0, 0.7071068]"), tipped),
            &[
                "log.toml, line 9, field `initial.quaternion_wxyz`: gravity would be 90.0 deg off",
                "in the order x, y, z, w",
            ],
        ),
        (
            Both(|text| text.replace("[1.0, 0.0, 0.0, 0.0]", "[0.7071068, -0.7071068, 0.0, 0.0]"), tipped),
            &[
                "gravity would be 180.0 deg off the vertical where the unit stands still",
                "this one is its inverse",
            ],
        ),
        // axes forward, right and down, or the accelerometers' sign
        (
            Rows(|t| {
                t.map("dvel_z", |_, velocity| -velocity);
                t.map("dtheta_z", |_, angle| -angle);
            }),
            &[
                "line 9, field `initial.quaternion_wxyz`: gravity would be 180.0",
                "or the axes are forward, right, down",
            ],
        ),
        // x and y exchanged
        (
            Rows(|t| {
                t.rename("dtheta_x", "aside");
                t.rename("dtheta_y", "dtheta_x");
                t.rename("aside", "dtheta_y");
            }),
            &[
                "field `initial.quaternion_wxyz`: the Earth's rate would point 90 deg off north",
                "x and y exchanged, or a heading that does not count from north?",
            ],
        ),
        (
            Rows(|t| {
                t.map("ref_quat_w", |_, _| 0.0);
                t.map("ref_quat_z", |_, _| 1.0);
            }),
            &[
                "`ref_quat_x`, `ref_quat_y`, `ref_quat_z`: the Earth's rate would point 180 deg off north",
                "these numbers are in the order x, y, z, w",
            ],
        ),
        (
            Rows(|t| t.map("dtheta_z", |_, _| 0.0)),
            &["field `site.latitude_deg`", "shows about 0", "`dtheta_z`", "read nothing but 0"],
        ),
        (
            Rows(|t| {
                t.map("ref_pos_e", |_, _| 32.06);
                t.map("ref_pos_n", |_, _| 118.8);
            }),
            &[
                "column `ref_pos_e`, `ref_pos_n`, `ref_pos_u`: begins with 32.06 and 118.8: the longitude and latitude",
                "in m",
            ],
        ),
        (
            Toml("[1.0, 0.0, 0.0, 0.0]", "[0.9, 0.43588989, 0.0, 0.0]"),
            &["gravity would be 51.7 deg off", "x right, y forward, z up"],
        ),
        (
            Rows(|t| {
                t.map("ref_quat_w", |_, _| 0.0);
                t.map("ref_quat_x", |_, _| 1.0);
            }),
            &[
                "column `ref_quat_w`, `ref_quat_x`, `ref_quat_y`, `ref_quat_z`: gravity would be 180.0 deg off",
            ],
        ),
        (
            Toml(
                "latitude_deg = 32.06\nlongitude_deg = 118.8",
                "latitude_deg = 118.8\nlongitude_deg = 32.06",
            ),
            &["field `site.latitude_deg`: is 118.8", "from -89.9 to 89.9"],
        ),
        (
            Toml("latitude_deg = 32.06\nlongitude_deg = 118.8", "latitude_deg = 70.0\nlongitude_deg = 32.06"),
            &["field `site.latitude_deg`: is 70.00", "shows about 32", "latitude and longitude exchanged?"],
        ),
        (Toml("latitude_deg = 32.06", "latitude_deg = -32.06"), &["shows about 32", "north is positive"]),
        (
            Toml("latitude_deg = 32.06", "latitude_deg = 0.5595"),
            &["is 0.56", "shows about 32", "this looks like rad"],
        ),
    ])
}

/// No fault, but worth a word: between two samples so far apart too much happens.
#[test]
fn a_rate_too_low_for_the_turns_is_said() -> Done {
    let folder = tempfile::tempdir()?;
    fs::write(folder.path().join("log.toml"), DESCRIPTION)?;
    for (turn, said) in [(0.06, true), (0.04, false)] {
        let mut table = Table::at_rest(400);
        table.map("dtheta_z", |_, angle| angle + turn);
        table.write_csv(&folder.path().join("log.csv"))?;
        let run = Command::new(env!("CARGO_BIN_EXE_sinscal"))
            .args(["calibrate", "log", "--filter", "36d-p"])
            .current_dir(folder.path())
            .output()?;
        let message = String::from_utf8_lossy(&run.stderr);
        assert!(run.status.success(), "{message}");
        let warned = message.contains("turns by up to 3.4 deg from one sample to the next");
        assert_eq!(warned, said, "{message}");
    }
    Ok(())
}
