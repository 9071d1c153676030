//! What the stamps of the rows are worth: each as it stands, or a straight line through all of them, or the rate alone.

use std::str::FromStr;

use super::columns::Batch;

/// A step longer than this many sampling intervals is a gap, unless the stamps are trusted.
pub(super) const LONGEST_STEP: f64 = 1.5;
/// The same where they are.
const LONGEST_TRUSTED: f64 = 4.0;
/// Beyond this a time is one of a calendar and not of a log, s.
const CALENDAR: f64 = 1e6;
/// Fewer steps than this show nothing.
const ENOUGH: usize = 32;
/// More steps than this part are no accident.
const MANY: f64 = 0.05;
/// The mean step may differ from the sampling interval by this part where no row is missing.
const COMPLETE: f64 = 0.02;
/// So many rows that lie so many intervals off the line through all, taken together, are behind rows that are missing, or behind a
/// jump of the clock: what jitters, or is written in bunches, comes back to the line.
const TOGETHER: u64 = 128;
const FARTHEST: f64 = 5.0;

/// How the stamps of a log are used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stamps {
    /// Each as it stands; every step has its own length.
    Trust,
    /// Not at all: rows are evenly spaced by the rate, from the first stamp.
    Rate,
    /// By the straight line through all of them.
    Fit,
}

impl Stamps {
    /// What may be said.
    pub const NAMES: [&'static str; 3] = ["trust", "rate", "fit"];
}

impl FromStr for Stamps {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "trust" => Ok(Self::Trust),
            "rate" => Ok(Self::Rate),
            "fit" => Ok(Self::Fit),
            _ => Err(format!("`{text}` is none of {}", Self::NAMES.join(", "))),
        }
    }
}

/// What becomes of the stamps of one file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plan {
    /// Whole seconds that are taken off every time.
    pub(super) origin: i64,
    /// Time of the first row and step, s, where the rows lie on a line.
    pub(super) line: Option<(f64, f64)>,
    /// In sampling intervals.
    pub(super) longest_step: f64,
    /// Steps beyond the longest are usual, and no row is missing.
    pub(super) uneven: bool,
}

impl Plan {
    /// Each stamp as it stands.
    pub(super) const AS_THEY_STAND: Self =
        Self { origin: 0, line: None, longest_step: LONGEST_STEP, uneven: false };

    pub(super) fn trusted() -> Self {
        Self { longest_step: LONGEST_TRUSTED, ..Self::AS_THEY_STAND }
    }

    /// Puts the times of a batch, whose first row is `row` counted from 0, where they belong.
    pub(super) fn apply(&self, batch: &mut Batch, row: u64) {
        let Some((start, step)) = self.line else { return };
        let rows = batch.rows;
        let times = batch.column_mut(0);
        times.clear();
        times.extend((0..rows as u64).map(|index| start + step * (row + index) as f64));
    }
}

/// Whole seconds of a first stamp that is one of a calendar; 0 for one that counts from the start of something.
pub(super) fn origin(first: f64) -> i64 {
    if first.abs() > CALENDAR && first.abs() < 1e15 { first.floor() as i64 } else { 0 }
}

/// What the first stamps show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Shown {
    /// They increase step by step.
    Even,
    /// Many steps are too long, and others so short that no row is missing.
    Uneven,
    /// Many do not increase at all, and no row is missing: they are when a row was written, not when it was measured.
    Bunched,
}

/// Judges the first stamps of a log with this sampling interval, s.
pub(super) fn judge(times: &[f64], interval: f64) -> Shown {
    let steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if steps.len() < ENOUGH || !times.iter().all(|time| time.is_finite()) {
        return Shown::Even;
    }
    let part =
        |of: &dyn Fn(f64) -> bool| steps.iter().filter(|step| of(**step)).count() as f64 / steps.len() as f64;
    let mean = steps.iter().sum::<f64>() / steps.len() as f64;
    if (mean / interval - 1.0).abs() > COMPLETE {
        return Shown::Even;
    }
    if part(&|step| step <= 0.0) > MANY {
        return Shown::Bunched;
    }
    if part(&|step| step > LONGEST_STEP * interval) > MANY { Shown::Uneven } else { Shown::Even }
}

/// A straight line through stamps, taken in one by one.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Line {
    count: f64,
    first: f64,
    mean_row: f64,
    mean_time: f64,
    rows: f64,
    both: f64,
}

