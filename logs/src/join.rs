//! A reference in a file of its own, with its own rate and clock, put on the rows of the unit: each reading on the row nearest in
//! time, and used once.

use std::path::PathBuf;

use super::columns::{Batch, Group};
use super::fault::LogError;
use super::table::Rows;

/// A reading this many sampling intervals from the nearest row falls into a gap.
const FARTHEST: f64 = 0.75;

/// The readings of a reference on their way to the rows.
pub(super) struct Joiner {
    path: PathBuf,
    rows: Rows,
    batch: Batch,
    next: usize,
    /// What is added to its times, s.
    offset: f64,
    interval: f64,
    last: Option<f64>,
    ended: bool,
    joined: u64,
    /// First and last time of the readings, and of the rows.
    readings: Option<(f64, f64)>,
    log: Option<(f64, f64)>,
}

impl Joiner {
    /// `offset` is added to its times and makes them those of the unit, whose rows are `interval` apart, s.
    pub(super) fn new(path: PathBuf, rows: Rows, offset: f64, interval: f64) -> Self {
        Self {
            path,
            rows,
            batch: Batch::new(),
            next: 0,
            offset,
            interval,
            last: None,
            ended: false,
            joined: 0,
            readings: None,
            log: None,
        }
    }

    /// The time of the next reading.
    fn time(&mut self) -> Result<Option<f64>, LogError> {
        if self.next == self.batch.rows && !self.ended {
            self.rows.read(&mut self.batch)?;
            self.next = 0;
            self.ended = self.batch.rows == 0;
        }
        if self.ended {
            return Ok(None);
        }
        Ok(Some(self.batch.cell(Group::TIME.first, self.next) + self.offset))
    }

    /// Puts the readings of the time of a batch on its rows.
    pub(super) fn join(&mut self, rows: &mut Batch) -> Result<(), LogError> {
        let of_reference = Group::ALL.into_iter().filter(|group| group.is_of_reference());
        let slots: Vec<usize> =
            of_reference.flat_map(Group::slots).filter(|slot| self.rows.has_slot(*slot)).collect();
        for slot in &slots {
            *rows.column_mut(*slot) = vec![f64::NAN; rows.rows];
        }
        let (Some(first), Some(end)) = (rows.times().first().copied(), rows.times().last().copied()) else {
            return Ok(());
        };
        self.log = Some((self.log.map_or(first, |(first, _)| first), end));
        // how far the reading on each row lies off
        let mut off = vec![f64::INFINITY; rows.rows];
        while let Some(time) = self.time()? {
            if let Some(last) = self.last.filter(|last| !(time >= *last)) {
                let row = self.rows.row_number(self.next);
                let problem = format!("{time} s follows {last} s");
                let help = "times of a reference must not go back";
                return Err(LogError::row(&self.path, row, Some("time_s"), problem).help(help));
            }
            if time > end + 0.5 * self.interval {
                break;
            }
            self.last = Some(time);
            self.readings = Some((self.readings.map_or(time, |(first, _)| first), time));
            let after = rows.times().partition_point(|row| *row < time);
            let distance = |row: usize| rows.times().get(row).map_or(f64::INFINITY, |row| (row - time).abs());
            let nearest = if after > 0 && distance(after - 1) <= distance(after) { after - 1 } else { after };
            let far = distance(nearest);
            if far <= FARTHEST * self.interval && off.get(nearest).is_some_and(|off| far < *off) {
                off[nearest] = far;
                for slot in &slots {
                    let value = self.batch.cell(*slot, self.next);
                    rows.column_mut(*slot)[nearest] = value;
                }
                self.joined += 1;
            }
            self.next += 1;
        }
        Ok(())
    }

    /// At the end of the log: a fault when no reading was of its time.
    pub(super) fn finish(&mut self) -> Result<(), LogError> {
        if self.joined > 0 {
            return Ok(());
        }
        let next = self.time()?;
        let (first, last) = match (self.readings, next) {
            (Some((first, last)), _) => (first, last),
            (None, Some(first)) => (first, f64::INFINITY),
            (None, None) => return Err(LogError::file(&self.path, "has no rows")),
        };
        let log = self.log.unwrap_or_default();
        let end = if last.is_finite() { format!("to {last:.3} s") } else { "on".into() };
        let problem = format!(
            "no reading falls into the log: they run from {first:.3} s {end}, the log from {:.3} s to {:.3} s",
            log.0, log.1
        );
        let help = "[reference] offset_s is added to its times and makes them those of the log";
        Err(LogError::file(&self.path, problem).help(help))
    }
}
