//! Blind trials: simulated units with something hidden, drawn by seed, and how the diagnosis of each is scored.

mod case;
mod grade;

pub use case::{Case, Hidden};
pub use grade::{Grade, Table};
use rig::ScenarioError;
use serde::Serialize;

use crate::{Error, Options, Verdict};

/// What became of one case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Trial {
    /// What the case was drawn from.
    pub seed: u64,
    /// The filter that was diagnosed.
    pub filter: &'static str,
    /// What was hidden, in words.
    pub hidden: String,
    /// The row of the table it counts in.
    pub kind: &'static str,
    /// How the diagnosis did.
    pub grade: Grade,
    /// Its verdict.
    pub verdict: Verdict,
    /// Its sentence.
    pub sentence: String,
    /// Of a single effect: the number of standard deviations at which it shows to the filter.
    pub strength: Option<f64>,
    /// For a right name: squared error over covariance of what was estimated, and its degrees of freedom.
    pub nees: Option<(f64, usize)>,
}

/// Why a trial could not be made.
#[derive(Debug, thiserror::Error)]
pub enum TrialError {
    /// The rig refused a scenario.
    #[error("case {seed}: {source}")]
    Scenario {
        /// Of which case.
        seed: u64,
        /// Why.
        source: ScenarioError,
    },
    /// The diagnosis failed.
    #[error("case {seed}: {source}")]
    Diagnosis {
        /// Of which case.
        seed: u64,
        /// Why.
        source: Error,
    },
}

/// Draws the case of a seed, diagnoses it and scores the diagnosis.
///
/// # Errors
/// When the case cannot be simulated or diagnosed; either would be a fault of this crate.
pub fn trial(seed: u64, options: &Options) -> Result<Trial, TrialError> {
    let case = Case::draw(seed).map_err(|source| TrialError::Scenario { seed, source })?;
    let d = case.diagnose(options).map_err(|source| TrialError::Diagnosis { seed, source })?;
    Ok(Trial {
        seed,
        filter: case.filter,
        hidden: case.hidden.to_string(),
        kind: case.hidden.kind(),
        grade: case.grade(&d),
        verdict: d.verdict,
        strength: case.strength(&d),
        nees: case.nees(&d),
        sentence: d.sentence,
    })
}
