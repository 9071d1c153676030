//! TOML text of a table -> [`Raw`], with the byte offset of everything that may turn out to be wrong.

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Spanned;

use crate::raw::{At, Cell, Raw, Step};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    schema: Spanned<u32>,
    name: Spanned<String>,
    kind: Spanned<String>,
    description: Spanned<String>,
    equation: Spanned<String>,
    source: Spanned<String>,
    sympy: Spanned<String>,
    parameters: Option<Parameters>,
    inputs: BTreeMap<Spanned<String>, Spanned<String>>,
    #[serde(default)]
    constants: BTreeMap<Spanned<String>, Spanned<f64>>,
    jacobian: Spanned<Jacobian>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Parameters {
    unit: Spanned<String>,
    components: Vec<Spanned<String>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Jacobian {
    rows: Spanned<usize>,
    columns: Spanned<usize>,
    nonzeros: Spanned<usize>,
    operations: Spanned<Operations>,
    #[serde(default)]
    steps: Vec<Named>,
    entries: Vec<Entry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Operations {
    add: u32,
    multiply: u32,
    divide: u32,
    function: u32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Named {
    name: Spanned<String>,
    expr: Spanned<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    row: Spanned<usize>,
    column: Spanned<usize>,
    expr: Spanned<String>,
}

fn at<T>(spanned: Spanned<T>) -> At<T> {
    let start = spanned.span().start;
    At { value: spanned.into_inner(), start }
}

/// Reads a table; the error is an offset and a message.
pub(crate) fn read(text: &str) -> Result<Raw, At<String>> {
    let document: Document = toml::from_str(text)
        .map_err(|e| At { value: e.message().to_owned(), start: e.span().map_or(0, |s| s.start) })?;
    let start = document.jacobian.span().start;
    let jacobian = document.jacobian.into_inner();
    let (unit, components) = match document.parameters {
        Some(p) => (Some(at(p.unit)), p.components.into_iter().map(at).collect()),
        None => (None, Vec::new()),
    };
    let operations = at(jacobian.operations);
    Ok(Raw {
        schema: at(document.schema),
        name: at(document.name),
        kind: at(document.kind),
        description: at(document.description),
        equation: at(document.equation),
        source: at(document.source),
        sympy: at(document.sympy),
        unit,
        components,
        inputs: document.inputs.into_iter().map(|(name, field)| (at(name), at(field))).collect(),
        constants: document.constants.into_iter().map(|(name, value)| (at(name), at(value))).collect(),
        jacobian: start,
        rows: at(jacobian.rows),
        columns: at(jacobian.columns),
        nonzeros: at(jacobian.nonzeros),
        operations: At {
            start: operations.start,
            value: crate::expr::Operations {
                add: operations.value.add,
                multiply: operations.value.multiply,
                divide: operations.value.divide,
                function: operations.value.function,
            },
        },
        steps: jacobian.steps.into_iter().map(|s| Step { name: at(s.name), expr: at(s.expr) }).collect(),
        entries: jacobian
            .entries
            .into_iter()
            .map(|e| Cell { row: at(e.row), column: at(e.column), expr: at(e.expr) })
            .collect(),
    })
}
