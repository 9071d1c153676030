//! Results as Parquet: one row per unit and filter, and one per parameter of these.

use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, RecordBatch, StringArray, UInt64Array};
use miette::{IntoDiagnostic, Result};
use parquet::arrow::ArrowWriter;
use parquet::basic::{Compression, ZstdLevel};
use parquet::file::properties::WriterProperties;
use study::{FilterResult, ParameterResult, UnitResult};

/// `filters.parquet`.
pub(super) fn filters(results: &[UnitResult]) -> Result<Vec<u8>> {
    let rows: Vec<(u64, &FilterResult)> =
        results.iter().flat_map(|result| result.filters.iter().map(|filter| (result.unit, filter))).collect();
    let number = |value: fn(&FilterResult) -> Option<f64>| -> ArrayRef {
        Arc::new(rows.iter().map(|(_, row)| value(row)).collect::<Float64Array>())
    };
    write(vec![
        ("unit", Arc::new(rows.iter().map(|(unit, _)| Some(*unit)).collect::<UInt64Array>())),
        ("filter", Arc::new(StringArray::from_iter_values(rows.iter().map(|(_, row)| &row.filter)))),
        ("nis_per_dof", number(|row| Some(row.nis_per_dof))),
        ("nees", number(|row| Some(row.nees))),
        ("degrees_of_freedom", number(|row| Some(row.degrees_of_freedom as f64))),
        ("max_horizontal_m", number(|row| row.max_horizontal_m)),
        ("final_horizontal_m", number(|row| row.final_horizontal_m)),
    ])
}

/// `parameters.parquet`.
pub(super) fn parameters(results: &[UnitResult]) -> Result<Vec<u8>> {
    let mut rows: Vec<(u64, &str, &ParameterResult)> = Vec::new();
    for result in results {
        for filter in &result.filters {
            rows.extend(filter.parameters.iter().map(|row| (result.unit, filter.filter.as_str(), row)));
        }
    }
    let number = |value: fn(&ParameterResult) -> f64| -> ArrayRef {
        Arc::new(Float64Array::from_iter_values(rows.iter().map(|(_, _, row)| value(row))))
    };
    write(vec![
        ("unit", Arc::new(UInt64Array::from_iter_values(rows.iter().map(|(unit, _, _)| *unit)))),
        ("filter", Arc::new(StringArray::from_iter_values(rows.iter().map(|(_, filter, _)| filter)))),
        ("parameter", Arc::new(StringArray::from_iter_values(rows.iter().map(|(_, _, row)| &row.name)))),
        ("component", Arc::new(StringArray::from_iter_values(rows.iter().map(|(_, _, row)| &row.component)))),
        ("truth", number(|row| row.truth)),
        ("value", number(|row| row.value)),
        ("sigma", number(|row| row.sigma)),
        ("converged_s", number(|row| row.converged_s)),
    ])
}

fn write(columns: Vec<(&str, ArrayRef)>) -> Result<Vec<u8>> {
    let batch = RecordBatch::try_from_iter(columns).into_diagnostic()?;
    let level = ZstdLevel::try_new(3).into_diagnostic()?;
    let properties = WriterProperties::builder().set_compression(Compression::ZSTD(level)).build();
    let mut bytes = Vec::new();
    let mut writer = ArrowWriter::try_new(&mut bytes, batch.schema(), Some(properties)).into_diagnostic()?;
    writer.write(&batch).into_diagnostic()?;
    writer.close().into_diagnostic()?;
    Ok(bytes)
}
