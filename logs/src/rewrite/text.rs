//! Lines of text with other numbers in some of their fields.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::Path;

use super::{Change, Sheet};
use crate::csv;
use crate::dialect::{self, Dialect, Separator};
use crate::fault::LogError;

/// The lines of a table on their way.
pub(super) struct Text<'a> {
    reader: BufReader<File>,
    dialect: Dialect,
    number: u64,
    line: Vec<u8>,
    out: &'a mut (dyn Write + Send),
}

impl<'a> Text<'a> {
    pub(super) fn open(path: &Path, out: &'a mut (dyn Write + Send)) -> Result<Self, LogError> {
        let (dialect, _) = csv::head(path)?;
        let file = File::open(path).map_err(|error| crate::unreadable(path, &error))?;
        Ok(Self {
            reader: BufReader::with_capacity(1 << 16, file),
            dialect,
            number: 0,
            line: Vec::new(),
            out,
        })
    }

    fn advance(&mut self) -> io::Result<bool> {
        self.line.clear();
        self.number += 1;
        // longer ones were refused where they were read
        Ok((&mut self.reader).take(csv::LONGEST_LINE).read_until(b'\n', &mut self.line)? > 0)
    }

    fn changed(&self, changes: &[Change]) -> io::Result<Vec<u8>> {
        let meanwhile = || io::Error::other("the log has changed meanwhile");
        let fields = places(&self.line, self.dialect.separator);
        let mut changes = changes.to_vec();
        changes.sort_unstable_by_key(|(column, _)| *column);
        let mut line = Vec::with_capacity(self.line.len() + 64);
        let mut copied = 0;
        for (column, change) in changes {
            let (start, end) = *fields.get(column.variable).ok_or_else(meanwhile)?;
            let field = std::str::from_utf8(&self.line[start..end]).map_err(|_| meanwhile())?;
            let number = dialect::number(field, self.dialect.decimal_comma).ok_or_else(meanwhile)?;
            line.extend_from_slice(&self.line[copied..start]);
            let number = (number + change).to_string();
            let number = if self.dialect.decimal_comma { number.replace('.', ",") } else { number };
            line.extend_from_slice(number.as_bytes());
            copied = end;
        }
        line.extend_from_slice(&self.line[copied..]);
        Ok(line)
    }
}

impl Sheet for Text<'_> {
    /// Copies the lines before this one too.
    fn put(&mut self, line: Option<u64>, changes: &[Change]) -> io::Result<()> {
        while self.advance()? {
            if Some(self.number) == line {
                return self.out.write_all(&self.changed(changes)?);
            }
            self.out.write_all(&self.line)?;
        }
        Err(io::Error::other("the log has become shorter meanwhile"))
    }

    fn finish(mut self: Box<Self>) -> io::Result<()> {
        while self.advance()? {
            self.out.write_all(&self.line)?;
        }
        Ok(())
    }
}

/// Where the fields of a line begin and end, without blanks and quotes about them.
fn places(line: &[u8], separator: Separator) -> Vec<(usize, usize)> {
    let mut places = Vec::new();
    let mut quoted = false;
    let mut start = 0;
    let mut put = |start: usize, end: usize| {
        let bare = |byte: &u8| !byte.is_ascii_whitespace() && *byte != b'"';
        let within = &line[start..end];
        match (within.iter().position(bare), within.iter().rposition(bare)) {
            (Some(first), Some(last)) => places.push((start + first, start + last + 1)),
            _ if separator == Separator::Blanks => {}
            _ => places.push((start, start)),
        }
    };
    for (at, byte) in line.iter().enumerate() {
        let separates = match separator {
            Separator::Byte(separator) => *byte == separator,
            Separator::Blanks => byte.is_ascii_whitespace(),
        };
        if *byte == b'"' && separator != Separator::Blanks {
            quoted = !quoted;
        } else if separates && !quoted {
            put(start, at);
            start = at + 1;
        }
    }
    put(start, line.len());
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_found_as_they_stand() {
        let found = |line: &str, separator| -> Vec<String> {
            places(line.as_bytes(), separator)
                .into_iter()
                .map(|(start, end)| line[start..end].to_owned())
                .collect()
        };
        assert_eq!(
            found(" 1.5, \"2\",,\"a, b\",4\r\n", Separator::Byte(b',')),
            ["1.5", "2", "", "a, b", "4"]
        );
        assert_eq!(found("  1  2\t3 \n", Separator::Blanks), ["1", "2", "3"]);
        assert_eq!(found("1\t\t3\n", Separator::Byte(b'\t')), ["1", "", "3"]);
    }
}
