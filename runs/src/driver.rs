//! The one driver: filters over the passes of a log.

use core::ops::ControlFlow;

use rayon::prelude::*;
use sinscal::{Sample, Setup, Statistics};

use crate::Error;
use crate::budget::budget;
use crate::consider;
use crate::filter::AnyFilter;
use crate::outcome::Outcome;
use crate::running::{Options, Running};
use crate::samples::Samples;
use crate::settle;

/// Samples handed over at a time when several filters run: enough to make a thread's while, few enough to stay in the cache.
const CHUNK: usize = 8192;

/// Is told how passes go. `()` does not listen.
pub trait Watch {
    /// A pass of a filter has ended.
    fn pass(&mut self, filter: &str, pass: u32, of: u32, statistics: &Statistics) {
        let _ = (filter, pass, of, statistics);
    }
}

impl Watch for () {}

/// Runs a filter over a log. With [`Options::settle`] and more than one pass, what a pass finds is kept only if it is better.
///
/// # Errors
/// When the log cannot be read, the filter diverges, or no reading was of what it measures.
pub fn calibrate(
    filter: &dyn AnyFilter,
    samples: &dyn Samples,
    setup: &Setup,
    options: &Options,
    watch: &mut dyn Watch,
) -> Result<Outcome, Error> {
    if options.settle && options.passes > 1 {
        if !filter.considers().is_empty() {
            return consider::calibrate(filter, samples, setup, options, watch);
        }
        return settle::calibrate(filter, samples, setup, options, watch);
    }
    let mut outcomes = calibrate_all(&[filter], samples, setup, options, watch)?;
    outcomes.pop().ok_or_else(|| no_update(filter))
}

/// Runs several filters over a log, which is read once for each pass; the filters work in parallel. Each gets every sample in
/// order: what it finds does not depend on the number of threads.
///
/// # Errors
/// When the log cannot be read, a filter diverges, or one had no reading of what it measures.
pub fn calibrate_all(
    filters: &[&dyn AnyFilter],
    samples: &dyn Samples,
    setup: &Setup,
    options: &Options,
    watch: &mut dyn Watch,
) -> Result<Vec<Outcome>, Error> {
    let mut runs: Vec<Box<dyn Running>> = filters.iter().map(|filter| filter.start(setup, options)).collect();
    let passes = options.passes.max(1);
    for pass in 1..=passes {
        for run in &mut runs {
            run.begin_pass(pass == passes)?;
        }
        feed(filters, &mut runs, samples)?;
        for (filter, run) in filters.iter().zip(&runs) {
            watch.pass(&filter.title(), pass, passes, run.statistics());
        }
    }
    let mut outcomes = Vec::with_capacity(runs.len());
    for (filter, run) in filters.iter().zip(runs) {
        let mut outcome = run.finish()?;
        if outcome.statistics.updates == 0 {
            return Err(no_update(*filter));
        }
        let considered = filter.considers();
        if !considered.is_empty() {
            outcome.budget = budget(&outcome, &considered);
        }
        outcomes.push(outcome);
    }
    Ok(outcomes)
}

pub(crate) fn no_update(filter: &dyn AnyFilter) -> Error {
    Error::NoUpdate { filter: filter.title(), measures: filter.measures().join(" and ") }
}

/// Gives every sample to every run.
pub(crate) fn feed(
    filters: &[&dyn AnyFilter],
    runs: &mut [Box<dyn Running>],
    samples: &dyn Samples,
) -> Result<(), Error> {
    let diverged = |filter: &&dyn AnyFilter| {
        let filter = filter.title();
        move |diverged| Error::Diverged { filter, diverged }
    };
    let mut all = |samples: &[Sample]| {
        if let ([filter], [run]) = (filters, &mut *runs) {
            return run.feed(samples).map_err(diverged(filter));
        }
        filters
            .par_iter()
            .zip(&mut *runs)
            .try_for_each(|(filter, run)| run.feed(samples).map_err(diverged(filter)))
    };
    // one filter takes what comes as it comes
    let least = if filters.len() > 1 { CHUNK } else { 0 };
    let mut waiting: Vec<Sample> = Vec::new();
    let mut fault = None;
    samples.read(&mut |samples| {
        let done = if samples.len() >= least && waiting.is_empty() {
            all(samples)
        } else {
            waiting.extend_from_slice(samples);
            if waiting.len() < least {
                return ControlFlow::Continue(());
            }
            let done = all(&waiting);
            waiting.clear();
            done
        };
        match done {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => {
                fault = Some(error);
                ControlFlow::Break(())
            }
        }
    })?;
    match fault {
        Some(error) => Err(error),
        None => all(&waiting),
    }
}
