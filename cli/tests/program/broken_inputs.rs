//! Every kind of broken input ends with exit code 1, a message that names the place and what would be right, and
//! nothing left behind.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::support::{DESCRIPTION, Done, RATE, Table};

const NAN: f64 = f64::NAN;

/// What is broken, and how.
pub(crate) enum Break {
    /// The description: a piece of it replaced by another.
    Toml(&'static str, &'static str),
    /// The table, read from CSV and from Parquet.
    Rows(fn(&mut Table)),
    /// The description and the table.
    Both(fn(&str) -> String, fn(&mut Table)),
    /// The text of the CSV file.
    Csv(fn(String) -> Vec<u8>),
    /// The bytes of the Parquet file.
    Bytes(fn(Vec<u8>) -> Vec<u8>),
    /// A column of text in the Parquet file.
    Text(&'static str),
    /// Something else about the files in the folder.
    Files(fn(&Path) -> std::io::Result<()>),
}
use Break::{Both, Bytes, Csv, Files, Rows, Text, Toml};

/// What is broken, how, and pieces the message must hold.
pub(crate) type Case = (Break, &'static [&'static str]);

fn descriptions() -> Vec<Case> {
    vec![
        (Toml("rate_hz = 50.0", "rate_hz = 0.0"), &["log.toml, line 3, field `imu.rate_hz`", "above 0"]),
        (Toml("rate_hz = 50.0", "rate_hz = -50.0"), &["line 3, field `imu.rate_hz`: is -50"]),
        (
            Toml("rate_hz = 50.0", "rate_hz = \"50 Hz\""),
            &["field `imu.rate_hz`: is a string", "stands without quotes and without a unit"],
        ),
        (
            Toml("rate_hz = 50.0", "rate_hz = 50 Hz"),
            &["log.toml, line 3: is not valid TOML", "numbers have a point, no unit and no quotes"],
        ),
        (Toml("rate_hz = 50.0", "rate_hz: 50.0"), &["log.toml, line 3: is not valid TOML", "NAME = VALUE"]),
        (Toml("rate_hz = 50.0", "rate_hz = nan"), &["field `imu.rate_hz`: is NaN"]),
        (
            Toml("rate_hz = 50.0", "rate_hz = 100.0"),
            &["column `time_s`", "(50.000 Hz)", "100.000 Hz", "imu.rate_hz"],
        ),
        (Toml("rate_hz = 50.0", ""), &["field `imu.rate_hz`: is missing", "sampling rate"]),
        (Toml("rate_hz = 50.0", "rate = 50.0"), &["`imu.rate`: is not a name", "did you mean `rate_hz`?"]),
        (Toml("rate_hz = 50.0", "rate_hz = 5O.0"), &["log.toml, line 3: is not valid TOML"]),
        (Toml("[imu]\nrate_hz = 50.0", ""), &["log.toml, field `imu.rate_hz`: is missing"]),
        (Toml("[imu]", "[[imu]]"), &["field `imu`: is an array, a table was expected"]),
        (
            Toml("latitude_deg = 32.06", "latitude_deg = 91.0"),
            &["line 5, field `site.latitude_deg`", "from -89.9 to 89.9"],
        ),
        (Toml("longitude_deg = 118.8", "longitude_deg = inf"), &["line 6, field `site.longitude_deg`"]),
        (Toml("height_m = 20.0\n", ""), &["field `site.height_m`: is missing"]),
        (Toml("height_m = 20.0", "height_m = 6378137.0"), &["field `site.height_m`", "from -1000 to 20000"]),
        (
            Toml("[site]", "[sites]"),
            &["`[sites]`: is not a name", "did you mean `site`?", "`site`: is missing"],
        ),
        (
            Toml("[1.0, 0.0, 0.0, 0.0]", "[1.0, 0.1, 0.0, 0.0]"),
            &["`initial.quaternion_wxyz`: has norm 1.00498"],
        ),
        (Toml("[1.0, 0.0, 0.0, 0.0]", "[0.0, 0.0, 0.0, 0.0]"), &["has norm 0.000000", "w, x, y, z"]),
        (Toml("[1.0, 0.0, 0.0, 0.0]", "[1.0, 0.0, 0.0]"), &["has 3 entries, 4 numbers were expected"]),
        (Toml("[1.0, 0.0, 0.0, 0.0]", "[[1.0, 0.0, 0.0, 0.0]]"), &["has 1 entry, 4 numbers were expected"]),
        (Toml("[1.0, 0.0, 0.0, 0.0]", "[nan, 0.0, 0.0, 0.0]"), &["`initial.quaternion_wxyz`: is NaN"]),
        (Toml("level_sigma_deg = 0.05", "level_sigma_deg = 0"), &["`initial.level_sigma_deg`: is 0"]),
        (
            Toml("velocity_sigma_m_s = 0.001", "velocity_sigma_m_s = 0.0"),
            &["line 13", "velocity_sigma_m_s`: is 0"],
        ),
        (
            Toml("position_sigma_m = 0.002", "position_sigma_m = -0.002"),
            &["`reference.position_sigma_m`: is -0.002"],
        ),
        (
            Toml("attitude_sigma_deg = 0.01", "attitude_sigma_deg = true"),
            &["attitude_sigma_deg`: is a boolean"],
        ),
        (
            Toml("gyro_arw_deg_sqrt_h = 0.001", "gyro_arw_deg_sqrt_h = -1"),
            &["`noise.gyro_arw_deg_sqrt_h`: is -1"],
        ),
        (Toml("accel_vrw_ug_sqrt_hz", "accel_vrw"), &["did you mean `accel_vrw_ug_sqrt_hz`?"]),
        (
            Toml("reference_c = 25.0", "reference_c = 298.15"),
            &["`temperature.reference_c`", "from -80 to 150"],
        ),
        (
            Toml("xyz_m = [0.0, 0.0, 0.0]", "xyz_m = 0.0"),
            &["`outer_lever.xyz_m`: is a float, a list of 3 numbers"],
        ),
        (Toml("accel-bias", "accel-bais"), &["line 24", "is not an effect", "did you mean `accel-bias`?"]),
        (
            Toml("\"ug\"", "\"mm\""),
            &["`prior.accel-bias.unit`: `mm` is not a unit", "accepted: m/s^2, g, mg, ug"],
        ),
        (
            Toml("{ sigma = 300.0, unit = \"ug\" }", "{ sigma = 1.0, unit = \"m/s2\" }"),
            &["`prior.accel-bias.unit`: `m/s2` is not a unit", "did you mean `m/s^2`?"],
        ),
        (Toml("sigma = 300.0", "sigma = -300.0"), &["`prior.accel-bias.sigma`: is -300", "above 0"]),
        (Toml("sigma = 300.0", "sigma = 1e12"), &["`prior.accel-bias`: is 9.8", "from 1e-15 to 1e6 m/s^2"]),
        (
            Toml("position_sigma_m = 0.002", "position_sigma_m = 1e-200"),
            &["`reference.position_sigma_m`", "from 1e-9 to 1000000 was expected"],
        ),
        (
            Toml("accel_vrw_ug_sqrt_hz = 5.0", "accel_vrw_ug_sqrt_hz = 1e300"),
            &["`noise.accel_vrw_ug_sqrt_hz`"],
        ),
        (Toml("gyro_arw_deg_sqrt_h = 0.001", "gyro_arw_deg_sqrt_h = nan"), &["gyro_arw_deg_sqrt_h`: is NaN"]),
        (
            Toml("[1.0, 0.0, 0.0, 0.0]", "[1.0, 0.0, \"0\", 0.0]"),
            &["is a string, a finite number was expected"],
        ),
        (Toml("rate_hz = 50.0", "rate_hz = 50,0"), &["log.toml, line 3: is not valid TOML"]),
        (Toml("rate_hz = 50.0", "rate_hz = 99999999999999999999"), &["`imu.rate_hz`: has too many digits"]),
        (Toml("sigma = 300.0", "sigma = 0.0"), &["`prior.accel-bias.sigma`: is 0"]),
        (
            Toml("sigma = 300.0", "sigma = 1e200"),
            &["`prior.accel-bias`: is 9.8", "no filter can compute with this"],
        ),
        (
            Toml("sigma = 300.0, unit = \"ug\"", "sigma = 1e6, unit = \"m/s^2\""),
            &["log.csv: 36d-p: the filter diverged at ", " s, when ", "[prior]", "far too wide"],
        ),
        (Toml("sigma = 300.0, ", ""), &["`prior.accel-bias.sigma`: is missing"]),
        (Toml("{ sigma = 300.0, unit = \"ug\" }", "300.0"), &["must give a sigma and its unit"]),
        (Toml("rate_hz = 50.0", "rate_hz = 50.0\nrate_hz = 50.0"), &["line 4: is not valid TOML"]),
        (
            Toml("rate_hz = 50.0", "rate_hz = 50.0\ngyro_rad_per_pulse = [0, 1, 1]"),
            &["`imu.gyro_rad_per_pulse`: is 0"],
        ),
    ]
}

