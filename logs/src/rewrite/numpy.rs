//! NumPy arrays with other numbers in some of their columns. What else an archive holds is copied as it is packed.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufReader, Cursor, Read, Write};
use std::path::Path;

use npyz::WriterBuilder as _;
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

use super::{Change, Column, Sheet};
use crate::arrays::Shape;
use crate::guard::guarded;
use crate::npz::numbers;

/// An array of more bytes may need the longer form of an archive.
const LONG: u64 = 1 << 31;

/// The arrays of a file on their way: they are read whole, and so are their changes.
pub(super) struct Numpy<'a> {
    path: &'a Path,
    out: &'a mut (dyn Write + Send),
    /// What is added to the numbers of each row.
    changes: BTreeMap<Column, Vec<f64>>,
}

impl<'a> Numpy<'a> {
    pub(super) fn new(path: &'a Path, out: &'a mut (dyn Write + Send)) -> Self {
        Self { path, out, changes: BTreeMap::new() }
    }

    /// Array `index` with its changes, as a file of its own.
    fn changed(&self, index: usize, array: impl Read) -> Result<Vec<u8>, String> {
        let mut values = Vec::new();
        let (dims, order) = numbers(array, &mut |value| {
            values.push(value);
            true
        })?;
        let mut in_file = dims.clone();
        if order == npyz::Order::Fortran {
            in_file.reverse();
        }
        let shape = Shape::of(&in_file)?;
        for (column, changes) in self.changes.iter().filter(|(column, _)| column.variable == index) {
            if changes.len() as u64 != shape.rows {
                return Err("the log has become shorter or longer meanwhile".into());
            }
            for (row, change) in changes.iter().enumerate() {
                let number = values.get_mut(shape.at(row, column.column));
                *number.ok_or("the log has changed meanwhile")? += change;
            }
        }
        let mut written = Vec::with_capacity(8 * values.len() + 256);
        let options = npyz::WriteOptions::<f64>::new().default_dtype().shape(&dims).order(order);
        let write = |written: &mut Vec<u8>| -> io::Result<()> {
            let mut writer = options.writer(written).begin_nd()?;
            writer.extend(values)?;
            writer.finish()
        };
        write(&mut written).map_err(|error| error.to_string())?;
        Ok(written)
    }

    /// The archive with its changed arrays.
    fn archive(&self, file: File) -> Result<Vec<u8>, String> {
        let told = |error: zip::result::ZipError| error.to_string();
        let mut archive = ZipArchive::new(BufReader::new(file)).map_err(told)?;
        let mut written = ZipWriter::new(Cursor::new(Vec::new()));
        for index in 0..archive.len() {
            if self.changes.keys().all(|column| column.variable != index) {
                written.raw_copy_file(archive.by_index_raw(index).map_err(told)?).map_err(told)?;
                continue;
            }
            let array = archive.by_index(index).map_err(told)?;
            let name = array.name().map_err(told)?.into_owned();
            let method = array.compression();
            let array = self.changed(index, array)?;
            let options =
                SimpleFileOptions::default().compression_method(method).large_file(array.len() as u64 > LONG);
            written.start_file(name, options).map_err(told)?;
            written.write_all(&array).map_err(|error| error.to_string())?;
        }
        Ok(written.finish().map_err(told)?.into_inner())
    }
}

impl Sheet for Numpy<'_> {
    fn put(&mut self, _: Option<u64>, changes: &[Change]) -> io::Result<()> {
        for (column, change) in changes {
            self.changes.entry(*column).or_default().push(*change);
        }
        Ok(())
    }

    fn finish(self: Box<Self>) -> io::Result<()> {
        let file = File::open(self.path)?;
        let is_archive = self.path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("npz"));
        let bytes =
            guarded(|| if is_archive { self.archive(file) } else { self.changed(0, BufReader::new(file)) });
        self.out.write_all(&bytes.map_err(io::Error::other)?)
    }
}

#[cfg(test)]
mod tests {
    use npyz::Order;

    use super::*;

    type Done = Result<(), Box<dyn std::error::Error>>;

    const ROWS: usize = 7;

