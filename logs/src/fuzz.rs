//! Damaged logs are read or refused: no panic, no endless reading, whatever they hold.

use std::fs;
use std::path::Path;

use proptest::prelude::*;

use self::damage::damaged;
use super::tests::support::{DESCRIPTION, Table};
use super::{Log, Reading};

#[path = "../../tests/common/damage.rs"]
pub(crate) mod damage;

/// Rows of the sound table; no damage of a few bytes makes many more of it.
const ROWS: usize = 120;

/// Reads the log in a folder to its end or its first fault; the number of rows.
fn read(folder: &Path) -> usize {
    let reading = Reading { bridge: Some(0.5), ..Reading::default() };
    let Ok(log) = Log::open(&folder.join("log"), &reading) else { return 0 };
    let Ok(samples) = log.samples() else { return 0 };
    let mut rows = 0;
    for sample in samples {
        match sample {
            Ok(sample) => assert!(sample.dtheta.iter().chain(&sample.dvel).all(|value| value.is_finite())),
            // the message is part of what must not fail
            Err(fault) => assert!(!fault.messages().is_empty()),
        }
        rows += 1;
    }
    rows
}

/// What a table file holds.
fn bytes(write: impl FnOnce(&Path) -> Result<(), Box<dyn std::error::Error>>) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("table");
    write(&path).expect("a table");
    fs::read(path).expect("its bytes")
}

fn check(name: &str, damaged: &[u8], table: &[u8]) -> Result<(), TestCaseError> {
    let folder = tempfile::tempdir()?;
    fs::write(folder.path().join("log.toml"), DESCRIPTION)?;
    if name == "log.toml" {
        fs::write(folder.path().join("log.csv"), table)?;
    }
    fs::write(folder.path().join(name), damaged)?;
    // a gap of half a second is bridged by at most 25 rows
    prop_assert!(read(folder.path()) <= 32 * 10 * ROWS);
    Ok(())
}

proptest! {
    #[test]
    fn fuzz_csv(damaged in damaged(bytes(|path| Table::at_rest(ROWS).write_csv(path)))) {
        check("log.csv", &damaged, &[])?;
    }

    #[test]
    fn fuzz_parquet(damaged in damaged(bytes(|path| Table::at_rest(ROWS).write_parquet(path, None)))) {
        check("log.parquet", &damaged, &[])?;
    }

    #[test]
    fn fuzz_description(damaged in damaged(DESCRIPTION.into())) {
        check("log.toml", &damaged, Table::at_rest(ROWS).csv().as_bytes())?;
    }
}