fn rows() -> Vec<Case> {
    vec![
        (
            Rows(|t| t.set("dtheta_x", 17, NAN)),
            &[
                "row 17, column `dtheta_x`: is NaN, an angle increment in rad",
                "every row needs a number here",
            ],
        ),
        (Rows(|t| t.set("dvel_z", 3, f64::INFINITY)), &["row 3, column `dvel_z`: is inf"]),
        (Rows(|t| t.set("time_s", 9, NAN)), &["row 9, column `time_s`: is NaN"]),
        (Rows(|t| t.set("time_s", 10, 9.0 / RATE)), &["row 10, column `time_s`: 0.18 s repeats"]),
        (Rows(|t| t.set("time_s", 10, 0.1)), &["row 10, column `time_s`: 0.1 s follows 0.18 s"]),
        (Rows(|t| t.drop_rows(101..=110)), &["row 101, column `time_s`: gap of 0.22", "--bridge-gaps"]),
        (Rows(|t| t.map("time_s", |_, time| time * 1000.0)), &["column `time_s`", "0.050 Hz", "50.000 Hz"]),
        (
            Rows(|t| t.map("time_s", |row, _| row as f64 / 60.0)),
            &["column `time_s`", "60.000 Hz", "imu.rate_hz"],
        ),
        (
            Rows(|t| t.set("dtheta_z", 40, 0.2)),
            &["row 40, column `dtheta_z`", "10.0 rad/s", "degrees taken for radians?"],
        ),
        (Rows(|t| t.set("dvel_y", 40, 30.0)), &["row 40, column `dvel_y`", "1500.0 m/s^2", "increments"]),
        (Rows(|t| t.map("dvel_*", |_, v| v / 9.80665)), &["`dvel_x`", "0.999 m/s^2 on average", "not in g"]),
        (Rows(|t| t.map("dvel_*", |_, v| v * RATE)), &["489.730 m/s^2 on average", "not forces"]),
        (Rows(|t| t.set("temp_y", 5, 298.15)), &["row 5, column `temp_y`: is 298.15, a temperature in degC"]),
        (
            Rows(|t| t.set("temp_gyro_z", 5, -90.0)),
            &["row 5, column `temp_gyro_z`: is -90", "from -80 to 150"],
        ),
        (Rows(|t| t.set("dither_x", 6, -0.1)), &["row 6, column `dither_x`: is -0.1, an amplitude in rad/s"]),
        (Rows(|t| t.set("dither_x", 6, f64::INFINITY)), &["row 6, column `dither_x`: is inf"]),
        (
            Rows(|t| t.set("ref_vel_n", 7, NAN)),
            &["row 7, column `ref_vel_n`: is NaN", "all components in a row"],
        ),
        (Rows(|t| t.set("ref_pos_u", 7, f64::NEG_INFINITY)), &["row 7, column `ref_pos_u`: is -inf"]),
        (Rows(|t| t.set("ref_quat_x", 8, NAN)), &["row 8, column `ref_quat_x`: is NaN"]),
        (
            Rows(|t| t.set("ref_quat_w", 8, 0.9)),
            &["row 8, column `ref_quat_w`", "has norm 0.900000", "no angles"],
        ),
        (
            Rows(|t| t.set("ref_quat_w", 8, 0.0)),
            &["row 8, column `ref_quat_w`", "has norm 0.000000", "leave the four fields empty"],
        ),
        (
            Rows(|t| t.set("ref_pos_e", 8, -2_604_352.0)),
            &["row 8, column `ref_pos_e`: is -2604352, a position in m within +-1000000", "not Earth-fixed"],
        ),
        (Rows(|t| t.drop("dvel_y")), &["column `dvel_y`: is missing beside `dvel_x`, `dvel_z`"]),
        (Rows(|t| t.drop("dtheta_*")), &["column `dtheta_x`: is missing", "gyro_pulse_x"]),
        (Rows(|t| t.drop("ref_vel_n")), &["column `ref_vel_n`: is missing beside `ref_vel_e`, `ref_vel_u`"]),
        (Rows(|t| t.drop("ref_quat_w")), &["column `ref_quat_w`: is missing", "all"]),
        (Rows(|t| t.drop("temp_z")), &["column `temp_z`: is missing"]),
        (
            Rows(|t| t.rename("dither_x", "diter_x")),
            &["column `diter_x`: is not a column", "did you mean `dither_x`?"],
        ),
        (Rows(|t| t.rename("temp_x", "temp_y")), &["column `temp_y`: stands there twice"]),
        (
            Rows(|t| {
                ["x", "y", "z"]
                    .iter()
                    .for_each(|a| t.rename(&format!("dtheta_{a}"), &format!("gyro_pulse_{a}")))
            }),
            &["column `gyro_pulse_x`: holds pulse counts", "lacks imu.gyro_rad_per_pulse"],
        ),
        (Rows(|t| t.drop_rows(1..=400)), &["has no rows"]),
        (Rows(|t| t.set("temp_*", 5, 303.15)), &["row 5, column `temp_x`: is 303.15", "in kelvin?"]),
        (Rows(|t| t.map("dither_y", |_, _| 4.6)), &["row 1, column `dither_y`: is 4.6", "in deg/s?"]),
        (
            Rows(|t| t.map("dtheta_x", |row, value| if row > 100 { NAN } else { value })),
            &["row 101, column `dtheta_x`: is NaN", "and so on in every row up to row 400"],
        ),
        (
            Rows(|t| t.map("time_s", |row, time| if row > 100 { time + 0.6 / RATE } else { time })),
            &["row 101, column `time_s`: gap of 0.032000 s (1.6 sampling intervals)"],
        ),
        (
            Rows(|t| t.columns.iter_mut().for_each(|(_, values)| values.reverse())),
            &["row 2, column `time_s`: 7.98 s follows 8 s", "times must increase"],
        ),
        (
            Rows(|t| t.columns.iter_mut().for_each(|(name, _)| *name = name.to_uppercase())),
            &["column `DTHETA_Y`: is not a column", "did you mean `dtheta_y`?"],
        ),
        (
            Rows(|t| t.columns.iter_mut().for_each(|(name, _)| *name = format!("col {name}"))),
            &[
                "none of its columns is one of the log format; the first is `col time_s`",
                "valid names: time_s",
            ],
        ),
        (
            Rows(|t| t.columns.insert(0, (String::new(), vec![0.0; 400]))),
            &["column 1 has no name", "row numbers"],
        ),
    ]
}

