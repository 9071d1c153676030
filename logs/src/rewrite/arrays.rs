//! Arrays with other numbers in some of their columns. They are read whole, and so are their changes.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;

use super::{Change, Column, Sheet};
use crate::arrays::{LARGEST, Shape};
use crate::guard::guarded;

/// What is added to the numbers of each row.
#[derive(Default)]
pub(crate) struct Changes(BTreeMap<Column, Vec<f64>>);

impl Changes {
    fn put(&mut self, changes: &[Change]) {
        for (column, change) in changes {
            self.0.entry(*column).or_default().push(*change);
        }
    }

    /// Whether an array of the file changes, by its place among all.
    pub(crate) fn has(&self, variable: usize) -> bool {
        self.0.keys().any(|column| column.variable == variable)
    }

    /// Changes the numbers of an array, in the order of the file, whose dimensions are these, the slowest first.
    pub(crate) fn apply(&self, variable: usize, dims: &[u64], numbers: &mut [f64]) -> Result<(), String> {
        let shape = Shape::of(dims)?;
        for (column, changes) in self.0.iter().filter(|(column, _)| column.variable == variable) {
            if changes.len() as u64 != shape.rows {
                return Err("the log has become shorter or longer meanwhile".into());
            }
            for (row, change) in changes.iter().enumerate() {
                let number = numbers.get_mut(shape.at(row, column.column));
                *number.ok_or("the log has changed meanwhile")? += change;
            }
        }
        Ok(())
    }
}

/// The bytes of a file in which numbers are changed where they stand.
pub(crate) fn whole(path: &Path) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|file| file.take(LARGEST + 1).read_to_end(&mut bytes))
        .map_err(|error| error.to_string())?;
    if bytes.len() as u64 > LARGEST {
        return Err(format!("it is larger than {} GiB: a shorter one can be written", LARGEST >> 30));
    }
    Ok(bytes)
}

/// Makes of a file and its changes the bytes of the new one.
pub(super) type Rewritten = fn(&Path, &Changes) -> Result<Vec<u8>, String>;

/// The arrays of a file on their way.
pub(super) struct Arrays<'a> {
    path: &'a Path,
    out: &'a mut (dyn Write + Send),
    rewritten: Rewritten,
    changes: Changes,
}

impl<'a> Arrays<'a> {
    pub(super) fn new(path: &'a Path, out: &'a mut (dyn Write + Send), rewritten: Rewritten) -> Self {
        Self { path, out, rewritten, changes: Changes::default() }
    }
}

impl Sheet for Arrays<'_> {
    fn put(&mut self, _: Option<u64>, changes: &[Change]) -> io::Result<()> {
        self.changes.put(changes);
        Ok(())
    }

    fn finish(self: Box<Self>) -> io::Result<()> {
        let bytes = guarded(|| (self.rewritten)(self.path, &self.changes));
        self.out.write_all(&bytes.map_err(io::Error::other)?)
    }
}

/// What is added in a row to a column of a variable, for tests: each time another number.
#[cfg(test)]
pub(crate) fn change(variable: usize, column: usize, row: usize) -> f64 {
    (100 * variable + 10 * column + row + 1) as f64
}

/// A file with [`change`] in so many rows of some columns, for tests.
#[cfg(test)]
pub(crate) fn changed(
    path: &Path,
    rewritten: Rewritten,
    rows: usize,
    columns: &[(usize, usize)],
) -> io::Result<Vec<u8>> {
    let mut out = Vec::new();
    let mut sheet = Box::new(Arrays::new(path, &mut out, rewritten));
    for row in 0..rows {
        let of = |(variable, column): &(usize, usize)| {
            (Column { variable: *variable, column: *column }, change(*variable, *column, row))
        };
        sheet.put(None, &columns.iter().map(of).collect::<Vec<Change>>())?;
    }
    sheet.finish()?;
    Ok(out)
}
