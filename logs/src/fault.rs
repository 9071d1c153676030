//! What is wrong with a log: always with the place (file, and line, column or row) and what would be right.

use std::fmt::Display;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use miette::{Diagnostic, NamedSource, SourceSpan};
use thiserror::Error;

use super::guess::Suggestion;

/// Texts with longer lines are not shown around a fault.
const LONGEST_QUOTED: usize = 500;
/// So many faults found together are told, the rest is counted: a reader mends the first of them.
pub(super) const TOLD: usize = 20;

/// Why a log cannot be used. The message stands on its own; a terminal also shows the faulty text.
#[derive(Debug, Error, Diagnostic)]
#[error(transparent)]
#[diagnostic(transparent)]
pub struct LogError(Box<Fault>);

#[derive(Debug, Error, Diagnostic)]
#[error("{message}")]
struct Fault {
    message: String,
    #[help]
    help: Option<String>,
    #[source_code]
    source_code: Option<NamedSource<Arc<str>>>,
    #[label("here")]
    span: Option<SourceSpan>,
    #[related]
    others: Vec<LogError>,
    /// Length of the path that the message begins with.
    path: usize,
    /// Row of a faulty cell.
    row: Option<u64>,
    /// Column of a faulty cell, or the faulty columns.
    column: Option<String>,
    /// A map that would likely read the file.
    map: Option<Suggestion>,
}

/// The beginning of a text out of a file; what would steer a terminal is left out.
pub(super) fn shown(text: &str, most: usize) -> String {
    let harmless = |c: char| if c.is_control() { char::REPLACEMENT_CHARACTER } else { c };
    text.chars().take(most).map(harmless).collect()
}

/// A text out of a file in one line: a name may hold a line break.
fn in_line(text: &str) -> String {
    text.replace('\r', "\\r").replace('\n', "\\n")
}

impl LogError {
    fn new(message: String) -> Self {
        Self(Box::new(Fault {
            message,
            help: None,
            source_code: None,
            span: None,
            others: Vec::new(),
            path: 0,
            row: None,
            column: None,
            map: None,
        }))
    }

    /// A fault in words of its own.
    pub(super) fn message(message: String) -> Self {
        Self::new(message)
    }

    /// A fault of a file as a whole.
    pub fn file(path: &Path, problem: impl Display) -> Self {
        Self::new(format!("{}: {problem}", path.display()))
    }

    /// A fault of one column of a table.
    pub(super) fn column(path: &Path, column: &str, problem: impl Display) -> Self {
        let mut fault = Self::new(format!("{}, column `{column}`: {problem}", path.display()));
        fault.0.column = Some(column.to_owned());
        fault
    }

    /// A fault of one variable of a file of arrays.
    pub(super) fn variable(path: &Path, variable: &str, problem: impl Display) -> Self {
        Self::new(format!("{}, variable `{variable}`: {problem}", path.display()))
    }

    /// A fault of one data row (counted from 1, the header does not count).
    pub(super) fn row(path: &Path, row: u64, column: Option<&str>, problem: impl Display) -> Self {
        let path = path.display().to_string();
        let mut fault = match column {
            Some(column) => Self::new(format!("{path}, row {row}, column `{column}`: {problem}")),
            None => Self::new(format!("{path}, row {row}: {problem}")),
        };
        fault.0.path = path.len();
        fault.0.row = Some(row);
        fault.0.column = column.map(str::to_owned);
        fault
    }

    /// A fault at a place of a text file.
    pub(super) fn text(
        path: &Path,
        text: &Arc<str>,
        span: Option<Range<usize>>,
        field: Option<&str>,
        problem: impl Display,
    ) -> Self {
        let file = path.display().to_string();
        let line = span.as_ref().map(|span| {
            let before = text.as_bytes().get(..span.start).unwrap_or(text.as_bytes());
            format!(", line {}", 1 + before.iter().filter(|byte| **byte == b'\n').count())
        });
        let field = field.map(|field| format!(", field `{}`", in_line(field)));
        let problem = in_line(&problem.to_string());
        let mut fault =
            Self::new(format!("{file}{}{}: {problem}", line.unwrap_or_default(), field.unwrap_or_default()));
        let quotable = text.lines().all(|line| line.len() <= LONGEST_QUOTED);
        if let Some(span) = span.filter(|_| quotable) {
            fault.0.source_code = Some(NamedSource::new(file, Arc::clone(text)));
            fault.0.span = Some(span.into());
        }
        fault
    }

    /// Adds what would be right.
    pub(super) fn help(mut self, help: impl Into<String>) -> Self {
        self.0.help = Some(help.into());
        self
    }

    /// Adds what would be right, where there is something to say.
    pub(super) fn help_if(mut self, help: Option<String>) -> Self {
        if help.is_some() {
            self.0.help = help;
        }
        self
    }

    /// Adds a map that would likely read the file.
    pub(super) fn suggest(mut self, map: Suggestion) -> Self {
        self.0.help = Some(format!("this looks like {}", map.argument()));
        self.0.map = Some(map);
        self
    }

    /// The map that would likely read the file.
    pub(super) fn suggestion(&self) -> Option<&Suggestion> {
        self.0.map.as_ref()
    }

    /// Says in which line of a text file the row stands, as editors count: from 1, with the header.
    pub(super) fn in_line(mut self, line: Option<u64>) -> Self {
        if let Some(line) = line {
            self.0.message.insert_str(self.0.path, &format!(", line {line}"));
        }
        self
    }

    /// Whether `next` is about the row after `row`, in the same column as this one.
    pub(super) fn continues(&self, row: u64, next: &Self) -> bool {
        next.row_number() == Some(row + 1) && self.0.column == next.0.column
    }

    /// The row of a faulty cell.
    pub(super) fn row_number(&self) -> Option<u64> {
        self.0.row
    }

    /// The column it is about, or several joined.
    pub(super) fn column_names(&self) -> Option<&str> {
        self.0.column.as_deref()
    }

    /// Adds a remark to the help.
    pub(super) fn note(mut self, note: String) -> Self {
        self.0.help = Some(match self.0.help.take() {
            Some(help) => format!("{help}; {note}"),
            None => note,
        });
        self
    }

    /// One error out of several; `None` when there is none.
    pub(super) fn all(faults: Vec<Self>) -> Option<Self> {
        let more = faults.len().saturating_sub(TOLD);
        let mut faults = faults.into_iter().take(TOLD);
        let mut first = faults.next()?;
        first.0.others.extend(faults);
        Some(if more > 0 { first.note(format!("and {more} more faults like these")) } else { first })
    }

    /// The message, then those of the faults found together with it.
    #[cfg(test)]
    pub(super) fn messages(&self) -> Vec<String> {
        let help = self.0.help.iter().map(|help| format!("help: {help}"));
        std::iter::once(self.to_string())
            .chain(help)
            .chain(self.0.others.iter().flat_map(LogError::messages))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_break_in_a_name_does_not_break_the_message() {
        let text: Arc<str> = "\"a\\nb\" = 1".into();
        let fault = LogError::text(Path::new("u.toml"), &text, None, Some("imu.a\nb"), "is `x\r\ny`");
        assert_eq!(fault.to_string(), "u.toml, field `imu.a\\nb`: is `x\\r\\ny`");
    }
}
