//! A table written once more, with other rates and forces and everything else as it stands.

pub(crate) mod arrays;
mod columns;
#[cfg(feature = "npz")]
mod numpy;
mod text;

use std::io::{self, Write};

use nalgebra::Vector3;
use sinscal::Sample;

use self::arrays::{Arrays, Rewritten};
use self::columns::Columns;
use self::text::Text;
use super::columns::Group;
use super::fault::LogError;
use super::files::Kind;
use super::rows::Row;
use super::{Log, Samples};

/// Angle and velocity increments, rad and m/s, in the axes of samples.
type Increments = (Vector3<f64>, Vector3<f64>);

/// A column of the file: of a table the variables are its columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Column {
    /// Which variable of the file, counted from 0.
    pub(super) variable: usize,
    /// Which of its columns.
    pub(super) column: usize,
}

/// A column, and what is added to its number in a row, in its unit.
type Change = (Column, f64);

/// A table on its way from file to file.
trait Sheet {
    /// The next row, which stands in this line of a text, with numbers changed in some columns: the same in all rows.
    fn put(&mut self, line: Option<u64>, changes: &[Change]) -> io::Result<()>;

    /// What comes after the last row.
    fn finish(self: Box<Self>) -> io::Result<()>;
}

/// What changes the arrays of a kind of file that this build reads, where it is one of arrays.
fn in_place(kind: Kind) -> Option<Rewritten> {
    match kind {
        #[cfg(feature = "npz")]
        Kind::Npz => Some(numpy::archive),
        #[cfg(feature = "npz")]
        Kind::Npy => Some(numpy::array),
        #[cfg(feature = "mat")]
        Kind::Mat => Some(super::mat5::rewritten),
        #[cfg(feature = "hdf5")]
        Kind::Hdf5 => Some(super::hdf5::rewritten),
        #[cfg(feature = "mcap")]
        Kind::Mcap => Some(super::topics::mcap::rewritten),
        #[cfg(feature = "bag")]
        Kind::Bag => Some(super::topics::bag::rewritten),
        #[cfg(feature = "ulog")]
        Kind::Ulog => Some(super::topics::ulog::rewritten),
        _ => None,
    }
}

impl Log {
    /// Writes its table with the increments that `correct` makes of each sample: names, units, axes and separators of the file stay, so do
    /// all other columns and lines. What the file holds as rates or forces changes by the change of the increment over its step.
    ///
    /// # Errors
    /// When the log is faulty or cannot be read. When `out` cannot be written, or what changes stands in the file as it cannot be written:
    /// packed, or as whole numbers.
    pub fn rewrite(
        &self,
        out: &mut (dyn Write + Send),
        correct: &mut dyn FnMut(&Sample) -> Increments,
    ) -> Result<io::Result<()>, LogError> {
        let slots = [Group::DTHETA, Group::GYRO_PULSE, Group::DVEL, Group::ACCEL_PULSE];
        let places = slots.into_iter().flat_map(Group::slots).filter_map(|slot| self.table.place(slot));
        let mut sheet: Box<dyn Sheet + '_> = match (self.table.kind(), in_place(self.table.kind())) {
            (Kind::Parquet, _) => {
                let variables: Vec<usize> = places.map(|(column, _)| column.variable).collect();
                match Columns::open(self.table(), out, &variables) {
                    Ok(sheet) => Box::new(sheet),
                    Err(error) => return Ok(Err(error)),
                }
            }
            (_, Some(rewritten)) => Box::new(Arrays::new(self.table(), out, rewritten)),
            _ => Box::new(Text::open(self.table(), out)?),
        };
        let mut samples = self.samples()?;
        while let Some((sample, step)) = self.next_row(&mut samples)? {
            let changes = self.changes(&sample, correct(&sample), step);
            if let Err(error) = sheet.put(samples.line(), &changes) {
                return Ok(Err(error));
            }
        }
        Ok(sheet.finish())
    }

    /// The next row of the table, and its step, s.
    fn next_row(&self, samples: &mut Samples) -> Result<Option<(Sample, f64)>, LogError> {
        let sample = match samples.row() {
            Ok(None) => return Ok(None),
            Ok(Some(Row::Next(sample))) => sample,
            Ok(Some(Row::AfterGap(sample, seconds, _))) if seconds <= self.bridge => sample,
            Ok(Some(Row::AfterGap(_, _, fault))) | Err(fault) => return Err(samples.survey(fault)),
        };
        let interval = 1.0 / self.description.rate;
        let step = samples.last.replace(sample.time).map_or(interval, |last| sample.time - last);
        let usual = step > 0.0 && step <= self.table.plan.longest_step * interval;
        Ok(Some((sample, if usual { step } else { interval })))
    }

    /// What changes in the columns of a row.
    fn changes(&self, sample: &Sample, (dtheta, dvel): Increments, step: f64) -> Vec<Change> {
        let description = &self.description;
        let (gyro, accel) = (dtheta - sample.dtheta, dvel - sample.dvel);
        let pulses = |change: Vector3<f64>, size: Option<Vector3<f64>>| {
            size.map_or(change, |size| change.component_div(&size))
        };
        let axes = self.table.axes();
        let mut changes = Vec::with_capacity(6);
        for (group, change, axes) in [
            (Group::DTHETA, gyro, axes.gyro()),
            (Group::GYRO_PULSE, pulses(gyro, description.gyro_pulse), axes.gyro()),
            (Group::DVEL, accel, axes.accel()),
            (Group::ACCEL_PULSE, pulses(accel, description.accel_pulse), axes.accel()),
        ] {
            // the axes of the file
            let change = axes.matrix().transpose() * change;
            for (slot, change) in group.slots().zip(&change) {
                if let Some((column, unit)) = self.table.place(slot) {
                    let length = if unit.per_interval { step } else { 1.0 };
                    changes.push((column, change / unit.scale / length));
                }
            }
        }
        changes
    }
}
