//! Tables as comma-separated text: one header line, then one line per row.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use super::columns::{Batch, NAMES, NEEDED, Source, may_be_empty};
use super::fault::{LogError, shown};
use super::layout::{Holds, Layout, Variable};
use super::map::ColumnMap;

/// No line of a log is longer; a file without line ends must not fill the memory.
const LONGEST_LINE: u64 = 1 << 16;
/// Rows per batch.
const ROWS: usize = 4096;

/// What other files begin with, what they are, and what to do.
const OTHERS: [(&[u8], &str, &str); 8] = [
    (b"PAR1", "a Parquet file, its ending says CSV", "call it .parquet"),
    (b"\x89HDF", "an HDF5 file, its ending says CSV", "call it .h5"),
    (b"MATLAB 5.0", "a MATLAB file, its ending says CSV", "call it .mat"),
    (b"\x93NUMPY", "a NumPy array, its ending says CSV", "call it .npy"),
    (b"PK\x03\x04", "a zip archive, as spreadsheets are", "export the sheet as CSV, or unpack the archive"),
    (b"\x1f\x8b", "packed by gzip", "unpack it"),
    (b"\xff\xfe", "UTF-16 text", "save it as UTF-8"),
    (b"\xfe\xff", "UTF-16 text", "save it as UTF-8"),
];
/// What a line that is a comment begins with, in the languages that write logs.
const COMMENTS: [&str; 4] = ["#", "%", "//", "\"#"];

/// A CSV file being read.
pub(super) struct CsvSource {
    path: PathBuf,
    lines: Lines,
    /// Slot of each column of the file, if it is read.
    slots: Vec<Option<usize>>,
    row: u64,
    /// Line of each row of the batch.
    numbers: Vec<u64>,
}

impl CsvSource {
    /// Opens a file and reads its header.
    pub(super) fn open(path: &Path, map: &ColumnMap) -> Result<(Self, Layout), LogError> {
        let file = File::open(path).map_err(|error| super::unreadable(path, &error))?;
        let mut reader = BufReader::with_capacity(1 << 16, file);
        let start = reader.fill_buf().map_err(|error| super::unreadable(path, &error))?;
        if let Some((_, what, help)) = OTHERS.iter().find(|(magic, ..)| start.starts_with(magic)) {
            return Err(LogError::file(path, format!("is {what}")).help(*help));
        }
        let mut lines = Lines { reader, line: Vec::new(), position: 0, number: 0 };
        if !lines.advance().map_err(|problem| LogError::file(path, problem))? {
            return Err(LogError::file(path, "is empty")
                .help("a header line and one line per IMU sample were expected"));
        }
        let header = header(path, &lines.line)?;
        let known = |piece: &str| NAMES.contains(&unquoted(piece).to_ascii_lowercase().as_str());
        if header.chars().all(|c| c.is_ascii_digit() || "+-.,;eE \t\"".contains(c)) {
            return Err(LogError::file(path, "line 1 holds numbers, the names of the columns were expected"));
        }
        if is_comment(header)
            && !header.split(',').any(|name| known(name.trim_start_matches(['#', '%', '/'])))
        {
            let problem = "line 1 is a comment, the names of the columns were expected";
            return Err(LogError::file(path, problem)
                .help("leave comments out: the names of the columns come first; the description has room for remarks"));
        }
        if !header.contains(',')
            && header.split([';', '\t', ' ', '|']).filter(|piece| known(piece)).count() > 1
        {
            let help = "write commas between fields and points in numbers";
            return Err(LogError::file(path, "line 1: fields must be separated by commas").help(help));
        }
        let names: Vec<&str> = header.split(',').map(unquoted).collect();
        let variable = |name: &&str| Variable { name: (*name).to_owned(), width: Ok(1) };
        let variables: Vec<Variable> = names.iter().map(variable).collect();
        let layout = Layout::new(path, &variables, Holds::Columns, map)?;
        let mut slots = vec![None; variables.len()];
        for (slot, place) in layout.columns() {
            slots[place.variable] = Some(slot);
        }
        Ok((Self { path: path.to_owned(), lines, slots, row: 0, numbers: Vec::new() }, layout))
    }

    /// One line into one row.
    fn parse(&self, batch: &mut Batch) -> Result<(), LogError> {
        let Ok(text) = std::str::from_utf8(&self.lines.line) else {
            return Err(self.fault(None, "is not text").help("save the table as UTF-8"));
        };
        let fields = text.split(',').count();
        if fields != self.slots.len() {
            return Err(self.miscounted(text, fields));
        }
        for (field, &slot) in text.split(',').zip(&self.slots) {
            let Some(slot) = slot else { continue };
            let field = unquoted(field);
            let value = match field.parse::<f64>() {
                Ok(value) => value,
                Err(_) if field.is_empty() && may_be_empty(slot) => f64::NAN,
                Err(_) => return Err(self.not_a_number(field, slot)),
            };
            batch.column_mut(slot).push(value);
        }
        batch.rows += 1;
        Ok(())
    }

    /// A fault of the row being read.
    fn fault(&self, slot: Option<usize>, problem: impl std::fmt::Display) -> LogError {
        let column = slot.and_then(|slot| NAMES.get(slot).copied());
        LogError::row(&self.path, self.row, column, problem).in_line(Some(self.lines.number))
    }

