//! Recordings written byte by byte after their specifications, and read like any log; damaged ones are read or refused.

use std::io::Write;

use nalgebra::Vector3;
use proptest::prelude::*;

use crate::fuzz::damage::damaged;
use crate::tests::support::Done;
use crate::{Log, LogError, Reading};

const DESCRIPTION: &str = "[imu]\nrate_hz = 200.0\n[site]\nlatitude_deg = 47.4\nlongitude_deg = 8.5\nheight_m = 400.0\n\
     [initial]\nquaternion_wxyz = [1.0, 0.0, 0.0, 0.0]\nlevel_sigma_deg = 1.0\nheading_sigma_deg = 180.0\n\
     [noise]\ngyro_arw_deg_sqrt_h = 0.5\naccel_vrw_ug_sqrt_hz = 200.0\n";
const ROWS: u32 = 60;
const SECOND: u32 = 1_700_000_000;

fn rate(row: u32) -> [f64; 3] {
    [1e-3, -2e-3, 3e-3].map(|mean| mean + 1e-4 * f64::from(row % 7))
}

fn force(row: u32) -> [f64; 3] {
    [0.1, -0.2, 9.79].map(|mean| mean + 1e-3 * f64::from(row % 5))
}

/// A text behind its length.
fn text(text: &[u8]) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes(), text].concat()
}

/// `sensor_msgs/Imu` of a row.
fn imu(row: u32, cdr: bool) -> Vec<u8> {
    let mut bytes = Vec::new();
    if !cdr {
        bytes.extend(row.to_le_bytes());
    }
    bytes.extend(SECOND.to_le_bytes());
    bytes.extend((row * 5_000_000).to_le_bytes());
    bytes.extend(text(if cdr { b"imu\0" } else { b"imu" }));
    if cdr {
        // numbers stand at multiples of eight
        bytes.resize(bytes.len().next_multiple_of(8), 0xaa);
    }
    let numbers =
        [[0.1, 0.2, 0.3].as_slice(), &[0.9], &[0.0; 9], &rate(row), &[0.0; 9], &force(row), &[0.0; 9]];
    bytes.extend(numbers.concat().into_iter().flat_map(f64::to_le_bytes));
    if cdr { [&[0, 1, 0, 0], bytes.as_slice()].concat() } else { bytes }
}

/// A record of a bag.
fn record(fields: &[(&str, &[u8])], data: &[u8]) -> Vec<u8> {
    let fields: Vec<u8> =
        fields.iter().flat_map(|(name, value)| text(&[name.as_bytes(), b"=", value].concat())).collect();
    [text(&fields), text(data)].concat()
}

fn bag(packing: &str) -> Vec<u8> {
    let about = |kind: &str| -> Vec<u8> {
        let fields = [("type", kind), ("md5sum", &"0".repeat(32)), ("message_definition", "")];
        fields.iter().flat_map(|(name, value)| text(format!("{name}={value}").as_bytes())).collect()
    };
    let conn = |id: u32| id.to_le_bytes();
    let mut chunk =
        record(&[("op", &[7]), ("conn", &conn(0)), ("topic", b"/imu/data")], &about("sensor_msgs/Imu"));
    chunk.extend(record(
        &[("op", &[7]), ("conn", &conn(1)), ("topic", b"/rosout")],
        &about("rosgraph_msgs/Log"),
    ));
    for row in 0..ROWS {
        chunk.extend(record(&[("op", &[2]), ("conn", &conn(0)), ("time", &[0; 8])], &imu(row, false)));
        chunk.extend(record(&[("op", &[2]), ("conn", &conn(1)), ("time", &[0; 8])], b"words"));
    }
    let size = (chunk.len() as u32).to_le_bytes();
    let packed = match packing {
        "lz4" => {
            let mut packer = lz4_flex::frame::FrameEncoder::new(Vec::new());
            packer.write_all(&chunk).expect("packed");
            packer.finish().expect("packed")
        }
        "bz2" => {
            let mut packer = bzip2::write::BzEncoder::new(Vec::new(), bzip2::Compression::fast());
            packer.write_all(&chunk).expect("packed");
            packer.finish().expect("packed")
        }
        _ => chunk,
    };
    let head = record(
        &[("op", &[3]), ("index_pos", &[0; 8]), ("conn_count", &[1; 4]), ("chunk_count", &[1; 4])],
        b"   ",
    );
    let chunk = record(&[("op", &[5]), ("compression", packing.as_bytes()), ("size", &size)], &packed);
    [b"#ROSBAG V2.0\n".as_slice(), &head, &chunk].concat()
}

/// A record of MCAP.
fn framed(operation: u8, data: &[u8]) -> Vec<u8> {
    [&[operation], (data.len() as u64).to_le_bytes().as_slice(), data].concat()
}

