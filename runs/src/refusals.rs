//! Watching what a pass leaves out of the reference.

use serde::Serialize;
use sinscal::{Event, Filter, Form, Observer, Refusal, Strapdown};

/// Refusals of a channel that follow one another within this time are one stretch, s.
const TOGETHER: f64 = 10.0;

/// Readings of one channel that were left out one after the other.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stretch {
    /// Name of the measurement.
    pub channel: &'static str,
    /// `outlier` or `repeated`.
    pub why: &'static str,
    /// Time of the first, s.
    pub first_s: f64,
    /// Time of the last, s.
    pub last_s: f64,
    /// Their number.
    pub readings: u64,
}

/// What a pass left out of the reference.
#[derive(Default)]
pub(crate) struct Refusals {
    pub(crate) stretches: Vec<Stretch>,
}

impl<F: Filter<Dynamics = Strapdown>> Observer<F> for Refusals {
    fn observe<C: Form>(&mut self, event: Event<'_, F, C>) {
        let Event::Refused { time, group: channel, why } = event else { return };
        let why = match why {
            Refusal::Outlier => "outlier",
            Refusal::Repeated => "repeated",
        };
        let open = self.stretches.iter_mut().rev().find(|stretch| stretch.channel == channel);
        match open.filter(|stretch| stretch.why == why && time <= stretch.last_s + TOGETHER) {
            Some(stretch) => {
                stretch.last_s = time;
                stretch.readings += 1;
            }
            None => {
                self.stretches.push(Stretch { channel, why, first_s: time, last_s: time, readings: 1 });
            }
        }
    }
}
