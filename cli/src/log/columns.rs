//! The columns of a table: which there may be, which there must be, and where they stand in a file.

use std::path::Path;

use super::fault::LogError;
use rig::suggest;

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

    const ALL: [Self; 11] = [
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

    /// Its columns' names.
    pub(super) fn names(self) -> &'static [&'static str] {
        NAMES.get(self.first..self.first + self.len).unwrap_or_default()
    }
}

/// Where the columns of the format stand in one file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layout {
    /// Index in the file of each slot's column.
    positions: [Option<usize>; NAMES.len()],
    /// Number of columns in the file.
    pub(super) width: usize,
}

impl Layout {
    /// Finds the columns in a file's header; every fault is reported at once.
    pub(super) fn new(path: &Path, header: &[impl AsRef<str>]) -> Result<Self, LogError> {
        if header.iter().all(|name| !NAMES.contains(&name.as_ref().to_ascii_lowercase().as_str())) {
            let first: String = header.first().map_or("", AsRef::as_ref).chars().take(64).collect();
            let problem = format!("none of its columns is one of the log format; the first is `{first}`");
            let help =
                format!("the names of the columns come first of all; valid names: {}", NAMES.join(", "));
            return Err(LogError::file(path, problem).help(help));
        }
        let mut faults = Vec::new();
        let mut positions = [None; NAMES.len()];
        for (index, name) in header.iter().map(AsRef::as_ref).enumerate() {
            match NAMES.iter().position(|known| *known == name) {
                None if name.is_empty() => {
                    let problem = format!("{}: column {} has no name", path.display(), index + 1);
                    let help = "a column of row numbers, or a comma at the end of the lines? Leave it out";
                    faults.push(LogError::message(problem).help(help));
                }
                None => {
                    let shown: String = name.chars().take(64).collect();
                    let hint = suggest::hint(name, NAMES);
                    faults
                        .push(LogError::column(path, &shown, "is not a column of the log format").help(hint));
                }
                Some(slot) => match positions[slot] {
                    None => positions[slot] = Some(index),
                    Some(_) => faults.push(LogError::column(path, name, "stands there twice")),
                },
            }
        }
        let layout = Self { positions, width: header.len() };
        if !layout.has(Group::TIME) {
            faults.push(LogError::column(path, "time_s", "is missing").help("the end of each interval, s"));
        }
        for (increments, pulses) in [(Group::DTHETA, Group::GYRO_PULSE), (Group::DVEL, Group::ACCEL_PULSE)] {
            let (first, alternative) = (increments.names()[0], pulses.names()[0]);
            match (layout.any(increments), layout.any(pulses)) {
                (true, true) => {
                    let problem =
                        format!("stands beside `{alternative}`: increments or pulse counts, not both");
                    faults.push(LogError::column(path, first, problem));
                }
                (false, false) => {
                    let missing = increments.names().join(", ");
                    let help = format!(
                        "expected {missing} (or {} with the scales in [imu])",
                        pulses.names().join(", ")
                    );
                    faults.push(LogError::column(path, first, "is missing").help(help));
                }
                _ => {}
            }
        }
        for group in Group::ALL.into_iter().filter(|group| layout.any(*group) && !layout.has(*group)) {
            let (there, missing): (Vec<&str>, Vec<&str>) =
                group.names().iter().partition(|name| header.iter().any(|column| column.as_ref() == **name));
            let problem = format!("is missing beside `{}`", there.join("`, `"));
            let help = format!("{} come together or not at all", group.names().join(", "));
            faults.push(LogError::column(path, &missing.join("`, `"), problem).help(help));
        }
        match LogError::all(faults) {
            Some(fault) => Err(fault),
            None => Ok(layout),
        }
    }

    /// Whether all columns of a group are there.
    pub(super) fn has(&self, group: Group) -> bool {
        self.slots(group).iter().all(Option::is_some)
    }

    fn any(&self, group: Group) -> bool {
        self.slots(group).iter().any(Option::is_some)
    }

    fn slots(&self, group: Group) -> &[Option<usize>] {
        self.positions.get(group.first..group.first + group.len).unwrap_or_default()
    }

    /// Slot and index in the file of every column that is there.
    pub(super) fn columns(&self) -> impl Iterator<Item = (usize, usize)> {
        self.positions.iter().enumerate().filter_map(|(slot, index)| index.map(|index| (slot, index)))
    }
}

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
}
