//! Kinds of logs that people bring, made up here: each equals what a careful conversion by hand gives.

use std::fs;
use std::path::Path;

use nalgebra::{UnitQuaternion, Vector3};
use sinscal::Sample;

use super::tests::support::{Done, Table};
use super::{Log, LogError, Reading};
use crate::units::{DEGREE, MICRO_G};

/// 50 Hz, near the equator of longitude, so that nothing vanishes.
const DESCRIPTION: &str = "[imu]\nrate_hz = 50.0\n[site]\nlatitude_deg = 32.06\nlongitude_deg = 118.8\nheight_m = 20.0\n\
                           [noise]\ngyro_arw_deg_sqrt_h = 0.3\naccel_vrw_ug_sqrt_hz = 150.0\n";
const G: f64 = 1e6 * MICRO_G;

fn write(folder: &Path, name: &str, text: &str, description: &str) -> Done {
    fs::write(folder.join(name).with_extension("toml"), description)?;
    Ok(fs::write(folder.join(name), text)?)
}

/// What `--map` and `--axes` say.
fn reading(map: &str, axes: &str) -> Reading {
    Reading {
        map: if map.is_empty() { Default::default() } else { map.parse().expect("a map") },
        axes: if axes.is_empty() { Default::default() } else { axes.parse().expect("axes") },
        ..Reading::default()
    }
}

fn samples(path: &Path, reading: &Reading) -> Result<Vec<Sample>, LogError> {
    Log::open(path, reading)?.samples()?.collect()
}

fn refusal(path: &Path, reading: &Reading) -> String {
    match samples(path, reading) {
        Ok(samples) => format!("accepted with {} samples", samples.len()),
        Err(fault) => fault.messages().join("\n"),
    }
}

/// Signals without symmetry: rate in rad/s and force in m/s^2 of a row.
fn signal(row: usize) -> [f64; 6] {
    let t = row as f64 * 0.02;
    [0.1 * (0.7 * t).sin(), -0.05 * t.cos(), 0.02 * (1.3 * t).sin(), 0.3 * t.sin(), -0.4 + 0.1 * t.cos(), 9.7]
}

/// Rows of numbers under a header.
fn csv(header: &str, rows: usize, row: impl Fn(usize) -> Vec<String>) -> String {
    let rows = (1..=rows).map(|at| row(at).join(","));
    std::iter::once(header.to_owned()).chain(rows).collect::<Vec<_>>().join("\n") + "\n"
}

fn close(a: &Vector3<f64>, b: &Vector3<f64>) -> bool {
    (a - b).norm() <= 1e-9 * b.norm()
}

#[test]
fn values_at_instants_are_integrated_by_the_trapezoid() -> Done {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("log.csv");
    // more than a batch, uneven steps
    let time = |row: usize| row as f64 * 0.02 + if row.is_multiple_of(3) { 0.002 } else { 0.0 };
    let text = csv("t,wx,wy,wz,ax,ay,az", 9000, |row| {
        std::iter::once(time(row)).chain(signal(row)).map(|value| format!("{value:?}")).collect()
    });
    let map = "time=t:s,gyro=w:rad/s,accel=a:m/s^2";
    let described = DESCRIPTION.replace("rate_hz = 50.0", "rate_hz = 50.0\nsamples = \"instants\"");
    write(folder.path(), "log.csv", &text, &described)?;
    let instants = samples(&path, &reading(map, ""))?;
    write(folder.path(), "log.csv", &text, DESCRIPTION)?;
    let averages = samples(&path, &reading(map, ""))?;
    for row in 2..=9000 {
        let step = time(row) - time(row - 1);
        let (before, now) = (signal(row - 1), signal(row));
        let mean = |of: usize| 0.5 * (before[of] + now[of]) * step;
        assert!(close(&instants[row - 1].dtheta, &Vector3::new(mean(0), mean(1), mean(2))), "{row}");
        assert!(close(&instants[row - 1].dvel, &Vector3::new(mean(3), mean(4), mean(5))), "{row}");
        assert!(close(&averages[row - 1].dtheta, &(Vector3::new(now[0], now[1], now[2]) * step)), "{row}");
    }
    write(folder.path(), "log.csv", &text, &described.replace("instants", "points"))?;
    assert!(refusal(&path, &reading(map, "")).contains("field `imu.samples`: `points` is neither"));
    Ok(())
}

