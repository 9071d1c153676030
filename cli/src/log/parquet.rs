//! Tables as Parquet files, read column-wise in batches.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use arrow_array::cast::AsArray;
use arrow_array::types::{
    ArrowPrimitiveType, Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type, UInt8Type,
    UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{Array, ArrayRef, RecordBatch};
use arrow_schema::DataType;
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::{
    ArrowReaderOptions, ParquetRecordBatchReader, ParquetRecordBatchReaderBuilder,
};
use parquet::basic::Compression;
use parquet::file::metadata::ParquetMetaData;

use super::columns::{Batch, NAMES, Source};
use super::fault::LogError;
use super::guard::guarded;
use super::layout::{Holds, Layout, Variable};
use super::map::ColumnMap;
use super::pages;

/// Rows per batch: large enough for column-wise work, small enough to stay in the cache.
const ROWS: usize = 4096;
/// A Parquet file starts and ends with these bytes.
const MAGIC: &[u8; 4] = b"PAR1";

/// A Parquet file being read.
pub(super) struct ParquetSource {
    path: PathBuf,
    reader: ParquetRecordBatchReader,
    /// Slot of each projected column, in the file's order.
    slots: Vec<usize>,
    position: u64,
    /// Rows that the file announces.
    rows: u64,
}

impl ParquetSource {
    /// Opens a file and checks its columns; also gives the number of rows.
    pub(super) fn open(path: &Path, map: &ColumnMap) -> Result<(Self, Layout, u64), LogError> {
        let mut file = File::open(path).map_err(|error| super::unreadable(path, &error))?;
        check_magic(path, &mut file)?;
        let options = ArrowReaderOptions::new().with_skip_arrow_metadata(true);
        let builder = guarded(|| ParquetRecordBatchReaderBuilder::try_new_with_options(file, options))
            .map_err(|problem| damaged(path, &problem))?;
        let fields = builder.schema().fields();
        let variables = fields.iter().map(|field| {
            let width = if is_number(field.data_type()) { Ok(1) } else { Err(describe(field.data_type())) };
            Variable { name: field.name().clone(), width }
        });
        let layout = Layout::new(path, &variables.collect::<Vec<_>>(), Holds::Columns, map)?;
        check_compression(path, builder.metadata())?;
        check_pages(path, builder.metadata(), &layout)?;
        let rows = u64::try_from(builder.metadata().file_metadata().num_rows())
            .map_err(|_| damaged(path, "a negative number of rows"))?;
        let mut columns: Vec<(usize, usize)> =
            layout.columns().map(|(slot, place)| (place.variable, slot)).collect();
        columns.sort_unstable();
        let mask = ProjectionMask::roots(builder.parquet_schema(), columns.iter().map(|(index, _)| *index));
        let reader = guarded(|| builder.with_projection(mask).with_batch_size(ROWS).build())
            .map_err(|problem| damaged(path, &problem))?;
        let slots = columns.into_iter().map(|(_, slot)| slot).collect();
        Ok((Self { path: path.to_owned(), reader, slots, position: 0, rows }, layout, rows))
    }

    fn copy(&self, record: &RecordBatch, batch: &mut Batch) -> Result<(), LogError> {
        if record.num_columns() != self.slots.len() {
            return Err(damaged(&self.path, "columns are lost"));
        }
        for (array, &slot) in record.columns().iter().zip(&self.slots) {
            if !numbers(array, batch.column_mut(slot)) {
                let problem = format!("holds {}, numbers were expected", describe(array.data_type()));
                return Err(LogError::column(&self.path, NAMES[slot], problem));
            }
        }
        batch.rows = record.num_rows();
        Ok(())
    }
}

impl Source for ParquetSource {
    fn read(&mut self, batch: &mut Batch) -> Result<(), LogError> {
        batch.clear();
        match guarded(|| self.reader.next().transpose()) {
            Ok(Some(record)) => {
                self.copy(&record, batch)?;
                self.position += batch.rows as u64;
                Ok(())
            }
            Ok(None) if self.position < self.rows => {
                let problem = format!("it holds {} rows, {} were announced", self.position, self.rows);
                Err(damaged(&self.path, &problem))
            }
            Ok(None) => Ok(()),
            Err(problem) => {
                let problem = format!("rows after {} cannot be read ({problem})", self.position);
                Err(damaged(&self.path, &problem))
            }
        }
    }

    fn position(&self) -> u64 {
        self.position
    }
}

/// Tells a foreign file from a cut one before the decoder sees it.
fn check_magic(path: &Path, file: &mut File) -> Result<(), LogError> {
    let failed = |error: std::io::Error| super::unreadable(path, &error);
    let length = file.metadata().map_err(failed)?.len();
    if length == 0 {
        return Err(LogError::file(path, "is empty (0 bytes): a Parquet table was expected"));
    }
    let mut first = [0; 4];
    let mut last = [0; 4];
    let start = file.read(&mut first).map_err(failed)?;
    if &first == b"PARE" {
        return Err(LogError::file(path, "is an encrypted Parquet file").help("write it without encryption"));
    }
    if start < 4 || &first != MAGIC {
        return Err(LogError::file(path, "is not a Parquet file (it does not begin with PAR1)")
            .help("a table in text form must be called .csv"));
    }
    if length >= 12 {
        file.seek(SeekFrom::End(-4)).map_err(failed)?;
        file.read_exact(&mut last).map_err(failed)?;
    }
    if &last != MAGIC {
        return Err(LogError::file(path, "is cut off: a Parquet file ends with PAR1, this one does not")
            .help("copy or write the file again"));
    }
    file.rewind().map_err(failed)
}

/// A column compressed in a way that is not supported is no damage: it is said which.
fn check_compression(path: &Path, metadata: &ParquetMetaData) -> Result<(), LogError> {
    let chunks = metadata.row_groups().iter().flat_map(|group| group.columns());
    for chunk in chunks {
        let name = match chunk.compression() {
            Compression::UNCOMPRESSED | Compression::SNAPPY | Compression::ZSTD(_) => continue,
            other => other.to_string(),
        };
        let name = name.split('(').next().unwrap_or_default();
        let problem = format!("is compressed with {name}, which this program does not read");
        return Err(LogError::column(path, &chunk.column_path().string(), problem)
            .help("write it uncompressed, or compressed with Snappy or Zstandard"));
    }
    Ok(())
}

/// The pages of the columns that are read must fit into memory when they are unpacked.
fn check_pages(path: &Path, metadata: &ParquetMetaData, layout: &Layout) -> Result<(), LogError> {
    let mut file = File::open(path).map_err(|error| super::unreadable(path, &error))?;
    let schema = metadata.file_metadata().schema_descr();
    for group in metadata.row_groups() {
        for (leaf, chunk) in group.columns().iter().enumerate().take(schema.num_columns()) {
            let root = schema.get_column_root_idx(leaf);
            if !layout.columns().any(|(_, place)| place.variable == root) {
                continue;
            }
            guarded(|| {
                let (start, length) = chunk.byte_range();
                pages::check(&mut file, start, length)
            })
            .map_err(|problem| {
                let problem = format!("is damaged or packed too tightly: {problem}");
                LogError::column(path, &chunk.column_path().string(), problem)
                    .help("write the file again, in pages of a few MiB as usual")
            })?;
        }
    }
    Ok(())
}

fn damaged(path: &Path, problem: &str) -> LogError {
    LogError::file(path, format!("is damaged or uses a part of Parquet that is not supported: {problem}"))
        .help("supported: plain columns of numbers, uncompressed or compressed with Snappy or Zstandard")
}

fn is_number(kind: &DataType) -> bool {
    kind.is_floating() && *kind != DataType::Float16 || kind.is_integer()
}

fn describe(kind: &DataType) -> String {
    match kind {
        DataType::Utf8 | DataType::LargeUtf8 | DataType::Utf8View => "text".into(),
        DataType::Binary | DataType::LargeBinary | DataType::BinaryView | DataType::FixedSizeBinary(_) => {
            "bytes or text".into()
        }
        DataType::Boolean => "true/false values".into(),
        DataType::Timestamp(..) | DataType::Date32 | DataType::Date64 => "dates".into(),
        DataType::List(_) | DataType::LargeList(_) | DataType::Struct(_) | DataType::Map(..) => {
            "nested values".into()
        }
        other => format!("values of type {other}"),
    }
}

/// Appends an array as numbers, null as NaN; `false` when it does not hold numbers.
fn numbers(array: &ArrayRef, into: &mut Vec<f64>) -> bool {
    fn copy<T: ArrowPrimitiveType>(
        array: &ArrayRef,
        into: &mut Vec<f64>,
        f64_of: fn(T::Native) -> f64,
    ) -> bool {
        let Some(array) = array.as_primitive_opt::<T>() else { return false };
        if array.null_count() == 0 {
            into.extend(array.values().iter().map(|value| f64_of(*value)));
        } else {
            into.extend(array.iter().map(|value| value.map_or(f64::NAN, f64_of)));
        }
        true
    }
    match array.data_type() {
        DataType::Float64 => copy::<Float64Type>(array, into, |value| value),
        DataType::Float32 => copy::<Float32Type>(array, into, f64::from),
        DataType::Int8 => copy::<Int8Type>(array, into, f64::from),
        DataType::Int16 => copy::<Int16Type>(array, into, f64::from),
        DataType::Int32 => copy::<Int32Type>(array, into, f64::from),
        DataType::Int64 => copy::<Int64Type>(array, into, |value| value as f64),
        DataType::UInt8 => copy::<UInt8Type>(array, into, f64::from),
        DataType::UInt16 => copy::<UInt16Type>(array, into, f64::from),
        DataType::UInt32 => copy::<UInt32Type>(array, into, f64::from),
        DataType::UInt64 => copy::<UInt64Type>(array, into, |value| value as f64),
        _ => false,
    }
}
