//! Tests that run the built program.

mod broken_inputs;
mod commands;
mod outside_logs;
mod support;
