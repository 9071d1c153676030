//! Tests that run the built program.

mod broken_inputs;
mod coarse;
mod commands;
mod determinism;
mod experiments;
mod golden;
mod kills;
mod memory;
mod other_inputs;
mod outside_logs;
mod simulate;
mod support;
mod wrong_files;
mod wrong_units;
