//! Where a report comes from: program, command line, the files that were read with their SHA-256.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use miette::{Result, miette};
use sha2::{Digest, Sha256};

use super::Report;
use logs::Log;

/// What a log's `NAME.truth.json` says, where there is one beside it.
pub(crate) fn truth_beside(log: &Log) -> Result<Option<rig::Truth>> {
    let path = log.table().with_extension("truth.json");
    let Ok(content) = std::fs::read_to_string(&path) else { return Ok(None) };
    let values: BTreeMap<String, Vec<f64>> = serde_json::from_str(&content).map_err(|error| {
        miette!("{}: is not a truth that `sinscal simulate` wrote: {error}", path.display())
    })?;
    let mut truth = rig::Truth::default();
    for (name, values) in values {
        if let Some(effect) = sinscal::effect(&name) {
            truth.insert(effect, values);
        }
    }
    Ok(Some(truth))
}

impl Report {
    /// Adds where every report comes from: program and command line.
    pub(crate) fn with_program(mut self) -> Self {
        let quoted = |argument: std::ffi::OsString| {
            let argument = argument.to_string_lossy().into_owned();
            let plain = |c: char| c.is_alphanumeric() || "-_./=,:+".contains(c);
            if !argument.is_empty() && argument.chars().all(plain) {
                argument
            } else {
                format!("'{}'", argument.replace('\'', "'\\''"))
            }
        };
        let mut line = vec!["sinscal".to_owned()];
        line.extend(std::env::args_os().skip(1).map(quoted));
        self.origin.push(("command".into(), line.join(" ")));
        self.origin.push(("program".into(), concat!("sinscal ", env!("CARGO_PKG_VERSION")).into()));
        self
    }

    /// Adds a log: its files with their SHA-256, and its description in full.
    pub(crate) fn with_log(mut self, log: &Log) -> Self {
        self = self.with_file("log", log.table());
        let description = log.table().with_extension("toml");
        if let Ok(content) = std::fs::read_to_string(&description) {
            self = self.with_file("description", &description);
            self.attachments.push((description.display().to_string(), content));
        }
        self
    }

    /// Adds a file that was read, with its SHA-256.
    pub(crate) fn with_file(mut self, what: &str, path: &Path) -> Self {
        if let Ok(sum) = sha256(path) {
            self.origin.push((what.into(), format!("{}, SHA-256 {sum}", path.display())));
        }
        self
    }

    /// Adds a scenario in full, the default one where no file is given.
    pub(crate) fn with_scenario(mut self, path: Option<&Path>) -> Self {
        match path {
            Some(path) => {
                self = self.with_file("scenario", path);
                if let Ok(content) = std::fs::read_to_string(path) {
                    self.attachments.push((path.display().to_string(), content));
                }
            }
            None => self.attachments.push(("default scenario".into(), rig::DEFAULT_SCENARIO.into())),
        }
        self
    }

    /// Adds a setting.
    pub(crate) fn with(mut self, name: &str, value: impl Into<String>) -> Self {
        self.origin.push((name.into(), value.into()));
        self
    }
}

/// Sum of a file, in hexadecimal.
pub(crate) fn sha256(path: &Path) -> io::Result<String> {
    let mut file = File::open(path)?;
    let mut sum = Sha256::new();
    let mut buffer = vec![0; 1 << 16];
    loop {
        let read = file.read(&mut buffer)?;
        if read == 0 {
            return Ok(sum.finalize().iter().map(|byte| format!("{byte:02x}")).collect());
        }
        sum.update(&buffer[..read]);
    }
}
