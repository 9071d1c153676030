//! What is said on standard error beside errors: warnings, remarks, details, progress; and how wide a terminal is.

use std::io::{self, IsTerminal, Write};
use std::sync::atomic::{AtomicU8, Ordering};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// How much is said.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Loudness {
    /// Warnings and errors.
    Quiet,
    /// Remarks and progress too.
    Usual,
    /// And details: what is read and written, each pass.
    Verbose,
}

/// Set once, before any work is done.
static LOUDNESS: AtomicU8 = AtomicU8::new(Loudness::Usual as u8);

/// Sets how much is said.
pub(crate) fn set(loudness: Loudness) {
    LOUDNESS.store(loudness as u8, Ordering::Relaxed);
}

fn said(loudness: Loudness) -> bool {
    LOUDNESS.load(Ordering::Relaxed) >= loudness as u8
}

/// Writes a line for people. A closed standard error is nobody's loss.
fn line(text: &str) {
    let _ = writeln!(io::stderr(), "{text}");
}

/// Says why nothing was done.
pub(crate) fn error(text: &str) {
    line(text);
}

/// Says what may make a result other than expected.
pub(crate) fn warn(text: &str) {
    line(&format!("warning: {text}"));
}

/// Says what is good to know.
pub(crate) fn remark(text: &str) {
    if said(Loudness::Usual) {
        line(text);
    }
}

/// Says what only those want to know who ask for it.
pub(crate) fn detail(text: impl FnOnce() -> String) {
    if said(Loudness::Verbose) {
        line(&text());
    }
}

/// A bar on standard error when that is a terminal, else nothing.
pub(crate) fn progress_bar(length: u64, task: &'static str) -> ProgressBar {
    let bar = ProgressBar::new(length);
    if !said(Loudness::Usual) {
        bar.set_draw_target(ProgressDrawTarget::hidden());
    }
    match ProgressStyle::with_template("{msg} {wide_bar} {percent:>3} %  {eta} left") {
        Ok(style) => bar.with_style(style).with_message(task),
        Err(_) => bar,
    }
}

/// Whether standard error may be coloured.
pub(crate) fn coloured() -> bool {
    io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

/// Columns that people see at once: of the terminal, or what COLUMNS says. None where nothing is said.
pub(crate) fn width() -> Option<usize> {
    let stated = || std::env::var("COLUMNS").ok()?.parse().ok();
    terminal_size::terminal_size().map(|(width, _)| usize::from(width.0)).or_else(stated)
}

/// Breaks lines that are wider than people see at once; what follows is indented by `indent`.
pub(crate) fn folded(text: &str, indent: usize) -> String {
    // narrower than this nothing can be read anyway
    let Some(width) = width().map(|width| width.max(indent + 20)) else { return text.to_owned() };
    let spaces = " ".repeat(indent);
    let options = textwrap::Options::new(width).subsequent_indent(&spaces);
    text.lines().map(|line| textwrap::fill(line, &options) + "\n").collect()
}