    #[cold]
    fn miscounted(&self, text: &str, fields: usize) -> LogError {
        let expected = self.slots.len();
        let plural = if fields == 1 { "" } else { "s" };
        let mut problem = format!("has {fields} field{plural}, the header has {expected}");
        if fields == 1 {
            problem = format!("`{}` {problem}", shown(text, 40));
        }
        self.fault(None, problem).help(if is_comment(text) {
            "comments are not read: leave the line out"
        } else if fields < expected {
            "fields are missing, or the file is cut off in this row"
        } else if !text.contains('.') {
            "decimal commas? Numbers are written with a point, and fields are separated by commas"
        } else {
            "a comma too many? Numbers are written with a point, without a separator of thousands"
        })
    }

    #[cold]
    fn not_a_number(&self, field: &str, slot: usize) -> LogError {
        if field.is_empty() {
            return self.fault(Some(slot), "is empty, a number was expected").help(NEEDED);
        }
        let problem = format!("`{}` is not a number", shown(field, 40));
        let begins_with = |of: fn(char) -> bool| field.starts_with(of);
        let help = if Some(&field) == NAMES.get(slot) {
            "the names of the columns stand only in the first line: were two files joined?"
        } else if self.row == 1 && slot == 0 && begins_with(|c| c.is_ascii_alphabetic()) {
            "the rows of numbers begin in the line after the names of the columns: no line of units between"
        } else if slot == 0 {
            "times are seconds, as plain numbers such as 12.34: no quotes, no dates, no clock times"
        } else if begins_with(|c| c.is_ascii_digit() || "+-.'\u{2212}".contains(c))
            && field != "-"
            && field != "--"
        {
            "a plain number such as -1.5e-3 was expected: no unit, no quotes, no separator of thousands"
        } else if may_be_empty(slot) {
            "leave the field empty, or write NaN, where there is no reading"
        } else {
            NEEDED
        };
        self.fault(Some(slot), problem).help(help)
    }
}

impl Source for CsvSource {
    fn read(&mut self, batch: &mut Batch) -> Result<(), LogError> {
        batch.clear();
        self.numbers.clear();
        while batch.rows < ROWS {
            let more = self.lines.advance();
            self.row += 1;
            if !more.map_err(|problem| self.fault(None, problem))? {
                break;
            }
            self.parse(batch)?;
            self.numbers.push(self.lines.number);
        }
        Ok(())
    }

    fn line(&self, row: usize) -> Option<u64> {
        self.numbers.get(row).copied()
    }

    fn position(&self) -> u64 {
        self.lines.position
    }
}

/// The first line as text.
fn header<'a>(path: &Path, line: &'a [u8]) -> Result<&'a str, LogError> {
    let line = line.strip_prefix(b"\xef\xbb\xbf").unwrap_or(line);
    let fault = |problem: &str, help: &str| Err(LogError::file(path, problem).help(help));
    match std::str::from_utf8(line) {
        Ok(text) if text.contains('\r') => fault(
            "ends its lines as old Macs did, with CR alone",
            "save it with line ends of Unix or Windows",
        ),
        Ok(text) if !text.contains('\0') => Ok(text),
        Ok(_) if line.get(1) == Some(&0) => fault("is UTF-16 text", "save it as UTF-8"),
        Err(error) if error.valid_up_to() > 0 && !line.contains(&0) => {
            let before = String::from_utf8_lossy(&line[..error.valid_up_to()]);
            let before = shown(before.rsplit(',').next().unwrap_or_default(), 40);
            fault(&format!("line 1 is not UTF-8 text after `{before}`"), "save it as UTF-8")
        }
        _ => fault(
            "is not text: a CSV table with a header line was expected",
            "export the table as CSV in UTF-8",
        ),
    }
}

/// Whether a line is a comment, or would be one elsewhere.
fn is_comment(line: &str) -> bool {
    COMMENTS.iter().any(|start| line.trim_start().starts_with(start))
}

/// Spaces and quotes around a field carry no meaning here: all fields are names or numbers.
fn unquoted(field: &str) -> &str {
    let field = field.trim();
    field.strip_prefix('"').and_then(|field| field.strip_suffix('"')).unwrap_or(field)
}

/// Lines of bounded length, empty ones left out.
struct Lines {
    reader: BufReader<File>,
    line: Vec<u8>,
    position: u64,
    /// Lines so far, empty ones too.
    number: u64,
}

impl Lines {
    /// Moves to the next line; `false` at the end of the file.
    fn advance(&mut self) -> Result<bool, String> {
        loop {
            self.line.clear();
            let read = (&mut self.reader)
                .take(LONGEST_LINE)
                .read_until(b'\n', &mut self.line)
                .map_err(|error| format!("cannot be read: {error}"))?;
            if read == 0 {
                return Ok(false);
            }
            self.position += read as u64;
            self.number += 1;
            if read as u64 == LONGEST_LINE && self.line.last() != Some(&b'\n') {
                return Err(if self.line.contains(&b'\r') {
                    "no line end within 64 KiB, but CR alone, as old Macs did: line ends of Unix or Windows were expected"
                } else {
                    "no line end within 64 KiB: this is not a CSV table"
                }
                .into());
            }
            let content =
                self.line.iter().rposition(|byte| !byte.is_ascii_whitespace()).map_or(0, |last| last + 1);
            self.line.truncate(content);
            if content > 0 {
                return Ok(true);
            }
        }
    }
}
