//! Experiments over many simulated units.
//!
//! A [`Plan`] says what is done with each unit: it is put through the calibration path, every filter calibrates it, and
//! with each calibration it navigates freely while it swings. [`Plan::unit`] does that for one unit, whose numbers depend
//! on nothing but plan and unit: any number of them may run at once, in any order, on any machine. [`Summary::new`] makes the
//! statistics of many.
//!
//! This crate does no input or output.

pub mod compare;
mod map;
mod plan;
pub mod statistics;
mod summary;
mod unit;

pub use map::{Cell, Sizes};
pub use plan::{Plan, Trouble};
pub use summary::{FilterSummary, ParameterSummary, Percentiles, Summary};
pub use unit::{FilterResult, ParameterResult, Traced, UnitResult};
