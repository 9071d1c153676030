//! NumPy files with other numbers in some of their arrays. What else an archive holds is copied as it is packed.

use std::fs::File;
use std::io::{self, BufReader, Cursor, Read, Write};
use std::path::Path;

use npyz::{Order, WriterBuilder as _};
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

use super::arrays::Changes;
use crate::npz::numbers;

/// An array of more bytes may need the longer form of an archive.
const LONG: u64 = 1 << 31;

/// An archive with its changes.
pub(super) fn archive(path: &Path, changes: &Changes) -> Result<Vec<u8>, String> {
    let told = |error: zip::result::ZipError| error.to_string();
    let file = File::open(path).map_err(|error| error.to_string())?;
    let mut archive = ZipArchive::new(BufReader::new(file)).map_err(told)?;
    let mut written = ZipWriter::new(Cursor::new(Vec::new()));
    for index in 0..archive.len() {
        if !changes.has(index) {
            written.raw_copy_file(archive.by_index_raw(index).map_err(told)?).map_err(told)?;
            continue;
        }
        let array = archive.by_index(index).map_err(told)?;
        let name = array.name().map_err(told)?.into_owned();
        let method = array.compression();
        let array = changed(index, array, changes)?;
        let options =
            SimpleFileOptions::default().compression_method(method).large_file(array.len() as u64 > LONG);
        written.start_file(name, options).map_err(told)?;
        written.write_all(&array).map_err(|error| error.to_string())?;
    }
    Ok(written.finish().map_err(told)?.into_inner())
}

/// The only array of a file with its changes.
pub(super) fn array(path: &Path, changes: &Changes) -> Result<Vec<u8>, String> {
    let file = File::open(path).map_err(|error| error.to_string())?;
    changed(0, BufReader::new(file), changes)
}

/// Array `index` with its changes, as a file of its own.
fn changed(index: usize, array: impl Read, changes: &Changes) -> Result<Vec<u8>, String> {
    let mut values = Vec::new();
    let (dims, order) = numbers(array, &mut |value| {
        values.push(value);
        true
    })?;
    let mut slowest_first = dims.clone();
    if order == Order::Fortran {
        slowest_first.reverse();
    }
    changes.apply(index, &slowest_first, &mut values)?;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rewrite::arrays::{change, changed};

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
        let mut zip = ZipWriter::new(File::create(&path)?);
        for (k, (name, bytes)) in arrays.iter().enumerate() {
            let method =
                if k % 2 == 0 { zip::CompressionMethod::Deflated } else { zip::CompressionMethod::Stored };
            zip.start_file(*name, SimpleFileOptions::default().compression_method(method))?;
            zip.write_all(bytes)?;
        }
        zip.finish()?;

        let columns = [(0, 1), (1, 2), (2, 0)];
        let out = changed(&path, archive, ROWS, &columns)?;
        let mut out = ZipArchive::new(Cursor::new(out))?;
        for (index, (name, before)) in arrays.iter().enumerate() {
            assert_eq!(out.by_index(index)?.name()?, *name);
            let (dims, order, mut expected) = read(before.as_slice())?;
            for (_, column) in columns.iter().filter(|(variable, _)| *variable == index) {
                for row in 0..ROWS {
                    let by_row = index == 0;
                    let at = if by_row { 3 * row + column } else { ROWS * column + row };
                    expected[at] += change(index, *column, row);
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
        let (dims, _, found) = read(changed(&path, array, ROWS, &[(0, 3)])?.as_slice())?;
        assert_eq!((dims, found[3], found[4], found[7 + 3]), (vec![7, 7], 32.0, 1.0, 33.0));
        std::fs::write(&path, npy(&[ROWS as u64 + 2, 7], Order::C, &vec![1.0; 7 * (ROWS + 2)], false)?)?;
        let error = changed(&path, array, ROWS, &[(0, 3)]).err().ok_or("another length")?;
        assert!(error.to_string().contains("has become shorter or longer"), "{error}");
        Ok(())
    }
}
