//! Which readings of the reference are not to be believed.
//!
//! A reading is judged by its normalised innovation squared per component. A filter that lacks an effect, or noise figures that
//! are too small, make innovations large all the time: those are what the data say, and refusing them would leave the filter
//! worse and the next ones larger. So the gate first learns what is usual, then refuses what is far beyond it:
//!
//! - In the first pass what is beyond [`FIRST`] times the level of the readings so far, which is their 97.5 % quantile
//!   followed by stochastic approximation (Robbins and Monro, *Annals of Mathematical Statistics* 22(3), 1951) of its logarithm.
//! - In a further pass what is beyond [`FAR`] times the square of how much wider the readings used in the pass before were spread
//!   than chi-square, by their 90 % quantile. The square, because what lacks an effect has longer tails too.
//!
//! In the first pass a burst and the onset of what the filter lacks look alike, and no rule that does not know what comes can tell
//! them: fifteen readings of a NIS of 1300 are a burst that must be refused whole, and they are what a filter sees after a turn whose
//! effect it lacks. A further pass refuses none of the second kind; a run of a single pass loses some (`rig`'s test of outliers
//! counts them) and the caller is to say so.
//!
//! The gate never shuts for good. While readings are refused one after the other the limit grows; when it lets one in after a
//! long run, the reference is taken to begin anew somewhere else: the caller opens the states that it measures. Where that
//! happens again, it is the filter that is wrong, and the limit stays where it is.

use calib_core::MeasurementInfo;
use nalgebra::ComplexField;

use crate::measurements::Reading;

/// 97.5 % quantile of chi-square with three degrees of freedom, per degree of freedom.
const EXPECTED: f64 = 9.348 / 3.0;
/// 90 % quantile of the same.
const EXPECTED_90: f64 = 6.251 / 3.0;
/// Refused in the first pass, in levels. With a level of 1 it is 12 standard deviations on one axis.
const FIRST: f64 = 50.0;
/// Refused in a further pass over data that the filter explains: 8.7 standard deviations on one axis, or chi-square of 75 on
/// three degrees of freedom; sound readings get there once in 1e15.
const FAR: f64 = 25.0;
/// Fewer readings than this say nothing about their spread.
const FEWEST: u32 = 50;
/// Steps of the level, up for 2.5 % of the readings and down for the others: exp(0.1 * 0.975), exp(-0.1 * 0.025).
const UP: f64 = 1.102_4;
const DOWN: f64 = 0.997_503;
/// So many refusals in a row are more than a burst.
const RUN: u32 = 10;
/// Readings that repeat the one before are no news once so many have differed for each that did not.
const DIFFERED: u32 = 20;

/// A filter measures no more than this.
pub(crate) const MOST: usize = 8;

/// What becomes of a reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// It is used.
    Use,
    /// It is left out.
    Refuse,
    /// It is used, after the states that it measures were opened to it.
    Reopen,
}

/// The gate of one measurement.
#[derive(Clone, Copy, Debug)]
struct Group {
    /// Readings beyond so many times the level are refused.
    far: f64,
    spread: Spread,
    /// Level of the innovations against what is expected of them; at least 1.
    level: f64,
    /// Level before the refusals of late.
    before: f64,
    /// Refusals in a row.
    run: u32,
    /// Whether it was reopened before.
    reopened: bool,
}

impl Group {
    const NEW: Self =
        Self { far: FIRST, spread: Spread::NEW, level: 1.0, before: 1.0, run: 0, reopened: false };

    /// For a further pass.
    fn again(&self) -> Self {
        let far = match self.spread.quantile_90() {
            Some(quantile) => FAR * (quantile / EXPECTED_90).max(1.0).powi(2),
            None => self.far,
        };
        Self { far, ..Self::NEW }
    }

    fn judge(&mut self, nis: f64) -> Verdict {
        // NaN is no reading to refuse: the update says that the filter has diverged
        if nis > self.far * self.level {
            if self.run == 0 {
                self.before = self.level;
            }
            self.run += 1;
            self.level *= UP;
            return Verdict::Refuse;
        }
        self.spread.count(nis);
        let run = core::mem::take(&mut self.run);
        if run > 0 && nis <= self.far * self.before {
            self.level = self.before;
        } else if run >= RUN {
            if !core::mem::replace(&mut self.reopened, true) {
                self.level = 1.0;
            }
            return Verdict::Reopen;
        }
        self.level = (self.level * if nis > EXPECTED * self.level { UP } else { DOWN }).max(1.0);
        Verdict::Use
    }
}

/// How readings are spread: a histogram in quarters of octaves, from 2^-6 to 2^26.
#[derive(Clone, Copy, Debug)]
struct Spread([u32; 128]);

impl Spread {
    const NEW: Self = Self([0; 128]);

    fn count(&mut self, nis: f64) {
        // what is below or above the histogram, and NaN, counts at its ends
        let bin = (4.0 * (ComplexField::log2(nis.max(1e-9)) + 6.0)) as usize;
        let last = self.0.len() - 1;
        self.0[bin.min(last)] += 1;
    }

    /// Upper end of the bin that holds the 90 % quantile.
    fn quantile_90(&self) -> Option<f64> {
        let all: u32 = self.0.iter().sum();
        let mut left = (all >= FEWEST).then_some(all - all / 10)?;
        for (bin, count) in self.0.iter().enumerate() {
            if left <= *count {
                return Some(ComplexField::powf(2.0, (bin + 1) as f64 / 4.0 - 6.0));
            }
            left -= count;
        }
        None
    }
}

/// How often the readings of one kind have changed.
#[derive(Clone, Copy, Debug)]
struct Repeats<T> {
    last: Option<T>,
    differed: u32,
    repeated: u32,
}