fn files() -> Vec<Case> {
    vec![
        (Csv(|_| Vec::new()), &["log.csv: is empty", "a header line"]),
        (
            Csv(|text| text.replace("0.07", "O.07").into()),
            &["row 1, column `dither_x`: `O.07` is not a number"],
        ),
        (
            Csv(|text| text.replacen(",0.07,", ",,", 1).replacen("0.02,0,", "0.02,,", 1).into()),
            &["column `dtheta_x`: is empty"],
        ),
        (
            Csv(|text| text[..text.len() - 40].into()),
            &["row 400: has", "fields, the header has 26", "cut off"],
        ),
        (
            Csv(|text| text.encode_utf16().flat_map(u16::to_le_bytes).collect()),
            &["log.csv: is UTF-16 text", "save it as UTF-8"],
        ),
        (
            Csv(|text| [0xfeff].into_iter().chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect()),
            &["log.csv: is UTF-16 text", "save it as UTF-8"],
        ),
        (Csv(|text| text.replacen("30.5", "N/A", 1).into()), &["column `temp_y`: `N/A`", "or write NaN"]),
        (Csv(|text| text.replacen("30.5", "30,5", 1).into()), &["row 1: has 27 fields", "with a point"]),
        (Csv(|text| text.split_once('\n').map_or("", |(_, rows)| rows).into()), &["line 1 holds numbers"]),
        (Csv(|_| vec![0xff; 300]), &["log.csv: is not text"]),
        (Csv(|_| vec![b'a'; 200_000]), &["no line end within 64 KiB"]),
        (Csv(|text| [text.as_bytes(), &[b'1'; 100_000]].concat()), &["row 401: no line end"]),
        (Csv(|_| b"PAR1....PAR1".into()), &["is a Parquet file, its ending says CSV"]),
        (Bytes(|_| Vec::new()), &["log.parquet: is empty (0 bytes)"]),
        (Bytes(|_| b"time_s,dtheta_x\n0.1,0.2\n".into()), &["is not a Parquet file", "must be called .csv"]),
        (
            Bytes(|bytes| bytes[..bytes.len() / 2].into()),
            &["log.parquet: is cut off", "write the file again"],
        ),
        (Bytes(|_| b"PAR1PAR1".into()), &["log.parquet: is cut off"]),
        (Bytes(|_| b"PAR1\0\0\0\0\0\0\0\0PAR1".into()), &["log.parquet: is damaged"]),
        (
            Bytes(|mut b| {
                let n = b.len();
                b[4..n / 3].fill(0x5a);
                b
            }),
            &["log.parquet, column `time_s`: is damaged", "the header of a page is damaged"],
        ),
        (Text("dtheta_x"), &["log.parquet, column `dtheta_x`: holds text, numbers were expected"]),
        (
            Files(|dir| fs::remove_file(dir.join("log.toml"))),
            &["log.toml: the description of the log is not there"],
        ),
        (
            Files(|dir| fs::remove_file(dir.join("log.csv"))),
            &["there is neither", "log.parquet nor", "log.csv"],
        ),
        (
            Files(|dir| fs::rename(dir.join("log.csv"), dir.join("log.CSV"))),
            &["there is neither", "log.CSV: endings are written in small letters"],
        ),
        (
            Files(|dir| fs::copy(dir.join("log.csv"), dir.join("log.parquet")).map(drop)),
            &["both", "with its ending"],
        ),
        (Files(|dir| fs::write(dir.join("log.toml"), [0x5b, 0xff])), &["log.toml: line 1 is not UTF-8"]),
        (
            Files(|dir| fs::write(dir.join("log.toml"), vec![b'#'; 2 << 20])),
            &["log.toml: is larger than 1 MiB"],
        ),
        (
            Files(|dir| fs::write(dir.join("log.toml"), "")),
            &["`imu.rate_hz`: is missing", "`site`: is missing"],
        ),
        (
            Files(|dir| {
                fs::remove_file(dir.join("log.csv"))?;
                fs::create_dir(dir.join("log.csv"))
            }),
            &["log.csv: is not a regular file"],
        ),
    ]
}

