//! Reading a calibration that `calibrate` wrote.

use std::path::Path;

use logs::suggest;
use miette::{Result, miette};
use runs::{Calibrated, Values};
use serde_json::Value;
use sinscal::StateInfo;

use crate::compose::compose;
use crate::vocabulary::vocabulary;

/// Calibrations are small; what is larger is some other file.
const LARGEST: u64 = 16 << 20;

/// A parameter beyond so many default priors is no calibration of an inertial unit, and the filter could not follow it.
const ABSURD: f64 = 1e6;

/// Sensors lie within this many degC, and so do their reference temperatures.
const TEMPERATURES: (f64, f64) = (-80.0, 150.0);

/// Reads and checks the calibration in `path`; also gives the document as a whole.
pub(crate) fn read(path: &Path) -> Result<(Calibrated, Value)> {
    let at = path.display();
    let what = "a calibration is what `sinscal calibrate --json` writes";
    let metadata = std::fs::metadata(path).map_err(|error| miette!("{at}: cannot be read: {error}"))?;
    if !metadata.is_file() || metadata.len() > LARGEST {
        return Err(miette!("{at}: is not a calibration that `sinscal calibrate --json` wrote"));
    }
    let bytes = std::fs::read(path).map_err(|error| miette!("{at}: cannot be read: {error}"))?;
    parse(&bytes).map_err(|fault| match fault.field {
        Some(field) => miette!(help = fault.help, "{at}, field `{field}`: {}", fault.problem),
        None => miette!(help = what, "{at}: {}", fault.problem),
    })
}

/// What is wrong with a calibration, and where.
#[derive(Debug)]
pub(super) struct Fault {
    field: Option<String>,
    problem: String,
    help: String,
}

fn fault(field: impl Into<String>, problem: impl Into<String>, help: impl Into<String>) -> Fault {
    Fault { field: Some(field.into()), problem: problem.into(), help: help.into() }
}

/// The calibration in a document, and the document.
pub(super) fn parse(bytes: &[u8]) -> Result<(Calibrated, Value), Fault> {
    let whole = |problem: String| Fault { field: None, problem, help: String::new() };
    // the mark that some editors begin a file with
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let document: Value =
        serde_json::from_slice(bytes).map_err(|error| whole(format!("is not valid JSON: {error}")))?;
    if !document.is_object() {
        return Err(whole(format!("holds {}, an object was expected", kind(&document))));
    }
    let filters = vocabulary().filters().map(|filter| filter.name());
    let name = match document.get("filter") {
        Some(Value::String(name)) => name,
        other => return Err(wrong("filter", other, "the name of a filter")),
    };
    let Ok(base) = vocabulary().filter(name) else {
        return Err(fault(
            "filter",
            format!("there is no filter called {name}"),
            suggest::hint(name, filters),
        ));
    };
    let chosen = compose(base.name(), &names(&document, "with")?, &names(&document, "without")?)
        .map_err(|error| fault("with", error.to_string(), "the effects that were added to the filter"))?;
    let list = match document.get("parameters") {
        Some(Value::Array(list)) => list,
        other => return Err(wrong("parameters", other, "a list of parameters")),
    };
    let (filter, known) = (chosen.title(), chosen.parameters());
    let filter = filter.as_str();
    let mut values = Values::new();
    for (index, parameter) in list.iter().enumerate() {
        let value = read_parameter(&format!("parameters[{index}]"), parameter, filter, &known, &values)?;
        values.push(value);
    }
    let missing =
        known.iter().find(|info| !values.iter().any(|(n, c, _)| *n == info.block && *c == info.component));
    if let Some(info) = missing {
        let problem = format!("`{} {}` of {filter} is missing", info.block, info.component);
        return Err(fault("parameters", problem, "every parameter of the filter must be there"));
    }
    let reference_temperature = match document.get("reference_temperature_c") {
        None | Some(Value::Null) => None,
        Some(Value::Number(number)) => number.as_f64(),
        other => return Err(wrong("reference_temperature_c", other, "a temperature in degC")),
    };
    if let Some(degrees) = reference_temperature.filter(|t| !(TEMPERATURES.0..=TEMPERATURES.1).contains(t)) {
        let problem = format!(
            "is {degrees}, a temperature from {} to {} degC was expected",
            TEMPERATURES.0, TEMPERATURES.1
        );
        return Err(fault("reference_temperature_c", problem, "where the temperature effects vanish"));
    }
    Ok((Calibrated { filter: chosen, values, reference_temperature }, document))
}

