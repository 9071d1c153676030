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

mod budget;
mod channels;
mod compiled;
mod compose;
mod consider;
mod driver;
mod error;
mod filter;
mod foresee;
mod history;
mod look;
mod navigate;
mod observe;
mod outcome;
mod pool;
mod posterior;
pub mod products;
mod refusals;
mod repeat;
mod running;
mod samples;
mod scores;
mod settle;
mod start;
mod tape;
mod timing;
mod together;
mod trace;
mod vocabulary;

pub use budget::Budget;
pub use channels::Channels;
pub use compiled::{About, Compiled, Selection};
pub use compose::{ComposeError, Composition, considering, wandering};
pub use consider::{Exact, exact, influences};
pub use driver::{Watch, calibrate, calibrate_all};
pub use error::Error;
pub use filter::{AnyFilter, Declared, Leaf, Pool};
pub use foresee::Piece;
pub use history::History;
pub use look::{Look, Saturated};
pub use navigate::{Calibrated, Flight, Values, navigate};
pub use observe::{Analysis, SPANS, State, observe};
pub use outcome::{Evidence, Outcome, Pass, Verdict, judge};
pub use refusals::Stretch;
pub use repeat::{Repeat, Scatter};
pub use running::{Form, Options, Running};
pub use samples::{Extent, ReadError, Samples, each, extent, site_shown};
pub use timing::Timing;
pub use together::Together;
pub use trace::{Measured, Moved, Row, Trace, Traced};
pub use vocabulary::Vocabulary;
