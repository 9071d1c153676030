//! A log as the library's runs read it: anew for each pass, decoded ahead in a thread of its own.

use core::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};

use indicatif::ProgressBar;
use logs::{Bridged, Log, LogError};
use miette::{Report, miette};
use runs::{Look, ReadError, Samples};
use sinscal::Sample;

use crate::calibrate::text::oddities;
use crate::say;

/// What to look at when a filter breaks down over a log whose every row is plausible.
const DIVERGED: &str = "look at that time in the log; and at [prior] and [initial] of its description: a sigma that is far too wide \
                        leaves the arithmetic no digits, one far too small no room, and quaternions go w, x, y, z";

/// A log with a bar that shows how far reading has come.
pub(crate) struct Source<'a> {
    log: &'a Log,
    bar: ProgressBar,
    /// Gaps that were filled in the last pass.
    bridged: Mutex<Bridged>,
}

impl<'a> Source<'a> {
    /// The log, to be read for `task`.
    pub(crate) fn new(log: &'a Log, task: &'static str) -> Self {
        Self { log, bar: say::progress_bar(log.size(), task), bridged: Mutex::default() }
    }

    /// The log, read by somebody who has a bar of his own.
    pub(crate) fn silent(log: &'a Log) -> Self {
        Self { log, bar: ProgressBar::hidden(), bridged: Mutex::default() }
    }

    /// What was put into gaps in the last pass.
    pub(crate) fn bridged(&self) -> Bridged {
        *self.bridged.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Source<'_> {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

impl Samples for Source<'_> {
    fn read(&self, visit: &mut dyn FnMut(&[Sample]) -> ControlFlow<()>) -> Result<(), ReadError> {
        for chunk in self.log.ahead()? {
            let chunk = chunk?;
            if visit(&chunk.samples).is_break() {
                break;
            }
            self.bar.set_position(chunk.position);
            *self.bridged.lock().unwrap_or_else(PoisonError::into_inner) = chunk.bridged;
        }
        Ok(())
    }
}

/// What is wrong with a log, or with a run over it, for people.
pub(crate) fn fault(log: &Log, error: runs::Error) -> Report {
    let table = log.table().display();
    match error {
        runs::Error::Unreadable(source) => unreadable(log, source),
        runs::Error::Diverged { .. } => {
            // what the samples themselves show is the likelier cause
            let mut look = Look::default();
            let read = log.samples().map(|samples| samples.map_while(Result::ok).for_each(|s| look.push(&s)));
            let mut odd = if read.is_ok() { oddities(&look, true) } else { Vec::new() };
            odd.push(DIVERGED.to_owned());
            miette!(help = odd.join("; "), "{table}: {error}")
        }
        runs::Error::NoUpdate { .. } => miette!(
            help = "`sinscal filters` says what each filter measures; ref_vel_*, ref_pos_* and ref_quat_* are the columns",
            "{table}: {error}"
        ),
        error => miette!("{table}: {error}"),
    }
}

/// Why a log could not be read.
pub(crate) fn unreadable(log: &Log, source: ReadError) -> Report {
    match source.downcast::<LogError>() {
        Ok(fault) => (*fault).into(),
        Err(other) => miette!("{}: {other}", log.table().display()),
    }
}
