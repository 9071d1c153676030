//! Simulates a strapdown inertial unit on a turntable: motion, sensors with every effect of the catalogue, surroundings.
//!
//! A [`Scenario`] says what is simulated, a seed which unit of its population. [`Simulation`] is an iterator over the samples of
//! the log, in memory that does not grow with its length; its [`truth`](Simulation::truth) and
//! [`description`](Simulation::description) give the files that go beside the table.
//!
//! ```
//! use rig::{Scenario, Simulation};
//!
//! let scenario = Scenario::parse("[motion]\npath = \"still\"\nduration = \"10 s\"")?;
//! let simulation = Simulation::new(&scenario, 1)?;
//! println!("{}{}", simulation.description().to_toml(), simulation.truth().to_json());
//! assert_eq!(simulation.count(), 500);
//! # Ok::<(), rig::ScenarioError>(())
//! ```
//!
//! What a program does with it: print [`DEFAULT_SCENARIO`], or [`Scenario::parse`] a file (a [`ScenarioError`] lists every [`Fault`] with
//! its field, line, bytes and what is accepted), [`Scenario::with_rate`] where a rate is asked for, [`Simulation::new`] with the
//! seed; then write `to_toml`, `to_json` and the samples, row by row. The columns of the reference belong in the table
//! when [`Description::readings`] says so, its attitude when [`Description::attitude`] does, the dither's when [`Description::dither`]
//! does; absent readings are NaN.
//!
//! This crate does no input or output. It knows effects as objects ([`AnyEffect`](sinscal::AnyEffect)), those of the catalogue and
//! your own ([`Scenario::parse_with`]), and shares no other code with the filters but the Earth and the types of a sample.

mod ahead;
pub mod analyses;
mod description;
mod dither;
mod environment;
mod mechanics;
pub mod motion;
mod noise;
pub mod random;
pub mod scenario;
mod sensors;
mod simulate;
mod truth;

pub use ahead::Ahead;
pub use description::Description;
pub use dither::DitherMotion;
pub use environment::{Amplitudes, TemperaturePlan, TemperatureProfile};
pub use mechanics::{Felt, Place};
pub use noise::NoiseFigures;
pub use scenario::{DEFAULT_SCENARIO, DitherMode, DitherPlan, Fault, Scenario, ScenarioError};
pub use sensors::size_effect;
pub use simulate::Simulation;
pub use truth::Truth;
