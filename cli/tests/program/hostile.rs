//! Inputs made to hang, to panic or to flood: each ends soon, with a message of bounded length.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

use crate::support::{DESCRIPTION, Done, Table};

/// No refusal takes longer, on a busy machine and without optimisation.
const LONGEST: Duration = Duration::from_secs(20);
/// No message is longer, bytes: twenty faults with what stands around them.
const LARGEST: usize = 100_000;

fn refused(folder: &Path, arguments: &str) -> Result<String, Box<dyn std::error::Error>> {
    let started = Instant::now();
    let Output { status, stderr, .. } = Command::new(env!("CARGO_BIN_EXE_sinscal"))
        .args(arguments.split(' '))
        .current_dir(folder)
        .output()?;
    let said = String::from_utf8(stderr)?;
    let start: String = said.chars().take(2000).collect();
    assert!(started.elapsed() < LONGEST, "{arguments}: {:?}", started.elapsed());
    assert_eq!(status.code(), Some(1), "{arguments}: {start}");
    assert!(said.len() < LARGEST, "{arguments}: {} bytes: {start}", said.len());
    assert!(!said.contains('\u{1b}') && !said.contains("panicked"), "{arguments}: {start}");
    Ok(said)
}

#[test]
fn descriptions_of_many_faults_are_refused_at_once() -> Done {
    let folder = tempfile::tempdir()?;
    let log = folder.path().join("log.toml");
    Table::at_rest(100).write_csv(&folder.path().join("log.csv"))?;
    let many = |head: &str, value: &str| {
        (0..60_000).fold(head.to_owned(), |mut text, i| {
            let _ = writeln!(text, "k{i}={value}");
            text
        })
    };
    let wrong_list = |item: &str| format!("[prior]\n\"accel-bias\" = [{}]\n", vec![item; 200_000].join(","));
    for (text, first) in [
        (many("", "1"), "`[k0]`: is not a name"),
        (many("[imu]\n", "1"), "`imu.k0`: is not a name"),
        (many("[prior]\n", "1"), "`prior.k0`: is not an effect"),
        (many("[prior.accel-bias]\n", "{}"), "`prior.accel-bias.k0`"),
        (wrong_list("1"), "must give a sigma"),
        (format!("[imu]\n{} = 1\n", "k".repeat(500_000)), "is not a name"),
        ("[imu]\n\"rate\\u001b[31m\\u202e_hz\" = 1\n".to_owned(), "\\u{1b}[31m\\u{202e}_hz"),
        ("[imu]\nrate_hz = 50\u{1b}[2J\n".to_owned(), "line 2"),
    ] {
        fs::write(&log, text)?;
        let said = refused(folder.path(), "calibrate log --filter 36d-p")?;
        assert!(said.contains(first), "{first}: {}", said.chars().take(500).collect::<String>());
    }
    Ok(())
}

#[test]
fn scenarios_of_many_faults_are_refused_at_once() -> Done {
    let folder = tempfile::tempdir()?;
    let many = |item: &str, times: usize| {
        format!("[motion]\npath=\"turns\"\nturns=[{}]\n", vec![item; times].join(","))
    };
    let names = |head: &str| {
        (0..60_000).fold(head.to_owned(), |mut text, i| {
            let _ = writeln!(text, "k{i}=1");
            text
        })
    };
    for (text, first) in [
        (names(""), "k0 is not known"),
        (names("[imu]\n"), "imu.k0 is not known"),
        (names("[population]\n"), "population.k0 is not an effect"),
        (many("{axis=\"w\",angle=\"1 deg\"}", 35_000), "motion.turns[0].axis is \"w\""),
        (many("{axis=\"x\",angle=\"1 ell\"}", 35_000), "motion.turns[0].angle"),
        (many("{axis=\"x\",angle=\"1 deg\",rate=\"1e9 deg/s\"}", 20_000), "motion.turns[0].rate"),
        (many("{}", 200_000), "motion.turns[0] lacks its axis"),
        (format!("{}bad = 1\n", " ".repeat(70_000)), "bad is not known"),
        (format!("[imu]\nrate = \"{}\"\n", "x".repeat(900_000)), "imu.rate"),
        ("[imu]\nrate = \"\\u001b[2J\"\n".to_owned(), "\\u{1b}[2J"),
    ] {
        fs::write(folder.path().join("s.toml"), text)?;
        let said = refused(folder.path(), "simulate --scenario s.toml --out x")?;
        assert!(said.contains(first), "{first}: {}", said.chars().take(500).collect::<String>());
    }
    Ok(())
}

