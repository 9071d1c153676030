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
    let look =
        look(&copy, &Reading { map, ..Reading::default() }).map_err(|fault| fault.messages().join("\n"))?;
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