#[test]
fn counts_about_an_offset_and_kelvin() -> Done {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("log.csv");
    let text = csv("n,gx,gy,gz,ax,ay,az,T [K]", 300, |row| {
        let s = signal(row);
        let count = |value: f64, size: f64| (value * size).round() as i64 + 32768;
        let gyro = (0..3).map(|of| count(s[of] / DEGREE, 131.0));
        let accel = (3..6).map(|of| count(s[of] / G, 3000.0));
        std::iter::once(row as i64)
            .chain(gyro)
            .chain(accel)
            .map(|n| n.to_string())
            .chain(["300.25".into()])
            .collect()
    });
    write(folder.path(), "log.csv", &text, DESCRIPTION)?;
    let map = "gyro=g-32768:131 LSB/(deg/s),accel=a-32768:g/3000,temp=T,temp_gyro=T";
    let read = samples(&path, &reading(map, ""))?;
    for (row, sample) in read.iter().enumerate() {
        let s = signal(row + 1);
        let count = |value: f64, size: f64| (value * size).round() / size;
        let w = Vector3::from_fn(|of, _| count(s[of] / DEGREE, 131.0) * DEGREE * 0.02);
        let f = Vector3::from_fn(|of, _| count(s[of + 3] / G, 3000.0) * G * 0.02);
        assert!(close(&sample.dtheta, &w) && close(&sample.dvel, &f), "{row}");
        assert!((sample.temperature - Vector3::repeat(27.1)).norm() < 1e-12, "{}", sample.temperature);
        assert!((sample.time - (row + 1) as f64 * 0.02).abs() < 1e-12);
    }
    let sizeless = "gyro=g:LSB,accel=a:g".parse::<super::ColumnMap>();
    assert!(sizeless.is_err_and(|error| error.contains("131 LSB/(deg/s)")));
    Ok(())
}

/// A log in forward-right-down and north-east-down, in ours by one switch.
#[test]
fn one_switch_turns_frd_and_ned_into_ours() -> Done {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("log.csv");
    let attitude = |row: usize| UnitQuaternion::from_euler_angles(0.02, -0.03, 0.5 + 0.001 * row as f64);
    let ours = csv(
        "time_s,dtheta_x,dtheta_y,dtheta_z,dvel_x,dvel_y,dvel_z,temp_x,temp_y,temp_z,ref_vel_e,ref_vel_n,ref_vel_u,ref_pos_e,ref_pos_n,ref_pos_u,ref_quat_w,ref_quat_x,ref_quat_y,ref_quat_z",
        300,
        |row| {
            let s = signal(row);
            let q = attitude(row);
            let mut all: Vec<f64> = vec![row as f64 * 0.02];
            all.extend(s.map(|value| value * 0.02));
            all.extend([20.0, 21.0, 22.0, 0.1, 0.2, 0.3, 1.0, 2.0, 3.0, q.w, q.i, q.j, q.k]);
            all.iter().map(|value| format!("{value:?}")).collect()
        },
    );
    // what a unit in frd, under a reference in ned, writes: x forward is our y, y right is our x, z down
    let theirs = csv(
        "time_s,dtheta_x,dtheta_y,dtheta_z,dvel_x,dvel_y,dvel_z,temp_x,temp_y,temp_z,v_n,v_e,v_d,p_n,p_e,p_d,q_x,q_y,q_z,q_w",
        300,
        |row| {
            let s = signal(row);
            let swap = |x: f64, y: f64, z: f64| [y, x, -z];
            let turn = nalgebra::Matrix3::new(0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0);
            let c = turn * attitude(row).to_rotation_matrix().into_inner() * turn;
            let q = UnitQuaternion::from_rotation_matrix(&nalgebra::Rotation3::from_matrix_unchecked(c))
                .inverse();
            let mut all: Vec<f64> = vec![row as f64 * 0.02];
            all.extend(swap(s[0], s[1], s[2]).map(|value| value * 0.02));
            all.extend(swap(s[3], s[4], s[5]).map(|value| value * 0.02));
            all.extend([21.0, 20.0, 22.0, 0.2, 0.1, -0.3, 2.0, 1.0, -3.0, q.i, q.j, q.k, q.w]);
            all.iter().map(|value| format!("{value:?}")).collect()
        },
    );
    let described = format!(
        "{DESCRIPTION}[initial]\nquaternion_wxyz = [1.0, 0.0, 0.0, 0.0]\nlevel_sigma_deg = 90.0\nheading_sigma_deg = 180.0\n[reference]\nattitude_sigma_deg = 20.0\n"
    );
    write(folder.path(), "log.csv", &ours, &described)?;
    let expected = samples(&path, &Reading::default())?;
    let map = "ref_vel=v,ref_pos=p,ref_quat=q";
    let axes = "imu=frd,reference=ned,quaternion=reference-to-body";
    write(folder.path(), "log.csv", &theirs, &described)?;
    let mut all = vec![samples(&path, &reading(map, axes))?];
    let said = "[axes]\nimu = \"+y+x-z\"\nreference = \"ned\"\nquaternion = \"xyzw reference-to-body\"\n[table]\nmap = \"ref_vel=v,ref_pos=p,ref_quat=q\"\n";
    write(folder.path(), "log.csv", &theirs, &format!("{described}{said}"))?;
    all.push(samples(&path, &Reading::default())?);
    for read in &all {
        for (read, expected) in read.iter().zip(&expected) {
            assert!(close(&read.dtheta, &expected.dtheta) && close(&read.dvel, &expected.dvel));
            assert_eq!(read.temperature, expected.temperature);
            assert_eq!(read.reference.velocity, expected.reference.velocity);
            assert_eq!(read.reference.position, expected.reference.position);
            let (Some(a), Some(b)) = (read.reference.attitude, expected.reference.attitude) else {
                return Err("no attitude".into());
            };
            assert!((a.coords - b.coords).norm().min((a.coords + b.coords).norm()) < 1e-12);
        }
    }
    // names that say another frame, and an attitude about left-handed axes
    write(folder.path(), "log.csv", &theirs, &described)?;
    let frame = refusal(&path, &reading(map, "imu=frd"));
    assert!(frame.contains("north, east, down") && frame.contains("--axes reference=ned"), "{frame}");
    let left = refusal(&path, &reading(map, "imu=fru,reference=ned"));
    assert!(left.contains("left-handed") && left.contains("give `gyro` and `accel` apart"), "{left}");
    let apart = samples(&path, &reading(map, "imu=frd,gyro=fru,reference=ned,quaternion=reference-to-body"))?;
    assert_eq!(apart[7].dtheta.z, -expected[7].dtheta.z);
    Ok(())
}

