//! Reading sound logs. The broken ones are in the tests of the program.

use std::fs;
use std::path::Path;

use sinscal::Sample;

use super::{Bridged, LogError, Reading};
use support::{DESCRIPTION, Done, RATE, Table};

#[path = "../../cli/tests/program/support.rs"]
pub(super) mod support;

/// Opens a log whose columns go by the names of the format.
struct Log;

impl Log {
    fn open(path: &Path) -> Result<super::Log, LogError> {
        super::Log::open(path, &Reading::default())
    }
}

fn read(log: &super::Log) -> Result<(Vec<Sample>, Bridged), LogError> {
    let mut samples = log.samples()?;
    let mut read = Vec::new();
    for sample in samples.by_ref() {
        read.push(sample?);
    }
    Ok((read, samples.bridged()))
}

/// A log with both kinds of table, `name.csv` and `name-p.parquet`.
fn write(folder: &Path, table: &Table, description: &str) -> Done {
    table.write_csv(&folder.join("c.csv"))?;
    table.write_parquet(&folder.join("p.parquet"), None)?;
    fs::write(folder.join("c.toml"), description)?;
    fs::write(folder.join("p.toml"), description)?;
    Ok(())
}

/// NaN is not equal to itself: compare what is shown.
fn shown(samples: &[Sample]) -> Vec<String> {
    samples.iter().map(|sample| format!("{sample:?}")).collect()
}

#[test]
fn what_may_be_wrong_is_a_prior() -> Done {
    let folder = tempfile::tempdir()?;
    let described = |uncertainty: &str| {
        write(folder.path(), &Table::at_rest(10), &format!("{DESCRIPTION}\n[uncertainty]\n{uncertainty}\n"))?;
        Ok::<_, Box<dyn std::error::Error>>(Log::open(&folder.path().join("c"))?.description().clone())
    };
    let arcsec = (1.0_f64 / 3600.0).to_radians();
    let stated = described("clock = \"1 ppm\"\ntable_orthogonality = \"30 arcsec\"")?;
    let expected = [("clock-scale", 1e-6), ("table-orthogonality", 30.0 * arcsec)];
    assert!(expected.iter().all(|one| stated.priors.contains(one)), "{:?}", stated.priors);
    assert_eq!(stated.uncertainty, expected);
    let refused = described("table_orthogonality = \"30 s\"").err().ok_or("taken for an angle")?;
    assert!(format!("{refused:?}").contains("uncertainty.table_orthogonality"), "{refused:?}");
    Ok(())
}

#[test]
fn parquet_and_csv_give_the_same_samples() -> Done {
    let folder = tempfile::tempdir()?;
    // more than one batch, numbers with all their digits, gaps in what may have gaps
    let mut table = Table::at_rest(9000);
    table.map("dtheta_x", |row, _| 1e-3 * (row as f64 * 0.7).sin());
    table.map("dvel_y", |row, _| 1e-2 * (row as f64 * 0.3).cos());
    table.map("temp_*", |row, value| if row % 50 == 1 { value } else { f64::NAN });
    table.map("ref_*", |row, value| if row % 5 == 0 { value } else { f64::NAN });
    write(folder.path(), &table, DESCRIPTION)?;
    let (csv, _) = read(&Log::open(&folder.path().join("c"))?)?;
    let (parquet, _) = read(&Log::open(&folder.path().join("p"))?)?;
    assert_eq!(csv.len(), 9000);
    assert_eq!(shown(&csv), shown(&parquet));
    Ok(())
}

#[test]
fn every_spelling_of_the_name_is_the_log() -> Done {
    let folder = tempfile::tempdir()?;
    write(folder.path(), &Table::at_rest(100), DESCRIPTION)?;
    for name in ["c", "c.csv", "c.toml", "p", "p.parquet", "p.toml"] {
        assert_eq!(read(&Log::open(&folder.path().join(name))?)?.0.len(), 100, "{name}");
    }
    fs::rename(folder.path().join("p.parquet"), folder.path().join("c.parquet"))?;
    let both = Log::open(&folder.path().join("c"));
    assert!(both.is_err_and(|error| error.messages().join(" ").contains("with its ending")));
    assert_eq!(read(&Log::open(&folder.path().join("c.csv"))?)?.0.len(), 100);
    assert_eq!(read(&Log::open(&folder.path().join("c.parquet"))?)?.0.len(), 100);
    Ok(())
}

