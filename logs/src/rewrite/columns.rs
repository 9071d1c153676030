//! A Parquet file with other numbers in some of its columns. What does not change is copied as it is packed, whatever it holds.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;

use parquet::column::writer::ColumnCloseResult;
use parquet::data_type::DoubleType;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{WriterProperties, WriterPropertiesBuilder};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::{Type, TypePtr};

use super::{Change, Sheet};
use crate::guard::guarded;
use crate::parquet::{Number, Numbers, number};

/// What Arrow adds about the types of columns.
const ARROW: &str = "ARROW:schema";

/// A table on its way, a row group at a time.
pub(super) struct Columns<'a> {
    file: File,
    reader: SerializedFileReader<File>,
    writer: SerializedFileWriter<&'a mut (dyn Write + Send)>,
    columns: Vec<Column>,
    /// The row group that is being filled, and its rows so far.
    group: usize,
    rows: usize,
}

/// A column that changes.
struct Column {
    leaf: usize,
    variable: usize,
    number: Number,
    optional: bool,
    /// What is added to its numbers in the rows of this group.
    changes: Vec<f64>,
}

impl<'a> Columns<'a> {
    /// `variables` are the columns that will change.
    pub(super) fn open(
        path: &Path,
        out: &'a mut (dyn Write + Send),
        variables: &[usize],
    ) -> io::Result<Self> {
        let file = File::open(path)?;
        let reader = SerializedFileReader::new(file.try_clone()?)?;
        let metadata = reader.metadata().file_metadata();
        let schema = metadata.schema_descr();
        let mut columns = Vec::new();
        for leaf in 0..schema.num_columns() {
            let variable = schema.get_column_root_idx(leaf);
            if variables.contains(&variable) {
                let number = number(schema.get_column_root(leaf)).map_err(io::Error::other)?;
                let optional = schema.column(leaf).max_def_level() > 0;
                columns.push(Column { leaf, variable, number, optional, changes: Vec::new() });
            }
        }
        let fields = schema
            .root_schema()
            .get_fields()
            .iter()
            .enumerate()
            .map(|(of, field)| if variables.contains(&of) { double(field) } else { Ok(field.clone()) });
        let root = Type::group_type_builder(schema.root_schema().name())
            .with_fields(fields.collect::<Result<_, _>>()?)
            .build()?;
        // kept where every column is of the type that it was
        let kept = columns.iter().all(|column| matches!(column.number, Number::F64));
        let notes = metadata.key_value_metadata().cloned().unwrap_or_default();
        let notes: Vec<KeyValue> = notes.into_iter().filter(|note| kept || note.key != ARROW).collect();
        let mut properties = WriterProperties::builder()
            .set_created_by(concat!("sinscal ", env!("CARGO_PKG_VERSION")).into())
            .set_key_value_metadata(Some(notes));
        if let Some(group) = reader.metadata().row_groups().first() {
            properties = packed_alike(properties, &columns, group);
        }
        let writer = SerializedFileWriter::new(out, Arc::new(root), Arc::new(properties.build()))?;
        Ok(Self { file, reader, writer, columns, group: 0, rows: 0 })
    }

    /// Writes a row group whose changes are all there.
    fn write(&mut self) -> io::Result<()> {
        guarded(|| self.write_group()).map_err(io::Error::other)?;
        self.group += 1;
        self.rows = 0;
        self.columns.iter_mut().for_each(|column| column.changes.clear());
        Ok(())
    }

    fn write_group(&mut self) -> Result<(), ParquetError> {
        let group = self.reader.get_row_group(self.group)?;
        let mut written = self.writer.next_row_group()?;
        for leaf in 0..group.num_columns() {
            let metadata = group.metadata().column(leaf).clone();
            let Some(column) = self.columns.iter().find(|column| column.leaf == leaf) else {
                let copied = ColumnCloseResult {
                    bytes_written: metadata.compressed_size().max(0).cast_unsigned(),
                    rows_written: group.metadata().num_rows().max(0).cast_unsigned(),
                    metadata,
                    bloom_filter: None,
                    column_index: None,
                    offset_index: None,
                };
                written.append_column(&self.file, copied)?;
                continue;
            };
            let descriptor = metadata.column_descr_ptr();
            let mut numbers = Numbers::new(column.number, descriptor, group.get_column_page_reader(leaf)?);
            let Some(mut writer) = written.next_column()? else { break };
            let (mut values, mut levels) = (Vec::new(), Vec::new());
            for changes in column.changes.chunks(ROWS) {
                values.clear();
                numbers.read(changes.len(), 0, &mut levels, &mut values)?;
                values.iter_mut().zip(changes).for_each(|(value, change)| *value += change);
                let present = vec![1; values.len()];
                let present = column.optional.then_some(present.as_slice());
                writer.typed::<DoubleType>().write_batch(&values, present, None)?;
            }
            writer.close()?;
        }
        written.close()?;
        Ok(())
    }

    fn rows_of(&self, group: usize) -> usize {
        let groups = self.reader.metadata().row_groups();
        groups.get(group).and_then(|group| usize::try_from(group.num_rows()).ok()).unwrap_or(0)
    }
}

/// Rows of a column in memory at a time.
const ROWS: usize = 4096;

impl Sheet for Columns<'_> {
    fn put(&mut self, _: Option<u64>, changes: &[Change]) -> io::Result<()> {
        while self.rows_of(self.group) == 0 && self.group < self.reader.num_row_groups() {
            self.write()?;
        }
        for column in &mut self.columns {
            let of = changes.iter().find(|(changed, _)| changed.variable == column.variable);
            column.changes.push(of.map_or(0.0, |(_, change)| *change));
        }
        self.rows += 1;
        if self.rows == self.rows_of(self.group) {
            self.write()?;
        }
        Ok(())
    }

    fn finish(self: Box<Self>) -> io::Result<()> {
        if self.rows > 0 {
            return Err(io::Error::other("the log has become shorter meanwhile"));
        }
        self.writer.close()?;
        Ok(())
    }
}

/// A column of the same name for numbers that were changed.
fn double(field: &TypePtr) -> Result<TypePtr, ParquetError> {
    let info = field.get_basic_info();
    let id = info.has_id().then(|| info.id());
    let builder = Type::primitive_type_builder(field.name(), parquet::basic::Type::DOUBLE)
        .with_repetition(info.repetition())
        .with_id(id);
    builder.build().map(Arc::new)
}

/// Packs the columns that change like those of the file.
fn packed_alike(
    mut properties: WriterPropertiesBuilder,
    columns: &[Column],
    group: &parquet::file::metadata::RowGroupMetaData,
) -> WriterPropertiesBuilder {
    for column in columns {
        let metadata = group.column(column.leaf);
        properties = properties
            .set_column_compression(metadata.column_path().clone(), metadata.compression())
            // numbers that were corrected hardly repeat
            .set_column_dictionary_enabled(metadata.column_path().clone(), false);
    }
    properties
}
