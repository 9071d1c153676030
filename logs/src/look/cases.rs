//! Looks at measured logs, and at simulated ones with a fault, as they lie beside the project.

use std::path::PathBuf;

use super::{Look, look};
use crate::reading::Reading;
use crate::tests::support::Done;

/// A file beside the project, or nothing with a printed line.
fn shared(name: &str) -> Option<PathBuf> {
    let path = crate::cases::shared().join(name);
    if !path.is_file() {
        println!("skipped: {} is not here", path.display());
        return None;
    }
    Some(path)
}

/// A look at a log, copied so that no description lies beside it unless one is given.
fn looked(
    name: &str,
    map: &str,
    description: Option<&str>,
) -> Result<Option<Look>, Box<dyn std::error::Error>> {
    let Some(path) = shared(name) else { return Ok(None) };
    let folder = tempfile::tempdir()?;
    let copy = folder.path().join(path.file_name().ok_or("no name")?);
    std::fs::copy(&path, &copy)?;
    if let Some(description) = description {
        std::fs::write(copy.with_extension("toml"), description)?;
    }
    let map = if map.is_empty() { Default::default() } else { map.parse()? };
    let look = look(&copy, &Reading { map, ..Reading::default() }, &mut |_| {})
        .map_err(|fault| fault.messages().join("\n"))?;
    println!("{name}\n{look}");
    Ok(Some(look))
}

const BARE: &str =
    "[imu]\nrate_hz = 102.4\n[site]\nlatitude_deg = 49.57\nlongitude_deg = 11.03\nheight_m = 280.0\n";

/// Six positions and three turns and back: twelve rests, in which the gyros read what their Ferraris calibration says.
#[test]
fn twelve_rests_of_a_unit_turned_by_hand() -> Done {
    let map = "gyro=gyr:deg/s,accel=acc:m/s^2";
    let Some(look) = looked("cases/measured/nilspod/raw.csv", map, Some(BARE))? else { return Ok(()) };
    // the unit was touched after 3 s, before the first of the twelve
    assert_eq!(look.rests.iter().filter(|rest| rest.start_s > 3.0).count(), 12, "{:?}", look.rests);
    assert!(look.rests.iter().all(|rest| rest.end_s - rest.start_s >= 2.0));
    let bias = look.mean_rate_rad_s.map(|rate| rate.to_degrees() * 3600.0);
    for (found, known) in bias.into_iter().zip([-2159.0, -1331.0, 212.0]) {
        assert!((found - known).abs() < 30.0, "{bias:?}");
    }
    Ok(())
}

/// About twenty rests of three seconds, whose mean gyro readings are known.
#[test]
fn rests_of_three_seconds_of_a_unit_turned_by_hand() -> Done {
    let map = "gyro=w:rad/s,accel=f:m/s^2,time=t:s";
    let Some(look) = looked("cases/measured/mpu9150/m2.csv", map, None)? else { return Ok(()) };
    assert!((18..=24).contains(&look.rests.len()), "{}", look.rests.len());
    let bias = look.mean_rate_rad_s.map(|rate| rate.to_degrees() * 3600.0);
    for (found, known) in bias.into_iter().zip([2097.0, -1349.0, 4649.0]) {
        assert!((found - known).abs() < 40.0, "{bias:?}");
    }
    let Some(look) = looked("cases/measured/mpu9150/m3_50s.csv", map, None)? else { return Ok(()) };
    assert!((4..=12).contains(&look.rests.len()), "{}", look.rests.len());
    Ok(())
}

#[test]
fn a_unit_that_lies_on_a_table_and_is_then_turned() -> Done {
    let map = "time=Time,gyro=Gyroscope,accel=Accelerometer";
    let Some(look) = looked("cases/measured/fusion/fu.csv", map, None)? else { return Ok(()) };
    let first = look.rests.first().ok_or("no rest")?;
    assert!(first.start_s < 1.0 && (11.0..14.0).contains(&first.end_s), "{first:?}");
    assert!(look.warnings.iter().any(|warning| warning.contains("--bridge-gaps")), "{:?}", look.warnings);
    Ok(())
}