#[test]
fn missing_readings_stay_missing_for_the_library_to_hold() -> Done {
    let folder = tempfile::tempdir()?;
    let mut table = Table::at_rest(100);
    table.set("temp_y", 2, f64::NAN);
    table.set("dither_x", 3, f64::NAN);
    table.set("ref_vel_*", 4, f64::NAN);
    table.set("ref_quat_*", 5, f64::NAN);
    table.drop("temp_gyro_*");
    write(folder.path(), &table, DESCRIPTION)?;
    for name in ["c", "p"] {
        let (samples, _) = read(&Log::open(&folder.path().join(name))?)?;
        let [first, second, third, fourth, fifth, ..] = samples.as_slice() else {
            return Err("too few".into());
        };
        assert_eq!(first.temperature.as_slice(), [30.0, 30.5, 31.0]);
        assert!(
            second.temperature.x == 30.0 && second.temperature.y.is_nan() && second.temperature.z == 31.0
        );
        assert!(third.dither.x.is_nan() && third.dither.y == 0.08);
        assert!(fourth.reference.velocity.is_none() && fourth.reference.position.is_some());
        assert!(fifth.reference.velocity.is_some() && fifth.reference.attitude.is_none());
        assert!(first.gyro_temperature.iter().all(|value| value.is_nan()));
    }
    Ok(())
}

#[test]
fn without_reference_columns_the_point_is_fixed() -> Done {
    let folder = tempfile::tempdir()?;
    let mut table = Table::at_rest(100);
    write(folder.path(), &table, DESCRIPTION)?;
    assert_eq!(Log::open(&folder.path().join("c"))?.update_rate(), super::MEASURED_RATE);
    table.drop("ref_*");
    write(folder.path(), &table, DESCRIPTION)?;
    let log = Log::open(&folder.path().join("c"))?;
    assert_eq!(log.update_rate(), super::FIXED_POINT_RATE);
    let zero = Some(nalgebra::Vector3::zeros());
    for sample in read(&log)?.0 {
        assert!(sample.reference.velocity == zero && sample.reference.position == zero);
        assert!(sample.reference.attitude.is_none());
    }
    Ok(())
}

#[test]
fn pulses_are_scaled_and_quaternions_normalised() -> Done {
    let folder = tempfile::tempdir()?;
    let mut table = Table::at_rest(100);
    for axis in ["x", "y", "z"] {
        table.rename(&format!("dtheta_{axis}"), &format!("gyro_pulse_{axis}"));
        table.rename(&format!("dvel_{axis}"), &format!("accel_pulse_{axis}"));
    }
    table.map("gyro_pulse_*", |_, _| 10.0);
    table.map("accel_pulse_*", |_, _| 1958.0);
    table.map("ref_quat_w", |_, _| 1.0005);
    let scales =
        "rate_hz = 50.0\ngyro_rad_per_pulse = [1e-6, 2e-6, 3e-6]\naccel_m_s_per_pulse = [1e-4, 1e-5, 1e-6]";
    write(folder.path(), &table, &DESCRIPTION.replace("rate_hz = 50.0", scales))?;
    for name in ["c", "p"] {
        for sample in read(&Log::open(&folder.path().join(name))?)?.0 {
            assert_eq!(sample.dtheta, nalgebra::Vector3::new(10.0 * 1e-6, 10.0 * 2e-6, 10.0 * 3e-6));
            assert_eq!(sample.dvel.x, 1958.0 * 1e-4);
            assert!(sample.reference.attitude.is_some_and(|attitude| (attitude.norm() - 1.0).abs() < 1e-15));
        }
    }
    Ok(())
}

