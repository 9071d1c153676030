//! [`Raw`] -> [`Table`]: everything that can be wrong with a table is found here.

use std::collections::{BTreeMap, BTreeSet};

use crate::expr::{Expr, Operations, Problem};
use crate::raw::{At, Raw};

/// Version of the format that is understood.
const SCHEMA: u32 = 1;

/// What a Jacobian is of, and so what it depends on and how it is called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Errors of the gyros by an effect's parameters.
    Rate,
    /// Errors of the accelerometers by an effect's parameters.
    Force,
    /// Errors of both by an effect's parameters.
    Sensors,
    /// Measurement residuals by an effect's parameters.
    Measurement,
    /// The matrix A.
    Core,
    /// The matrix B.
    Injection,
    /// The matrix H of the leading states.
    Residual,
    /// The matrix L.
    ResidualInput,
}

impl Kind {
    fn named(name: &str) -> Option<Self> {
        Some(match name {
            "rate" => Self::Rate,
            "force" => Self::Force,
            "sensors" => Self::Sensors,
            "measurement" => Self::Measurement,
            "core" => Self::Core,
            "injection" => Self::Injection,
            "residual" => Self::Residual,
            "residual-input" => Self::ResidualInput,
            _ => return None,
        })
    }

    /// Whether the table belongs to an effect, which has parameters.
    pub(crate) fn is_effect(self) -> bool {
        matches!(self, Self::Rate | Self::Force | Self::Sensors | Self::Measurement)
    }

    /// Whether the Jacobian is asked for by column.
    pub(crate) fn by_column(self) -> bool {
        matches!(self, Self::Injection | Self::ResidualInput)
    }

    /// Whether the expressions depend on `Signals`; on `Point` otherwise.
    pub(crate) fn of_signals(self) -> bool {
        matches!(self, Self::Rate | Self::Force | Self::Sensors)
    }

    fn shape(self, parameters: usize) -> (usize, usize) {
        match self {
            Self::Rate | Self::Force | Self::Sensors => (6, parameters),
            Self::Measurement => (12, parameters),
            Self::Core => (9, 9),
            Self::Residual => (12, 9),
            Self::Injection => (9, 6),
            Self::ResidualInput => (12, 6),
        }
    }

    /// Rows that may hold entries.
    fn rows(self) -> std::ops::Range<usize> {
        match self {
            Self::Rate => 0..3,
            Self::Force => 3..6,
            Self::Sensors => 0..6,
            Self::Measurement | Self::Residual | Self::ResidualInput => 0..12,
            Self::Core | Self::Injection => 0..9,
        }
    }
}

/// Vectors along x, y, z that expressions may be read from, and scalars.
const SIGNAL_VECTORS: [&str; 16] = [
    "rate",
    "angular_acceleration",
    "force",
    "force_rate",
    "temperature",
    "temperature_rate",
    "gyro_temperature",
    "dither",
    "coupled_dither",
    "up",
    "earth_rate",
    "earth_turn",
    "gyro_temperature_rate",
    "temperature_slope",
    "gyro_temperature_slope",
    "arms",
];
const SIGNAL_SCALARS: [&str; 4] = ["time", "gravity", "gravity_by_latitude", "gravity_by_height"];
const POINT_VECTORS: [&str; 8] = [
    "velocity",
    "position",
    "force_n",
    "rate_eb",
    "lever",
    "point_velocity",
    "point_acceleration",
    "point_position",
];
const POINT_SCALARS: [&str; 2] = ["latitude", "height"];

fn is_field(kind: Kind, path: &str) -> bool {
    let (vectors, scalars): (&[&str], &[&str]) =
        if kind.of_signals() { (&SIGNAL_VECTORS, &SIGNAL_SCALARS) } else { (&POINT_VECTORS, &POINT_SCALARS) };
    match path.split_once('.') {
        None => scalars.contains(&path),
        Some(("c_bn", entry)) => {
            let is_index = |digit: &u8| (b'1'..=b'3').contains(digit);
            let of_matrix =
                matches!(entry.as_bytes(), [b'm', row, column] if is_index(row) && is_index(column));
            of_matrix && !kind.of_signals()
        }
        Some((vector, axis)) => vectors.contains(&vector) && matches!(axis, "x" | "y" | "z"),
    }
}

/// An entry of a Jacobian.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    /// Its row.
    pub(crate) row: usize,
    /// Its column.
    pub(crate) column: usize,
    /// Its value.
    pub(crate) expr: Expr,
}

