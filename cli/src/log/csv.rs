//! Tables as comma-separated text: one header line, then one line per row.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use super::columns::{Batch, NAMES, Source, may_be_empty};
use super::fault::LogError;
use super::layout::{Holds, Layout, Variable};
use super::map::ColumnMap;

/// No line of a log is longer; a file without line ends must not fill the memory.
const LONGEST_LINE: u64 = 1 << 16;
/// Rows per batch.
const ROWS: usize = 4096;

/// A CSV file being read.
pub(super) struct CsvSource {
    path: PathBuf,
    lines: Lines,
    /// Slot of each column of the file, if it is read.
    slots: Vec<Option<usize>>,
    row: u64,
}

impl CsvSource {
    /// Opens a file and reads its header.
    pub(super) fn open(path: &Path, map: &ColumnMap) -> Result<(Self, Layout), LogError> {
        let file = File::open(path).map_err(|error| super::unreadable(path, &error))?;
        let mut lines =
            Lines { reader: BufReader::with_capacity(1 << 16, file), line: Vec::new(), position: 0 };
        if !lines.advance().map_err(|problem| LogError::file(path, problem))? {
            return Err(LogError::file(path, "is empty")
                .help("a header line and one line per IMU sample were expected"));
        }
        if lines.line.starts_with(b"PAR1") {
            return Err(LogError::file(path, "is a Parquet file, its ending says CSV"));
        }
        if lines.line.starts_with(b"\xff\xfe") || lines.line.starts_with(b"\xfe\xff") {
            return Err(LogError::file(path, "is UTF-16 text").help("save it as UTF-8"));
        }
        let header = lines.line.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&lines.line);
        let Some(header) = std::str::from_utf8(header).ok().filter(|text| !text.contains('\0')) else {
            return Err(LogError::file(path, "is not text: a CSV table with a header line was expected"));
        };
        if header.chars().all(|c| c.is_ascii_digit() || "+-.,;eE \t\"".contains(c)) {
            return Err(LogError::file(path, "line 1 holds numbers, the names of the columns were expected"));
        }
        let known = |piece: &str| NAMES.contains(&unquoted(piece).to_ascii_lowercase().as_str());
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
        Ok((Self { path: path.to_owned(), lines, slots, row: 0 }, layout))
    }

    /// One line into one row.
    fn parse(&self, batch: &mut Batch) -> Result<(), LogError> {
        let Ok(text) = std::str::from_utf8(&self.lines.line) else {
            return Err(
                LogError::row(&self.path, self.row, None, "is not text").help("save the table as UTF-8")
            );
        };
        let fields = text.split(',').count();
        if fields != self.slots.len() {
            let problem = format!("has {fields} fields, the header has {}", self.slots.len());
            let help = if fields < self.slots.len() {
                "the file may be cut off in this row"
            } else {
                "a comma too many? Numbers are written with a point"
            };
            return Err(LogError::row(&self.path, self.row, None, problem).help(help));
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

    #[cold]
    fn not_a_number(&self, field: &str, slot: usize) -> LogError {
        let problem = match field {
            "" => "is empty, a number was expected".to_owned(),
            text => format!("`{}` is not a number", text.chars().take(40).collect::<String>()),
        };
        let help = if self.row == 1 && slot == 0 && field.starts_with(|c: char| c.is_ascii_alphabetic()) {
            Some(
                "the rows of numbers begin in the line after the names of the columns: no line of units between",
            )
        } else if may_be_empty(slot) {
            Some("leave the field empty, or write NaN, where there is no reading")
        } else {
            None
        };
        LogError::row(&self.path, self.row, NAMES.get(slot).copied(), problem)
            .help_if(help.map(str::to_owned))
    }
}

impl Source for CsvSource {
    fn read(&mut self, batch: &mut Batch) -> Result<(), LogError> {
        batch.clear();
        while batch.rows < ROWS {
            let more = self
                .lines
                .advance()
                .map_err(|problem| LogError::row(&self.path, self.row + 1, None, problem))?;
            if !more {
                break;
            }
            self.row += 1;
            self.parse(batch)?;
        }
        Ok(())
    }

    fn position(&self) -> u64 {
        self.lines.position
    }
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
            if read as u64 == LONGEST_LINE && self.line.last() != Some(&b'\n') {
                return Err("no line end within 64 KiB: this is not a CSV table".into());
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