impl<T: Copy + PartialEq> Repeats<T> {
    const NONE: Self = Self { last: None, differed: 0, repeated: 0 };

    /// Whether a reading repeats the one before to the bit where readings used to differ.
    fn stuck(&mut self, reading: T) -> bool {
        let same = self.last.replace(reading) == Some(reading);
        if !same {
            self.differed = self.differed.saturating_add(1);
            return false;
        }
        if self.differed >= DIFFERED.saturating_mul(self.repeated.saturating_add(1)) {
            return true;
        }
        self.repeated = self.repeated.saturating_add(1);
        false
    }
}

/// How the readings of a filter's measurements were spread in a run, and so which are not to be believed in the next one.
#[derive(Clone, Copy, Debug)]
pub struct Gate {
    measures: &'static [MeasurementInfo],
    groups: [Group; MOST],
    readings: [Repeats<Reading>; MOST],
}

impl Gate {
    /// Gates that have seen nothing.
    pub(crate) fn new(measures: &'static [MeasurementInfo]) -> Self {
        Self { measures, groups: [Group::NEW; MOST], readings: [Repeats::NONE; MOST] }
    }

    /// The gates for a further pass over the same log.
    pub(crate) fn again(&self) -> Self {
        Self { groups: self.groups.map(|group| group.again()), ..Self::new(self.measures) }
    }

    /// Takes over what the gates of another filter have learnt of what both measure.
    pub(crate) fn adopt(&mut self, other: &Self) {
        for (group, info) in self.groups.iter_mut().zip(self.measures) {
            if let Some(there) = other.measures.iter().position(|measured| measured.name == info.name) {
                *group = other.groups[there];
            }
        }
    }

    /// Whether the reading of a measurement is no news.
    pub(crate) fn repeats(&mut self, measured: usize, reading: &Reading) -> bool {
        self.readings[measured].stuck(*reading)
    }

    /// Judges the reading of a measurement by its normalised innovation squared per row.
    pub(crate) fn judge(&mut self, measured: usize, nis: f64) -> Verdict {
        self.groups[measured].judge(nis)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What becomes of readings.
    fn verdicts(group: &mut Group, readings: impl IntoIterator<Item = f64>) -> (u32, u32) {
        let (mut refused, mut reopened) = (0, 0);
        for nis in readings {
            match group.judge(nis) {
                Verdict::Use => {}
                Verdict::Refuse => refused += 1,
                Verdict::Reopen => reopened += 1,
            }
        }
        (refused, reopened)
    }

    /// A stand-in for chi-square on three degrees of freedom, per degree of freedom: its quantiles in disorder.
    fn usual(n: usize) -> impl Iterator<Item = f64> {
        (0..n).map(|i| (-(1.0 - (i * 37 % 101) as f64 / 101.5).ln()) * 0.9)
    }

    #[test]
    fn a_burst_is_refused_and_leaves_no_trace() {
        let mut group = Group::NEW;
        assert_eq!(verdicts(&mut group, usual(1000)), (0, 0));
        for (burst, mut group) in [(1e6, group), (60.0, group.again())] {
            for _ in 0..5 {
                let level = group.level;
                assert_eq!(verdicts(&mut group, core::iter::repeat_n(burst, 9)), (9, 0));
                assert_eq!(verdicts(&mut group, [1.0]), (0, 0));
                assert!(group.level <= level);
            }
        }
    }

    #[test]
    fn what_is_always_large_is_what_the_data_say() {
        let mut group = Group::NEW;
        // innovations that grow to a thousand times the expected, as those of a filter that lacks an effect
        let grown =
            || (0..4000).map(|i| 1000_f64.min(1.005_f64.powi(i)) * if i % 20 == 0 { 5.0 } else { 0.3 });
        // the first pass learns how large they are, and may lose some of them; a further one knows
        let (refused, reopened) = verdicts(&mut group, grown());
        assert!(refused < 4000 / 200 && reopened == 0, "{refused}, {reopened}");
        assert_eq!(verdicts(&mut group.again(), grown()), (0, 0));
    }

    #[test]
    fn a_lasting_jump_reopens_once() {
        let mut group = Group::NEW;
        assert_eq!(verdicts(&mut group, usual(1000)), (0, 0));
        let mut group = group.again();
        let (refused, reopened) = verdicts(&mut group, core::iter::repeat_n(1e4, 70));
        assert_eq!(reopened, 1);
        assert!((50..70).contains(&refused), "{refused}");
        assert_eq!(verdicts(&mut group, core::iter::repeat_n(1.0, 100)), (0, 0));
    }

    #[test]
    fn quantiles() {
        let mut spread = Spread::NEW;
        usual(1000).for_each(|nis| spread.count(nis));
        assert!(spread.quantile_90().is_some_and(|q| (2.0..2.5).contains(&q)), "{:?}", spread.quantile_90());
        [f64::NAN, 0.0, -1.0, 1e300, f64::INFINITY].into_iter().for_each(|nis| spread.count(nis));
        assert_eq!(Spread::NEW.quantile_90(), None);
    }

    #[test]
    fn readings_that_repeat_are_stuck_only_where_they_used_to_differ() {
        let mut noisy = Repeats::NONE;
        assert!((0..100).all(|i| !noisy.stuck(i)));
        assert!((0..50).all(|_| noisy.stuck(99)));
        assert!(!noisy.stuck(7));
        let mut held = Repeats::NONE;
        assert!((0..1000).all(|i| !held.stuck(i / 5)), "a slow reference, held between its readings");
        let mut fixed = Repeats::NONE;
        assert!((0..1000).all(|_| !fixed.stuck(0)));
    }
}
