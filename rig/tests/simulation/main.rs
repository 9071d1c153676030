//! Simulated logs as a whole: what filters make of them, that they repeat, that they agree with the physics.

mod common;
mod determinism;
mod dither;
mod fuzz;
mod increments;
mod nees;
mod noise;
mod outliers;
mod round_trip;
mod scenario;
mod soak;
mod speed;
