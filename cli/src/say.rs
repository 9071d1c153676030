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

/// A longer line is cut in its middle, characters: its beginning says where, its end what would be right.
const LONGEST_LINE: usize = 4000;

/// A text that may hold names out of files, as it can be shown: what would steer a terminal or break a line stands escaped, and a
/// line has an end. Colours stay where there are any.
pub(crate) fn harmless(text: &str, coloured: bool) -> String {
    let mut shown = String::with_capacity(text.len());
    for (i, line) in text.split('\n').enumerate() {
        if i > 0 {
            shown.push('\n');
        }
        let line: Vec<char> = line.strip_suffix('\r').unwrap_or(line).chars().collect();
        let more = line.len().saturating_sub(LONGEST_LINE);
        if more == 0 {
            escape(&line, coloured, &mut shown);
        } else {
            let end = LONGEST_LINE / 4;
            escape(&line[..LONGEST_LINE - end], coloured, &mut shown);
            shown += &format!(" ... ({more} characters left out) ... ");
            escape(&line[line.len() - end..], coloured, &mut shown);
        }
    }
    shown
}

/// Adds a part of a line without what steers a terminal; a sequence of colours is told by its form, `ESC [ digits m`.
fn escape(mut rest: &[char], coloured: bool, shown: &mut String) {
    let steers = |c: char| {
        c.is_control()
            || matches!(c, '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    while let [first, after @ ..] = rest {
        let digits = after.iter().skip(1).take_while(|c| c.is_ascii_digit() || **c == ';').count();
        let colour = *first == '\u{1b}' && after.first() == Some(&'[') && after.get(1 + digits) == Some(&'m');
        if coloured && colour {
            shown.push(*first);
        } else if steers(*first) && *first != '\t' {
            shown.extend(first.escape_default());
        } else {
            shown.push(*first);
        }
        rest = after;
    }
}

/// Writes a line for people. A closed standard error is nobody's loss.
fn line(text: &str) {
    let _ = writeln!(io::stderr(), "{}", harmless(text, false));
}

/// Says why nothing was done, in colours or not.
pub(crate) fn error(text: &str, coloured: bool) {
    let _ = writeln!(io::stderr(), "{}", harmless(text, coloured));
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_out_of_files_steer_nothing() {
        assert_eq!(
            harmless("log\u{1b}[2J\u{7}.csv:\tgone\nnext", false),
            "log\\u{1b}[2J\\u{7}.csv:\tgone\nnext"
        );
        let colours = "\u{1b}[38;2;1m\u{1b}[0mx\u{1b}]0;title";
        assert_eq!(harmless(colours, true), "\u{1b}[38;2;1m\u{1b}[0mx\\u{1b}]0;title");
        assert!(!harmless(colours, false).contains('\u{1b}'));
        assert_eq!(harmless("a\u{2028}b\u{202e}c", false), "a\\u{2028}b\\u{202e}c");
    }

    #[test]
    fn a_line_has_an_end() {
        let long = format!("log.csv: {} was expected", "x".repeat(1_000_000));
        let shown = harmless(&long, false);
        assert!(shown.len() < LONGEST_LINE + 100 && shown.starts_with("log.csv: x"), "{}", shown.len());
        assert!(shown.ends_with("x was expected") && shown.contains("996022 characters left out"));
    }
}
