//! The rows of a log as samples, one after the other: checked, joined with the reference, gaps filled, the coarse stage's errors taken out.

use std::path::PathBuf;

use nalgebra::Vector3;
use sinscal::{CoarseCalibration, Sample};

use super::LogError;
use super::columns::Batch;
use super::join::Joiner;
use super::refer::Referee;
use super::rows::{Checker, Row};
use super::still::Stillness;
use super::table::Rows;

/// So many faulty rows are described, the rest is counted.
const DESCRIBED_ROWS: usize = 8;

/// Gaps that were filled.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bridged {
    /// Number of gaps.
    pub gaps: u64,
    /// Number of rows put into them.
    pub rows: u64,
}

/// The rows of a log in order, each checked. Ends after the first error.
pub struct Samples {
    pub(super) source: Rows,
    pub(super) joiner: Option<Joiner>,
    pub(super) checker: Checker,
    pub(super) stillness: Stillness,
    pub(super) batch: Batch,
    /// Next row of the batch.
    pub(super) next: usize,
    pub(super) rows: u64,
    pub(super) table: PathBuf,
    pub(super) interval: f64,
    pub(super) bridge: f64,
    pub(super) coarse: Option<CoarseCalibration>,
    pub(super) referee: Option<Referee>,
    pub(super) gap: Option<Gap>,
    /// Time, rate and specific force of the last row read.
    pub(super) before: Option<(f64, Vector3<f64>, Vector3<f64>)>,
    /// Whether gyros and accelerometers are given as rates.
    pub(super) rates: [bool; 2],
    /// Time of the last sample given.
    pub(super) last: Option<f64>,
    pub(super) bridged: Bridged,
    /// Whether the last fault was that of one row, so that reading can go on after it.
    pub(super) in_row: bool,
    pub(super) ended: bool,
}

/// A gap being filled.
pub(super) struct Gap {
    /// Time, rate and specific force before it.
    before: (f64, Vector3<f64>, Vector3<f64>),
    after: Sample,
    /// Rate and specific force of the row after it.
    rates: (Vector3<f64>, Vector3<f64>),
    /// Of each of its rows, s.
    length: f64,
    steps: u64,
    step: u64,
}

impl Samples {
    /// How far reading has come, out of [`Log::size`](super::Log::size).
    pub fn position(&self) -> u64 {
        self.source.position()
    }

    /// What was put into gaps so far.
    pub fn bridged(&self) -> Bridged {
        self.bridged
    }

    /// Checks the next row; nothing at the end.
    pub(super) fn row(&mut self) -> Result<Option<Row>, LogError> {
        self.in_row = false;
        if self.next == self.batch.rows {
            self.source.read(&mut self.batch)?;
            self.next = 0;
            if self.batch.rows == 0 {
                if self.rows == 0 {
                    return Err(LogError::file(&self.table, "has no rows")
                        .help("one row per IMU sample was expected"));
                }
                self.joiner.as_mut().map_or(Ok(()), Joiner::finish)?;
                return Ok(None);
            }
            if let Some(joiner) = &mut self.joiner {
                joiner.join(&mut self.batch)?;
            }
            self.checker.check_batch(&self.batch).map_err(|fault| self.source.explain(fault))?;
        }
        self.in_row = true;
        let place = |fault: LogError| self.source.explain(fault).in_line(self.source.line(self.next));
        let row = match self.checker.check(&self.batch, self.next) {
            Ok(Row::AfterGap(sample, seconds, fault)) => Ok(Row::AfterGap(sample, seconds, place(fault))),
            row => row.map_err(place),
        };
        self.next += 1;
        self.rows += 1;
        row.map(Some)
    }

    /// Line of a text in which the last row stands, counted from 1.
    pub(super) fn line(&self) -> Option<u64> {
        self.source.line(self.next.checked_sub(1)?)
    }

    /// The next sample, or the next of a gap.
    fn sample(&mut self) -> Result<Option<Sample>, LogError> {
        if let Some(gap) = &mut self.gap {
            let filled = gap.sample();
            if gap.step == gap.steps {
                self.gap = None;
            } else {
                self.bridged.rows += 1;
            }
            return Ok(Some(filled));
        }
        match self.row()? {
            None => Ok(None),
            Some(Row::Next(sample)) => {
                let step = self.before.map_or(self.interval, |(time, ..)| sample.time - time);
                self.before = Some(self.as_rates(&sample, step));
                Ok(Some(sample))
            }
            Some(Row::AfterGap(sample, seconds, fault)) => {
                let after = self.as_rates(&sample, self.interval);
                let Some(before) = self.before.replace(after).filter(|_| seconds <= self.bridge) else {
                    return Err(fault);
                };
                // A gap is at least 1.5 intervals long, so that there is a row to put in.
                let steps = ((seconds / self.interval).round() as u64).max(2);
                self.bridged.gaps += 1;
                // what is filled in lasts as long as the gap, and no longer
                let length = seconds / steps as f64;
                self.gap =
                    Some(Gap { before, after: sample, rates: (after.1, after.2), length, steps, step: 0 });
                self.sample()
            }
        }
    }

