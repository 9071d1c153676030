//! The calibrations that are compared.

use std::path::{Path, PathBuf};

use miette::Result;
use serde::Serialize;
use sinscal::StateInfo;
use study::compare::Estimate;

use crate::navigate::read as calibration;

/// A calibration, and where it comes from.
#[derive(Serialize)]
pub(super) struct Calibration {
    /// By which it is called: A, B, C.
    pub(super) letter: char,
    #[serde(rename = "file")]
    pub(super) path: PathBuf,
    pub(super) filter: String,
    pub(super) log: Option<String>,
    pub(super) verdict: Option<String>,
    pub(super) duration_s: Option<f64>,
    pub(super) reference_temperature_c: Option<f64>,
    /// Its parameters; nothing where the log says less than the prior.
    #[serde(skip)]
    pub(super) estimates: Vec<(StateInfo, Option<Estimate>)>,
}

/// Reads the calibration at `place` in the order of the command line.
pub(super) fn read(path: &Path, place: usize) -> Result<Calibration> {
    let (calibrated, document) = calibration::read(path)?;
    let known = calibrated.filter.parameters();
    let mut estimates = Vec::new();
    for (index, (name, component, value)) in calibrated.values.iter().enumerate() {
        let info = known.iter().find(|info| info.block == *name && info.component == *component);
        let Some(info) = info else { continue };
        let estimate = match value {
            Some(value) => {
                Some(Estimate { value: *value, sigma: calibration::sigma(path, &document, index)? })
            }
            None => None,
        };
        estimates.push((*info, estimate));
    }
    let text = |field: &str| document[field].as_str().map(str::to_owned);
    Ok(Calibration {
        letter: ('A'..='Z').nth(place).unwrap_or('?'),
        path: path.to_owned(),
        filter: calibrated.filter.title(),
        log: text("log"),
        verdict: text("verdict"),
        duration_s: document["duration_s"].as_f64(),
        reference_temperature_c: calibrated.reference_temperature,
        estimates,
    })
}

/// What must be known before differences are read.
pub(super) fn notes(all: &[Calibration]) -> Vec<String> {
    let mut notes = Vec::new();
    for (i, one) in all.iter().enumerate() {
        if one
            .verdict
            .as_deref()
            .is_some_and(|verdict| ["does-not-fit", "passes-disagree"].contains(&verdict))
        {
            notes.push(format!(
                "{}: its filter does not fit its log ({}), so that its sigmas are too small and differences too large",
                one.letter,
                one.verdict.as_deref().unwrap_or_default()
            ));
        }
        for other in &all[i + 1..] {
            if one.log.is_some() && one.log == other.log {
                notes.push(format!(
                    "{} and {} name the same log ({}): their noise is shared, and what differs is due to the filters",
                    one.letter,
                    other.letter,
                    one.log.as_deref().unwrap_or_default()
                ));
            }
        }
        let Some(first) = all.first().filter(|first| i > 0 && first.filter != one.filter) else { continue };
        notes.push(format!(
            "{} is by {}, {} by {}: what one of them lacks is in the other's estimates",
            first.letter, first.filter, one.letter, one.filter
        ));
    }
    let temperatures: Vec<(char, f64)> =
        all.iter().filter_map(|one| Some((one.letter, one.reference_temperature_c?))).collect();
    if let Some((first, others)) = temperatures.split_first()
        && let Some(other) = others.iter().find(|other| other.1 != first.1)
    {
        notes.push(format!(
            "reference temperatures differ ({} in {}, {} degC in {}): what goes with temperature stands for another one there",
            first.1, first.0, other.1, other.0
        ));
    }
    notes
}
