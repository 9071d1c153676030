//! Rates and forces row by row, of a log that need not have a description.

use std::path::Path;

use nalgebra::Vector3;
use sinscal::{Reference, Sample};

use super::columns::{Batch, Group};
use super::description::Description;
use super::fault::LogError;
use super::files;
use super::layout::Part;
use super::reading::Reading;
use super::table::{Known, Table};

/// A log as it lies there.
pub(super) struct Opened {
    pub(super) table: Table,
    /// What was asked for, and what the description adds.
    pub(super) reading: Reading,
    pub(super) description: Option<Description>,
}

impl Opened {
    /// Finds the files of a log. A description that lies beside it is heeded.
    pub(super) fn of(log: &Path, reading: &Reading) -> Result<Self, LogError> {
        let (path, kind, description_path) = files::find(log)?;
        let description = match description_path.is_file() {
            true => Some(Description::read(&description_path, &reading.effects)?),
            false => None,
        };
        let reading = match &description {
            Some(description) => reading.or(&description.reading),
            None => reading.clone(),
        };
        let known = Known {
            rate: description.as_ref().map(|description| description.rate),
            site: description.as_ref().map(|description| description.site),
            fixes: description.as_ref().and_then(|description| description.fixes.clone()),
            origin: None,
        };
        let apart = description.as_ref().is_some_and(|description| description.reference_file.is_some());
        let part = if apart { Part::Unit } else { Part::Whole };
        let mut table = Table::open(&path, kind, &reading, part, known.clone());
        let mut reading = reading;
        if let Some(map) = table.as_ref().err().and_then(LogError::suggestion).cloned() {
            reading.map = map.map();
            table = Table::open(&path, kind, &reading, part, known);
            if let Ok(table) = &mut table {
                table.notes.push(format!(
                    "no map was given: names and numbers suggest {}; check the units, those of the gyros above all",
                    map.argument()
                ));
            }
        }
        Ok(Self { table: table?, reading, description })
    }
}

/// One row.
pub(super) struct Row {
    pub(super) time: f64,
    /// Since the row before, s; one interval for the first.
    pub(super) step: f64,
    /// rad/s, or pulses per second where their size is not known.
    pub(super) rate: Vector3<f64>,
    /// m/s^2, or pulses per second.
    pub(super) force: Vector3<f64>,
    /// degC; NaN where there is no reading.
    pub(super) temperature: Vector3<f64>,
    pub(super) gyro_temperature: Vector3<f64>,
}

impl Row {
    pub(super) fn is_sound(&self) -> bool {
        self.rate.iter().chain(&self.force).all(|value| value.is_finite())
    }

    /// As a sample that lasts its step.
    pub(super) fn sample(&self) -> Sample {
        Sample {
            time: self.time,
            dtheta: self.rate * self.step,
            dvel: self.force * self.step,
            temperature: self.temperature,
            gyro_temperature: self.gyro_temperature,
            dither: Vector3::repeat(f64::NAN),
            reference: Reference::default(),
        }
    }
}

/// How increments or pulses become rates and forces.
pub(super) struct Signals {
    groups: [Group; 2],
    scales: [Option<Vector3<f64>>; 2],
    rates: [bool; 2],
    /// Whether there are pulses whose size is not known.
    pub(super) unscaled: bool,
}

impl Signals {
    pub(super) fn new(table: &Table, description: Option<&Description>) -> Self {
        let counts = [Group::GYRO_PULSE, Group::ACCEL_PULSE].map(|group| table.has(group));
        let scales = [
            description.and_then(|description| description.gyro_pulse).filter(|_| counts[0]),
            description.and_then(|description| description.accel_pulse).filter(|_| counts[1]),
        ];
        let groups = [
            if counts[0] { Group::GYRO_PULSE } else { Group::DTHETA },
            if counts[1] { Group::ACCEL_PULSE } else { Group::DVEL },
        ];
        let unscaled = (0..2).any(|of| counts[of] && scales[of].is_none());
        Self { groups, scales, rates: table.rates(), unscaled }
    }

    /// Reads all rows in order.
    pub(super) fn each(
        &self,
        table: &Table,
        mut each: impl FnMut(&Row) -> Result<(), LogError>,
    ) -> Result<(), LogError> {
        let interval = table.interval;
        let mut rows = table.rows()?;
        let mut batch = Batch::new();
        let mut last = None;
        loop {
            rows.read(&mut batch)?;
            if batch.rows == 0 {
                return Ok(());
            }
            for row in 0..batch.rows {
                let time = batch.cell(Group::TIME.first, row);
                let step = last.replace(time).map_or(interval, |last| time - last);
                // as the increments were made
                let usual = step > 0.0 && step <= table.plan.longest_step * interval;
                let triad = |group: Group| Vector3::from_fn(|axis, _| batch.cell(group.first + axis, row));
                let of = |of: usize| {
                    let values = triad(self.groups[of]);
                    let values =
                        self.scales[of].map_or(values, |scale: Vector3<f64>| values.component_mul(&scale));
                    values / if self.rates[of] && usual { step } else { interval }
                };
                each(&Row {
                    time,
                    step,
                    rate: of(0),
                    force: of(1),
                    temperature: triad(Group::TEMP),
                    gyro_temperature: triad(Group::TEMP_GYRO),
                })?;
            }
        }
    }
}