fn mcap(packing: &str, cdr: bool) -> Vec<u8> {
    let kind = if cdr { "sensor_msgs/msg/Imu" } else { "sensor_msgs/Imu" };
    let (encoding, short) = (if cdr { "cdr" } else { "ros1" }, |id: u16| id.to_le_bytes());
    let schema = [&short(1)[..], &text(kind.as_bytes()), &text(b"ros2msg"), &text(b"")].concat();
    let channel =
        [&short(4)[..], &short(1), &text(b"/imu/data"), &text(encoding.as_bytes()), &text(b"")].concat();
    let mut chunk = [framed(3, &schema), framed(4, &channel)].concat();
    for row in 0..ROWS {
        chunk.extend(framed(5, &[&short(4)[..], &[0; 20], &imu(row, cdr)].concat()));
    }
    let packed = match packing {
        "zstd" => zstd::encode_all(chunk.as_slice(), 1).expect("packed"),
        "lz4" => {
            let mut packer = lz4_flex::frame::FrameEncoder::new(Vec::new());
            packer.write_all(&chunk).expect("packed");
            packer.finish().expect("packed")
        }
        _ => chunk.clone(),
    };
    let (size, length) = ((chunk.len() as u64).to_le_bytes(), (packed.len() as u64).to_le_bytes());
    let chunk = [&[0; 16], &size[..], &[0; 4], &text(packing.as_bytes()), &length, &packed].concat();
    let magic = b"\x89MCAP0\r\n".as_slice();
    [
        magic,
        &framed(1, &[text(b"ros2"), text(b"t")].concat()),
        &framed(6, &chunk),
        &framed(15, &[0; 4]),
        magic,
    ]
    .concat()
}

fn ulog() -> Vec<u8> {
    let message =
        |kind: u8, data: &[u8]| [(data.len() as u16).to_le_bytes().as_slice(), &[kind], data].concat();
    let mut bytes = [b"ULog\x01\x12\x35\x01".as_slice(), &[0; 8]].concat();
    bytes.extend(message(b'B', &[0; 40]));
    bytes.extend(message(b'I', b"\x10char[3] sys_nameabc"));
    bytes.extend(message(
        b'F',
        b"sensor_combined:uint64_t timestamp;float[3] gyro_rad;uint32_t dt;float[3] accelerometer_m_s2;",
    ));
    bytes.extend(message(b'A', b"\x00\x03\x00sensor_combined"));
    for row in 0..ROWS {
        let floats = |numbers: [f64; 3]| numbers.into_iter().flat_map(|number| (number as f32).to_le_bytes());
        let time = 112_614_307 + 5000 * u64::from(row);
        let mut data = [3_u16.to_le_bytes().as_slice(), &time.to_le_bytes()].concat();
        data.extend(floats(rate(row)));
        data.extend([0; 4]);
        data.extend(floats(force(row)));
        bytes.extend(message(b'D', &data));
    }
    bytes
}

/// Time, rate and force.
type Row = (f64, Vector3<f64>, Vector3<f64>);

/// What a recording of this name gives.
fn read(name: &str, bytes: &[u8]) -> Result<Vec<Row>, LogError> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).expect("written");
    std::fs::write(path.with_extension("toml"), DESCRIPTION).expect("written");
    let log = Log::open(&path, &Reading::default())?;
    let samples: Vec<_> = log.samples()?.collect::<Result<_, _>>()?;
    let mut last = None;
    let found = samples.iter().map(|sample| {
        let step = last.replace(sample.time).map_or(0.005, |last| sample.time - last);
        (sample.time, sample.dtheta / step, sample.dvel / step)
    });
    Ok(found.collect())
}

#[test]
fn recordings_are_read_without_a_map() -> Done {
    for (name, bytes, digits) in [
        ("log.bag", bag("none"), 1e-12),
        ("log.bag", bag("lz4"), 1e-12),
        ("log.bag", bag("bz2"), 1e-12),
        ("log.mcap", mcap("", true), 1e-12),
        ("log.mcap", mcap("zstd", true), 1e-12),
        ("log.mcap", mcap("lz4", false), 1e-12),
        ("log.ulg", ulog(), 1e-6),
    ] {
        let found = read(name, &bytes).map_err(|fault| format!("{name}: {}", fault.messages().join("\n")))?;
        assert_eq!(found.len(), ROWS as usize, "{name}");
        for (row, (time, turn, pull)) in found.iter().enumerate() {
            assert!((time - found[0].0 - 0.005 * row as f64).abs() < 1e-9, "{name}: {time}");
            let row = row as u32;
            assert!((turn - Vector3::from(rate(row))).norm() < digits * 1e-2, "{name}, row {row}: {turn}");
            assert!((pull - Vector3::from(force(row))).norm() < digits * 10.0, "{name}, row {row}: {pull}");
        }
    }
    Ok(())
}