fn program(log: &Path, out: &Path) -> std::io::Result<Output> {
    Command::new(env!("CARGO_BIN_EXE_sinscal"))
        .args(["calibrate", "--filter", "36d-p", "--json"])
        .arg(out.join("out.json"))
        .arg("--out")
        .arg(out.join("results"))
        .arg(log)
        .output()
}

fn listing(folder: &Path) -> std::io::Result<BTreeSet<PathBuf>> {
    fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect()
}

/// Runs the program on the folder's log; what is wrong with its behaviour, if anything.
fn complaint(folder: &Path, expected: &[&str]) -> Result<Option<String>, Box<dyn std::error::Error>> {
    let before = listing(folder)?;
    let output = program(&folder.join("log"), folder)?;
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    let mut wrong = Vec::new();
    if output.status.code() != Some(1) {
        wrong.push(format!("exit code {:?}", output.status.code()));
    }
    wrong.extend(
        expected.iter().filter(|part| !message.contains(**part)).map(|part| format!("{part:?} is not said")),
    );
    if message.contains("panicked") || message.contains("RUST_BACKTRACE") {
        wrong.push("it panicked".into());
    }
    if !output.stdout.is_empty() {
        wrong.push("something is on standard output".into());
    }
    if listing(folder)? != before {
        wrong.push("something is left behind".into());
    }
    Ok((!wrong.is_empty()).then(|| format!("{}\n{message}", wrong.join("; "))))
}

