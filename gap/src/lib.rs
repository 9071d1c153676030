//! Finds the effect that a calibration filter lacks: where prediction and measurement disagree, which effect is missing, and
//! whether adding it shrinks the gap on data that was not used to choose it.
//!
//! [`diagnose`] is the whole workflow; it does no input or output: samples come from whatever implements [`runs::Samples`]. A log is run closed loop with every effect of the
//! catalogue in the filter, and recorded once about that trajectory. From there everything is linear: the noise is fitted,
//! every effect and every set of effects is priced from one run (Friedland's separate bias, exact), thresholds are
//! simulated, the smallest adequate set is named and put to a second log, and what no effect explains is compared with a
//! dictionary of products of what was measured. What was named is then added and really run.
//!
//! ```no_run
//! use gap::{Log, Options, diagnose};
//! use runs::Vocabulary;
//! # fn with(samples: &Vec<sinscal::Sample>, setup: &sinscal::Setup) -> Result<(), gap::Error> {
//! let log = Log { samples, setup };
//! let vocabulary = Vocabulary::standard();
//! let filter = vocabulary.filter("36d-p").expect("a filter of the library");
//! let found = diagnose(&*filter, vocabulary.effects(), &[log], None, &Options::default(), &mut |stage, done| {
//!     eprintln!("{:3.0} % {stage}", 100.0 * done);
//! })?;
//! println!("{}", found.sentence);
//! # Ok(())
//! # }
//! ```

#[cfg(feature = "blind")]
pub mod blind;
mod candidates;
mod chain;
mod chi2;
mod decide;
mod declaration;
mod diagnose;
mod dictionary;
mod error;
mod excite;
mod linear;
mod locate;
mod log;
#[cfg(feature = "blind")]
pub mod menu;
mod name;
mod neighbours;
mod noise;
mod open;
mod parallel;
mod partial;
mod prices;
mod pricing;
mod random;
mod recording;
mod report;
mod rerun;
mod review;
mod run;
mod say;
mod scan;
mod scene;
mod shifted;
mod taken;
#[cfg(test)]
mod tests;
mod threshold;
mod verify;
mod white;

pub use chi2::ln_survival;
pub use declaration::{BaseFilter, USED_BY_LAWS, block, declaration, fields, type_name};
pub use diagnose::{Options, diagnose};
pub use error::{Error, Which};
pub use linear::Noise;
pub use log::Log;
pub use pricing::Pricing;
pub use report::{
    Diagnosis, Evidence, FoundEffect, FoundLaw, Gap, Horizontal, LogGap, NoiseScale, Place, Remainder, Rival,
    Verdict,
};