/// The standard deviation of an estimated parameter, by its place in the list of a calibration that was read.
pub(crate) fn sigma(path: &Path, document: &Value, index: usize) -> Result<f64> {
    let parameter = &document["parameters"][index];
    match parameter["sigma"].as_f64() {
        Some(sigma) if sigma.is_finite() && sigma > 0.0 => Ok(sigma),
        _ => Err(miette!(
            help = "a calibration is what `sinscal calibrate --json` writes",
            "{}, field `parameters[{index}].sigma`: a number above 0 was expected for `{} {}`",
            path.display(),
            parameter["name"].as_str().unwrap_or_default(),
            parameter["component"].as_str().unwrap_or_default()
        )),
    }
}

/// A list of names, empty where there is none.
fn names(document: &Value, field: &str) -> Result<Vec<String>, Fault> {
    let expected = || wrong(field, document.get(field), "a list of names");
    match document.get(field) {
        None => Ok(Vec::new()),
        Some(Value::Array(list)) => {
            list.iter().map(|name| name.as_str().map(str::to_owned).ok_or_else(expected)).collect()
        }
        Some(_) => Err(expected()),
    }
}

/// One entry of the list, which comes after `before`.
fn read_parameter(
    field: &str,
    parameter: &Value,
    filter: &str,
    known: &[StateInfo],
    before: &Values,
) -> Result<(String, String, Option<f64>), Fault> {
    let text = |key: &str, expected: &str| match parameter.get(key) {
        Some(Value::String(text)) => Ok(text.as_str()),
        other => Err(wrong(&format!("{field}.{key}"), other, expected)),
    };
    let name = text("name", "the name of an effect")?;
    let component = match parameter.get("component") {
        None => "",
        Some(_) => text("component", "a component such as x")?,
    };
    let Some(info) = known.iter().find(|info| info.block == name && info.component == component) else {
        let blocks = known.iter().filter(|info| info.block == name);
        let help = match blocks.clone().next() {
            Some(_) => suggest::hint(component, blocks.map(|info| info.component)),
            None => suggest::hint(name, known.iter().map(|info| info.block)),
        };
        return Err(fault(field, format!("{filter} has no parameter `{name} {component}`"), help));
    };
    if before.iter().any(|(n, c, _)| n == name && c == component) {
        return Err(fault(
            field,
            format!("`{name} {component}` stands there twice"),
            "leave one of them out",
        ));
    }
    if let Some(unit) = parameter.get("unit").filter(|unit| unit.as_str() != Some(info.unit)) {
        let problem = format!("is {unit}, `{name}` is read in \"{}\"", info.unit);
        return Err(fault(format!("{field}.unit"), problem, "values are in SI units"));
    }
    let value_field = format!("{field}.value");
    let value = match parameter.get("value") {
        Some(Value::Null) => None,
        Some(Value::Number(number)) => number.as_f64(),
        other => return Err(wrong(&value_field, other, "a number, or null where nothing was estimated")),
    };
    let most = ABSURD * info.prior_sigma;
    if let Some(value) = value.filter(|value| !(value.abs() <= most)) {
        let problem =
            format!("is {value:e} {}, beyond any `{name}` (at most {most:e} was expected)", info.unit);
        return Err(fault(value_field, problem, "values are in SI units"));
    }
    Ok((name.to_owned(), component.to_owned(), value))
}

/// A value that is missing or of another kind than expected.
fn wrong(field: &str, found: Option<&Value>, expected: &str) -> Fault {
    let problem = found.map_or_else(|| "is missing".to_owned(), |value| format!("is {}", kind(value)));
    fault(
        field,
        format!("{problem}, {expected} was expected"),
        "a calibration is what `sinscal calibrate --json` writes",
    )
}

fn kind(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "true or false",
        Value::Number(_) => "a number",
        Value::String(_) => "text",
        Value::Array(_) => "a list",
        Value::Object(_) => "an object",
    }
}

#[cfg(test)]
#[path = "../../../tests/common/damage.rs"]
mod damage;

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::damage::damaged;
    use super::*;

    /// A calibration that found nothing.
    fn sound() -> Vec<u8> {
        let known = vocabulary().filter("43d-b").map(|filter| filter.parameters()).unwrap_or_default();
        let parameter = |info: &StateInfo| serde_json::json!({ "name": info.block, "component": info.component, "value": 1e-9, "unit": info.unit });
        let parameters: Vec<Value> = known.iter().map(parameter).collect();
        serde_json::json!({ "filter": "43d-b", "parameters": parameters }).to_string().into_bytes()
    }

    #[test]
    fn the_sound_one_is_sound() {
        assert!(parse(&sound()).is_ok_and(|(calibrated, _)| calibrated.values.len() == 34));
    }

    proptest! {
        #[test]
        fn fuzz_calibration(damaged in damaged(sound())) {
            match parse(&damaged) {
                Ok((calibrated, _)) => prop_assert!(calibrated.values.iter().all(|(.., v)| v.is_none_or(f64::is_finite))),
                Err(fault) => prop_assert!(!fault.problem.is_empty()),
            }
        }
    }
}
