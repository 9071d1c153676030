//! The program `sinscal`: calibrates inertial measurement units from log files.
//!
//! It reads logs, calls the library `sinscal` and writes reports; it holds no mathematics of its own.
//! Exit codes: 0 when the work was done, 1 for bad input or a failed run, 2 for bad usage.

mod ablate;
mod broadcast;
mod calibrate;
mod campaign;
mod completions;
mod demo;
mod diagnose;
mod draw;
mod effects;
mod export;
mod figures;
mod filters;
mod history;
mod log;
mod navigate;
mod observe;
mod output;
mod paper;
mod report;
mod scenario;
mod self_test;
mod setup;
mod simulate;

use std::io::IsTerminal;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use miette::{Diagnostic, GraphicalReportHandler, GraphicalTheme};

/// What `--help` ends with.
const AFTER_HELP: &str = "\
Examples:
  sinscal demo                                        the whole story, no files needed
  sinscal simulate --out runs/unit-3 --seed 3         a log with its truth
  sinscal observe runs/unit-3 --filter 43d-b          what the log can show
  sinscal calibrate runs/unit-3 --filter 43d-b --out results
  sinscal diagnose runs/unit-3 --filter 36d-p --out findings
  sinscal calibrate log.mat --filter 43d-b --map gyro=wm,accel=vm,time=t
  sinscal export results/calibration.json --format c --out imu_calibration.h

Exit codes: 0 the work was done, 1 bad input or a failed run, 2 bad usage.
With --out DIR every command writes DIR/report.html, which needs no network. NO_COLOR switches colours off.";

/// Systematic calibration of strapdown inertial navigation systems.
#[derive(Parser)]
#[command(name = "sinscal", version, about, max_term_width = 100, after_help = AFTER_HELP)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Demo(demo::Arguments),
    Simulate(simulate::Arguments),
    Calibrate(calibrate::Arguments),
    Diagnose(diagnose::Arguments),
    Ablate(ablate::Arguments),
    Observe(observe::Arguments),
    Navigate(navigate::Arguments),
    Export(export::Arguments),
    Campaign(campaign::Arguments),
    Paper(paper::Arguments),
    Filters(filters::Arguments),
    Effects(effects::Arguments),
    Completions(completions::Arguments),
}

fn main() -> ExitCode {
    quiet_decoder();
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(usage) => {
            let code = u8::try_from(usage.exit_code()).unwrap_or(2);
            // Nothing can be said when the terminal has gone away.
            let _ = usage.print();
            return ExitCode::from(code);
        }
    };
    let result = match cli.command {
        Command::Demo(arguments) => arguments.run(),
        Command::Simulate(arguments) => arguments.run(),
        Command::Calibrate(arguments) => arguments.run(),
        Command::Diagnose(arguments) => arguments.run(),
        Command::Ablate(arguments) => arguments.run(),
        Command::Observe(arguments) => arguments.run(),
        Command::Navigate(arguments) => arguments.run(),
        Command::Export(arguments) => arguments.run(),
        Command::Campaign(arguments) => arguments.run(),
        Command::Paper(arguments) => arguments.run(),
        Command::Filters(arguments) => arguments.run(),
        Command::Effects(arguments) => arguments.run(),
        Command::Completions(arguments) => arguments.run(),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            complain(error.as_ref());
            ExitCode::from(1)
        }
    }
}

/// Shows an error on standard error: with colours and a frame on a terminal, as plain unbroken lines elsewhere.
fn complain(error: &dyn Diagnostic) {
    let handler = if std::io::stderr().is_terminal() {
        let colours = std::env::var_os("NO_COLOR").is_none();
        let theme = if colours { GraphicalTheme::unicode() } else { GraphicalTheme::unicode_nocolor() };
        GraphicalReportHandler::new_themed(theme).with_width(110)
    } else {
        GraphicalReportHandler::new_themed(GraphicalTheme::none()).with_wrap_lines(false)
    };
    let mut text = String::new();
    if handler.with_links(false).render_report(&mut text, error).is_err() {
        text = error.to_string();
    }
    output::remark(text.trim_end());
}

/// A panic inside the decoder of damaged files is caught and reported as what it is: it needs no message of its own.
fn quiet_decoder() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if !log::decoding() {
            usual(panic);
        }
    }));
}