impl Line {
    pub(super) fn push(&mut self, time: f64) {
        if self.count == 0.0 {
            self.first = time;
        }
        let row = self.count;
        self.count += 1.0;
        let (row_off, time_off) = (row - self.mean_row, time - self.first - self.mean_time);
        self.mean_row += row_off / self.count;
        self.mean_time += time_off / self.count;
        self.rows += row_off * (row - self.mean_row);
        self.both += row_off * (time - self.first - self.mean_time);
    }

    /// Time of the first row, and step from row to row, s; nothing of fewer than two rows.
    pub(super) fn fitted(&self) -> Option<(f64, f64)> {
        let step = self.both / self.rows;
        (self.count >= 2.0 && step.is_finite() && step > 0.0)
            .then_some((self.first + self.mean_time - step * self.mean_row, step))
    }
}

/// How far stamps lie from the line through them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Residuals {
    line: (f64, f64),
    row: u64,
    squares: f64,
    /// The farthest stamp, and its row counted from 1.
    pub(super) farthest: (f64, u64),
    /// Sum over the rows of a stretch.
    stretch: f64,
    /// The farthest mean of a stretch, and its last row.
    apart: (f64, u64),
}

impl Residuals {
    pub(super) fn new(line: (f64, f64)) -> Self {
        Self { line, row: 0, squares: 0.0, farthest: (0.0, 0), stretch: 0.0, apart: (0.0, 0) }
    }

    pub(super) fn push(&mut self, time: f64) {
        let off = time - self.line.0 - self.line.1 * self.row as f64;
        self.row += 1;
        self.squares += off * off;
        if off.abs() > self.farthest.0 {
            self.farthest = (off.abs(), self.row);
        }
        self.stretch += off;
        if self.row.is_multiple_of(TOGETHER) {
            let mean = (self.stretch / TOGETHER as f64).abs();
            if mean > self.apart.0 {
                self.apart = (mean, self.row);
            }
            self.stretch = 0.0;
        }
    }

    /// Root of the mean square, s.
    pub(super) fn rms(&self) -> f64 {
        (self.squares / self.row.max(1) as f64).sqrt()
    }

    /// How far off rows lie, and the row, where no jitter explains it.
    pub(super) fn breaks(&self) -> Option<(f64, u64)> {
        Some(self.apart).filter(|(mean, _)| *mean > FARTHEST * self.line.1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stamps_show() {
        let of = |step: &dyn Fn(usize) -> f64| {
            let mut time = 0.0;
            let times: Vec<f64> = (0..400)
                .map(|row| {
                    time += step(row);
                    time
                })
                .collect();
            judge(&times, 0.05)
        };
        assert_eq!(of(&|_| 0.05), Shown::Even);
        assert_eq!(of(&|row| if row % 4 == 3 { 0.08 } else { 0.04 }), Shown::Uneven);
        // five rows are written at once
        assert_eq!(of(&|row| if row % 5 == 0 { 0.25 } else { 0.0 }), Shown::Bunched);
        // a single repeated stamp is a fault, and so are rows that are missing
        assert_eq!(of(&|row| if row == 7 { 0.0 } else { 0.05 }), Shown::Even);
        assert_eq!(of(&|row| if row % 4 == 3 { 0.1 } else { 0.05 }), Shown::Even);
    }

    #[test]
    fn a_line_goes_through_jittered_stamps() {
        let mut line = Line::default();
        let stamp =
            |row: usize| 1000.0 + 0.005 * row as f64 + if row.is_multiple_of(2) { 0.001 } else { -0.001 };
        (0..10_000).for_each(|row| line.push(stamp(row)));
        let (start, step) = line.fitted().expect("a line");
        assert!((start - 1000.0).abs() < 1e-6 && (step - 0.005).abs() < 1e-9, "{start} {step}");
        let mut residuals = Residuals::new((start, step));
        (0..10_000).for_each(|row| residuals.push(stamp(row)));
        assert!((residuals.rms() - 0.001).abs() < 1e-6 && residuals.breaks().is_none());
        let mut jumped = Residuals::new((start, step));
        (0..10_000).for_each(|row| jumped.push(stamp(row) + if row >= 9_000 { 0.5 } else { 0.0 }));
        assert!(jumped.breaks().is_some_and(|(off, row)| off > 0.4 && row > 9_000));
        assert_eq!(Line::default().fitted(), None);
    }

    #[test]
    fn times_of_a_calendar_are_counted_anew() {
        assert_eq!(origin(1_700_000_000.25), 1_700_000_000);
        assert_eq!((origin(345_600.5), origin(-3.0), origin(f64::NAN), origin(1e300)), (0, 0, 0, 0));
    }
}
