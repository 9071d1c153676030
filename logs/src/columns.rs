//! The columns of the log format, and what yields them.

use super::fault::LogError;

/// Every column of the format; a slot is an index into this list.
pub(super) const NAMES: [&str; 59] = [
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
    "ref_lat_deg",
    "ref_lon_deg",
    "ref_height_m",
    "ref_heading_deg",
    "ref_roll_deg",
    "ref_pitch_deg",
    "ref_yaw_deg",
    "ref_vel_sigma_e",
    "ref_vel_sigma_n",
    "ref_vel_sigma_u",
    "ref_pos_sigma_e",
    "ref_pos_sigma_n",
    "ref_pos_sigma_u",
    "ref_att_sigma_deg",
    "ref_fix",
    "time_ns",
    "ref_rate_x",
    "ref_rate_y",
    "ref_rate_z",
    "ref_own_1",
    "ref_own_2",
    "ref_own_3",
    "ref_own_4",
    "ref_own_5",
    "ref_own_6",
    "ref_own_7",
    "ref_own_8",
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

    /// Geodetic latitude and longitude.
    pub(super) const REF_LATLON: Self = Self { first: 32, len: 2 };
    pub(super) const REF_HEIGHT: Self = Self { first: 34, len: 1 };
    /// East of north.
    pub(super) const REF_HEADING: Self = Self { first: 35, len: 1 };
    /// Angles about the x, y and z of the file's body.
    pub(super) const REF_EULER: Self = Self { first: 36, len: 3 };
    pub(super) const REF_VEL_SIGMA: Self = Self { first: 39, len: 3 };
    pub(super) const REF_POS_SIGMA: Self = Self { first: 42, len: 3 };
    pub(super) const REF_ATT_SIGMA: Self = Self { first: 45, len: 1 };
    /// What a receiver says of the quality of its fix.
    pub(super) const REF_FIX: Self = Self { first: 46, len: 1 };
    /// The part of a second, where time stands in two columns.
    pub(super) const TIME_NANOS: Self = Self { first: 47, len: 1 };

    /// Rate of the body against the Earth.
    pub(super) const REF_RATE: Self = Self { first: 48, len: 3 };
    /// What measurements of the program's own read; each may be there or not.
    pub(super) const REF_OWN: Self = Self { first: 51, len: 8 };

    pub(super) const ALL: [Self; 29] = [
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
        Self::REF_LATLON,
        Self::REF_HEIGHT,
        Self::REF_HEADING,
        Self::REF_EULER,
        Self::REF_VEL_SIGMA,
        Self::REF_POS_SIGMA,
        Self::REF_ATT_SIGMA,
        Self::REF_FIX,
        Self::TIME_NANOS,
        Self::REF_RATE,
        Self::own(0),
        Self::own(1),
        Self::own(2),
        Self::own(3),
        Self::own(4),
        Self::own(5),
        Self::own(6),
        Self::own(7),
    ];

    /// One of the columns of [`REF_OWN`](Self::REF_OWN).
    pub(super) const fn own(index: usize) -> Self {
        Self { first: Self::REF_OWN.first + index, len: 1 }
    }

    /// Whether it belongs to the reference.
    pub(super) fn is_of_reference(self) -> bool {
        (Self::REF_VEL.first..=Self::REF_FIX.first).contains(&self.first)
            || self.first >= Self::REF_RATE.first
    }

    /// Whether one reading may serve all of its columns: one thermometer for three sensors.
    pub(super) fn may_be_shared(self) -> bool {
        let shared = [Self::TEMP, Self::TEMP_GYRO, Self::DITHER, Self::REF_VEL_SIGMA, Self::REF_POS_SIGMA];
        shared.into_iter().any(|group| group.slots().contains(&self.first))
    }

    /// The group of a slot.
    pub(super) fn of(slot: usize) -> Self {
        Self::ALL.into_iter().find(|group| group.slots().contains(&slot)).unwrap_or(Self::TIME)
    }

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
    slot >= Group::TEMP.first && slot != Group::TIME_NANOS.first
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

    /// The rows of a group whose columns are all there, to be changed in place.
    pub(super) fn change<const N: usize>(&mut self, group: Group, change: impl Fn([f64; N]) -> [f64; N]) {
        if self.columns[group.slots()].iter().any(|column| column.len() != self.rows) {
            return;
        }
        for row in 0..self.rows {
            let changed = change(std::array::from_fn(|of| self.columns[group.first + of][row]));
            for (of, value) in changed.into_iter().enumerate() {
                self.columns[group.first + of][row] = value;
            }
        }
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

    /// Counts times from here, in the unit of the file: taken off before a time becomes a number of 53 bits.
    fn count_from(&mut self, origin: i64);

    /// How far reading has come, in the unit of the table's size.
    fn position(&self) -> u64;

    /// Line of a text file in which a row of the batch stands, counted from 1.
    fn line(&self, _row: usize) -> Option<u64> {
        None
    }
}
