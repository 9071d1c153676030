//! Tables of named columns, written as Parquet.

use std::io::{self, Write};
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::Result;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::Type;

/// Some cells of a column.
pub(crate) enum Cells {
    Numbers(Vec<f64>),
    /// Some of them may be empty.
    Some(Vec<Option<f64>>),
    Counts(Vec<u64>),
    Words(Vec<String>),
}

/// A column: its name and its cells, all of them or those of a piece of the table.
pub(crate) type Column = (String, Cells);

/// Writes a table piece by piece: what is held is a piece.
pub(crate) struct TableWriter<'a> {
    file: SerializedFileWriter<&'a mut (dyn Write + Send)>,
}

impl<'a> TableWriter<'a> {
    /// A table with columns like these, whose cells are not written, and a title.
    pub(crate) fn new(out: &'a mut (dyn Write + Send), like: &[Column], title: &str) -> io::Result<Self> {
        let fields = like.iter().map(|(name, cells)| field(name, cells).map(Arc::new));
        let schema =
            Type::group_type_builder("schema").with_fields(fields.collect::<Result<_>>()?).build()?;
        let properties = WriterProperties::builder()
            .set_compression(Compression::ZSTD(ZstdLevel::default()))
            .set_created_by(concat!("sinscal ", env!("CARGO_PKG_VERSION")).into())
            .set_key_value_metadata(Some(vec![KeyValue::new("title".to_owned(), title.to_owned())]))
            .build();
        Ok(Self { file: SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties))? })
    }

    /// Writes the next rows.
    pub(crate) fn write(&mut self, columns: &[Column]) -> io::Result<()> {
        let mut group = self.file.next_row_group()?;
        for (_, cells) in columns {
            put(&mut group, cells)?;
        }
        group.close()?;
        Ok(())
    }

    /// Ends the table.
    pub(crate) fn finish(self) -> io::Result<()> {
        self.file.close()?;
        Ok(())
    }
}

fn field(name: &str, cells: &Cells) -> Result<Type> {
    let (physical, logical) = match cells {
        Cells::Numbers(_) | Cells::Some(_) => (Physical::DOUBLE, None),
        Cells::Counts(_) => (Physical::INT64, Some(LogicalType::integer(64, false))),
        Cells::Words(_) => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
    };
    let repetition = match cells {
        Cells::Some(_) => Repetition::OPTIONAL,
        _ => Repetition::REQUIRED,
    };
    Type::primitive_type_builder(name, physical)
        .with_logical_type(logical)
        .with_repetition(repetition)
        .build()
}

fn put<W: Write + Send>(group: &mut SerializedRowGroupWriter<'_, W>, cells: &Cells) -> Result<()> {
    let Some(mut column) = group.next_column()? else { return Ok(()) };
    match cells {
        Cells::Numbers(values) => column.typed::<DoubleType>().write_batch(values, None, None)?,
        Cells::Some(cells) => {
            let levels: Vec<i16> = cells.iter().map(|cell| i16::from(cell.is_some())).collect();
            let values: Vec<f64> = cells.iter().flatten().copied().collect();
            column.typed::<DoubleType>().write_batch(&values, Some(&levels), None)?
        }
        Cells::Counts(values) => {
            let values: Vec<i64> = values.iter().map(|value| value.cast_signed()).collect();
            column.typed::<Int64Type>().write_batch(&values, None, None)?
        }
        Cells::Words(words) => {
            let words: Vec<ByteArray> = words.iter().map(|word| word.as_str().into()).collect();
            column.typed::<ByteArrayType>().write_batch(&words, None, None)?
        }
    };
    column.close()
}
