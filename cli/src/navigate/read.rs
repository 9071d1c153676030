//! Reading a calibration that `calibrate` wrote.

use std::path::Path;

use miette::{Result, miette};
use serde::Deserialize;
use sinscal::{Filter, FilterVisitor, Strapdown, visit_filter};

use super::run::{Calibrated, Values};
use crate::suggest;

/// Calibrations are small; what is larger is some other file.
const LARGEST: u64 = 16 << 20;

#[derive(Deserialize)]
struct Document {
    filter: String,
    parameters: Vec<Parameter>,
}

#[derive(Deserialize)]
struct Parameter {
    name: String,
    #[serde(default)]
    component: String,
    value: Option<f64>,
}

/// Names of the parameters of a filter.
struct Names;

impl FilterVisitor for Names {
    type Output = Vec<(&'static str, &'static str)>;

    fn visit<F: Filter<Dynamics = Strapdown>>(self) -> Self::Output {
        let mut names = Vec::new();
        F::states(&mut |info| names.push((info.block, info.component)));
        names.split_off(<F::Dynamics as sinscal::Dynamics>::CORE)
    }
}

/// Reads and checks the calibration in `path`.
pub(super) fn read(path: &Path) -> Result<Calibrated> {
    let at = path.display();
    let metadata = std::fs::metadata(path).map_err(|error| miette!("{at}: cannot be read: {error}"))?;
    if !metadata.is_file() || metadata.len() > LARGEST {
        return Err(miette!("{at}: is not a calibration that `sinscal calibrate --json` wrote"));
    }
    let text = std::fs::read_to_string(path).map_err(|error| miette!("{at}: cannot be read: {error}"))?;
    let document: Document = serde_json::from_str(&text).map_err(|error| {
        miette!(help = "a calibration is what `sinscal calibrate --json` writes", "{at}: {error}")
    })?;
    let filters = sinscal::FILTERS.iter().map(|filter| filter.name);
    let Some(filter) = filters.clone().find(|name| *name == document.filter) else {
        let help = suggest::hint(&document.filter, filters);
        return Err(miette!(
            help = help,
            "{at}, field `filter`: there is no filter called {}",
            document.filter
        ));
    };
    let names = visit_filter(filter, Names).unwrap_or_default();
    let mut values = Values::new();
    for (index, Parameter { name, component, value }) in document.parameters.into_iter().enumerate() {
        let field = format!("parameters[{index}]");
        if !names.contains(&(name.as_str(), component.as_str())) {
            return Err(miette!("{at}, field `{field}`: {filter} has no parameter `{name} {component}`"));
        }
        if values.iter().any(|(n, c, _)| (n, c) == (&name, &component)) {
            return Err(miette!("{at}, field `{field}`: `{name} {component}` stands there twice"));
        }
        values.push((name, component, value));
    }
    let missing =
        names.iter().find(|(name, component)| !values.iter().any(|(n, c, _)| n == name && c == component));
    if let Some((name, component)) = missing {
        return Err(miette!("{at}, field `parameters`: `{name} {component}` of {filter} is missing"));
    }
    Ok(Calibrated { filter, values })
}