/// A table without mistakes.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    /// Name of the effect or model.
    pub(crate) name: String,
    /// What the Jacobian is of.
    pub(crate) kind: Kind,
    /// One line about it.
    pub(crate) description: String,
    /// The model in plain text.
    pub(crate) equation: String,
    /// Where the model comes from.
    pub(crate) source: String,
    /// Version of SymPy that derived it.
    pub(crate) sympy: String,
    /// SI unit of the parameters; empty without parameters.
    pub(crate) unit: String,
    /// Names of the parameters.
    pub(crate) components: Vec<String>,
    /// Names in expressions, and the fields they are read from.
    pub(crate) inputs: Vec<(String, String)>,
    /// Names in expressions, and their values.
    pub(crate) constants: Vec<(String, f64)>,
    /// Rows of the Jacobian.
    pub(crate) rows: usize,
    /// Columns of the Jacobian.
    pub(crate) columns: usize,
    /// What it costs.
    pub(crate) operations: Operations,
    /// Intermediate results, in order.
    pub(crate) steps: Vec<(String, Expr)>,
    /// The entries that are not zero.
    pub(crate) entries: Vec<Entry>,
}

/// A message and the offset it is about.
type Fault = At<String>;

fn fault<T>(start: usize, message: impl Into<String>) -> Result<T, Fault> {
    Err(At { value: message.into(), start })
}

/// Names that the generated functions use themselves, and words of Rust.
const RESERVED: &[&str] = &[
    "at", "base", "input", "put", "signals", "value", "abstract", "as", "async", "await", "become", "box",
    "break", "const", "continue", "crate", "do", "dyn", "else", "enum", "extern", "false", "final", "fn",
    "for", "gen", "if", "impl", "in", "let", "loop", "macro", "match", "mod", "move", "mut", "override",
    "priv", "pub", "ref", "return", "self", "static", "struct", "super", "trait", "true", "try", "type",
    "typeof", "unsafe", "unsized", "use", "virtual", "where", "while", "yield",
];

fn is_identifier(name: &str) -> bool {
    let mut bytes = name.bytes();
    if RESERVED.contains(&name) {
        return false;
    }
    bytes.next().is_some_and(|b| b.is_ascii_lowercase())
        && bytes.all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_')
}

fn is_table_name(name: &str) -> bool {
    !name.contains('_') && is_identifier(&name.replace('-', "_"))
}

/// Names an expression may use so far, and those that were used.
#[derive(Default)]
struct Scope {
    known: BTreeMap<String, usize>,
    used: BTreeSet<String>,
}

impl Scope {
    fn define(&mut self, name: &At<String>) -> Result<(), Fault> {
        if !is_identifier(&name.value) {
            return fault(
                name.start,
                format!("`{}` is not a name: lower case, digits and _, no word of Rust", name.value),
            );
        }
        match self.known.insert(name.value.clone(), name.start) {
            None => Ok(()),
            Some(_) => fault(name.start, format!("`{}` is defined twice", name.value)),
        }
    }

    fn parse(&mut self, text: &At<String>) -> Result<Expr, Fault> {
        let expr = Expr::parse(&text.value).map_err(|Problem { at, message }| At {
            // The opening quote stands before the first byte.
            start: text.start + 1 + at,
            value: format!("in `{}`: {message}", text.value),
        })?;
        let mut unknown = None;
        expr.names(&mut |name| {
            if !self.known.contains_key(name) {
                unknown.get_or_insert_with(|| name.to_owned());
            }
            self.used.insert(name.to_owned());
        });
        match unknown {
            None => Ok(expr),
            Some(name) => fault(
                text.start,
                format!("in `{}`: `{name}` is no input, constant or earlier step", text.value),
            ),
        }
    }
}