/// The parser of NumPy's headers takes twice as long for each bracket in a bracket.
#[cfg(feature = "npz")]
#[test]
fn nested_headers_are_refused_at_once() -> Done {
    use std::io::Write as _;

    let folder = tempfile::tempdir()?;
    fs::write(folder.path().join("log.toml"), DESCRIPTION)?;
    for brackets in ["[".repeat(24), "(".repeat(200), "{".repeat(60_000), "[[{(".repeat(30)] {
        let header = format!("{{'descr': {brackets}}}\n");
        let mut array = b"\x93NUMPY\x02\x00".to_vec();
        array.extend(u32::try_from(header.len())?.to_le_bytes());
        array.extend(header.as_bytes());
        fs::write(folder.path().join("log.npy"), &array)?;
        refused(folder.path(), "calibrate log.npy --filter 36d-p")?;
        let mut archive = zip::ZipWriter::new(fs::File::create(folder.path().join("log.npz"))?);
        archive.start_file("imu.npy", zip::write::SimpleFileOptions::default())?;
        archive.write_all(&array)?;
        archive.finish()?;
        refused(folder.path(), "calibrate log.npz --filter 36d-p")?;
    }
    Ok(())
}

/// A number that was changed, and an array put after another: neither is read as if nothing were wrong.
#[cfg(feature = "npz")]
#[test]
fn checksums_of_archives_are_checked_and_nothing_is_left_unread() -> Done {
    use std::io::Write as _;

    let folder = tempfile::tempdir()?;
    fs::write(folder.path().join("log.toml"), DESCRIPTION)?;
    let rows = 500_usize;
    let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({rows}, 7), }}\n");
    let mut array = b"\x93NUMPY\x01\x00".to_vec();
    array.extend(u16::try_from(header.len())?.to_le_bytes());
    array.extend(header.as_bytes());
    for row in 0..rows {
        let numbers = [0.0, 7.292e-5 * 0.848 / 50.0, 7.292e-5 * 0.5308 / 50.0, 0.0, 0.0, 9.7946 / 50.0];
        let time = (row + 1) as f64 / 50.0;
        numbers.iter().chain([&time]).for_each(|number: &f64| array.extend(number.to_le_bytes()));
    }
    let path = folder.path().join("log.npz");
    let write = |bytes: &[u8]| -> Done {
        let mut archive = zip::ZipWriter::new(fs::File::create(&path)?);
        let stored =
            zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
        archive.start_file("imu.npy", stored)?;
        archive.write_all(bytes)?;
        archive.finish()?;
        Ok(())
    };
    write(&array)?;
    let calibrate = || {
        Command::new(env!("CARGO_BIN_EXE_sinscal"))
            .args(["calibrate", "log.npz", "--filter", "36d-p", "-q"])
            .current_dir(folder.path())
            .output()
    };
    let sound = calibrate()?;
    assert!(sound.status.success(), "{}", String::from_utf8_lossy(&sound.stderr));
    let mut bytes = fs::read(&path)?;
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&path, bytes)?;
    let said = refused(folder.path(), "calibrate log.npz --filter 36d-p")?;
    assert!(said.to_lowercase().contains("checksum") && said.contains("imu"), "{said}");
    write(&[array.as_slice(), &array].concat())?;
    let said = refused(folder.path(), "calibrate log.npz --filter 36d-p")?;
    assert!(said.contains("more follows the array"), "{said}");
    Ok(())
}
