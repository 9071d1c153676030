//! Tables of text: lines above the names, one line of names, then one line per row, in whatever [`Dialect`].

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use super::columns::{Batch, Group, NAMES, NEEDED, Source, may_be_empty};
use super::dialect::{self, Dialect, Splitter};
use super::exact;
use super::fault::{LogError, shown};
use super::layout::{Asked, Holds, Layout, Variable};

/// No line of a log is longer; a file without line ends must not fill the memory.
pub(super) const LONGEST_LINE: u64 = 1 << 16;
/// Rows per batch.
const ROWS: usize = 4096;
/// So many lines, of so many bytes together, show how a file is written.
const HEAD: (usize, usize) = (200, 1 << 16);

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

/// A table of text being read.
pub(super) struct CsvSource {
    path: PathBuf,
    lines: Lines,
    splitter: Splitter,
    decimal_comma: bool,
    /// Every row ends with a separator.
    trailing: bool,
    /// Slots that each column of the file fills.
    slots: Vec<Vec<usize>>,
    /// Times are counted from here.
    origin: Option<i64>,
    row: u64,
    /// Line of each row of the batch.
    numbers: Vec<u64>,
}

impl CsvSource {
    /// Opens a file and reads its header.
    pub(super) fn open(path: &Path, asked: Asked<'_>) -> Result<(Self, Layout), LogError> {
        let failed = |error: &std::io::Error| super::unreadable(path, error);
        let mut file = File::open(path).map_err(|error| failed(&error))?;
        let mut start = Vec::new();
        (&mut file).take(16).read_to_end(&mut start).map_err(|error| failed(&error))?;
        if let Some((_, what, help)) = OTHERS.iter().find(|(magic, ..)| start.starts_with(magic)) {
            return Err(LogError::file(path, format!("is {what}")).help(*help));
        }
        let (dialect, skipped) = head(path)?;
        let names = names(path, &dialect, asked)?;
        let variable = |name: &String| Variable { name: name.clone(), width: Ok(1) };
        let variables: Vec<Variable> = names.iter().map(variable).collect();
        let layout = Layout::new(path, &variables, Holds::Columns, asked)?;
        let mut slots = vec![Vec::new(); variables.len()];
        for (slot, place) in layout.columns() {
            slots[place.variable].push(slot);
        }
        let mut lines = Lines::open(path, dialect.separator)?;
        while lines.number < skipped && lines.advance().map_err(|problem| LogError::file(path, problem))? {}
        let source = Self {
            path: path.to_owned(),
            lines,
            splitter: Splitter::new(dialect.separator),
            decimal_comma: dialect.decimal_comma,
            trailing: dialect.trailing,
            slots,
            origin: None,
            row: 0,
            numbers: Vec::new(),
        };
        Ok((source, layout))
    }

    /// One line into one row.
    fn parse(&mut self, batch: &mut Batch) -> Result<(), LogError> {
        let Ok(text) = std::str::from_utf8(&self.lines.line) else {
            return Err(self.fault(None, "is not text").help("save the table as UTF-8"));
        };
        let Some(fields) = self.splitter.split(text) else {
            let help = "quotes stand on both sides of a field, in one line";
            return Err(self.fault(None, "has a quote that does not end").help(help));
        };
        let expected = self.slots.len() + usize::from(self.trailing);
        if fields != expected {
            return Err(self.miscounted(text, fields));
        }
        for (field, slots) in self.splitter.fields().zip(&self.slots) {
            for &slot in slots {
                let value = match self.number(field, slot) {
                    Some(value) => value,
                    None if field.is_empty() && may_be_empty(slot) => f64::NAN,
                    None => return Err(self.not_a_number(field, slot)),
                };
                batch.column_mut(slot).push(value);
            }
        }
        batch.rows += 1;
        Ok(())
    }

    fn number(&self, field: &str, slot: usize) -> Option<f64> {
        let is_time = slot == Group::TIME.first;
        let date = |origin: i64| exact::date_since(field, origin).filter(|_| is_time);
        let number = match self.origin.filter(|_| is_time) {
            Some(origin) if self.decimal_comma => exact::since(&field.replacen(',', ".", 1), origin),
            Some(origin) => exact::since(field, origin),
            None => dialect::number(field, self.decimal_comma),
        };
        number.or_else(|| date(self.origin.unwrap_or(0)))
    }

    /// A fault of the row being read.
    fn fault(&self, slot: Option<usize>, problem: impl std::fmt::Display) -> LogError {
        let column = slot.and_then(|slot| NAMES.get(slot).copied());
        LogError::row(&self.path, self.row, column, problem).in_line(Some(self.lines.number))
    }

