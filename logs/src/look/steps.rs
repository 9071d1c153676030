//! Times from row to row: rate, gaps, jitter, stamps that do not increase.

use super::TOLD;
use crate::stamps::LONGEST_STEP;

/// Steps scatter by this part of the interval without a word.
const JITTER: f64 = 0.05;
/// The rate of the stamps and that of the description may differ by this part.
const SAME: f64 = 0.02;

/// Takes in stamps.
pub(super) struct Steps {
    interval: f64,
    rows: u64,
    first: f64,
    last: f64,
    /// Steps of a usual length: number, sum, sum of squares about the interval.
    usual: (f64, f64, f64),
    gaps: Runs,
    back: Runs,
}

/// Rows where something is so: the first of them, their number, and the largest.
#[derive(Default)]
struct Runs {
    rows: Vec<u64>,
    count: u64,
    largest: f64,
}

impl Runs {
    fn push(&mut self, row: u64, size: f64) {
        if self.rows.len() < TOLD {
            self.rows.push(row);
        }
        self.count += 1;
        self.largest = self.largest.max(size);
    }

    fn told(&self) -> String {
        let rows: Vec<String> = self.rows.iter().map(u64::to_string).collect();
        let more = if self.count > rows.len() as u64 { " ..." } else { "" };
        format!("row{} {}{more}", if self.count == 1 { "" } else { "s" }, rows.join(", "))
    }
}

impl Steps {
    pub(super) fn new(interval: f64) -> Self {
        Self {
            interval,
            rows: 0,
            first: f64::NAN,
            last: f64::NAN,
            usual: (0.0, 0.0, 0.0),
            gaps: Runs::default(),
            back: Runs::default(),
        }
    }

    /// The step to a row, s; one interval for the first.
    pub(super) fn push(&mut self, time: f64) -> f64 {
        self.rows += 1;
        if self.rows == 1 {
            (self.first, self.last) = (time, time);
            return self.interval;
        }
        let step = time - self.last;
        self.last = time;
        if !(step > 0.0) {
            self.back.push(self.rows, -step);
        } else if step > LONGEST_STEP * self.interval {
            self.gaps.push(self.rows, step);
        } else {
            self.usual.0 += 1.0;
            self.usual.1 += step;
            self.usual.2 += (step - self.interval) * (step - self.interval);
        }
        step
    }

    pub(super) fn duration(&self) -> f64 {
        self.last - self.first + self.interval
    }

    /// Hz, by the steps that are no gaps.
    pub(super) fn rate(&self) -> f64 {
        if self.usual.0 > 0.0 { self.usual.0 / self.usual.1 } else { 1.0 / self.interval }
    }

    /// Scatter of the steps that are no gaps about the interval, rms, s.
    pub(super) fn jitter(&self) -> f64 {
        let (count, _, squares) = self.usual;
        (squares / count.max(1.0)).sqrt()
    }

    pub(super) fn warnings(&self, stated: Option<f64>) -> Vec<String> {
        let mut warnings = Vec::new();
        if self.back.count > 0 {
            warnings.push(format!(
                "{}: {} stamps do not come after the one before: rows in disorder or twice, or stamps of when a row was written: \
                 --stamps fit, or --stamps rate",
                self.back.told(),
                self.back.count
            ));
        }
        if self.gaps.count > 0 {
            let whole = self.duration() / self.rows as f64;
            let complete = (whole / self.interval - 1.0).abs() < SAME
                && self.gaps.count as f64 > 0.05 * self.rows as f64;
            let help = if complete {
                "no row is missing: --stamps trust where the steps are as long as they say, --stamps fit where the stamps jitter".into()
            } else {
                format!(
                    "--bridge-gaps {} fills them by interpolation",
                    (self.gaps.largest * 1.01 * 1e3).ceil() / 1e3
                )
            };
            warnings.push(format!(
                "{}: {} steps are longer than {LONGEST_STEP} intervals, the longest {:.4} s: {help}",
                self.gaps.told(),
                self.gaps.count,
                self.gaps.largest
            ));
        }
        let jitter = self.jitter();
        if jitter > JITTER * self.interval {
            warnings.push(format!(
                "rows 1 to {}: the steps scatter by {jitter:.2e} s, {:.0} % of the interval: --stamps fit puts a straight line through \
                 stamps that jitter",
                self.rows,
                100.0 * jitter / self.interval
            ));
        }
        if let Some(stated) = stated.filter(|stated| (self.rate() / stated - 1.0).abs() > SAME) {
            warnings.push(format!(
                "rows 1 to {}: by the stamps the rate is {:.4} Hz, the description says {stated} Hz: correct imu.rate_hz, or the unit of \
                 the times",
                self.rows,
                self.rate()
            ));
        }
        warnings
    }
}
