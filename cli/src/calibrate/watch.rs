//! Watching a pass: the smoother where it was asked for, and what of the reference was left out.

use serde::Serialize;
use sinscal::calib_core::CoreVector;
use sinscal::{Filter, Form, Kalman, Observer, Refusal, Smoother, Strapdown, Transition, Updated};

use super::tape::FileTape;

/// Refusals of a channel that follow one another within this time are one stretch, s.
const TOGETHER: f64 = 10.0;

/// Readings of one channel that were left out one after the other.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Stretch {
    pub(super) channel: &'static str,
    /// `outlier` or `repeated`.
    pub(super) why: &'static str,
    pub(super) first_s: f64,
    pub(super) last_s: f64,
    pub(super) readings: u64,
}

/// Watches one pass.
pub(super) struct Watch<F: Filter<Dynamics = Strapdown>> {
    pub(super) smoother: Option<Smoother<F, FileTape>>,
    pub(super) refused: Vec<Stretch>,
}

impl<F: Filter<Dynamics = Strapdown>> Watch<F> {
    /// With a tape, the pass is smoothed.
    pub(super) fn new(tape: Option<FileTape>) -> Self {
        Self { smoother: tape.map(Smoother::new), refused: Vec::new() }
    }
}

impl<F: Filter<Dynamics = Strapdown>> Observer<F> for Watch<F> {
    fn predicted(&mut self, transition: &Transition<F, f64>, density: &CoreVector<F, f64>) {
        if let Some(smoother) = &mut self.smoother {
            smoother.predicted(transition, density);
        }
    }

    fn moved<C: Form>(&mut self, kalman: &Kalman<F, f64, C>) {
        if let Some(smoother) = &mut self.smoother {
            smoother.moved(kalman);
        }
    }

    fn widened(&mut self, variances: &CoreVector<F, f64>) {
        if let Some(smoother) = &mut self.smoother {
            smoother.widened(variances);
        }
    }

    fn updated(&mut self, update: &Updated<'_, F>) {
        if let Some(smoother) = &mut self.smoother {
            smoother.updated(update);
        }
    }

    fn refused(&mut self, time: f64, channel: &'static str, why: Refusal) {
        let why = match why {
            Refusal::Outlier => "outlier",
            Refusal::Repeated => "repeated",
        };
        let open = self.refused.iter_mut().rev().find(|stretch| stretch.channel == channel);
        match open.filter(|stretch| stretch.why == why && time <= stretch.last_s + TOGETHER) {
            Some(stretch) => {
                stretch.last_s = time;
                stretch.readings += 1;
            }
            None => {
                self.refused.push(Stretch { channel, why, first_s: time, last_s: time, readings: 1 });
            }
        }
    }
}