#[test]
fn rests_of_an_industrial_unit() -> Done {
    let Some(look) = looked("data/real/imu-tk-xsens.parquet", "", None)? else { return Ok(()) };
    assert!((30..=60).contains(&look.rests.len()), "{}", look.rests.len());
    Ok(())
}

#[test]
fn a_walk_does_not_rest() -> Done {
    let map = "gyro=w:rad/s,accel=a:g,time=t:s";
    let Some(look) = looked("cases/measured/gnss-walk/walk.csv", map, None)? else { return Ok(()) };
    let moving = look.rests.iter().filter(|rest| rest.start_s > 60.0).count();
    assert_eq!(moving, 0, "{:?}", look.rests);
    Ok(())
}

#[test]
fn a_range_that_was_exceeded_and_an_axis_with_the_other_sign() -> Done {
    let at =
        |name: &str| shared(&format!("cases/logs/{name}/log.toml")).map(std::fs::read_to_string).transpose();
    for (name, part) in [
        ("saturated-gyro", "gyro y stands at"),
        ("gyro-axis-inverted", "--axes gyro=+x+y-z"),
        ("carried-unit", ""),
    ] {
        let Some(description) = at(name)? else { return Ok(()) };
        let Some(look) = looked(&format!("cases/logs/{name}/log.csv"), "", Some(&description))? else {
            return Ok(());
        };
        let told = look.warnings.join("\n");
        assert!(told.contains(part), "{name}: {told}");
        assert_eq!(part.is_empty(), look.warnings.is_empty(), "{name}: {told}");
        assert!(look.rests.len() > 5, "{name}: {:?}", look.rests);
    }
    Ok(())
}

/// Nobody says which columns are which: names and numbers do.
#[test]
fn a_log_without_any_description_is_read_by_names_and_numbers() -> Done {
    let text = |names: &str, time: fn(usize) -> String, scales: [f64; 2]| {
        let rows = (0..400).map(|row| {
            let noise = |of: usize| ((row * row * (of + 5)) as f64 * 0.37).sin();
            let rate = [0.003, -0.002, 0.005].map(|mean| (mean + 1e-3 * noise(1)) * scales[0]);
            let force = [0.1, -0.2, 9.79].map(|mean| (mean + 0.02 * noise(2)) * scales[1]);
            let numbers = rate.iter().chain(&force).map(f64::to_string).collect::<Vec<_>>();
            format!("{},{}\n", time(row), numbers.join(","))
        });
        format!("{names}\n{}", rows.collect::<String>())
    };
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("log.csv");
    let degree = crate::units::DEGREE;
    let px4 = "timestamp,gyro_rad[0],gyro_rad[1],gyro_rad[2],acc[0],acc[1],acc[2]";
    for (names, time, scales, map) in [
        (
            px4,
            (|row| (112_614_307 + 5000 * row).to_string()) as fn(usize) -> String,
            [1.0, 1.0],
            "gyro=gyro_rad:rad/s,accel=acc:m/s^2,time=timestamp:us",
        ),
        (
            "secs,nsecs,wx,wy,wz,ax,ay,az",
            |row| format!("{},{}", 1_700_000_000 + row / 200, row % 200 * 5_000_000),
            [1.0 / degree, 1.0 / 9.806_65],
            "gyro=w:deg/s,accel=a:g,time=secs+nsecs",
        ),
    ] {
        std::fs::write(&path, text(names, time, scales))?;
        let found =
            look(&path, &Reading::default(), &mut |_| {}).map_err(|fault| fault.messages().join("\n"))?;
        assert!((found.rate_hz - 200.0).abs() < 0.01, "{}", found.rate_hz);
        for (found, known) in found.mean_rate_rad_s.iter().zip([0.003, -0.002, 0.005]) {
            assert!((found - known).abs() < 2e-4, "{found} {known}");
        }
        assert!((found.mean_force_m_s2[2] - 9.79).abs() < 0.01, "{:?}", found.mean_force_m_s2);
        assert!(found.description.contains(map), "{}", found.description);
        let told = crate::Log::open(&path, &Reading::default());
        assert!(told.is_err());
    }
    Ok(())
}
