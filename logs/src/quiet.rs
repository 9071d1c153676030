//! What the sensors read at rest, for whoever looks for the noise in it.

use std::path::Path;

use nalgebra::Vector3;

use super::description::Description;
use super::fault::LogError;
use super::reading::Reading;
use super::rests::{BLOCK, Rest, RestFinder};
use super::signals::{Opened, Signals};
use super::table::Table;

/// Rests whose specific forces agree to this, m/s^2, are of one position.
const SAME_POSITION: f64 = 0.05;
/// Where that is so, and the rests are so much of the log, it was at rest as a whole.
const WHOLE: f64 = 0.9;
/// A longer step than so many intervals is a gap.
const GAP: f64 = 1.5;
/// Temperatures are averaged over so long, s, and lie on straight lines between: a thermometer of few digits brings no steps in.
const SMOOTHING: f64 = 30.0;

/// A log in which a unit rested.
pub struct Quiet {
    table: Table,
    description: Option<Description>,
    stretches: Vec<Rest>,
    /// Whether the unit lay in one position all the time.
    whole: bool,
    temperatures: Temperatures,
    /// Sampling interval: that of the description, or the mean of the steps that are no gaps, s.
    interval: f64,
}

/// What was read in one row of a rest: rates, rad/s, forces, m/s^2.
pub struct AtRest {
    /// Whether it does not follow the row before: a rest begins, or rows are missing.
    pub begins: bool,
    /// Of the gyros and of the accelerometers.
    pub readings: [Vector3<f64>; 2],
    /// Of the same sensors, degC, smoothed over half a minute; nothing where the log has none.
    pub temperatures: [Option<Vector3<f64>>; 2],
}

impl Quiet {
    /// Reads a log and finds its rests. A description that lies beside it is heeded.
    ///
    /// # Errors
    /// When the log cannot be read, holds pulses of unknown size or no rest.
    pub fn of(log: &Path, reading: &Reading) -> Result<Self, LogError> {
        let Opened { table, description, .. } = Opened::of(log, reading)?;
        let signals = Signals::new(&table, description.as_ref());
        if signals.unscaled {
            let help =
                "its description says how large they are: imu.gyro_rad_per_pulse, imu.accel_m_s_per_pulse";
            return Err(LogError::file(table.path(), "holds pulses of unknown size").help(help));
        }
        let mut finder = RestFinder::new(table.interval);
        let mut temperatures = Temperatures::default();
        let (mut rows, mut first, mut last) = (0, f64::NAN, f64::NAN);
        let (mut steps, mut sum) = (0.0, 0.0);
        signals.each(&table, |row| {
            finder.push(row.time, &row.rate, &row.force);
            temperatures.push(row.time, [&row.gyro_temperature, &row.temperature]);
            rows += 1;
            last = row.time;
            if rows == 1 {
                first = row.time - row.step;
            } else if row.step > 0.0 && row.step < GAP * table.interval {
                steps += 1.0;
                sum += row.step;
            }
            Ok(())
        })?;
        temperatures.finish();
        let rests = finder.finish().rests;
        let Some(one) = rests.first() else {
            let help = "noise shows where a unit lies still: some hours tell bias instability, a minute the random walks alone";
            return Err(LogError::file(table.path(), "never rests for a second").help(help));
        };
        let force = Vector3::from(one.force);
        let still: f64 = rests.iter().map(|rest| rest.end_s - rest.start_s).sum();
        let whole = still >= WHOLE * (last - first)
            && rests.iter().all(|rest| (Vector3::from(rest.force) - force).norm() < SAME_POSITION);
        let stretches = if whole {
            vec![Rest { start_s: first, end_s: last, first_row: 1, last_row: rows, ..*one }]
        } else {
            // what moved the unit may reach into the first and last of the blocks that rests are made of
            let margin = (BLOCK / table.interval).ceil() as u64;
            let inner = rests.into_iter().filter(|rest| rest.last_row - rest.first_row > 4 * margin);
            inner
                .map(|rest| Rest {
                    first_row: rest.first_row + margin,
                    last_row: rest.last_row - margin,
                    ..rest
                })
                .collect()
        };
        let stated = description.as_ref().map(|description| 1.0 / description.rate);
        let interval = stated.unwrap_or(if steps > 0.0 { sum / steps } else { table.interval });
        Ok(Self { table, description, stretches, whole, temperatures, interval })
    }

