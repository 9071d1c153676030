//! Files of named arrays, as MATLAB, NumPy and HDF5 hold them: what is wanted of them is read into memory as a whole.

use std::path::Path;
use std::sync::Arc;

use super::columns::{Batch, Group, NAMES, Source};
use super::fault::LogError;
use super::layout::{Asked, Holds, Layout, Variable};

/// Numbers of a log in memory, bytes; CSV and Parquet are read in pieces and may be larger.
pub(super) const LARGEST: u64 = 2 << 30;
/// No file of a log holds more variables.
pub(super) const MOST_VARIABLES: usize = 10_000;
/// Rows per batch.
const ROWS: usize = 4096;

/// An array of a file: its name, and its dimensions or what it holds instead of real numbers.
pub(super) struct Named {
    pub(super) name: String,
    /// Slowest first, in the order of the numbers in the file.
    pub(super) dims: Result<Vec<u64>, String>,
}

/// A file of named arrays.
pub(super) trait Arrays {
    /// Hands over the numbers of one array, in the order of the file, until `each` has enough.
    fn read(&mut self, index: usize, each: &mut dyn FnMut(f64) -> bool) -> Result<(), String>;
}

/// How the samples stand in an array.
#[derive(Clone, Copy)]
pub(super) struct Shape {
    pub(super) rows: u64,
    columns: usize,
    /// Whether the numbers of a row follow each other, or those of a column.
    by_row: bool,
}

impl Shape {
    /// Samples go along the longer side.
    pub(super) fn of(dims: &[u64]) -> Result<Self, String> {
        let long: Vec<u64> = dims.iter().copied().filter(|side| *side != 1).collect();
        let (slow, fast) = match long[..] {
            _ if dims.contains(&0) => return Err("nothing (it is empty)".into()),
            [] => (1, 1),
            [rows] => (rows, 1),
            [slow, fast] => (slow, fast),
            _ => return Err(format!("an array of {} dimensions", dims.len())),
        };
        let by_row = slow >= fast;
        let (rows, columns) = (slow.max(fast), slow.min(fast));
        // a log has more samples than columns; anything else is told by its sides
        let columns = usize::try_from(columns).map_err(|_| "an array too large".to_owned())?;
        Ok(Self { rows, columns, by_row })
    }

    /// Which number of the file stands in a row and a column.
    pub(super) fn at(&self, row: usize, column: usize) -> usize {
        if self.by_row { row * self.columns + column } else { column * self.rows as usize + row }
    }
}

/// The columns of a log in memory.
#[derive(Debug)]
pub(super) struct Memory {
    columns: [Vec<f64>; NAMES.len()],
    pub(super) rows: usize,
}

