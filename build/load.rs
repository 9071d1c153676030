//! Text of a table -> [`Table`], or what is wrong with it and where.

use std::path::Path;

use crate::ir::{Table, check};
use crate::read::read;

/// Loads the table that stands in `file`; an error begins with file and line.
pub(crate) fn table(file: &str, text: &str) -> Result<Table, String> {
    let table = read(text).and_then(check).map_err(|fault| {
        let line = 1 + text.bytes().take(fault.start).filter(|b| *b == b'\n').count();
        format!("{file}:{line}: {}", fault.value)
    })?;
    if Path::new(file).file_stem().is_none_or(|stem| stem != table.name.as_str()) {
        return Err(format!("{file}:1: the table is named `{}`, the file is not", table.name));
    }
    Ok(table)
}
