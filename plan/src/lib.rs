//! Designs the path of a calibration: which turns and rests show a filter's parameters best in a given time.
//!
//! [`Evaluator`] says what a path will show before it is run, by one pass of the filter's covariance along the motion. [`design`] looks
//! for the path with the smallest [`Criterion`]; what the table can do is a [`Table`]. The same seed gives the same path, on any number of
//! threads: a search ends by the number of its evaluations.
//!
//! This crate does no input or output.

mod criterion;
mod draft;
mod evaluate;
mod foresight;
mod known;
mod search;
mod table;

pub use criterion::{Criterion, Group, groups};
pub use evaluate::{Evaluator, Expected, Trouble};
pub use known::{KNOWN, Known, best_known, known_paths, noise_alone};
pub use search::{Effort, Way, design, shortest};
pub use table::Table;