/// Reads what the map, or the names, make of a file's arrays.
pub(super) fn load(
    path: &Path,
    named: Vec<Named>,
    file: &mut dyn Arrays,
    asked: Asked<'_>,
) -> Result<(Memory, Layout), LogError> {
    let shapes: Vec<Result<Shape, String>> =
        named.iter().map(|array| array.dims.clone().and_then(|dims| Shape::of(&dims))).collect();
    let variables: Vec<Variable> = named
        .into_iter()
        .zip(&shapes)
        .map(|(Named { name, .. }, shape)| Variable {
            name,
            width: shape.as_ref().map(|shape| shape.columns).map_err(Clone::clone),
        })
        .collect();
    let layout = Layout::new(path, &variables, Holds::Arrays, asked)?;
    let rows = check_rows(path, &variables, &shapes, &layout)?;
    let mut columns = [const { Vec::new() }; NAMES.len()];
    for (index, (variable, shape)) in variables.iter().zip(&shapes).enumerate() {
        let places = layout.columns().filter(|(_, place)| place.variable == index);
        let wanted: Vec<(usize, usize)> = places.map(|(slot, place)| (slot, place.column)).collect();
        let Some(shape) = shape.as_ref().ok().filter(|_| !wanted.is_empty()) else { continue };
        let fault = |problem: String| LogError::variable(path, &variable.name, problem);
        let total = shape.rows.saturating_mul(shape.columns as u64);
        let mut count = 0;
        let mut room = true;
        file.read(index, &mut |value| {
            let column = if shape.by_row { count % shape.columns as u64 } else { count / shape.rows };
            count += 1;
            if count > total {
                return false;
            }
            for (slot, _) in wanted.iter().filter(|(_, wanted)| *wanted as u64 == column) {
                // what is announced may be more than there is, and what there is more than the machine can hold
                room &= columns[*slot].try_reserve(1).is_ok();
                if room {
                    columns[*slot].push(value);
                }
            }
            room
        })
        .map_err(|problem| {
            let foreign = problem.to_ascii_lowercase().contains("unsupported");
            let help = if foreign {
                "it is packed in a way that is not read here (LZF and the like): write it with gzip, or unpacked"
            } else {
                "write the file again; it is damaged or cut off"
            };
            fault(format!("cannot be read: {problem}")).help(help)
        })?;
        if !room {
            let help = "a log as Parquet or CSV is read in pieces and may be of any length";
            return Err(fault("does not fit into the memory of this machine".into()).help(help));
        }
        if count > total {
            let problem = format!("holds more than the {total} numbers that were announced");
            return Err(fault(problem).help("write the file again"));
        }
        if count < total {
            let problem = format!("is cut off: it holds {count} numbers, {total} were announced");
            return Err(fault(problem).help("write the file again"));
        }
    }
    Ok((Memory { columns, rows }, layout))
}

/// All variables that are used must have as many rows, and not too many for the memory.
fn check_rows(
    path: &Path,
    variables: &[Variable],
    shapes: &[Result<Shape, String>],
    layout: &Layout,
) -> Result<usize, LogError> {
    let mut first: Option<(&Variable, u64)> = None;
    for (_, place) in layout.columns() {
        let (Some(variable), Some(Ok(shape))) = (variables.get(place.variable), shapes.get(place.variable))
        else {
            continue;
        };
        let (before, rows) = *first.get_or_insert((variable, shape.rows));
        if rows != shape.rows {
            let problem = format!("has {} rows, `{}` has {rows}", shape.rows, before.name);
            let help = "all variables of a log have one row per sample";
            return Err(LogError::variable(path, &variable.name, problem).help(help));
        }
    }
    let rows = first.map_or(0, |(_, rows)| rows);
    let bytes = rows.saturating_mul(layout.columns().count() as u64).saturating_mul(8);
    if bytes > LARGEST {
        let problem = format!("holds {rows} rows, {:.1} GiB of numbers", bytes as f64 / f64::from(1 << 30));
        let help = "arrays are read whole, up to 2 GiB; a log as Parquet or CSV is read in pieces and may be of any length";
        return Err(LogError::file(path, problem).help(help));
    }
    usize::try_from(rows).map_err(|_| LogError::file(path, "holds more rows than this machine can count"))
}

/// The columns in memory as a file that yields them.
pub(super) struct MemorySource {
    memory: Arc<Memory>,
    next: usize,
    origin: f64,
}

impl MemorySource {
    pub(super) fn new(memory: Arc<Memory>) -> Self {
        Self { memory, next: 0, origin: 0.0 }
    }
}

impl Source for MemorySource {
    fn read(&mut self, batch: &mut Batch) -> Result<(), LogError> {
        batch.clear();
        let end = self.memory.rows.min(self.next + ROWS);
        for (slot, column) in self.memory.columns.iter().enumerate() {
            if let Some(rows) = column.get(self.next..end) {
                batch.column_mut(slot).extend_from_slice(rows);
            }
        }
        if self.origin != 0.0 {
            batch.column_mut(Group::TIME.first).iter_mut().for_each(|time| *time -= self.origin);
        }
        batch.rows = end - self.next;
        self.next = end;
        Ok(())
    }

    fn count_from(&mut self, origin: i64) {
        self.origin = origin as f64;
    }

    fn position(&self) -> u64 {
        self.next as u64
    }
}
