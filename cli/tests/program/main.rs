//! Tests that run the built program.

mod apply;
#[cfg(target_os = "linux")]
mod bombs;
mod broken_inputs;
mod browser;
mod coarse;
mod commands;
mod compare;
mod determinism;
mod experiments;
mod export;
mod golden;
mod guide;
mod honest;
mod hostile;
mod inputs_stay;
mod kills;
mod laws;
mod manners;
mod memory;
mod missing_effects;
mod noise;
mod other_inputs;
mod outside_logs;
mod own_project;
mod plan;
mod rests;
mod simulate;
mod support;
mod walk;
mod wrong_files;
mod wrong_units;