/// A recording with more turn and pull in each step.
fn rewritten(name: &str, bytes: &[u8], turn: &Vector3<f64>, pull: &Vector3<f64>) -> Result<Vec<u8>, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).expect("written");
    std::fs::write(path.with_extension("toml"), DESCRIPTION).expect("written");
    let told = |fault: LogError| fault.messages().join("\n");
    let log = Log::open(&path, &Reading::default()).map_err(told)?;
    let mut written = Vec::new();
    log.rewrite(&mut written, &mut |sample| (sample.dtheta + turn, sample.dvel + pull))
        .map_err(told)?
        .map_err(|error| error.to_string())?;
    Ok(written)
}

#[test]
fn recordings_are_written_with_other_rates_and_forces_and_nothing_else() -> Done {
    let (turn, pull) = (Vector3::new(1e-5, -2e-5, 3e-5), Vector3::new(-1e-3, 2e-3, 3e-3));
    for (name, bytes, digits, size) in [
        ("log.bag", bag("none"), 1e-12, 8),
        ("log.mcap", mcap("", true), 1e-12, 8),
        ("log.mcap", mcap("", false), 1e-12, 8),
        ("log.ulg", ulog(), 1e-6, 4),
    ] {
        let written =
            rewritten(name, &bytes, &turn, &pull).map_err(|problem| format!("{name}: {problem}"))?;
        let (before, after) = (read(name, &bytes)?, read(name, &written)?);
        assert_eq!(before.len(), after.len(), "{name}");
        for (before, after) in before.iter().zip(&after) {
            assert_eq!(before.0, after.0, "{name}");
            assert!(
                (after.1 - before.1 - turn / 0.005).norm() < digits * 1e-2,
                "{name}: {before:?} {after:?}"
            );
            assert!(
                (after.2 - before.2 - pull / 0.005).norm() < digits * 10.0,
                "{name}: {before:?} {after:?}"
            );
        }
        let others = bytes.iter().zip(&written).filter(|(old, new)| old != new).count();
        assert!(written.len() == bytes.len() && others <= 6 * size * ROWS as usize, "{name}: {others}");
        // and nothing where nothing is taken out
        assert_eq!(rewritten(name, &bytes, &Vector3::zeros(), &Vector3::zeros())?, bytes, "{name}");
    }
    Ok(())
}

#[test]
fn checksums_of_what_was_written_are_taken_out() -> Done {
    let (bytes, none) = (mcap("", true), Vector3::zeros());
    let mut with = bytes.clone();
    // of the chunk: behind the magic, a header of 9 + 4 + 4 + 4 + 1 bytes, the head of the record and three numbers; of all data
    let (chunk, data) = (8 + 22 + 9 + 24, bytes.len() - 8 - 4);
    for at in [chunk, data] {
        assert_eq!(with[at..at + 4], [0; 4]);
        with[at..at + 4].fill(7);
    }
    assert_eq!(rewritten("log.mcap", &with, &none, &none)?, bytes);
    Ok(())
}

#[test]
fn what_is_packed_is_read_and_not_written() {
    for (name, bytes, part) in [
        ("log.bag", bag("lz4"), "`rosbag decompress` unpacks them"),
        ("log.mcap", mcap("zstd", true), "`mcap decompress` unpacks them"),
    ] {
        let fault = rewritten(name, &bytes, &Vector3::zeros(), &Vector3::zeros()).expect_err(name);
        assert!(fault.contains(part), "{name}: {fault}");
    }
}

#[test]
fn what_is_no_recording_is_refused_with_its_name() {
    for (name, bytes, part) in [
        ("log.bag", b"#ROSBAG V1.2\n".to_vec(), "log.bag: is no bag of ROS 1"),
        ("log.bag", bag("none")[..2000].to_vec(), "it is cut off"),
        ("log.mcap", b"\x89MCAP1\r\n".to_vec(), "log.mcap: is no MCAP recording"),
        ("log.mcap", mcap("", true)[..3000].to_vec(), "mcap recover"),
        ("log.ulg", b"ULo".to_vec(), "log.ulg"),
    ] {
        let fault = read(name, &bytes).expect_err(name).messages().join("\n");
        assert!(fault.contains(part), "{name}: {fault}");
    }
}

fn check(name: &str, bytes: &[u8]) -> Result<(), TestCaseError> {
    match read(name, bytes) {
        // damage of a few bytes makes few more rows
        Ok(rows) => prop_assert!(rows.len() <= 32 * ROWS as usize),
        Err(fault) => prop_assert!(!fault.messages().is_empty()),
    }
    Ok(())
}

proptest! {
    #[test]
    fn fuzz_bag(damaged in damaged(bag("none"))) {
        check("log.bag", &damaged)?;
    }

    #[test]
    fn fuzz_packed_bag(damaged in damaged(bag("lz4"))) {
        check("log.bag", &damaged)?;
    }

    #[test]
    fn fuzz_mcap(damaged in damaged(mcap("", true))) {
        check("log.mcap", &damaged)?;
    }

    #[test]
    fn fuzz_packed_mcap(damaged in damaged(mcap("zstd", true))) {
        check("log.mcap", &damaged)?;
    }

    #[test]
    fn fuzz_ulog(damaged in damaged(ulog())) {
        check("log.ulg", &damaged)?;
    }
}
