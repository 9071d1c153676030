//! The program `sinscal` as a library: calibrates inertial measurement units from log files.
//!
//! It reads logs, calls the libraries and writes reports; it holds no mathematics of its own.
//!
//! A program of one's own has every subcommand for the filters that it declares:
//!
//! ```no_run
//! use sinscal::prelude::*;
//!
//! #[derive(StateBlocks)]
//! #[filter(name = "my-unit", measures(velocity, position))]
//! struct MyUnit {
//!     attitude: Attitude,
//!     velocity: Velocity,
//!     position: Position,
//!     gyro: GyroErrors,
//!     accel: AccelErrors,
//! }
//!
//! fn main() -> std::process::ExitCode {
//!     sinscal_cli::Program::standard().filter::<MyUnit>().run()
//! }
//! ```

mod ablate;
mod apply;
mod arguments;
mod calibrate;
mod campaign;
mod compare;
mod completions;
mod compose;
mod demo;
mod diagnose;
mod effects;
mod export;
mod filters;
mod look;
mod navigate;
mod new;
mod noise;
mod observe;
mod origin;
mod output;
mod paper;
mod plan;
mod say;
mod scenario;
mod self_test;
mod setup;
mod signals;
mod simulate;
mod source;
mod table;
mod vocabulary;

use std::io::IsTerminal;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use miette::{Diagnostic, GraphicalReportHandler, GraphicalTheme};
use runs::Vocabulary;
use sinscal::{Effect, Filter, Sizes, Strapdown};

use crate::say::Loudness;

/// What `--help` ends with.
const AFTER_HELP: &str = "\
Examples:
  sinscal demo                                        the whole story, no files needed
  sinscal simulate --out runs/unit-3 --seed 3         a log with its truth
  sinscal look runs/unit-3                            what a log holds, before anything is calibrated
  sinscal noise runs/unit-3 --out noise               noise processes in its rests
  sinscal observe runs/unit-3 --filter 43d-b          what the log can show
  sinscal calibrate runs/unit-3 --filter 43d-b --out results
  sinscal diagnose runs/unit-3 --filter 36d-p --out findings
  sinscal calibrate log.mat --filter 43d-b --map gyro=wm,accel=vm,time=t
  sinscal compare monday.json friday.json --out change
  sinscal export results/calibration.json --format c --out imu_calibration.h

Exit codes: 0 the work was done, 1 bad input or a failed run, 2 bad usage.
Results go to standard output, everything else to standard error. With --out DIR every command writes DIR/report.html, which
needs no network. NO_COLOR switches colours off.";

/// Systematic calibration of strapdown inertial navigation systems.
#[derive(Parser)]
#[command(name = "sinscal", version, about, max_term_width = 100, after_help = AFTER_HELP)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    /// Say nothing but results, warnings and errors
    #[arg(long, short, global = true)]
    quiet: bool,
    /// Say what is read and written, and how each pass went
    #[arg(long, short, global = true, conflicts_with = "quiet")]
    verbose: bool,
}

#[derive(Subcommand)]
enum Command {
    Demo(demo::Arguments),
    Look(look::Arguments),
    Noise(noise::Arguments),
    Simulate(simulate::Arguments),
    Calibrate(calibrate::Arguments),
    Diagnose(diagnose::Arguments),
    Ablate(ablate::Arguments),
    Observe(observe::Arguments),
    Navigate(navigate::Arguments),
    Apply(apply::Arguments),
    Compare(compare::Arguments),
    Export(export::Arguments),
    Campaign(campaign::Arguments),
    Paper(paper::Arguments),
    Plan(plan::Arguments),
    Filters(filters::Arguments),
    Effects(effects::Arguments),
    New(new::Arguments),
    Completions(completions::Arguments),
}

/// The program, and what can be named on its command line.
#[must_use = "`run` it"]
pub struct Program {
    vocabulary: Vocabulary,
}

impl Program {
    /// With the filters of the library.
    pub fn standard() -> Self {
        Self { vocabulary: Vocabulary::standard() }
    }