    /// Time, rate and specific force of a row whose step is so long, s. Increments that were given last one interval.
    pub(super) fn as_rates(&self, sample: &Sample, step: f64) -> (f64, Vector3<f64>, Vector3<f64>) {
        let [gyro, accel] = self.rates.map(|rates| if rates { step } else { self.interval });
        (sample.time, sample.dtheta / gyro, sample.dvel / accel)
    }

    /// Reads on after a fault, to tell about the other faulty rows. Rows in a row with the same column are one fault.
    pub(super) fn survey(&mut self, first: LogError) -> LogError {
        let mut last = first.row_number().unwrap_or(0);
        let mut runs = vec![(first, last)];
        let mut more = 0_u64;
        while self.in_row && (self.next < self.batch.rows || runs.len() < DESCRIBED_ROWS) {
            let fault = match self.row() {
                Ok(None) => break,
                Ok(Some(Row::AfterGap(_, seconds, fault))) if seconds > self.bridge => fault,
                Ok(Some(_)) => continue,
                Err(fault) => fault,
            };
            let row = fault.row_number().unwrap_or(0);
            let room = runs.len() < DESCRIBED_ROWS;
            match runs.last_mut() {
                Some((run, end)) if last == *end && run.continues(last, &fault) => *end = row,
                _ if room => runs.push((fault, row)),
                _ => more += 1,
            }
            last = row;
        }
        let described = runs.into_iter().map(|(fault, end)| match fault.row_number() {
            Some(row) if end > row => fault.note(format!("and so on in every row up to row {end}")),
            _ => fault,
        });
        let mut all =
            LogError::all(described.collect()).unwrap_or_else(|| LogError::file(&self.table, "is faulty"));
        if more > 0 {
            all = all.note(format!("and at least {more} more faulty rows"));
        }
        all
    }
}

impl Gap {
    fn sample(&mut self) -> Sample {
        self.step += 1;
        let (time, rate, force) = self.before;
        let last = self.step == self.steps;
        let part = if last { 1.0 } else { self.step as f64 / self.steps as f64 };
        let (dtheta, dvel) =
            (rate.lerp(&self.rates.0, part) * self.length, force.lerp(&self.rates.1, part) * self.length);
        if last {
            return Sample { dtheta, dvel, ..self.after };
        }
        let nothing = Vector3::repeat(f64::NAN);
        Sample {
            time: time + part * (self.after.time - time),
            dtheta,
            dvel,
            temperature: nothing,
            gyro_temperature: nothing,
            dither: nothing,
            reference: sinscal::Reference::default(),
        }
    }
}

impl Iterator for Samples {
    type Item = Result<Sample, LogError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let mut item = self.checked()?;
            let used = match (&mut item, &mut self.referee) {
                (Ok(sample), Some(referee)) => referee.refer(sample),
                _ => true,
            };
            if used {
                return Some(item);
            }
        }
    }
}

impl Samples {
    /// The next sample with what the columns say of the reference.
    fn checked(&mut self) -> Option<Result<Sample, LogError>> {
        if self.ended {
            return None;
        }
        match self.sample() {
            Ok(Some(mut sample)) => {
                if let Err(fault) = self.stillness.push(&sample) {
                    self.ended = true;
                    return Some(Err(fault));
                }
                let before = self.last.replace(sample.time);
                if let Some(coarse) = &self.coarse {
                    let dt = before.map_or(self.interval, |before| sample.time - before);
                    coarse.compensate(&mut sample, dt);
                }
                Some(Ok(sample))
            }
            Ok(None) => {
                self.ended = true;
                if self.rows == 1 {
                    let fault =
                        LogError::file(&self.table, "has a single row: nothing can be estimated from it");
                    return Some(Err(
                        fault.help("some minutes are expected, at rest in several positions and turning")
                    ));
                }
                self.stillness.judge().err().map(Err)
            }
            Err(fault) => {
                self.ended = true;
                Some(Err(self.survey(fault)))
            }
        }
    }
}
