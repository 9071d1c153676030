//! Tables as Parquet files, read column-wise in batches.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use parquet::basic::{Compression, ConvertedType, LogicalType, Repetition, Type as Physical};
use parquet::column::page::PageReader;
use parquet::column::reader::ColumnReaderImpl;
use parquet::data_type::{DataType, DoubleType, FloatType, Int32Type, Int64Type};
use parquet::errors;
use parquet::file::metadata::ParquetMetaData;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::schema::types::{ColumnDescPtr, Type};

use super::columns::{Batch, Group, Source};
use super::fault::LogError;
use super::guard::guarded;
use super::layout::{Asked, Holds, Layout, Variable};
use super::pages;

/// Rows per batch: large enough for column-wise work, small enough to stay in the cache.
const ROWS: usize = 4096;
/// A Parquet file starts and ends with these bytes.
const MAGIC: &[u8; 4] = b"PAR1";

/// A Parquet file being read.
pub(super) struct ParquetSource {
    path: PathBuf,
    reader: SerializedFileReader<File>,
    columns: Vec<Column>,
    /// The row group that comes after the open one.
    next: usize,
    /// Readers of the open row group, one for each column.
    open: Vec<Numbers>,
    /// Rows of it that have not been read.
    left: usize,
    position: u64,
    /// Rows that the file announces.
    rows: u64,
    /// Times are counted from here.
    origin: i64,
}

/// A column that is wanted.
struct Column {
    slot: usize,
    /// Its place among the columns of the file, those inside of nested ones counted.
    leaf: usize,
    kind: Number,
}

impl ParquetSource {
    /// Opens a file and checks its columns; also gives the number of rows.
    pub(super) fn open(path: &Path, asked: Asked<'_>) -> Result<(Self, Layout, u64), LogError> {
        let mut file = File::open(path).map_err(|error| super::unreadable(path, &error))?;
        check_magic(path, &mut file)?;
        let reader =
            guarded(|| SerializedFileReader::new(file)).map_err(|problem| damaged(path, &problem))?;
        let schema = reader.metadata().file_metadata().schema_descr();
        let kinds: Vec<_> = schema.root_schema().get_fields().iter().map(|field| number(field)).collect();
        let fields = schema.root_schema().get_fields().iter().zip(&kinds);
        let variables = fields.map(|(field, kind)| {
            let width = kind.map(|_| 1).map_err(str::to_owned);
            Variable { name: field.name().to_owned(), width }
        });
        let layout = Layout::new(path, &variables.collect::<Vec<_>>(), Holds::Columns, asked)?;
        check_compression(path, reader.metadata())?;
        check_pages(path, reader.metadata(), &layout)?;
        let rows = u64::try_from(reader.metadata().file_metadata().num_rows())
            .map_err(|_| damaged(path, "a negative number of rows"))?;
        let mut columns = Vec::new();
        for (slot, place) in layout.columns() {
            let leaf =
                (0..schema.num_columns()).find(|leaf| schema.get_column_root_idx(*leaf) == place.variable);
            let (Some(leaf), Some(Ok(kind))) = (leaf, kinds.get(place.variable)) else {
                return Err(damaged(path, "columns are lost"));
            };
            columns.push(Column { slot, leaf, kind: *kind });
        }
        let path = path.to_owned();
        let source =
            Self { path, reader, columns, next: 0, open: Vec::new(), left: 0, position: 0, rows, origin: 0 };
        Ok((source, layout, rows))
    }

    /// Fills `batch` with rows of the open row group; with none at its end.
    fn fill(&mut self, batch: &mut Batch) -> Result<(), String> {
        let rows = ROWS.min(self.left);
        let mut levels = Vec::new();
        for (column, numbers) in self.columns.iter().zip(&mut self.open) {
            let into = batch.column_mut(column.slot);
            let origin = if column.slot == Group::TIME.first { self.origin } else { 0 };
            numbers.read(rows, origin, &mut levels, into).map_err(|error| error.to_string())?;
            if into.len() != rows {
                let held = self.position + into.len() as u64;
                return Err(format!("it holds {held} rows, {} were announced", self.rows));
            }
        }
        self.left -= rows;
        batch.rows = rows;
        Ok(())
    }

    /// Opens the next row group.
    fn advance(&mut self) -> Result<(), String> {
        let group = self.reader.get_row_group(self.next).map_err(|error| error.to_string())?;
        self.next += 1;
        self.left = usize::try_from(group.metadata().num_rows()).map_err(|error| error.to_string())?;
        self.open.clear();
        for column in &self.columns {
            let descriptor = group.metadata().schema_descr().column(column.leaf);
            let pages = group.get_column_page_reader(column.leaf).map_err(|error| error.to_string())?;
            self.open.push(Numbers::new(column.kind, descriptor, pages));
        }
        Ok(())
    }
}

impl Source for ParquetSource {
    fn read(&mut self, batch: &mut Batch) -> Result<(), LogError> {
        batch.clear();
        let groups = self.reader.num_row_groups();
        let filled = guarded(|| {
            self.fill(batch)?;
            while batch.rows == 0 && self.next < groups {
                self.advance()?;
                self.fill(batch)?;
            }
            Ok::<_, String>(())
        });
        if let Err(problem) = filled {
            let problem = format!("rows after {} cannot be read ({problem})", self.position);
            return Err(damaged(&self.path, &problem));
        }
        self.position += batch.rows as u64;
        if batch.rows == 0 && self.position < self.rows {
            let problem = format!("it holds {} rows, {} were announced", self.position, self.rows);
            return Err(damaged(&self.path, &problem));
        }
        Ok(())
    }

