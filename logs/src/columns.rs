//! The columns of the log format, and what yields them.

use super::fault::LogError;

/// Every column of the format; a slot is an index into this list.
pub(super) const NAMES: [&str; 32] = [
    "time_s",
    "dtheta_x",
    "dtheta_y",
    "dtheta_z",
    "dvel_x",
    "dvel_y",
    "dvel_z",
    "gyro_pulse_x",
    "gyro_pulse_y",
    "gyro_pulse_z",
    "accel_pulse_x",
    "accel_pulse_y",
    "accel_pulse_z",
    "temp_x",
    "temp_y",
    "temp_z",
    "temp_gyro_x",
    "temp_gyro_y",
    "temp_gyro_z",
    "dither_x",
    "dither_y",
    "dither_z",
    "ref_vel_e",
    "ref_vel_n",
    "ref_vel_u",
    "ref_pos_e",
    "ref_pos_n",
    "ref_pos_u",
    "ref_quat_w",
    "ref_quat_x",
    "ref_quat_y",
    "ref_quat_z",
];

/// Columns that come together or not at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Group {
    /// Slot of its first column.
    pub(super) first: usize,
    /// Number of columns.
    pub(super) len: usize,
}

impl Group {
    pub(super) const TIME: Self = Self { first: 0, len: 1 };
    pub(super) const DTHETA: Self = Self { first: 1, len: 3 };
    pub(super) const DVEL: Self = Self { first: 4, len: 3 };
    pub(super) const GYRO_PULSE: Self = Self { first: 7, len: 3 };
    pub(super) const ACCEL_PULSE: Self = Self { first: 10, len: 3 };
    pub(super) const TEMP: Self = Self { first: 13, len: 3 };
    pub(super) const TEMP_GYRO: Self = Self { first: 16, len: 3 };
    pub(super) const DITHER: Self = Self { first: 19, len: 3 };
    pub(super) const REF_VEL: Self = Self { first: 22, len: 3 };
    pub(super) const REF_POS: Self = Self { first: 25, len: 3 };
    pub(super) const REF_QUAT: Self = Self { first: 28, len: 4 };

    pub(super) const ALL: [Self; 11] = [
        Self::TIME,
        Self::DTHETA,
        Self::DVEL,
        Self::GYRO_PULSE,
        Self::ACCEL_PULSE,
        Self::TEMP,
        Self::TEMP_GYRO,
        Self::DITHER,
        Self::REF_VEL,
        Self::REF_POS,
        Self::REF_QUAT,
    ];

    /// Its columns.
    pub(super) fn slots(self) -> std::ops::Range<usize> {
        self.first..self.first + self.len
    }

    /// Its columns' names.
    pub(super) fn names(self) -> &'static [&'static str] {
        NAMES.get(self.slots()).unwrap_or_default()
    }
}

/// What to do where time or an increment is missing.
pub(super) const NEEDED: &str = "every row needs a number here; leave the row out where there is none, and `--bridge-gaps SECONDS` \
                                 fills the gap";

/// Whether a cell of this slot may be empty: everything may but time and increments.
pub(super) fn may_be_empty(slot: usize) -> bool {
    slot >= Group::TEMP.first
}

/// Some consecutive rows of a table, column by column.
pub(super) struct Batch {
    columns: [Vec<f64>; NAMES.len()],
    /// Number of rows.
    pub(super) rows: usize,
}

impl Batch {
    pub(super) fn new() -> Self {
        Self { columns: std::array::from_fn(|_| Vec::new()), rows: 0 }
    }

    /// Forgets the rows and keeps the memory.
    pub(super) fn clear(&mut self) {
        self.columns.iter_mut().for_each(Vec::clear);
        self.rows = 0;
    }

    /// The column of a slot, to be filled.
    pub(super) fn column_mut(&mut self, slot: usize) -> &mut Vec<f64> {
        &mut self.columns[slot]
    }

    /// The time column, and another to be changed.
    pub(super) fn times_and(&mut self, slot: usize) -> (&[f64], &mut [f64]) {
        let (times, others) = self.columns.split_at_mut(1);
        (&times[0], others.get_mut(slot.wrapping_sub(1)).map_or(&mut [], |column| column))
    }

    /// The time column.
    pub(super) fn times(&self) -> &[f64] {
        &self.columns[Group::TIME.first]
    }

    /// One cell; NaN where the file has no such column.
    pub(super) fn cell(&self, slot: usize, row: usize) -> f64 {
        self.columns[slot].get(row).copied().unwrap_or(f64::NAN)
    }
}

/// A file that yields its rows in batches.
pub(super) trait Source {
    /// Replaces the rows of `batch` by the next ones; no rows at the end of the file.
    fn read(&mut self, batch: &mut Batch) -> Result<(), LogError>;

    /// How far reading has come, in the unit of the table's size.
    fn position(&self) -> u64;

    /// Line of a text file in which a row of the batch stands, counted from 1.
    fn line(&self, _row: usize) -> Option<u64> {
        None
    }
}