/// The reference in a file of its own: another rate, another clock, latitude and longitude in 1e-7 deg, angles, fixes.
#[test]
fn a_reference_with_its_own_file_and_clock() -> Done {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("log.csv");
    let (start, gps) = (1_700_000_000_000_000_000_i64, 1_700_000_000.0);
    let imu =
        csv("stamp [ns],wx [rad/s],wy [rad/s],wz [rad/s],ax [m/s^2],ay [m/s^2],az [m/s^2]", 9000, |row| {
            let time = start + row as i64 * 20_000_000;
            std::iter::once(time.to_string()).chain(signal(row).map(|value| format!("{value:?}"))).collect()
        });
    // 5 Hz, stamped 0.25 s late, some of them no fixes
    let reference = csv("gps_time;lat;lon;alt;Q;roll;pitch;yaw;vn;ve;vd", 950, |fix| {
        let time = gps - 5.0 + 0.2 * fix as f64 + 0.25 + 0.003;
        let row = format!(
            "{time:.3};{};{};{:.3};{};1.5;-2.0;{};0.2;0.1;-0.3",
            320_600_000 + 10 * fix,
            1_188_000_000 - 7 * fix,
            20.0 + 0.01 * fix as f64,
            if fix % 10 == 0 { 5 } else { 1 },
            30.0 + 0.01 * fix as f64
        );
        vec![row]
    });
    let described = format!(
        "{DESCRIPTION}[reference]\nfile = \"gnss.txt\"\noffset_s = -0.25\naccept_fix = [1]\nattitude_sigma_deg = 30.0\n\
         [axes]\nreference = \"ned\"\nimu = \"frd\"\neuler = \"zyx\"\n"
    );
    write(folder.path(), "log.csv", &imu, &described)?;
    fs::write(folder.path().join("gnss.txt"), &reference)?;
    let map = "time=stamp,gyro=w,accel=a,ref_time=gps_time:s,ref_lat=lat:1e-7 deg,ref_lon=lon:1e-7 deg,ref_height=alt:m,ref_fix=Q,\
               ref_vel=v,ref_roll=roll:deg,ref_pitch=pitch:deg,ref_yaw=yaw:deg";
    let log = Log::open(&path, &reading(map, ""))?;
    let read: Vec<Sample> =
        log.samples()?.collect::<Result<_, _>>().map_err(|fault: LogError| fault.messages().join("\n"))?;
    let fixes: Vec<(usize, &Sample)> =
        read.iter().enumerate().filter(|(_, sample)| sample.reference.position.is_some()).collect();
    // from the first row to the last, without every tenth
    assert!((780..=830).contains(&fixes.len()), "{}", fixes.len());
    let (meridian, prime_vertical) = sinscal::earth::radii(32.06_f64.to_radians());
    for (row, sample) in fixes {
        // readings are 3 ms after the row
        let fix = ((sample.time + 5.0) / 0.2).round();
        assert!((sample.time + 5.0 - 0.2 * fix).abs() < 1e-6, "{row}: {}", sample.time);
        assert!(!(fix as u64).is_multiple_of(10));
        let position = sample.reference.position.ok_or("no position")?;
        let north = (320_600_000.0 + 10.0 * fix) * 1e-7;
        let east = (1_188_000_000.0 - 7.0 * fix) * 1e-7;
        let expected = Vector3::new(
            (east - 118.8).to_radians() * (prime_vertical + 20.0) * 32.06_f64.to_radians().cos(),
            (north - 32.06).to_radians() * (meridian + 20.0),
            0.01 * fix,
        );
        assert!((position - expected).norm() < 1e-6, "{position} {expected}");
        assert_eq!(sample.reference.velocity, Some(Vector3::new(0.1, 0.2, 0.3)));
        let forward = sample.reference.attitude.ok_or("no attitude")? * Vector3::y();
        let heading = forward.x.atan2(forward.y).to_degrees();
        assert!((heading - 30.0 - 0.01 * fix).abs() < 1e-9, "{heading}");
    }
    // another clock
    write(folder.path(), "log.csv", &imu, &described.replace("offset_s = -0.25", "offset_s = 500.0"))?;
    let apart = refusal(&path, &reading(map, ""));
    assert!(apart.contains("no reading falls into the log") && apart.contains("offset_s"), "{apart}");
    Ok(())
}

