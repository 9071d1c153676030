//! Where a report comes from: program, command line, the files that were read with their SHA-256.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use miette::{Result, miette};
use runs::{ReadError, each};
use sha2::{Digest, Sha256};
use sinscal::Sample;

use logs::Log;
use reports::{Inputs, Report};

use crate::output::Files;
use crate::source::{Source, unreadable};
use crate::vocabulary::vocabulary;

/// What a log's `NAME.truth.json` says, where there is one beside it.
pub(crate) fn truth_beside(log: &Log) -> Result<Option<rig::Truth>> {
    let path = log.table().with_extension("truth.json");
    let Ok(content) = std::fs::read_to_string(&path) else { return Ok(None) };
    let values: BTreeMap<String, Vec<f64>> = serde_json::from_str(&content).map_err(|error| {
        miette!("{}: is not a truth that `sinscal simulate` wrote: {error}", path.display())
    })?;
    let mut truth = rig::Truth::default();
    for (name, values) in values {
        if let Ok(effect) = vocabulary().effect(&name) {
            truth.insert(effect.info(), values);
        }
    }
    Ok(Some(truth))
}

/// What the program adds to a page, and where it puts it.
pub(crate) trait Documented: Sized {
    /// Adds where every report comes from: program and command line.
    fn with_program(self) -> Self;
    /// Adds a log: its files with their SHA-256, and its description in full.
    fn with_log(self, log: &Log) -> Self;
    /// Adds a file that was read, with its SHA-256.
    fn with_file(self, what: &str, path: &Path) -> Self;
    /// Adds a scenario in full, the default one where no file is given.
    fn with_scenario(self, path: Option<&Path>) -> Self;
    /// Writes the page alone.
    fn write_page(&self, files: &mut Files, path: &Path) -> Result<()>;
    /// Writes `report.html` to a folder, and what is drawn in it to `figures/`.
    fn write(&self, files: &mut Files, folder: &Path) -> Result<()>;
}

impl Documented for Report {
    fn with_program(mut self) -> Self {
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

    fn with_log(mut self, log: &Log) -> Self {
        self = self.with_file("log", log.table());
        let description = log.description_path();
        if let Ok(content) = std::fs::read_to_string(&description) {
            self = self.with_file("description", &description);
            self.attachments.push((description.display().to_string(), content));
        }
        self
    }

    fn with_file(mut self, what: &str, path: &Path) -> Self {
        if let Ok(sum) = sha256(path) {
            self.origin.push((what.into(), format!("{}, SHA-256 {sum}", path.display())));
        }
        self
    }

    fn with_scenario(mut self, path: Option<&Path>) -> Self {
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

    fn write_page(&self, files: &mut Files, path: &Path) -> Result<()> {
        let html = self.page().map_err(|error| miette!("{error}"))?;
        files.write(path, |file| file.write_all(html.as_bytes()))
    }

    fn write(&self, files: &mut Files, folder: &Path) -> Result<()> {
        for (name, content) in self.files().map_err(|error| miette!("{error}"))? {
            let path = folder.join(name);
            if let Some(folder) = path.parent() {
                files.folder(folder)?;
            }
            files.write(&path, |file| file.write_all(&content))?;
        }
        Ok(())
    }
}

/// What the unit was put through in a log.
pub(crate) fn inputs(log: &Log) -> Result<Inputs> {
    let mut inputs = Inputs::new();
    let push = |sample: &Sample| {
        inputs.push(sample);
        Ok(())
    };
    each::<ReadError>(&Source::silent(log), push).map_err(|error| unreadable(log, error))?;
    Ok(inputs)
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
