//! A start from the data where the heading is unknown: a filter that is linearised about a wrong one never comes back, so several are
//! tried on the first part of the log, and the one that explains it best is where the run begins.

use core::f64::consts::PI;
use core::ops::ControlFlow;

use nalgebra::{UnitQuaternion, Vector3};
use sinscal::{InitialAttitude, Setup};

use crate::Error;
use crate::filter::AnyFilter;
use crate::running::Options;
use crate::samples::Samples;
use crate::scores::START;

/// A heading known no better than this is sought, rad.
const UNKNOWN: f64 = PI / 6.0;
/// So many are tried, all around...
const HEADINGS: u32 = 12;
/// ...each taken to be known as well as this, rad...
const KNOWN: f64 = PI / 9.0;
/// ...over so much of the log after the first reading, s.
const TRIED: f64 = 180.0;
/// The best must be better than those that are not its neighbours by so much log-likelihood.
const CLEAR: f64 = 5.0;
/// A start that was moved is taken to be known to so many of its standard deviations.
const WITHIN: f64 = 4.0;

/// Attitude at the first sample, as the data have it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Start {
    initial: InitialAttitude,
}

impl Start {
    /// The heading that explains the first part of a log best; nothing where it is known, or where the reference never moves and shows none.
    pub(crate) fn find(
        filter: &dyn AnyFilter,
        samples: &dyn Samples,
        setup: &Setup,
        options: &Options,
    ) -> Result<Option<Self>, Error> {
        if setup.initial.heading_sigma < UNKNOWN {
            return Ok(None);
        }
        let mut found = Vec::new();
        for k in 0..HEADINGS {
            let by = UnitQuaternion::from_scaled_axis(
                Vector3::z() * (2.0 * PI * f64::from(k) / f64::from(HEADINGS)),
            );
            let initial = InitialAttitude {
                attitude: by * setup.initial.attitude,
                heading_sigma: KNOWN,
                ..setup.initial
            };
            let Some(log_likelihood) = explains(filter, samples, &Setup { initial, ..*setup }, options)?
            else {
                return Ok(None);
            };
            found.push((Self { initial }, log_likelihood));
        }
        let best = (0..found.len()).max_by(|a, b| found[*a].1.total_cmp(&found[*b].1)).unwrap_or(0);
        let is_apart = |k: usize| !matches!(k.abs_diff(best), 0 | 1 | 11);
        let others = (0..found.len()).filter(|k| is_apart(*k)).map(|k| found[k].1);
        let next = others.fold(f64::NEG_INFINITY, f64::max);
        Ok((found[best].1 > next + CLEAR).then_some(found[best].0))
    }

    /// A setup that begins there.
    pub(crate) fn within<'a>(&self, setup: &Setup<'a>) -> Setup<'a> {
        Setup { initial: self.initial, ..*setup }
    }

    /// From there to the attitude of a setup, as an attitude error, and its standard deviations, rad.
    pub(crate) fn to_prior(self, setup: &Setup) -> ([f64; START], [f64; START]) {
        let there = &setup.initial;
        let turn = (there.attitude * self.initial.attitude.inverse()).scaled_axis();
        (turn.into(), [there.level_sigma, there.level_sigma, there.heading_sigma])
    }

    /// Takes out an attitude error that is known to `sigmas`, rad.
    pub(crate) fn correct(&mut self, by: &[f64; START], sigmas: &[f64; START]) {
        let initial = &mut self.initial;
        initial.attitude = UnitQuaternion::from_scaled_axis(Vector3::from(*by)) * initial.attitude;
        initial.level_sigma = initial.level_sigma.min(WITHIN * sigmas[0].max(sigmas[1]));
        initial.heading_sigma = initial.heading_sigma.min(WITHIN * sigmas[2]);
    }
}

/// How well a filter that begins so explains the first part of a log; nothing where the reference never moves.
fn explains(
    filter: &dyn AnyFilter,
    samples: &dyn Samples,
    setup: &Setup,
    options: &Options,
) -> Result<Option<f64>, Error> {
    let mut run = filter.start(setup, &Options { smooth: false, residuals: false, ..options.clone() });
    run.begin_pass(false)?;
    let mut until = f64::INFINITY;
    let mut survives = true;
    samples.read(&mut |samples| {
        survives = run.feed(samples).is_ok();
        let now = samples.last().map_or(0.0, |sample| sample.time);
        if until.is_infinite() && run.statistics().updates > 0 {
            until = now + TRIED;
        }
        if survives && now < until { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    })?;
    if run.look().is_fixed_point() {
        return Ok(None);
    }
    let statistics = run.statistics();
    Ok(Some(if survives {
        statistics.log_likelihood - crate::settle::left_out(statistics)
    } else {
        f64::NEG_INFINITY
    }))
}
