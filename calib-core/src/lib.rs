//! The engine under `sinscal`: block layout, structured propagation and update, innovations, Jacobian checks.
//!
//! No allocation, no standard library, no `unsafe`. A user meets it through the `sinscal` facade and
//! `#[derive(StateBlocks)]`.
#![cfg_attr(not(feature = "std"), no_std)]

mod block;
#[cfg(feature = "check")]
pub mod check;
mod conventional;
#[doc(hidden)]
pub mod declare;
mod dynamics;
mod extended;
mod filter;
mod form;
mod kalman;
mod machine;
mod measurement;
mod observability;
mod probe;
mod real;
mod tile;
mod transition;
mod ud;
mod view;
mod vocabulary;

pub use block::{Block, Need, Relaxation, StateInfo};
pub use conventional::Conventional;
pub use dynamics::Dynamics;
pub use extended::{Counted, Extended, ExtendedView, Grown, Sizes};
pub use filter::{
    Array, CoreRows, CoreVector, Dim, Filter, Matrix, MeasurementMatrix, MeasurementRows, MeasurementVector,
    Shape, Vector,
};
pub use form::{Fade, Form, Whitened};
pub use kalman::{Innovation, Kalman, NotPositiveDefinite, Residuals, measurement_rows, relaxing};
pub use measurement::{Measurement, MeasurementInfo};
pub use observability::{Decomposition, ObservabilityRows, Triangle, system_rows};
pub use probe::{Fault, Flaw, faults, probe};
pub use real::Real;
pub use transition::Transition;
pub use ud::Ud;
pub use view::{BlockView, Entries, Estimate, View};
pub use vocabulary::{
    BlockVisitor, Leaf, considered_in, declares, first_state, leaves, relaxations, relaxes,
};