/// Runs the program on every case.
pub(crate) fn check(cases: Vec<Case>) -> Done {
    let mut failures = Vec::new();
    let mut run = |prepare: &dyn Fn(&Path) -> Done, expected: &[&str]| -> Done {
        let folder = tempfile::tempdir()?;
        fs::write(folder.path().join("log.toml"), DESCRIPTION)?;
        prepare(folder.path())?;
        failures.extend(complaint(folder.path(), expected)?.map(|text| format!("for {expected:?}: {text}")));
        Ok(())
    };
    let sound = Table::at_rest(400);
    for (fault, expected) in &cases {
        match fault {
            Toml(from, to) => run(
                &|folder| {
                    assert!(DESCRIPTION.contains(from), "{from}");
                    fs::write(folder.join("log.toml"), DESCRIPTION.replacen(from, to, 1))?;
                    sound.write_csv(&folder.join("log.csv"))
                },
                expected,
            )?,
            Rows(spoil) => {
                let mut table = sound.clone();
                spoil(&mut table);
                run(&|folder| table.write_csv(&folder.join("log.csv")), expected)?;
                run(&|folder| table.write_parquet(&folder.join("log.parquet"), None), expected)?;
            }
            Both(describe, spoil) => {
                let mut table = sound.clone();
                spoil(&mut table);
                run(
                    &|folder| {
                        fs::write(folder.join("log.toml"), describe(DESCRIPTION))?;
                        table.write_csv(&folder.join("log.csv"))
                    },
                    expected,
                )?;
            }
            Csv(spoil) => {
                run(&|folder| Ok(fs::write(folder.join("log.csv"), spoil(sound.csv()))?), expected)?
            }
            Bytes(spoil) => run(
                &|folder| {
                    let path = folder.join("log.parquet");
                    sound.write_parquet(&path, None)?;
                    Ok(fs::write(&path, spoil(fs::read(&path)?))?)
                },
                expected,
            )?,
            Text(column) => {
                run(&|folder| sound.write_parquet(&folder.join("log.parquet"), Some(column)), expected)?;
            }
            Files(spoil) => run(
                &|folder| {
                    sound.write_csv(&folder.join("log.csv"))?;
                    Ok(spoil(folder)?)
                },
                expected,
            )?,
        }
    }
    assert!(failures.is_empty(), "{} of {} cases:\n{}", failures.len(), cases.len(), failures.join("\n"));
    Ok(())
}

