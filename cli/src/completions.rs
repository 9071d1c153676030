//! `sinscal completions`: what a shell needs to complete arguments.

use clap::{Args, CommandFactory};
use clap_complete::Shell;
use miette::Result;

use crate::output;

/// What its help ends with.
const EXAMPLES: &str = "\
Examples:
  sinscal completions bash";

/// Print what a shell needs to complete arguments, to be put where it looks for that
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The shell
    shell: Shell,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<()> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut crate::Cli::command(), "sinscal", &mut script);
        output::print(&String::from_utf8_lossy(&script))
    }
}
