//! Simulated logs as a whole: what filters make of them, that they repeat, that they agree with the physics.

mod common;
mod determinism;
mod dither;
mod increments;
mod nees;
mod round_trip;
mod scenario;
mod speed;