#[test]
fn broken_descriptions() -> Done {
    check(descriptions())
}

#[test]
fn broken_rows() -> Done {
    check(rows())
}

#[test]
fn broken_files() -> Done {
    check(files())
}

#[test]
fn the_sound_log_is_sound() -> Done {
    let folder = tempfile::tempdir()?;
    fs::write(folder.path().join("log.toml"), DESCRIPTION)?;
    Table::at_rest(400).write_csv(&folder.path().join("log.csv"))?;
    let output = program(&folder.path().join("log"), folder.path())?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Ok(())
}

#[test]
fn several_faulty_rows_are_all_named() -> Done {
    let folder = tempfile::tempdir()?;
    fs::write(folder.path().join("log.toml"), DESCRIPTION)?;
    let mut table = Table::at_rest(400);
    for row in [30, 31, 200] {
        table.set("dtheta_y", row, NAN);
    }
    table.set("temp_x", 350, 500.0);
    table.write_csv(&folder.path().join("log.csv"))?;
    let expected = ["row 30,", "in every row up to row 31", "row 200,", "row 350, column `temp_x`"];
    assert_eq!(complaint(folder.path(), &expected)?, None);
    Ok(())
}

/// Flips bytes all over each file of a log: it is read or refused; the program never fails in another way.
#[test]
fn damaged_files_never_break_the_program() -> Done {
    for damaged in ["log.parquet", "log.csv", "log.toml"] {
        let folder = tempfile::tempdir()?;
        fs::write(folder.path().join("log.toml"), DESCRIPTION)?;
        if damaged == "log.parquet" {
            Table::at_rest(40).write_parquet(&folder.path().join(damaged), None)?;
        } else {
            Table::at_rest(40).write_csv(&folder.path().join("log.csv"))?;
        }
        let path = folder.path().join(damaged);
        let sound = fs::read(&path)?;
        let mut state = 1_u64;
        for round in 0..60 {
            let mut bytes = sound.clone();
            for _ in 0..=round % 3 {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let place = (state >> 33) as usize % bytes.len();
                bytes[place] ^= (state >> 24) as u8 | 1;
            }
            fs::write(&path, bytes)?;
            let output = program(&folder.path().join("log"), folder.path())?;
            let message = String::from_utf8_lossy(&output.stderr);
            assert!(
                matches!(output.status.code(), Some(0 | 1)),
                "{damaged}, round {round}: {:?} {message}",
                output.status
            );
            assert!(!message.contains("panicked"), "{damaged}, round {round}: {message}");
        }
    }
    Ok(())
}