/// Checks a table.
pub(crate) fn check(raw: Raw) -> Result<Table, Fault> {
    if raw.schema.value != SCHEMA {
        return fault(raw.schema.start, format!("schema {} is not {SCHEMA}", raw.schema.value));
    }
    let Some(kind) = Kind::named(&raw.kind.value) else {
        let known = "rate, force, measurement, core, injection, residual, residual-input";
        return fault(raw.kind.start, format!("kind `{}` is not one of {known}", raw.kind.value));
    };
    if !is_table_name(&raw.name.value) {
        return fault(
            raw.name.start,
            format!("`{}` is not a name: lower-case words joined by -", raw.name.value),
        );
    }
    for text in [&raw.description, &raw.equation, &raw.source, &raw.sympy] {
        if text.value.trim().is_empty() {
            return fault(text.start, "this must say something");
        }
    }
    let unit = parameters(&raw, kind)?;

    let mut scope = Scope::default();
    for (name, field) in &raw.inputs {
        scope.define(name)?;
        if !is_field(kind, &field.value) {
            let of = if kind.of_signals() { "Signals" } else { "Point" };
            return fault(field.start, format!("`{}` is not a field of `{of}`", field.value));
        }
    }
    for (name, value) in &raw.constants {
        scope.define(name)?;
        if !value.value.is_finite() {
            return fault(value.start, format!("`{}` is not finite", name.value));
        }
    }
    let mut operations = Operations::default();
    let mut steps = Vec::new();
    if let (true, Some(step)) = (kind.by_column(), raw.steps.first()) {
        return fault(step.name.start, "a Jacobian that is asked for by column has no steps");
    }
    for step in &raw.steps {
        let expr = scope.parse(&step.expr)?;
        scope.define(&step.name)?;
        expr.count(&mut operations);
        steps.push((step.name.value.clone(), expr));
    }
    let entries = entries(&raw, kind, &mut scope, &mut operations)?;

    if let Some((name, start)) = scope.known.iter().find(|(name, _)| !scope.used.contains(*name)) {
        return fault(*start, format!("`{name}` is never used"));
    }
    if raw.nonzeros.value != entries.len() {
        let message = format!("nonzeros says {}, there are {} entries", raw.nonzeros.value, entries.len());
        return fault(raw.nonzeros.start, message);
    }
    if raw.operations.value != operations {
        let message = format!("operations says {}; counted are {operations}", raw.operations.value);
        return fault(raw.operations.start, message);
    }
    Ok(Table {
        name: raw.name.value,
        kind,
        description: raw.description.value,
        equation: raw.equation.value,
        source: raw.source.value,
        sympy: raw.sympy.value,
        unit,
        components: raw.components.into_iter().map(|c| c.value).collect(),
        inputs: raw.inputs.into_iter().map(|(name, field)| (name.value, field.value)).collect(),
        constants: raw.constants.into_iter().map(|(name, value)| (name.value, value.value)).collect(),
        rows: raw.rows.value,
        columns: raw.columns.value,
        operations,
        steps,
        entries,
    })
}

/// Unit of the parameters, after checking them and the shape of the Jacobian.
fn parameters(raw: &Raw, kind: Kind) -> Result<String, Fault> {
    let unit = match (&raw.unit, kind.is_effect()) {
        (Some(unit), true) => unit.value.clone(),
        (None, false) => String::new(),
        (None, true) => return fault(raw.name.start, "an effect needs [parameters]"),
        (Some(unit), false) => return fault(unit.start, "only an effect has [parameters]"),
    };
    let mut seen = BTreeSet::new();
    for component in &raw.components {
        if !is_identifier(&component.value) || !seen.insert(&component.value) {
            return fault(component.start, format!("component `{}` is no name of its own", component.value));
        }
    }
    let (rows, columns) = kind.shape(raw.components.len());
    for (found, wanted, what) in [(&raw.rows, rows, "rows"), (&raw.columns, columns, "columns")] {
        if found.value != wanted {
            let message = format!("{what} says {}, this kind of table has {wanted}", found.value);
            return fault(found.start, message);
        }
    }
    if columns == 0 {
        return fault(raw.jacobian, "an effect needs at least one parameter");
    }
    Ok(unit)
}

fn entries(
    raw: &Raw,
    kind: Kind,
    scope: &mut Scope,
    operations: &mut Operations,
) -> Result<Vec<Entry>, Fault> {
    let mut seen = BTreeSet::new();
    let mut entries = Vec::new();
    for cell in &raw.entries {
        let (row, column) = (cell.row.value, cell.column.value);
        if !kind.rows().contains(&row) || row >= raw.rows.value {
            let rows = kind.rows();
            let message = format!("row {row} is outside rows {} to {}", rows.start, rows.end - 1);
            return fault(cell.row.start, message);
        }
        if column >= raw.columns.value {
            return fault(
                cell.column.start,
                format!("column {column} is outside {} columns", raw.columns.value),
            );
        }
        if !seen.insert((row, column)) {
            return fault(cell.row.start, format!("entry ({row}, {column}) stands here twice"));
        }
        let expr = scope.parse(&cell.expr)?;
        expr.count(operations);
        entries.push(Entry { row, column, expr });
    }
    Ok(entries)
}
