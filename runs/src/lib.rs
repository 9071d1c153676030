//! What can be done with any declared filter over a log, whatever its sizes: one driver for every command.
//!
//! [`AnyFilter`] is the object-safe face of a declaration; every `F: Filter<Dynamics = Strapdown>` has it as
//! [`Declared<F>`](Declared). A [`Vocabulary`] holds the filters that can be named: those of the library, and those that a program
//! adds. [`calibrate`] drives one or several of them over the passes of a log that is read anew for each
//! ([`Samples`]); what comes of each is an [`Outcome`], which [`judges itself`](Outcome::verdict). [`observe`] says what a
//! log can show, [`navigate`] what a calibration is worth.
//!
//! ```
//! use runs::{Options, Vocabulary, calibrate};
//! # fn with(samples: &Vec<sinscal::Sample>, setup: &sinscal::Setup) -> Result<(), runs::Error> {
//! let vocabulary = Vocabulary::standard();
//! let filter = vocabulary.filter("43d-b")?;
//! let outcome = calibrate(&*filter, samples, setup, &Options::of(&*filter), &mut ())?;
//! println!("{}", outcome.verdict());
//! # Ok(())
//! # }
//! ```
//!
//! This crate knows no file of a log and no simulator: samples come from whatever implements [`Samples`].

mod channels;
mod compiled;
mod compose;
mod driver;
mod error;
mod filter;
mod history;
mod look;
mod navigate;
mod observe;
mod outcome;
mod pool;
mod refusals;
mod running;
mod samples;
mod tape;
mod trace;
mod vocabulary;

pub use channels::Channels;
pub use compiled::{About, Compiled, Selection};
pub use compose::{ComposeError, Composition};
pub use driver::{Watch, calibrate, calibrate_all};
pub use error::Error;
pub use filter::{AnyFilter, Declared, Leaf, Pool};
pub use history::History;
pub use look::{Look, Saturated};
pub use navigate::{Calibrated, Flight, Values, navigate};
pub use observe::{Analysis, SPANS, State, observe};
pub use outcome::{Evidence, Outcome, Verdict, judge};
pub use refusals::Stretch;
pub use running::{Form, Options, Running};
pub use samples::{Extent, ReadError, Samples, each, extent};
pub use trace::{Measured, Moved, Row, Trace, Traced};
pub use vocabulary::Vocabulary;