    /// A file of an array, in single or double precision.
    fn npy(dims: &[u64], order: Order, values: &[f64], single: bool) -> io::Result<Vec<u8>> {
        let mut file = Vec::new();
        if single {
            let options = npyz::WriteOptions::<f32>::new().default_dtype().shape(dims).order(order);
            let mut writer = options.writer(&mut file).begin_nd()?;
            writer.extend(values.iter().map(|value| *value as f32))?;
            writer.finish()?;
        } else {
            let options = npyz::WriteOptions::<f64>::new().default_dtype().shape(dims).order(order);
            let mut writer = options.writer(&mut file).begin_nd()?;
            writer.extend(values.iter().copied())?;
            writer.finish()?;
        }
        Ok(file)
    }

    fn read(array: impl Read) -> Result<(Vec<u64>, Order, Vec<f64>), String> {
        let mut values = Vec::new();
        let (dims, order) = numbers(array, &mut |value| {
            values.push(value);
            true
        })?;
        Ok((dims, order, values))
    }

    /// What is added in a row to column `column` of variable `variable`.
    fn change(variable: usize, column: usize, row: usize) -> Change {
        (Column { variable, column }, (100 * variable + 10 * column + row + 1) as f64)
    }

    fn rewritten(path: &Path, columns: &[(usize, usize)]) -> io::Result<Vec<u8>> {
        let mut out = Vec::new();
        let mut sheet = Box::new(Numpy::new(path, &mut out));
        for row in 0..ROWS {
            let changes: Vec<Change> = columns.iter().map(|(v, c)| change(*v, *c, row)).collect();
            sheet.put(None, &changes)?;
        }
        sheet.finish()?;
        Ok(out)
    }

    #[test]
    fn columns_change_whatever_the_order_and_everything_else_stays() -> Done {
        let folder = tempfile::tempdir()?;
        let values: Vec<f64> = (0..3 * ROWS).map(|k| 0.5 * k as f64).collect();
        let rows = ROWS as u64;
        let arrays = [
            ("by_row.npy", npy(&[rows, 3], Order::C, &values, true)?),
            ("by_column.npy", npy(&[rows, 3], Order::Fortran, &values, false)?),
            ("lying.npy", npy(&[3, rows], Order::C, &values, false)?),
            ("other.npy", npy(&[2], Order::C, &[1.0, 2.0], true)?),
        ];
        let path = folder.path().join("log.npz");
        let mut archive = ZipWriter::new(File::create(&path)?);
        for (k, (name, array)) in arrays.iter().enumerate() {
            let method =
                if k % 2 == 0 { zip::CompressionMethod::Deflated } else { zip::CompressionMethod::Stored };
            archive.start_file(*name, SimpleFileOptions::default().compression_method(method))?;
            archive.write_all(array)?;
        }
        archive.finish()?;

        let changed = [(0, 1), (1, 2), (2, 0)];
        let out = rewritten(&path, &changed)?;
        let mut out = ZipArchive::new(Cursor::new(out))?;
        for (index, (name, before)) in arrays.iter().enumerate() {
            assert_eq!(out.by_index(index)?.name()?, *name);
            let (dims, order, mut expected) = read(before.as_slice())?;
            for (_, column) in changed.iter().filter(|(variable, _)| *variable == index) {
                for row in 0..ROWS {
                    let by_row = index == 0;
                    let at = if by_row { 3 * row + column } else { ROWS * column + row };
                    expected[at] += change(index, *column, row).1;
                }
            }
            assert_eq!(read(out.by_index(index)?)?, (dims, order, expected), "{name}");
        }
        Ok(())
    }

    #[test]
    fn a_single_array_is_written_too_and_another_length_is_told() -> Done {
        let folder = tempfile::tempdir()?;
        let path = folder.path().join("log.npy");
        let values = vec![1.0; 7 * ROWS];
        std::fs::write(&path, npy(&[ROWS as u64, 7], Order::C, &values, false)?)?;
        let (dims, _, found) = read(rewritten(&path, &[(0, 3)])?.as_slice())?;
        assert_eq!((dims, found[3], found[4], found[7 + 3]), (vec![7, 7], 32.0, 1.0, 33.0));
        std::fs::write(&path, npy(&[ROWS as u64 + 2, 7], Order::C, &vec![1.0; 7 * (ROWS + 2)], false)?)?;
        let error = rewritten(&path, &[(0, 3)]).err().ok_or("another length")?;
        assert!(error.to_string().contains("has become shorter or longer"), "{error}");
        Ok(())
    }
}
