//! Tests that run the built program.

mod broken_inputs;
mod coarse;
mod commands;
mod experiments;
mod outside_logs;
mod simulate;
mod support;
