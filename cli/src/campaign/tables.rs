//! Results as Parquet: one row per unit and filter, and one per parameter of these.

use miette::{IntoDiagnostic, Result};
use study::{FilterResult, ParameterResult, UnitResult};

use crate::table::{Cells, Column, TableWriter};

/// `filters.parquet`.
pub(super) fn filters(results: &[UnitResult]) -> Result<Vec<u8>> {
    let rows: Vec<(u64, &FilterResult)> =
        results.iter().flat_map(|result| result.filters.iter().map(|filter| (result.unit, filter))).collect();
    let number =
        |value: fn(&FilterResult) -> f64| Cells::Numbers(rows.iter().map(|(_, row)| value(row)).collect());
    let some = |value: fn(&FilterResult) -> Option<f64>| {
        Cells::Some(rows.iter().map(|(_, row)| value(row)).collect())
    };
    write(
        "Campaign: filters",
        vec![
            ("unit".into(), Cells::Counts(rows.iter().map(|(unit, _)| *unit).collect())),
            ("filter".into(), Cells::Words(rows.iter().map(|(_, row)| row.filter.clone()).collect())),
            ("nis_per_dof".into(), number(|row| row.nis_per_dof)),
            ("nees".into(), number(|row| row.nees)),
            ("degrees_of_freedom".into(), number(|row| row.degrees_of_freedom as f64)),
            ("max_horizontal_m".into(), some(|row| row.max_horizontal_m)),
            ("final_horizontal_m".into(), some(|row| row.final_horizontal_m)),
        ],
    )
}

/// `parameters.parquet`.
pub(super) fn parameters(results: &[UnitResult]) -> Result<Vec<u8>> {
    let mut rows: Vec<(u64, &str, &ParameterResult)> = Vec::new();
    for result in results {
        for filter in &result.filters {
            rows.extend(filter.parameters.iter().map(|row| (result.unit, filter.filter.as_str(), row)));
        }
    }
    let number = |value: fn(&ParameterResult) -> f64| {
        Cells::Numbers(rows.iter().map(|(.., row)| value(row)).collect())
    };
    let words = |value: fn(&ParameterResult) -> &str| {
        Cells::Words(rows.iter().map(|(.., row)| value(row).to_owned()).collect())
    };
    write(
        "Campaign: parameters",
        vec![
            ("unit".into(), Cells::Counts(rows.iter().map(|(unit, ..)| *unit).collect())),
            ("filter".into(), Cells::Words(rows.iter().map(|(_, filter, _)| (*filter).to_owned()).collect())),
            ("parameter".into(), words(|row| &row.name)),
            ("component".into(), words(|row| &row.component)),
            ("truth".into(), number(|row| row.truth)),
            ("value".into(), number(|row| row.value)),
            ("sigma".into(), number(|row| row.sigma)),
            ("converged_s".into(), number(|row| row.converged_s)),
        ],
    )
}

fn write(title: &str, columns: Vec<Column>) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut writer = TableWriter::new(&mut bytes, &columns, title).into_diagnostic()?;
    writer.write(&columns).into_diagnostic()?;
    writer.finish().into_diagnostic()?;
    Ok(bytes)
}