    /// And with filter `F`. It replaces one of the same name.
    pub fn filter<F: Filter<Dynamics = Strapdown, Shape: Sizes>>(mut self) -> Self {
        self.vocabulary = self.vocabulary.with_filter::<F>();
        self
    }

    /// And with effect `E`. It replaces one of the same name.
    pub fn effect<E: Effect>(mut self) -> Self {
        self.vocabulary = self.vocabulary.with_effect::<E>();
        self
    }

    /// Does what the command line says: exit code 0 when the work was done, 1 for bad input or a failed run, 2 for bad usage.
    pub fn run(self) -> ExitCode {
        if let Some(fault) = self.vocabulary.faults().first() {
            say::error(&format!("this program's own filter: {fault}"), false);
            return ExitCode::from(1);
        }
        vocabulary::set(self.vocabulary);
        run()
    }
}

fn run() -> ExitCode {
    quiet_decoder();
    signals::listen();
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(usage) => {
            let code = u8::try_from(usage.exit_code()).unwrap_or(2);
            // Nothing can be said when the terminal has gone away.
            let _ = usage.print();
            return ExitCode::from(code);
        }
    };
    say::set(match (cli.quiet, cli.verbose) {
        (true, _) => Loudness::Quiet,
        (_, true) => Loudness::Verbose,
        _ => Loudness::Usual,
    });
    let result = match cli.command {
        Command::Demo(arguments) => arguments.run(),
        Command::Look(arguments) => arguments.run(),
        Command::Noise(arguments) => arguments.run(),
        Command::Simulate(arguments) => arguments.run(),
        Command::Calibrate(arguments) => arguments.run(),
        Command::Diagnose(arguments) => arguments.run(),
        Command::Ablate(arguments) => arguments.run(),
        Command::Observe(arguments) => arguments.run(),
        Command::Navigate(arguments) => arguments.run(),
        Command::Apply(arguments) => arguments.run(),
        Command::Compare(arguments) => arguments.run(),
        Command::Export(arguments) => arguments.run(),
        Command::Campaign(arguments) => arguments.run(),
        Command::Paper(arguments) => arguments.run(),
        Command::Plan(arguments) => arguments.run(),
        Command::Filters(arguments) => arguments.run(),
        Command::Effects(arguments) => arguments.run(),
        Command::New(arguments) => arguments.run(),
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
        let theme =
            if say::coloured() { GraphicalTheme::unicode() } else { GraphicalTheme::unicode_nocolor() };
        GraphicalReportHandler::new_themed(theme).with_width(say::width().unwrap_or(80).min(110))
    } else {
        GraphicalReportHandler::new_themed(GraphicalTheme::none()).with_wrap_lines(false)
    };
    let mut text = String::new();
    if handler.with_links(false).render_report(&mut text, error).is_err() {
        text = error.to_string();
    }
    say::error(text.trim_end(), std::io::stderr().is_terminal() && say::coloured());
}

/// A panic inside the decoder of damaged files is caught and reported as what it is: it needs no message of its own.
fn quiet_decoder() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if !logs::decoding() {
            usual(panic);
        }
    }));
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    /// Every line of a text that calls the program, without what redirects or explains.
    fn calls(text: &str) -> impl Iterator<Item = Vec<&str>> {
        text.lines().filter_map(|line| {
            let call = line.trim().strip_prefix("sinscal ")?;
            let words = call.split("  ").next()?;
            Some(std::iter::once("sinscal").chain(words.split_whitespace()).collect())
        })
    }

    fn check(command: &clap::Command, path: &str) {
        let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
        assert!(
            calls(&help).count() > 0 || ["filters", "effects", "merge", "help"].contains(&command.get_name()),
            "{path}: its help has no example"
        );
        for call in calls(&help) {
            assert!(Cli::try_parse_from(&call).is_ok(), "{path}: {call:?}");
        }
        for inner in command.get_subcommands() {
            check(inner, &format!("{path} {}", inner.get_name()));
        }
    }

    #[test]
    fn every_example_in_a_help_is_understood() {
        let command = Cli::command();
        command.clone().debug_assert();
        check(&command, "sinscal");
    }
}