    /// Between rows, s.
    pub fn interval(&self) -> f64 {
        self.interval
    }

    /// The table's path.
    pub fn path(&self) -> &Path {
        self.table.path()
    }

    /// How it was read and what of it is used, in words.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = self.table.notes.clone();
        let long = |rest: &Rest| (rest.last_row + 1 - rest.first_row) as f64 * self.interval;
        let all: f64 = self.stretches.iter().map(long).sum();
        notes.push(match &self.stretches[..] {
            _ if self.whole => format!("the unit rests from beginning to end: all of {all:.1} s is used"),
            [one] => format!("one rest of {all:.1} s is used: rows {} to {}", one.first_row, one.last_row),
            rests => format!("{} rests of {all:.1} s in all are used, each by itself", rests.len()),
        });
        notes
    }

    /// Hands over the rows of all rests in order, until there is a fault.
    ///
    /// # Errors
    /// When the log cannot be read, and what `each` says.
    pub fn each(&self, mut each: impl FnMut(&AtRest) -> Result<(), LogError>) -> Result<(), LogError> {
        let signals = Signals::new(&self.table, self.description.as_ref());
        let mut rests = self.stretches.iter().peekable();
        let (mut row, mut before) = (0, 0);
        signals.each(&self.table, |read| {
            row += 1;
            while rests.next_if(|rest| rest.last_row < row).is_some() {
                before = 0;
            }
            if rests.peek().is_none_or(|rest| row < rest.first_row) || !read.is_sound() {
                return Ok(());
            }
            let follows =
                before + 1 == row && before > 0 && read.step > 0.0 && read.step < GAP * self.table.interval;
            before = row;
            each(&AtRest {
                begins: !follows,
                readings: [read.rate, read.force],
                temperatures: self.temperatures.at(read.time),
            })
        })
    }
}

/// Temperatures of gyros and accelerometers, averaged over even times.
#[derive(Default)]
struct Temperatures {
    /// Middle of the time, s, and the means.
    means: Vec<(f64, [Vector3<f64>; 2])>,
    open: Vec<Mean>,
    begin: Option<f64>,
    end: f64,
}

#[derive(Clone, Copy, Default)]
struct Mean {
    sum: f64,
    count: f64,
}

impl Temperatures {
    fn push(&mut self, time: f64, readings: [&Vector3<f64>; 2]) {
        let begin = *self.begin.get_or_insert(time);
        if time - begin >= SMOOTHING {
            self.close();
            self.begin = Some(time);
        }
        self.end = time;
        self.open.resize(6, Mean::default());
        for (mean, reading) in self.open.iter_mut().zip(readings.into_iter().flatten()) {
            if reading.is_finite() {
                mean.sum += reading;
                mean.count += 1.0;
            }
        }
    }

    fn close(&mut self) {
        let Some(begin) = self.begin else { return };
        let mean = |at: usize| self.open.get(at).map_or(f64::NAN, |mean| mean.sum / mean.count);
        let mut means = [0, 3].map(|first| Vector3::from_fn(|axis, _| mean(first + axis)));
        // without thermometers of their own, gyros have those of the accelerometers
        for axis in 0..3 {
            if means[0][axis].is_nan() {
                means[0][axis] = means[1][axis];
            }
        }
        // no reading: the last one holds
        if let Some((_, last)) = self.means.last() {
            for (mean, last) in means.iter_mut().zip(last) {
                *mean = mean.zip_map(last, |mean, last| if mean.is_nan() { last } else { mean });
            }
        }
        if means.iter().any(|means| means.iter().any(|mean| mean.is_finite())) {
            self.means.push((0.5 * (begin + self.end), means));
        }
        self.open.clear();
    }

    fn finish(&mut self) {
        self.close();
    }

    /// Temperatures at a time.
    fn at(&self, time: f64) -> [Option<Vector3<f64>>; 2] {
        let after = self.means.partition_point(|(middle, _)| *middle < time);
        let (Some((before, low)), Some((next, high))) =
            (self.means.get(after.saturating_sub(1)), self.means.get(after).or(self.means.last()))
        else {
            return [None; 2];
        };
        let part = if next > before { ((time - before) / (next - before)).clamp(0.0, 1.0) } else { 0.0 };
        [0, 1].map(|of| {
            Some(low[of].lerp(&high[of], part)).filter(|at: &Vector3<f64>| at.iter().all(|t| t.is_finite()))
        })
    }
}