    #[cold]
    fn miscounted(&self, text: &str, fields: usize) -> LogError {
        let expected = self.slots.len() + usize::from(self.trailing);
        let plural = if fields == 1 { "" } else { "s" };
        let mut problem = format!("has {fields} field{plural}, the header has {expected}");
        if fields == 1 {
            problem = format!("`{}` {problem}", shown(text, 40));
        }
        self.fault(None, problem).help(if is_comment(text) {
            "comments are not read: leave the line out"
        } else if fields < expected {
            "fields are missing, or the file is cut off in this row"
        } else if !text.contains('.') && !self.decimal_comma {
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
            "write times as plain numbers such as 12.34, as dates such as 2023-11-14T22:13:20.005, or as times of a day such as 22:13:20.005"
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
    fn count_from(&mut self, origin: i64) {
        self.origin = Some(origin);
    }

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

/// How a file is written, and the number of the last line before its rows.
pub(super) fn head(path: &Path) -> Result<(Dialect, u64), LogError> {
    let mut lines = Lines::open(path, dialect::Separator::Byte(b'\t'))?;
    let mut head: Vec<(u64, Vec<u8>)> = Vec::new();
    let mut bytes = 0;
    while head.len() < HEAD.0 && bytes < HEAD.1 {
        match lines.advance() {
            Ok(true) => {}
            Ok(false) => break,
            Err(problem) if head.is_empty() => return Err(LogError::file(path, problem)),
            // it is told with its row, when that is read
            Err(_) => break,
        }
        if head.is_empty() {
            check_text(path, &lines.line)?;
        }
        bytes += lines.line.len();
        head.push((lines.number, lines.line.clone()));
    }
    if head.is_empty() {
        return Err(
            LogError::file(path, "is empty").help("a header line and one line per IMU sample were expected")
        );
    }
    let bare = |line: &[u8]| line.strip_prefix(b"\xef\xbb\xbf").unwrap_or(line).to_owned();
    let texts: Vec<String> =
        head.iter().map(|(_, line)| String::from_utf8_lossy(&bare(line)).into_owned()).collect();
    let dialect = Dialect::of(&texts.iter().map(String::as_str).collect::<Vec<_>>());
    if let Some((number, line)) = dialect.header.and_then(|header| head.get(header))
        && let Err(error) = std::str::from_utf8(&bare(line))
    {
        let before = String::from_utf8_lossy(&bare(line)[..error.valid_up_to()]).into_owned();
        let before = shown(before.rsplit(',').next().unwrap_or_default(), 40);
        let problem = format!("line {number} is not UTF-8 text after `{before}`");
        return Err(LogError::file(path, problem).help("save it as UTF-8"));
    }
    let skipped =
        dialect.above.checked_sub(1).and_then(|last| head.get(last)).map_or(0, |(number, _)| *number);
    Ok((dialect, skipped))
}

/// Refuses what is no text with lines.
fn check_text(path: &Path, line: &[u8]) -> Result<(), LogError> {
    let line = line.strip_prefix(b"\xef\xbb\xbf").unwrap_or(line);
    let fault = |problem: &str, help: &str| Err(LogError::file(path, problem).help(help));
    match std::str::from_utf8(line) {
        _ if line.contains(&b'\r') => fault(
            "ends its lines as old Macs did, with CR alone",
            "save it with line ends of Unix or Windows",
        ),
        Ok(_) if !line.contains(&0) => Ok(()),
        Ok(_) if line.get(1) == Some(&0) => fault("is UTF-16 text", "save it as UTF-8"),
        Err(error) if error.valid_up_to() > 0 && !line.contains(&0) => Ok(()),
        _ => fault(
            "is not text: a CSV table with a header line was expected",
            "export the table as CSV in UTF-8",
        ),
    }
}

/// The names of the columns: those in the file, or those that were given.
fn names(path: &Path, dialect: &Dialect, asked: Asked<'_>) -> Result<Vec<String>, LogError> {
    match (asked.columns, &dialect.names) {
        (Some(given), _) if given.len() == dialect.width => Ok(given.to_vec()),
        (Some(given), _) => {
            let problem = format!("has {} columns, --columns names {}", dialect.width, given.len());
            Err(LogError::file(path, problem)
                .help("one name for each, in the order of the file, with commas between"))
        }
        (None, Some(names)) => Ok(names.clone()),
        (None, None) => {
            let line = dialect.above + 1;
            let problem = format!("line {line} holds numbers, the names of the columns were expected");
            let example = ["t", "wx", "wy", "wz", "ax", "ay", "az"];
            let example: Vec<String> = (0..dialect.width)
                .map(|at| example.get(at).map_or_else(|| format!("c{at}"), |name| (*name).to_owned()))
                .collect();
            let help = format!(
                "name its {} columns, for instance --columns {}, and say which are which by --map",
                dialect.width,
                example.join(",")
            );
            Err(LogError::file(path, problem).help(help))
        }
    }
}

/// Whether a line is a comment, or would be one elsewhere.
fn is_comment(line: &str) -> bool {
    COMMENTS.iter().any(|start| line.trim_start().starts_with(start))
}

/// Lines of bounded length, empty ones left out.
struct Lines {
    reader: BufReader<File>,
    line: Vec<u8>,
    position: u64,
    /// Lines so far, empty ones too.
    number: u64,
    /// Tabs at the end of a line separate fields.
    keeps_tabs: bool,
}

impl Lines {
    fn open(path: &Path, separator: dialect::Separator) -> Result<Self, LogError> {
        let file = File::open(path).map_err(|error| super::unreadable(path, &error))?;
        let reader = BufReader::with_capacity(1 << 16, file);
        let keeps_tabs = separator == dialect::Separator::Byte(b'\t');
        Ok(Self { reader, line: Vec::new(), position: 0, number: 0, keeps_tabs })
    }

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
            let content = self.line.iter().rposition(|byte| !byte.is_ascii_whitespace());
            let ends = |byte: &u8| byte.is_ascii_whitespace() && !(self.keeps_tabs && *byte == b'\t');
            let end = self.line.iter().rposition(|byte| !ends(byte)).map_or(0, |last| last + 1);
            self.line.truncate(end);
            if content.is_some() {
                return Ok(true);
            }
        }
    }
}
