//! Layouts that people's programs write, as they lie beside the project: `../shared/cases`.

use std::fs;
use std::path::{Path, PathBuf};

use nalgebra::Vector3;
use sinscal::Sample;

use super::tests::support::Done;
use super::{Log, LogError, Reading};
use crate::units::DEGREE;

/// What lies beside the project; `SINSCAL_DATA` names its folder `data` where it lies elsewhere.
pub(crate) fn shared() -> PathBuf {
    match std::env::var_os("SINSCAL_DATA") {
        Some(data) => PathBuf::from(data).join(".."),
        None => Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared"),
    }
}

/// A folder of cases, or nothing with a printed line.
fn cases(name: &str) -> Option<PathBuf> {
    let folder = shared().join("cases").join(name);
    if !folder.is_dir() {
        println!("skipped: {} is not here", folder.display());
        return None;
    }
    Some(folder)
}

/// How a log is read, by what the command line would say.
fn reading(map: &str, columns: &str) -> Reading {
    Reading {
        map: if map.is_empty() { Default::default() } else { map.parse().expect("a map") },
        columns: (!columns.is_empty()).then(|| super::column_names(columns).expect("names")),
        ..Reading::default()
    }
}

fn samples(path: &Path, reading: &Reading) -> Result<Vec<Sample>, LogError> {
    Log::open(path, reading)?.samples()?.collect()
}

/// Means of rate, deg/s, and of force, m/s^2, over samples of one length.
fn means(samples: &[Sample], rate: f64) -> [Vector3<f64>; 2] {
    let scale = rate / samples.len() as f64;
    [
        samples.iter().map(|sample| sample.dtheta).sum::<Vector3<f64>>() * scale / DEGREE,
        samples.iter().map(|sample| sample.dvel).sum::<Vector3<f64>>() * scale,
    ]
}

/// The same unit at rest in every layout: the same means, and the rows of all that hold the same digits are the same.
#[test]
fn layouts_that_programs_write_give_the_same_unit() -> Done {
    let Some(folder) = cases("files") else { return Ok(()) };
    let xyz = "gyro=w:rad/s,accel=a:m/s^2";
    let mut first: Option<Vec<Sample>> = None;
    for (name, map, columns) in [
        ("euroc-like", "time=#timestamp [ns]:ns,gyro=w_RS_S,accel=a_RS_S", ""),
        ("euroc-like", "gyro=w_RS_S:rad/s,accel=a_RS_S", ""),
        (
            "rostopic-like",
            "time=%time:ns,gyro=field.angular_velocity:rad/s,accel=field.linear_acceleration:m/s^2",
            "",
        ),
        ("px4-like", "time=timestamp:us,gyro=gyro_rad:rad/s,accel=accelerometer_m_s2:m/s^2", ""),
        (
            "px4-like",
            "time=timestamp:us,dtheta_x=gyro_rad[0]:rad/s,dtheta_y=gyro_rad[1]:rad/s,dtheta_z=gyro_rad[2]:rad/s,\
             accel=accelerometer_m_s2[{0,1,2}]:m/s^2",
            "",
        ),
        ("blanks", &format!("time=time,{xyz}"), ""),
        ("tabs", &format!("time=time,{xyz}"), ""),
        ("no-header", xyz, "wx,wy,wz,ax,ay,az"),
        ("decimal-commas", "time=t,gyro=g:rad/s,accel=a:m/s^2", ""),
        ("secs-nsecs", &format!("time=secs+nsecs,{xyz}"), ""),
        ("secs-nsecs", xyz, ""),
        ("preamble", "gyro=g:131 LSB/(deg/s),accel=a:16384 LSB/g", ""),
        ("navego-like.mat", "", ""),
        ("navego-like.mat", "time=imu.t,gyro=imu.wb:rad/s,accel=imu.fb:m/s^2", ""),
    ] {
        if name.ends_with(".mat") && !cfg!(feature = "mat") {
            continue;
        }
        let path = folder.join(if name.ends_with(".mat") { name.to_owned() } else { format!("{name}.csv") });
        let read = samples(&path, &reading(map, columns)).map_err(|fault| fault.messages().join("\n"))?;
        let [rate, force] = means(&read, 200.0);
        let worst = 5.0 / (read.len() as f64).sqrt();
        let (w, f) = (Vector3::new(0.2, -0.1, 0.3), Vector3::new(0.1, -0.2, 9.79));
        assert!((rate - w).norm() < 0.001 * worst / DEGREE + 0.01, "{name}: {rate}");
        assert!((force - f).norm() < 0.02 * worst + 0.002, "{name}: {force}");
        if name == "preamble" {
            continue;
        }
        match &first {
            None => first = Some(read),
            Some(first) => {
                assert_eq!(read.len(), first.len(), "{name}");
                for (row, (read, first)) in read.iter().zip(first).enumerate() {
                    // stamps are rounded to 128 ns where they were written as doubles
                    assert!((read.dtheta - first.dtheta).norm() < 1e-4 * first.dtheta.norm(), "{name} {row}");
                    assert!((read.dvel - first.dvel).norm() < 1e-4 * first.dvel.norm(), "{name} {row}");
                }
            }
        }
    }
    Ok(())
}

/// Stamps in ns are used with all their digits.
#[test]
fn stamps_of_nineteen_digits_lose_nothing() -> Done {
    let Some(folder) = cases("files") else { return Ok(()) };
    let path = folder.join("euroc-like.csv");
    let read = samples(&path, &reading("gyro=w_RS_S,accel=a_RS_S", ""))?;
    let text = fs::read_to_string(&path)?;
    let mut before: Option<i64> = None;
    for (line, sample) in text.lines().skip(1).zip(&read) {
        let fields: Vec<&str> = line.split(',').collect();
        let time: i64 = fields[0].parse()?;
        let step = before.replace(time).map_or(0.005, |before| (time - before) as f64 * 1e-9);
        for axis in 0..3 {
            let expected = fields[1 + axis].parse::<f64>()? * step;
            assert!((sample.dtheta[axis] - expected).abs() <= 1e-9 * expected.abs(), "{line}");
        }
    }
    Ok(())
}