#[test]
fn gaps_are_bridged_on_request_only() -> Done {
    let folder = tempfile::tempdir()?;
    let mut table = Table::at_rest(200);
    table.map("dtheta_x", |row, _| row as f64 * 1e-6);
    table.drop_rows(51..=60);
    write(folder.path(), &table, DESCRIPTION)?;
    let log = Log::open(&folder.path().join("c"))?;
    let refused = read(&log);
    assert!(refused.is_err_and(|error| error.to_string().contains("row 51, column `time_s`: gap of 0.22")));
    let bridging = Reading { bridge: Some(0.3), ..Reading::default() };
    let log = super::Log::open(&folder.path().join("c"), &bridging)?;
    let (samples, bridged) = read(&log)?;
    assert_eq!(bridged, Bridged { gaps: 1, rows: 10 });
    assert_eq!(samples.len(), 200);
    for (index, sample) in samples.iter().enumerate() {
        let row = (index + 1) as f64;
        assert!((sample.time - row / RATE).abs() < 1e-9);
        assert!((sample.dtheta.x - row * 1e-6).abs() < 1e-15);
        let made_up = (50..60).contains(&index);
        assert_eq!(sample.temperature.x.is_nan(), made_up);
        assert_eq!(sample.reference.velocity.is_none(), made_up);
    }
    Ok(())
}

#[test]
fn figures_are_converted_and_defaults_are_announced() -> Done {
    let folder = tempfile::tempdir()?;
    let table = Table::at_rest(100);
    write(folder.path(), &table, DESCRIPTION)?;
    let log = Log::open(&folder.path().join("c"))?;
    let description = log.description();
    assert!(log.warnings().is_empty());
    assert!((description.site.latitude - 0.559_552_558).abs() < 1e-8);
    // 0.001 deg/sqrt(h) and 5 ug/sqrt(Hz)
    assert!((description.noise.angle_random_walk - 2.908_882_087e-7).abs() < 1e-15);
    assert!((description.noise.velocity_random_walk - 4.903_325e-5).abs() < 1e-15);
    assert!((description.reference.attitude - 1.745_329e-4).abs() < 1e-9);
    assert_eq!(description.priors.len(), 1);
    assert!((description.priors[0].1 - 300.0 * 9.80665e-6).abs() < 1e-15);

    let least = "[imu]\nrate_hz = 50\n[site]\nlatitude_deg = -89\nlongitude_deg = 180\nheight_m = 0\n";
    write(folder.path(), &table, least)?;
    let log = Log::open(&folder.path().join("c"))?;
    assert!(log.description().initial.is_none());
    assert_eq!(log.description().reference_temperature, 25.0);
    assert_eq!(log.warnings().len(), 4, "{:?}", log.warnings());

    let graded = least.replace("rate_hz = 50", "rate_hz = 50\ngrade = \"tactical\"")
        + "[prior]\n\"gyro-bias\" = { sigma = 7.0, unit = \"deg/h\" }\n";
    write(folder.path(), &table, &graded)?;
    let mut log = Log::open(&folder.path().join("c"))?;
    let description = log.description();
    // what is stated goes before the class; what is not is the class's
    assert!((description.prior("gyro-bias") - 7.0 * 4.848_136_81e-6).abs() < 1e-12);
    assert!((description.prior("accel-scale") - 0.01).abs() < 1e-12);
    // 0.1 deg/sqrt(h)
    assert!((description.noise.angle_random_walk - 2.908_882_087e-5).abs() < 1e-13);
    let said = |text: &str, all: &[String]| all.iter().any(|line| line.contains(text));
    assert!(
        said("0.100 deg/sqrt(h) and 100 ug/sqrt(Hz) are assumed", log.warnings()),
        "{:?}",
        log.warnings()
    );
    log.refer(&["velocity", "position"])?;
    assert!(said("of the class `tactical`: gyro-scale 5000 ppm", log.assumed()), "{:?}", log.assumed());
    assert!(!said("gyro-bias", log.assumed()));

    write(folder.path(), &table, &graded.replace("tactical", "consumer"))?;
    let fault = Log::open(&folder.path().join("c")).err().ok_or("a class that is none")?;
    assert!(format!("{fault:?}").contains("none of ring-laser, fibre-optic, tactical, mems"), "{fault:?}");
    Ok(())
}