#[test]
fn angles_need_an_order() -> Done {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("log.csv");
    let mut table = Table::at_rest(100);
    table.drop("ref_*");
    for angle in ["roll", "pitch", "yaw"] {
        table.columns.push((format!("ref_{angle}_deg"), vec![0.0; 100]));
    }
    write(folder.path(), "log.csv", &table.csv(), DESCRIPTION)?;
    let told = refusal(&path, &Reading::default());
    assert!(told.contains("--axes euler=zyx"), "{told}");
    let read = samples(&path, &reading("", "euler=zxy"))?;
    assert!(read.iter().all(|sample| sample.reference.attitude == Some(UnitQuaternion::identity())));
    Ok(())
}

#[test]
fn stamps_that_are_no_sampling_times() -> Done {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("log.csv");
    let map = "time=t:s,gyro=w:rad/s,accel=a:m/s^2";
    let with = |stamp: &dyn Fn(usize) -> f64| {
        csv("t,wx,wy,wz,ax,ay,az", 6000, |row| {
            std::iter::once(stamp(row)).chain(signal(row)).map(|value| format!("{value:.9}")).collect()
        })
    };
    // five rows are written at once: recognised, and said
    write(folder.path(), "log.csv", &with(&|row| 0.1 * (row as f64 / 5.0).ceil()), DESCRIPTION)?;
    let log = Log::open(&path, &reading(map, ""))?;
    assert!(log.warnings().iter().any(|note| note.contains("--stamps fit")), "{:?}", log.warnings());
    let read: Vec<Sample> = log.samples()?.collect::<Result<_, _>>()?;
    let step = |pair: &[Sample]| pair[1].time - pair[0].time;
    assert!(read.windows(2).all(|pair| (step(pair) - 0.02).abs() < 1e-7));
    // by the rate, from the first stamp
    let by_rate = Reading { stamps: Some(super::Stamps::Rate), ..reading(map, "") };
    write(
        folder.path(),
        "log.csv",
        &with(&|row| 7.0 + 0.02 * row as f64 + 0.009 * (row % 2) as f64),
        DESCRIPTION,
    )?;
    let read = samples(&path, &by_rate)?;
    assert!((read[0].time - 7.029).abs() < 1e-9 && (read[5999].time - 7.029 - 5999.0 * 0.02).abs() < 1e-9);
    // rows that are missing have no line
    let fit = Reading { stamps: Some(super::Stamps::Fit), ..reading(map, "") };
    write(
        folder.path(),
        "log.csv",
        &with(&|row| 0.02 * row as f64 + if row > 4000 { 3.0 } else { 0.0 }),
        DESCRIPTION,
    )?;
    let told = refusal(&path, &fit);
    assert!(told.contains("rows are missing somewhere"), "{told}");
    Ok(())
}