#[test]
fn headers_that_are_comments_or_come_late_are_read() -> Done {
    let Some(folder) = cases("logs") else { return Ok(()) };
    let rates = "gyro=field.angular_velocity:rad/s,accel=field.linear_acceleration:m/s^2";
    let mut all = Vec::new();
    for (name, map) in [
        ("header-begins-with-hash/rostopic.csv", format!("time=%time:ns,{rates}")),
        (
            "header-begins-with-hash/euroc.csv",
            "time=#timestamp [ns]:ns,dtheta_x=w_RS_S_x [rad s^-1]:rad/s,dtheta_y=w_RS_S_y [rad s^-1]:rad/s,\
             dtheta_z=w_RS_S_z [rad s^-1]:rad/s,accel=a_RS_S:m/s^2"
                .into(),
        ),
        (
            "names-with-brackets/px4.csv",
            "time=timestamp:us,gyro=gyro_rad:rad/s,accel=accelerometer_m_s2:m/s^2".into(),
        ),
    ] {
        let read =
            samples(&folder.join(name), &reading(&map, "")).map_err(|fault| fault.messages().join("\n"))?;
        all.push((name, read));
    }
    let (_, first) = &all[0];
    for (name, read) in &all {
        for (a, b) in read.iter().zip(first) {
            assert!((a.dtheta - b.dtheta).norm() < 1e-9 * b.dtheta.norm() + 1e-15, "{name}");
        }
    }
    let late = folder.join("lines-above-the-names/log.csv");
    let map = "time=time,dtheta_x=Gx[deg/s]:deg/s,dtheta_y=Gy[deg/s]:deg/s,dtheta_z=Gz[deg/s]:deg/s,dvel_x=Ax[mG]:mg,\
               dvel_y=Ay[mG]:mg,dvel_z=Az[mG]:mg,temp=Ts";
    let said = samples(&late, &reading(map, "")).map_err(|fault| fault.messages().join("\n"))?;
    let short = samples(&late, &reading("time=time,gyro=G,accel=A,temp=Ts", ""))?;
    assert_eq!(format!("{said:?}"), format!("{short:?}"));
    assert!((said[0].dvel.z - 1021.93e-3 * 9.80665 * 0.01).abs() < 1e-12 && said[0].temperature.y == 30.1);
    Ok(())
}

#[test]
fn one_thermometer_serves_all_sensors() -> Done {
    let Some(folder) = cases("logs/one-thermometer") else { return Ok(()) };
    for map in ["temp_x=temp,temp_y=temp,temp_z=temp,temp_gyro=temp", "temp=temp,temp_gyro=temp[0,0,0]"] {
        let read = samples(&folder.join("one.csv"), &reading(map, ""))
            .map_err(|fault| fault.messages().join("\n"))?;
        assert!(
            read.iter()
                .all(|s| s.temperature == Vector3::repeat(25.0) && s.gyro_temperature == s.temperature)
        );
    }
    let unsaid = samples(&folder.join("one.csv"), &Reading::default())?;
    assert_eq!((unsaid[0].temperature.z, unsaid[0].gyro_temperature.z.is_nan()), (25.0, true));
    if cfg!(feature = "npz") {
        for map in ["temp=T[0,0,0]", "temp=T"] {
            let map = format!("gyro=imu[0:3],accel=imu[3:6],time=imu[6],{map}");
            let read = samples(&folder.join("guide.npz"), &reading(&map, ""))
                .map_err(|fault| fault.messages().join("\n"))?;
            assert!(read.iter().all(|s| s.temperature.x == s.temperature.z && s.temperature.x.is_finite()));
        }
    }
    Ok(())
}

/// Steps of 40, 40, 40 and 80 ms: every way to read them keeps what was turned and gained.
#[test]
fn uneven_steps_are_integrated_with_their_own_length() -> Done {
    let Some(folder) = cases("logs/bridged-uneven-steps") else { return Ok(()) };
    let path = folder.join("log.csv");
    let plain = reading("time=t,gyro=g:rad/s,accel=a:m/s^2", "");
    let refused = samples(&path, &plain).err().ok_or("accepted")?.messages().join("\n");
    assert!(refused.contains("--stamps trust") && refused.contains("--stamps fit"), "{refused}");
    let trusted = samples(&path, &Reading { stamps: Some(super::Stamps::Trust), ..plain.clone() })?;
    let bridged = samples(&path, &Reading { bridge: Some(0.1), ..plain })?;
    let mut time = 0.0;
    for (line, sample) in fs::read_to_string(&path)?.lines().skip(1).zip(&trusted) {
        let fields: Vec<f64> = line.split(',').map(str::parse).collect::<Result<_, _>>()?;
        let step = if time == 0.0 { 0.05 } else { fields[0] - time };
        time = fields[0];
        assert!((sample.dvel.z - fields[6] * step).abs() < 1e-12);
    }
    // a row put into a gap lasts a part of it: the sums are the same to what the signal changes within a gap
    let sum = |samples: &[Sample]| samples.iter().map(|sample| sample.dvel.norm()).sum::<f64>();
    let (a, b) = (sum(&trusted), sum(&bridged));
    assert!((a / b - 1.0).abs() < 1e-3, "{a} {b}");
    Ok(())
}
