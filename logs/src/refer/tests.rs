//! What stands for a reference, row by row.

use std::path::PathBuf;

use nalgebra::Vector3;
use sinscal::{Missed, Sample};

use crate::tests::support::{DESCRIPTION, Done, RATE, Table};
use crate::{Log, LogError, Reading};

const HAND: &[&str] = &["velocity", "rate"];
const MEMS: &str =
    "[imu]\nrate_hz = 50.0\n[site]\nlatitude_deg = 32.06\nlongitude_deg = 118.8\nheight_m = 20.0\n";

/// Moves for a second, rests for ten, turns over in three, rests for ten, moves for two.
fn carried() -> Table {
    let moves = |row: usize| {
        let time = row as f64 / RATE;
        time < 1.0 || (11.0..14.0).contains(&time) || time > 24.0
    };
    let noise = |row: usize, size: f64| {
        let bits = (row as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let bits = (bits ^ (bits >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        size * ((bits >> 11) as f64 / (1_u64 << 52) as f64 - 1.0)
    };
    let mut table = Table::at_rest(1300);
    table.drop("ref_*");
    for (axis, name) in ["dtheta_x", "dtheta_y", "dtheta_z"].into_iter().enumerate() {
        let wave = |row: usize| if moves(row) { 0.02 * (row as f64 * 0.11).sin() } else { 0.0 };
        table.map(name, |row, value| value + 4e-4 + wave(row) + noise(row + 10_000 * axis, 4e-5));
    }
    for (axis, name) in ["dvel_x", "dvel_y", "dvel_z"].into_iter().enumerate() {
        let wave = |row: usize| if moves(row) { 0.03 * (row as f64 * 0.23).sin() } else { 0.0 };
        let over = if axis == 1 { 9.7946 / RATE } else { 0.0 };
        table.map(name, |row, value| {
            (if row > 600 { over } else { value }) + wave(row) + noise(row + 50_000 + 10_000 * axis, 4e-4)
        });
    }
    table
}

fn opened(
    table: &Table,
    description: &str,
) -> Result<(tempfile::TempDir, PathBuf), Box<dyn std::error::Error>> {
    let folder = tempfile::tempdir()?;
    table.write_csv(&folder.path().join("c.csv"))?;
    std::fs::write(folder.path().join("c.toml"), description)?;
    let path = folder.path().join("c");
    Ok((folder, path))
}

fn referred(
    table: &Table,
    description: &str,
    measures: &[&str],
) -> Result<(Log, Vec<Sample>), Box<dyn std::error::Error>> {
    let (_folder, path) = opened(table, description)?;
    let mut log = Log::open(&path, &Reading::default())?;
    log.refer(measures)?;
    let samples = log.samples()?.collect::<Result<Vec<_>, LogError>>()?;
    Ok((log, samples))
}

fn refused(table: &Table, description: &str, measures: &[&str]) -> String {
    referred(table, description, measures).map_or_else(|error| error.to_string(), |_| "nothing".into())
}

#[test]
fn a_hand_carried_unit_is_referred_to_its_rests() -> Done {
    let (log, samples) = referred(&carried(), MEMS, HAND)?;
    assert_eq!(log.rests().len(), 2, "{:?}", log.rests());
    assert_eq!(log.update_rate(), crate::MEASURED_RATE);
    // it begins in the first rest: nothing is known before
    let first = samples[0].time;
    assert!((1.0..1.8).contains(&first), "{first}");
    for sample in &samples {
        let reference = &sample.reference;
        if (1.8..10.4).contains(&sample.time) || (14.8..23.4).contains(&sample.time) {
            assert_eq!(
                (reference.velocity, reference.rate),
                (Some(Vector3::zeros()), Some(Vector3::zeros()))
            );
            // two rests do not show how biases wander: 20 deg/h, the Earth's rate, and 90 readings that say the same
            assert!((9e-4..2e-3).contains(&reference.sigma.rate.x), "{}", reference.sigma.rate);
        }
        if (11.0..14.0).contains(&sample.time) || sample.time > 24.0 {
            assert!(!reference.is_read(), "{}", sample.time);
        }
    }
    // what the turn may have missed is said once, where the second rest begins
    let missed: Vec<&Sample> =
        samples.iter().filter(|sample| sample.reference.missed != Missed::default()).collect();
    assert_eq!(missed.len(), 1);
    assert!((14.0..14.8).contains(&missed[0].time) && missed[0].reference.missed.velocity == 1.0);
    // noise and priors that are not given
    let noise = log.description().noise;
    let uniform = 1.0 / 3_f64.sqrt();
    assert!((noise.angle_random_walk / (4e-5 * uniform * RATE.sqrt()) - 1.0).abs() < 0.2, "{noise:?}");
    assert!((noise.velocity_random_walk / (4e-4 * uniform * RATE.sqrt()) - 1.0).abs() < 0.2, "{noise:?}");
    assert!((log.description().prior("gyro-bias") - 2_f64.to_radians()).abs() < 1e-12);
    for (said, text) in [(0, "at rest 2 times"), (1, "[initial]"), (2, "[noise]"), (3, "priors")] {
        assert!(log.assumed()[said].contains(text), "{:?}", log.assumed());
    }
    assert!(!log.warnings().iter().any(|warning| warning.contains("[noise]")), "{:?}", log.warnings());
    Ok(())
}

#[test]
fn asking_twice_is_the_same_and_other_filters_stay_what_they_are() -> Done {
    let (_folder, path) = opened(&carried(), MEMS)?;
    let mut log = Log::open(&path, &Reading::default())?;
    log.refer(HAND)?;
    let (said, prior) = (log.assumed().to_vec(), log.description().priors.clone());
    log.refer(HAND)?;
    assert_eq!((log.assumed(), &log.description().priors), (&said[..], &prior));

    let (log, samples) = referred(&carried(), MEMS, &["velocity", "position"])?;
    assert!(log.rests().is_empty() && log.assumed().is_empty() && samples.len() == 1300);
    assert!(samples.iter().all(|sample| sample.reference.position == Some(Vector3::zeros())));
    // with the attitude at the first row every row counts
    let initial = "[initial]\nquaternion_wxyz = [1, 0, 0, 0]\nlevel_sigma_deg = 3\nheading_sigma_deg = 180\n";
    assert_eq!(referred(&carried(), &(MEMS.to_owned() + initial), HAND)?.1.len(), 1300);
    Ok(())
}

#[test]
fn velocities_of_zero_in_the_rests_are_joined_by_what_else_a_rest_says() -> Done {
    let mut table = carried();
    let rows = table.columns[0].1.len();
    let at =
        |row: usize| if (200..500).contains(&row) || (800..1000).contains(&row) { 0.0 } else { f64::NAN };
    for name in ["ref_vel_e", "ref_vel_n", "ref_vel_u"] {
        table.columns.push((name.into(), (0..rows).map(at).collect()));
    }
    let (log, samples) = referred(&table, MEMS, HAND)?;
    assert_eq!(log.rests().len(), 2);
    assert!(samples.iter().any(|sample| sample.reference.rate.is_some()));
    // of columns that say anything else nothing is added
    table.set("ref_vel_n", 900, 0.001);
    let (log, samples) = referred(&table, MEMS, HAND)?;
    assert!(log.rests().is_empty() && log.assumed().is_empty() && samples.len() == rows);
    assert!(samples.iter().all(|sample| sample.reference.rate.is_none()));
    Ok(())
}

#[test]
fn the_description_goes_before_and_what_cannot_be_is_refused() -> Done {
    let kind = |kind: &str| format!("{MEMS}[reference]\nkind = \"{kind}\"\n");
    let (log, samples) = referred(&carried(), &kind("fixed-point"), HAND)?;
    assert!(log.rests().is_empty() && samples[650].reference.velocity == Some(Vector3::zeros()));
    let (log, _) = referred(&carried(), &kind("rests"), &["velocity", "position"])?;
    assert_eq!(log.rests().len(), 2);
    // readings that are there, and are not to be taken for any
    let rests = DESCRIPTION.replace("[reference]", "[reference]\nkind = \"fixed-point\"");
    let mut away = Table::at_rest(600);
    away.map("ref_pos_e", |_, _| 3.0);
    let (_, samples) = referred(&away, &rests, &["velocity", "position"])?;
    assert!(samples.iter().all(|sample| sample.reference.position == Some(Vector3::zeros())));

    assert!(refused(&carried(), MEMS, &["position", "attitude"]).contains("the filter measures attitude"));
    assert!(refused(&carried(), &kind("readings"), HAND).contains("`readings`"));
    let mut shaken = carried();
    for (name, rate, size) in
        [("dtheta_x", 7.0, 0.01), ("dtheta_y", 11.0, 0.01), ("dvel_x", 5.0, 0.04), ("dvel_y", 3.0, 0.04)]
    {
        shaken.map(name, |row, value| value + size * (rate * row as f64 / RATE).sin());
    }
    let problem = refused(&shaken, MEMS, HAND);
    assert!(problem.contains("rests nowhere"), "{problem}");
    Ok(())
}

/// Logs with one fault each, as they lie beside the project.
#[test]
fn what_rests_contradict_is_said_before_anything_is_estimated() -> Done {
    for (case, refusal, warning) in [
        ("gyro-axis-inverted", Some("--axes gyro=+x+y-z"), None),
        ("noise-in-si-units", Some("noise.gyro_arw_deg_sqrt_h is 8.730e-5"), None),
        ("saturated-gyro", None, Some("gyro y stands at")),
        ("carried-unit", None, None),
    ] {
        let path = crate::cases::shared().join("cases/logs").join(case).join("log.csv");
        if !path.is_file() {
            println!("skipped: {} is not here", path.display());
            continue;
        }
        let mut log = Log::open(&path, &Reading::default())?;
        let refused = log.refer(HAND).err().map(|fault| fault.messages().join("\n"));
        match (refusal, &refused) {
            (Some(part), Some(said)) => assert!(said.contains(part), "{case}: {said}"),
            (None, None) => {}
            _ => panic!("{case}: {refused:?}"),
        }
        let told = log.warnings().join("\n");
        assert_eq!(warning.is_some_and(|part| told.contains(part)), warning.is_some(), "{case}: {told}");
        assert!(warning.is_some() || !told.contains("rows"), "{case}: {told}");
    }
    Ok(())
}