    fn count_from(&mut self, origin: i64) {
        self.origin = origin;
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

/// How a column holds numbers; what integers mean depends on their sign.
#[derive(Clone, Copy)]
pub(super) enum Number {
    F64,
    F32,
    I32(fn(i32) -> f64),
    I64(fn(i64) -> f64),
}

/// How a column holds numbers, or what it holds instead.
pub(super) fn number(field: &Type) -> Result<Number, &'static str> {
    let info = field.get_basic_info();
    // the root of a column has no repetition only where a file is damaged
    if !field.is_primitive() || !info.has_repetition() || info.repetition() == Repetition::REPEATED {
        return Err("nested values");
    }
    // shorter ones are kept as 32 bits
    let unsigned = match (info.logical_type_ref(), info.converted_type()) {
        (Some(LogicalType::Integer(kind)), _) => !kind.is_signed,
        (None, ConvertedType::UINT_8 | ConvertedType::UINT_16) => true,
        (None, ConvertedType::UINT_32 | ConvertedType::UINT_64) => true,
        (None, ConvertedType::INT_8 | ConvertedType::INT_16) => false,
        (None, ConvertedType::INT_32 | ConvertedType::INT_64 | ConvertedType::NONE) => false,
        (Some(LogicalType::Decimal(_)), _) | (None, ConvertedType::DECIMAL) => {
            return Err("values of type Decimal");
        }
        (Some(LogicalType::Float16), _) => return Err("values of type Float16"),
        (Some(LogicalType::Unknown), _) => return Err("nothing but empty cells"),
        (Some(LogicalType::String | LogicalType::Json), _) => return Err("text"),
        (None, ConvertedType::UTF8 | ConvertedType::JSON) => return Err("text"),
        (Some(LogicalType::Date | LogicalType::Timestamp(_)), _) | (None, ConvertedType::DATE) => {
            return Err("dates");
        }
        (None, ConvertedType::TIMESTAMP_MILLIS | ConvertedType::TIMESTAMP_MICROS) => return Err("dates"),
        (Some(LogicalType::Time(_)), _) => return Err("times of day"),
        (None, ConvertedType::TIME_MILLIS | ConvertedType::TIME_MICROS) => return Err("times of day"),
        _ => return Err("bytes or text"),
    };
    match field.get_physical_type() {
        Physical::DOUBLE => Ok(Number::F64),
        Physical::FLOAT => Ok(Number::F32),
        Physical::INT32 if unsigned => Ok(Number::I32(|value| value.cast_unsigned().into())),
        Physical::INT32 => Ok(Number::I32(f64::from)),
        Physical::INT64 if unsigned => Ok(Number::I64(|value| value.cast_unsigned() as f64)),
        Physical::INT64 => Ok(Number::I64(|value| value as f64)),
        Physical::BOOLEAN => Err("true/false values"),
        Physical::INT96 => Err("dates"),
        Physical::BYTE_ARRAY | Physical::FIXED_LEN_BYTE_ARRAY => Err("bytes or text"),
    }
}

/// A column of a row group on its way into memory.
pub(super) enum Numbers {
    F64(ColumnReaderImpl<DoubleType>),
    F32(ColumnReaderImpl<FloatType>),
    I32(ColumnReaderImpl<Int32Type>, fn(i32) -> f64),
    I64(ColumnReaderImpl<Int64Type>, fn(i64) -> f64),
}

impl Numbers {
    pub(super) fn new(kind: Number, column: ColumnDescPtr, pages: Box<dyn PageReader>) -> Self {
        match kind {
            Number::F64 => Self::F64(ColumnReaderImpl::new(column, pages)),
            Number::F32 => Self::F32(ColumnReaderImpl::new(column, pages)),
            Number::I32(f64_of) => Self::I32(ColumnReaderImpl::new(column, pages), f64_of),
            Number::I64(f64_of) => Self::I64(ColumnReaderImpl::new(column, pages), f64_of),
        }
    }

    /// Appends the next `rows` cells less `origin`, empty ones as NaN; `levels` is room to work in.
    pub(super) fn read(
        &mut self,
        rows: usize,
        origin: i64,
        levels: &mut Vec<i16>,
        into: &mut Vec<f64>,
    ) -> errors::Result<()> {
        let less = |value: f64| if origin == 0 { value } else { value - origin as f64 };
        match self {
            Self::F64(reader) => cells(reader, rows, levels, into, less),
            Self::F32(reader) => cells(reader, rows, levels, into, |value| less(value.into())),
            Self::I32(reader, f64_of) => cells(reader, rows, levels, into, |value| less(f64_of(value))),
            // before it becomes a number of 53 bits
            Self::I64(reader, f64_of) => {
                cells(reader, rows, levels, into, |value| f64_of(value.wrapping_sub(origin)))
            }
        }
    }
}

fn cells<T: DataType>(
    reader: &mut ColumnReaderImpl<T>,
    rows: usize,
    levels: &mut Vec<i16>,
    into: &mut Vec<f64>,
    f64_of: impl Fn(T::T) -> f64,
) -> errors::Result<()> {
    levels.clear();
    let mut values = Vec::with_capacity(rows);
    reader.read_records(rows, Some(levels), None, &mut values)?;
    let mut values = values.into_iter().map(f64_of);
    if levels.is_empty() {
        // no cell of this column may be empty
        into.extend(values);
    } else {
        let cell = |level: &i16| if *level > 0 { values.next() } else { None };
        into.extend(levels.iter().map(cell).map(|value| value.unwrap_or(f64::NAN)));
    }
    Ok(())
}
