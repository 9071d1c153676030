//! A table as it is written, before anything about it is checked.

use crate::expr::Operations;

/// A value and the offset in the table's text where it stands.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct At<T> {
    /// The value.
    pub(crate) value: T,
    /// Its first byte.
    pub(crate) start: usize,
}

/// A named intermediate result.
#[derive(Clone, Debug)]
pub(crate) struct Step {
    /// Its name.
    pub(crate) name: At<String>,
    /// Its value.
    pub(crate) expr: At<String>,
}

/// An entry of the Jacobian.
#[derive(Clone, Debug)]
pub(crate) struct Cell {
    /// Its row.
    pub(crate) row: At<usize>,
    /// Its column.
    pub(crate) column: At<usize>,
    /// Its value.
    pub(crate) expr: At<String>,
}

/// A table.
#[derive(Clone, Debug)]
pub(crate) struct Raw {
    /// Version of the format.
    pub(crate) schema: At<u32>,
    /// Name of the effect or model.
    pub(crate) name: At<String>,
    /// What the Jacobian is of.
    pub(crate) kind: At<String>,
    /// One line about it.
    pub(crate) description: At<String>,
    /// The model in plain text.
    pub(crate) equation: At<String>,
    /// Where the model comes from.
    pub(crate) source: At<String>,
    /// Version of SymPy that derived it.
    pub(crate) sympy: At<String>,
    /// SI unit of the parameters.
    pub(crate) unit: Option<At<String>>,
    /// Names of the parameters.
    pub(crate) components: Vec<At<String>>,
    /// Names in expressions, and the fields they are read from.
    pub(crate) inputs: Vec<(At<String>, At<String>)>,
    /// Names in expressions, and their values.
    pub(crate) constants: Vec<(At<String>, At<f64>)>,
    /// Where the Jacobian stands.
    pub(crate) jacobian: usize,
    /// Its rows.
    pub(crate) rows: At<usize>,
    /// Its columns.
    pub(crate) columns: At<usize>,
    /// Its entries that are not zero.
    pub(crate) nonzeros: At<usize>,
    /// What it costs.
    pub(crate) operations: At<Operations>,
    /// Intermediate results, in order.
    pub(crate) steps: Vec<Step>,
    /// The entries, row after row.
    pub(crate) entries: Vec<Cell>,
}
