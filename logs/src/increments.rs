//! Numbers of a file in the units of the format: counts, temperatures, and rates that become increments over their interval.

use super::columns::{Batch, Group, NAMES};
use super::layout::Layout;
use super::map::Unit;

/// What the rates in a file are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Values {
    /// Averages over the interval that ends at the stamp.
    #[default]
    Averages,
    /// The values at the stamp.
    Instants,
}

/// Converts batch after batch.
pub(super) struct Increments {
    values: Values,
    /// Sampling interval, s, and the longest step in it.
    interval: f64,
    longest_step: f64,
    last_time: Option<f64>,
    /// Rates of the row before, where it is needed.
    last: [f64; NAMES.len()],
}

impl Increments {
    pub(super) fn new(values: Values, interval: f64, longest_step: f64) -> Self {
        Self { values, interval, longest_step, last_time: None, last: [f64::NAN; NAMES.len()] }
    }

    /// The times of a batch, s.
    pub(super) fn times(layout: &Layout, batch: &mut Batch) {
        let unit = layout.unit(Group::TIME.first);
        if unit != Unit::SAME {
            batch
                .column_mut(Group::TIME.first)
                .iter_mut()
                .for_each(|time| *time = (*time - unit.zero) * unit.scale);
        }
        if layout.has(Group::TIME_NANOS) {
            let unit = layout.unit(Group::TIME_NANOS.first);
            let parts = std::mem::take(batch.column_mut(Group::TIME_NANOS.first));
            for (time, part) in batch.column_mut(Group::TIME.first).iter_mut().zip(&parts) {
                *time += (part - unit.zero) * unit.scale;
            }
        }
    }

    /// Everything else.
    pub(super) fn apply(&mut self, layout: &Layout, batch: &mut Batch) {
        let times = std::mem::take(batch.column_mut(Group::TIME.first));
        let is_time = |slot: usize| slot == Group::TIME.first || slot == Group::TIME_NANOS.first;
        for (slot, place) in
            layout.columns().filter(|(slot, place)| !is_time(*slot) && place.unit != Unit::SAME)
        {
            let Unit { scale, zero, per_interval } = place.unit;
            let values = batch.column_mut(slot);
            values.iter_mut().for_each(|value| *value = (*value - zero) * scale);
            if !per_interval {
                continue;
            }
            let (mut before, mut last) = (self.last_time, self.last[slot]);
            for (time, value) in times.iter().zip(values) {
                let step = before.replace(*time).map_or(self.interval, |before| time - before);
                // the first row, and the row after a gap, last one interval
                let usual = step > 0.0 && step <= self.longest_step * self.interval;
                let now = *value;
                let mean = match self.values {
                    Values::Instants if usual && last.is_finite() => 0.5 * (last + now),
                    _ => now,
                };
                *value = mean * if usual { step } else { self.interval };
                last = now;
            }
            self.last[slot] = last;
        }
        self.last_time = times.last().copied().or(self.last_time);
        *batch.column_mut(Group::TIME.first) = times;
    }
}
