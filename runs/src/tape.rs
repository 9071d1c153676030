//! What the smoother remembers of a run, in a temporary file.

use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};

use sinscal::Tape;

/// A file without a name, which goes with the program.
pub(crate) struct FileTape {
    file: BufWriter<File>,
    length: u64,
    bytes: Vec<u8>,
}

impl FileTape {
    pub(crate) fn new() -> io::Result<Self> {
        Ok(Self {
            file: BufWriter::new(tempfile::tempfile().map_err(unnamed)?),
            length: 0,
            bytes: Vec::new(),
        })
    }
}

/// Without the name of a file that nobody has asked for: where it was to be is enough.
fn unnamed(error: io::Error) -> io::Error {
    let cause = error.get_ref().and_then(|inner| inner.source()).map(ToString::to_string);
    let folder = std::env::temp_dir();
    let cause = cause.unwrap_or_else(|| error.to_string());
    io::Error::new(error.kind(), format!("in {} (TMPDIR): {cause}", folder.display()))
}

impl Tape for FileTape {
    fn push(&mut self, record: &[f64]) -> io::Result<()> {
        self.bytes.clear();
        self.bytes.extend(record.iter().flat_map(|number| number.to_le_bytes()));
        self.length += self.bytes.len() as u64;
        self.file.write_all(&self.bytes)
    }

    fn pop(&mut self, record: &mut [f64]) -> io::Result<bool> {
        let Some(start) = self.length.checked_sub(8 * record.len() as u64) else { return Ok(false) };
        self.length = start;
        // writes out what is still buffered
        self.file.seek(SeekFrom::Start(start))?;
        self.bytes.resize(8 * record.len(), 0);
        self.file.get_mut().read_exact(&mut self.bytes)?;
        for (number, bytes) in record.iter_mut().zip(self.bytes.chunks_exact(8)) {
            *number = f64::from_le_bytes(bytes.try_into().map_err(io::Error::other)?);
        }
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_come_back_from_the_last_to_the_first() -> io::Result<()> {
        let mut tape = FileTape::new()?;
        for k in 0..1000 {
            tape.push(&[f64::from(k), -1.0 / f64::from(k), f64::NAN])?;
        }
        let mut record = [0.0; 3];
        for k in (0..1000).rev() {
            assert!(tape.pop(&mut record)?);
            assert_eq!(record[..2], [f64::from(k), -1.0 / f64::from(k)]);
        }
        assert!(!tape.pop(&mut record)?);
        Ok(())
    }
}