/// In every form that is read they give the samples that plain seconds give.
#[test]
fn dates_and_times_of_a_day_are_times() -> Done {
    let folder = tempfile::tempdir()?;
    let at = folder.path().join("c.csv");
    Table::at_rest(300).write_csv(&at)?;
    fs::write(folder.path().join("c.toml"), DESCRIPTION)?;
    let text = fs::read_to_string(&at)?;
    let plain = read(&Log::open(&at)?)?.0;
    let dated = |date: &str, zone: &str| -> String {
        let mut lines = text.lines();
        let header = lines.next().unwrap_or_default().to_owned() + "\n";
        lines.fold(header, |all, line| {
            let (time, rest) = line.split_once(',').expect("a time");
            let time: f64 = time.parse().expect("a number");
            all + &format!("{date}10:59:{:09.6}{zone},{rest}\n", 30.0 + time)
        })
    };
    for (date, zone) in [("2023-05-01T", "Z"), ("2023-05-01 ", ""), ("2023/05/01 ", ""), ("", "")] {
        fs::write(&at, dated(date, zone))?;
        let samples = read(&Log::open(&at)?)?.0;
        assert_eq!(samples.len(), plain.len(), "{date}");
        for (sample, plain) in samples.iter().zip(&plain) {
            assert_eq!(sample.dtheta, plain.dtheta, "{date}");
        }
        let (first, last) = (samples[0].time, samples[samples.len() - 1].time);
        let span = plain[plain.len() - 1].time - plain[0].time;
        assert!((last - first - span).abs() < 2e-6, "{date}: {first} to {last}");
    }
    Ok(())
}

#[test]
fn all_faults_of_a_description_are_found_at_once() -> Done {
    let folder = tempfile::tempdir()?;
    let broken = DESCRIPTION
        .replace("latitude_deg = 32.06", "latitude_deg = 320.6")
        .replace("velocity_sigma_m_s = 0.001", "velocity_sigma_m_s = -1")
        .replace("accel_vrw_ug_sqrt_hz", "accel_vrw_mg_sqrt_hz")
        .replace("accel-bias", "acel-bias");
    write(folder.path(), &Table::at_rest(100), &broken)?;
    let messages = match Log::open(&folder.path().join("c")) {
        Ok(_) => return Err("accepted".into()),
        Err(error) => error.messages(),
    };
    let text = messages.join("\n");
    for part in [
        "line 5, field `site.latitude_deg`: is 320.6, a number from -89.9 to 89.9 was expected",
        "line 13, field `reference.velocity_sigma_m_s`: is -1, a number from 1e-9 to 1000 was expected",
        "line 18, field `noise.accel_vrw_mg_sqrt_hz`: is not a name of the log format",
        "did you mean `accel_vrw_ug_sqrt_hz`?",
        "field `noise.accel_vrw_ug_sqrt_hz`: is missing",
        "line 24, field `prior.acel-bias`: is not an effect",
        "did you mean `accel-bias`?",
    ] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
    Ok(())
}

#[test]
fn times_rounded_to_milliseconds_are_no_wrong_rate() -> Done {
    let folder = tempfile::tempdir()?;
    let mut table = Table::at_rest(500);
    table.map("time_s", |row, _| (row as f64 * 3.5).round() / 1000.0);
    table.map("dvel_z", |_, _| 9.7946 * 0.0035);
    table.map("dtheta_*", |_, value| value * RATE * 0.0035);
    let quick = DESCRIPTION.replace("rate_hz = 50.0", "rate_hz = 285.714286");
    write(folder.path(), &table, &quick)?;
    assert_eq!(read(&Log::open(&folder.path().join("p"))?)?.0.len(), 500);
    write(folder.path(), &table, &quick.replace("285.7", "295.7"))?;
    assert!(
        read(&Log::open(&folder.path().join("p"))?).is_err_and(|error| error.to_string().contains("time_s"))
    );
    Ok(())
}

/// Logs that came from outside, where they are at hand.
#[test]
fn logs_from_outside_are_read_to_the_end() -> Done {
    let root = std::env::var_os("SINSCAL_DATA").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data"),
        std::path::PathBuf::from,
    );
    let mut found = 0;
    for folder in ["rig", "real"] {
        let Ok(entries) = fs::read_dir(root.join(folder)) else { continue };
        for entry in entries {
            let path = entry?.path();
            if path.extension().is_some_and(|ending| ending == "parquet") {
                let log = Log::open(&path)?;
                let started = std::time::Instant::now();
                let rows = read(&log)?.0.len() as u64;
                println!("{}: {rows} rows in {:?}", path.display(), started.elapsed());
                assert_eq!(rows, log.size());
                found += 1;
            }
        }
    }
    if found == 0 {
        println!("skipped: no logs in {} (set SINSCAL_DATA)", root.display());
    }
    Ok(())
}
