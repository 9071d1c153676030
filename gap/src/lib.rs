//! Finds the effect that a calibration filter lacks.

#[cfg(feature = "blind")]
pub mod blind;
mod candidates;
mod chi2;
mod decide;
mod declaration;
mod diagnose;
mod dictionary;
mod excite;
mod linear;
mod locate;
mod name;
mod noise;
mod open;
mod prices;
mod random;
mod recording;
mod report;
mod run;
mod say;
mod scene;
mod threshold;
mod verify;

pub use candidates::{CandidateStates, Candidates};
pub use chi2::ln_survival;
pub use declaration::{BaseFilter, declaration};
pub use diagnose::{Error, Options, diagnose, diagnose_named, diagnose_with};
pub use linear::Noise;
pub use recording::{Column, Recording};
pub use report::{Diagnosis, Evidence, FoundEffect, Gap, LogGap, NoiseScale, Place, Rival, Verdict};
pub use run::Log;
