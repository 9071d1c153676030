//! Whether a file is still the one that it was.

use std::fs::Metadata;
use std::path::Path;
use std::time::SystemTime;

use super::fault::LogError;

/// Identity, length and time of the last change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Stamp {
    file: Option<(u64, u64)>,
    length: u64,
    changed: Option<SystemTime>,
}

impl Stamp {
    /// Of the file as it is.
    pub(super) fn of(path: &Path) -> Result<Self, LogError> {
        let metadata = std::fs::metadata(path).map_err(|error| super::unreadable(path, &error))?;
        Ok(Self { file: file(&metadata), length: metadata.len(), changed: metadata.modified().ok() })
    }

    /// Refuses a file that has become another.
    pub(super) fn check(&self, path: &Path) -> Result<(), LogError> {
        if Self::of(path)? == *self {
            return Ok(());
        }
        Err(LogError::file(path, "was changed or replaced while it was read")
            .help("a log is read several times and must stay as it is: copy it, or wait until its recording has ended"))
    }
}

/// Device and number of a file, where the system has them.
#[cfg(unix)]
fn file(metadata: &Metadata) -> Option<(u64, u64)> {
    use std::os::unix::fs::MetadataExt;
    Some((metadata.dev(), metadata.ino()))
}

#[cfg(not(unix))]
fn file(_: &Metadata) -> Option<(u64, u64)> {
    None
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn what_was_appended_or_replaced_is_another_file() -> Result<(), Box<dyn std::error::Error>> {
        let folder = tempfile::tempdir()?;
        let path = folder.path().join("log.csv");
        fs::write(&path, "time_s\n1\n")?;
        let stamp = Stamp::of(&path)?;
        assert!(stamp.check(&path).is_ok());
        let text = fs::read_to_string(&path)?;
        fs::write(folder.path().join("other"), &text)?;
        fs::rename(folder.path().join("other"), &path)?;
        assert!(stamp.check(&path).is_err());
        let stamp = Stamp::of(&path)?;
        fs::write(&path, text + "2\n")?;
        let fault = stamp.check(&path).map_err(|fault| fault.to_string());
        assert!(fault.is_err_and(|said| said.contains("log.csv: was changed or replaced")));
        fs::remove_file(&path)?;
        assert!(stamp.check(&path).is_err());
        Ok(())
    }
}