#[test]
fn a_log_without_times_and_one_whose_times_have_no_unit() -> Done {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("log.csv");
    let mut table = Table::at_rest(100);
    table.drop("time_s");
    table.drop("ref_*");
    write(folder.path(), "log.csv", &table.csv(), DESCRIPTION)?;
    let log = Log::open(&path, &Reading::default())?;
    assert!(log.warnings().iter().any(|note| note.contains("evenly spaced")), "{:?}", log.warnings());
    let read: Vec<Sample> = log.samples()?.collect::<Result<_, _>>()?;
    assert!((read[99].time - 2.0).abs() < 1e-12);
    let text = csv("timestamp,wx,wy,wz,ax,ay,az", 100, |row| {
        std::iter::once(row as f64 * 20_000.0).chain(signal(row)).map(|value| value.to_string()).collect()
    });
    write(folder.path(), "log.csv", &text, DESCRIPTION)?;
    let told = refusal(&path, &reading("gyro=w:rad/s,accel=a:m/s^2", ""));
    assert!(told.contains("time=timestamp:UNIT") && told.contains("--stamps rate"), "{told}");
    assert_eq!(samples(&path, &reading("time=timestamp:us,gyro=w:rad/s,accel=a:m/s^2", ""))?.len(), 100);
    // a unit in the name that contradicts what is said
    write(folder.path(), "log.csv", &text.replace("wy", "wy [deg/s]"), DESCRIPTION)?;
    let told = refusal(&path, &reading("time=timestamp:us,gyro=w:rad/s,accel=a:m/s^2", ""));
    assert!(told.contains("says deg/s, but --map gyro=w:rad/s says another unit"), "{told}");
    Ok(())
}

#[test]
fn held_fixes_are_used_once() -> Done {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("log.csv");
    let mut table = Table::at_rest(1000);
    table.drop("ref_vel*");
    table.drop("ref_quat*");
    table.map("ref_pos_*", |row, _| (row / 10) as f64 * 0.01);
    write(folder.path(), "log.csv", &table.csv(), DESCRIPTION)?;
    let log = Log::open(&path, &Reading::default())?;
    assert!(
        log.warnings().iter().any(|note| note.contains("holds each reading for 10 rows")),
        "{:?}",
        log.warnings()
    );
    let read: Vec<Sample> = log.samples()?.collect::<Result<_, _>>()?;
    assert_eq!(read.iter().filter(|sample| sample.reference.position.is_some()).count(), 101);
    Ok(())
}

/// Standard deviations of each row, height and heading alone.
#[test]
fn rows_state_their_own_sigmas() -> Done {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("log.csv");
    let mut table = Table::at_rest(100);
    table.drop("ref_vel*");
    table.drop("ref_quat*");
    table.columns.push(("sE".into(), vec![0.5; 100]));
    table.columns.push(("sN".into(), (1..=100).map(|row| if row == 7 { f64::NAN } else { 0.25 }).collect()));
    table.columns.push(("sU".into(), vec![2.0; 100]));
    table.columns.push(("course".into(), vec![90.0; 100]));
    write(folder.path(), "log.csv", &table.csv(), DESCRIPTION)?;
    let map = reading("ref_pos_sigma=s:m,ref_heading=course:deg", "");
    let read = samples(&path, &map)?;
    assert_eq!(read[0].reference.sigma.position, Vector3::new(0.5, 0.25, 2.0));
    assert!(read[6].reference.sigma.position.y.is_nan() && read[6].reference.sigma.position.x == 0.5);
    assert!(read.iter().all(|s| s.reference.heading == Some(90.0 * DEGREE) && s.reference.height.is_none()));
    // north and east go with their axes
    let turned = samples(
        &path,
        &reading("ref_pos_sigma_e=sN,ref_pos_sigma_n=sE,ref_pos_sigma_u=sU", "reference=ned"),
    )?;
    assert_eq!(turned[0].reference.sigma.position, Vector3::new(0.5, 0.25, 2.0));
    table.map("sU", |row, value| if row == 9 { 0.0 } else { value });
    write(folder.path(), "log.csv", &table.csv(), DESCRIPTION)?;
    let told = refusal(&path, &map);
    assert!(
        told.contains("row 9, column `ref_pos_sigma_u`: is 0, one standard deviation, above 0"),
        "{told}"
    );
    // a height alone is one over the ellipsoid
    table.drop("ref_pos*");
    table.drop("s?");
    table.columns.retain(|(name, _)| !name.starts_with('s'));
    table.columns.push(("ref_height_m".into(), vec![21.5; 100]));
    write(folder.path(), "log.csv", &table.csv(), DESCRIPTION)?;
    let read = samples(&path, &reading("ref_heading=course:deg", ""))?;
    assert!(read.iter().all(|s| s.reference.height == Some(1.5) && s.reference.velocity.is_none()));
    Ok(())
}
