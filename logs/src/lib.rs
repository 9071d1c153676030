//! Logs: a table of samples and the description beside it, read in one streaming pass and checked throughout.
//!
//! A log is named by its path with or without ending. Without one, the table beside `NAME.toml` is taken; when there
//! is both `NAME.parquet` and `NAME.csv` the ending must say which is meant, so that no stale copy is read unnoticed.
//!
//! Tables in text (`csv`, in whatever `dialect`) and `parquet` are read in pieces; files of arrays (`mat5`, `hdf5`, `npz`) and recordings of messages (`topics`) are
//! read into memory. A `layout` says where the columns of the format stand in a file, from its `names` and the `map` of a
//! [`Reading`]. A `table` puts what is read where it belongs, batch by batch: `stamps`, `increments`, `axes`, a reference that is
//! `held` or `join`ed from a file of its own. The checks of `rows` and `still` come last, over samples as a filter gets them.

mod ahead;
#[cfg_attr(
    not(all(feature = "mat", feature = "npz", feature = "hdf5")),
    allow(dead_code, reason = "what every reader uses, whichever are built in")
)]
mod arrays;
mod axes;
#[cfg(test)]
mod cases;
mod columns;
mod csv;
mod description;
mod dialect;
mod exact;
mod fault;
mod fields;
mod files;
#[cfg(test)]
mod foreign;
#[cfg(test)]
mod fuzz;
mod geodetic;
mod grade;
mod guard;
mod guess;
#[cfg(feature = "hdf5")]
mod hdf5;
mod held;
mod increments;
mod join;
#[cfg(test)]
mod kinds;
mod layout;
mod look;
mod map;
#[cfg(feature = "mat")]
mod mat5;
mod names;
#[cfg(feature = "npz")]
mod npz;
mod pages;
mod parquet;
mod quiet;
mod reading;
mod refer;
mod rests;
#[cfg_attr(
    not(all(feature = "mat", feature = "npz", feature = "hdf5")),
    allow(dead_code, reason = "what every writer uses, whichever are built in")
)]
mod rewrite;
mod rows;
mod samples;
mod sections;
mod signals;
mod stamp;
mod stamps;
mod still;
pub mod suggest;
mod table;
#[cfg(test)]
mod tests;
#[cfg(any(feature = "mcap", feature = "bag", feature = "ulog"))]
mod topics;
pub mod units;
mod written;

use std::io;
use std::path::{Path, PathBuf};

use sinscal::{CoarseCalibration, UnknownPulses};

use self::columns::{Batch, Group};
use self::join::Joiner;
use self::layout::Part;
use self::refer::{Instead, Referee};
use self::rows::Checker;
use self::still::Stillness;
use self::table::{Known, Table};

pub use self::ahead::Ahead;
pub use self::axes::{Axes, Pointing};
pub use self::description::{Description, ReferenceKind};
pub use self::fault::LogError;
pub use self::grade::Grade;
pub use self::guard::decoding;
pub use self::increments::Values;
pub use self::look::{Look, Noise, look};
pub use self::map::ColumnMap;
pub use self::quiet::{AtRest, Quiet};
pub use self::reading::{Reading, column_names};
pub use self::rests::{Rest, RestFinder, Rests};
pub use self::samples::{Bridged, Samples};
pub use self::stamps::Stamps;

/// A fixed point's reference holds at every instant; it is used at this rate, Hz.
const FIXED_POINT_RATE: f64 = 1.0;
/// A measured reference is used at most at this rate, Hz: the errors of neighbouring readings of a real one (a camera
/// system's calibration, a still unit's creep) are not independent, and counting them as if they were makes sigmas
/// that are too small.
const MEASURED_RATE: f64 = 10.0;
/// Rows that come more slowly than this deserve a word, Hz.
const SLOW: f64 = 20.0;
/// A log whose description and columns are sound. Rows are checked as they are read.
#[derive(Debug)]
pub struct Log {
    description: Description,
    table: Table,
    /// The reference, where it has a file of its own.
    reference: Option<Table>,
    /// Where its noise is stated, if not in its description.
    noise_file: Option<PathBuf>,
    /// Whether nothing is said about the observed point.
    no_columns: bool,
    /// What stands for readings.
    instead: Option<Instead>,
    /// What was assumed.
    assumed: Vec<String>,
    bridge: f64,
    unknown: UnknownPulses,
    coarse: Option<CoarseCalibration>,
    warnings: Vec<String>,
}

impl Log {
    /// Finds the files of a log, reads the description and checks the columns. Pulses must have known sizes.
    pub fn open(log: &Path, reading: &Reading) -> Result<Self, LogError> {
        let log = Self::open_counting(log, reading)?;
        let help = "give the size of a pulse on each axis; where the log has still positions, `sinscal calibrate` finds it \
                    and says what to write";
        log.lacking_scale(help).map_or(Ok(log), Err)
    }

    /// The fault that pulses have no size, if some have none; `help` says what can be done.
    pub fn lacking_scale(&self, help: &str) -> Option<LogError> {
        let (group, field) = match self.unknown {
            UnknownPulses { gyro: true, .. } => (Group::GYRO_PULSE, "gyro_rad_per_pulse"),
            UnknownPulses { accel: true, .. } => (Group::ACCEL_PULSE, "accel_m_s_per_pulse"),
            UnknownPulses { .. } => return None,
        };
        let description = self.table().with_extension("toml");
        let problem = format!("holds pulse counts, but {} lacks imu.{field}", description.display());
        Some(LogError::column(self.table(), group.names()[0], problem).help(help))
    }

    /// The same with pulses of unknown size: until [`correct`](Self::correct) says it, samples hold counts.
    pub fn open_counting(log: &Path, reading: &Reading) -> Result<Self, LogError> {
        let (path, kind, description_path) = files::find(log)?;
        files::check_file(&description_path, "description of the log", Some(files::LEAST))?;
        let description = Description::read(&description_path, &reading.effects)?;
        let description = match &reading.noise {
            Some(path) => description.with_noise_of(path)?,
            None => description,
        };
        let reading = reading.or(&description.reading);
        let known = Known {
            rate: Some(description.rate),
            site: Some(description.site),
            fixes: description.fixes.clone(),
            origin: None,
        };
        let apart = description.reference_file.as_deref();
        let part = if apart.is_some() { Part::Unit } else { Part::Whole };
        let table = Table::open(&path, kind, &reading, part, known.clone())?;
        let reference = match apart {
            Some(name) => {
                let (path, kind) = files::beside(&description_path, name)?;
                let origin = (table.plan.origin != 0).then_some(table.plan.origin);
                let known = Known { rate: None, origin, ..known };
                Some(Table::open(&path, kind, &reading, Part::Reference, known)?)
            }
            None => None,
        };
        let has =
            |group| table.has(group) || reference.as_ref().is_some_and(|reference| reference.has(group));
        let unknown = UnknownPulses {
            gyro: has(Group::GYRO_PULSE) && description.gyro_pulse.is_none(),
            accel: has(Group::ACCEL_PULSE) && description.accel_pulse.is_none(),
        };
        let mut warnings = warnings(&description, &has, &description_path);
        for table in [Some(&table), reference.as_ref()].into_iter().flatten() {
            let path = table.path().display();
            warnings.extend(table.notes.iter().map(|note| format!("{path}: {note}")));
            warnings.extend(table.unused().map(|unused| format!("{path}: not used: {unused}")));
        }
        let no_columns = rows::is_fixed_point(&has);
        let bridge = reading.bridge.unwrap_or(0.0);
        Ok(Self {
            description,
            table,
            reference,
            noise_file: reading.noise,
            no_columns,
            instead: None,
            assumed: Vec::new(),
            bridge,
            unknown,
            coarse: None,
            warnings,
        })
    }

    /// Which pulses have unknown sizes.
    pub fn unknown_pulses(&self) -> UnknownPulses {
        self.unknown
    }

    /// Gives samples in SI, with the errors of a coarse calibration taken out.
    pub fn correct(&mut self, coarse: CoarseCalibration) {
        self.description.gyro_pulse = coarse.gyro_pulse.or(self.description.gyro_pulse);
        self.description.accel_pulse = coarse.accel_pulse.or(self.description.accel_pulse);
        self.unknown = UnknownPulses::default();
        self.coarse = Some(coarse);
    }

    /// The coarse calibration whose errors were taken out.
    pub fn coarse(&self) -> Option<&CoarseCalibration> {
        self.coarse.as_ref()
    }

    /// What the description says.
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// The table's path.
    pub fn table(&self) -> &Path {
        self.table.path()
    }

    /// The path of its description.
    pub fn description_path(&self) -> PathBuf {
        self.table().with_extension("toml")
    }

    /// Every file that is read for it.
    pub fn files(&self) -> Vec<PathBuf> {
        let tables = [Some(&self.table), self.reference.as_ref()].into_iter().flatten();
        let files = tables.map(|table| table.path().to_owned()).chain([self.description_path()]);
        files.chain(self.noise_file.clone()).collect()
    }

    /// The reference is used at most this often, Hz.
    pub fn update_rate(&self) -> f64 {
        let fixed_point = match self.instead {
            Some(Instead::FixedPoint) => true,
            Some(Instead::Rests(_)) => false,
            None => self.no_columns,
        };
        if fixed_point { FIXED_POINT_RATE } else { MEASURED_RATE }
    }

    /// Defaults in use that the reader of the results should know about.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Length of the table in the unit of [`Samples::position`].
    pub fn size(&self) -> u64 {
        self.table.size
    }

    /// [`samples`](Self::samples) in chunks, read by another thread ahead of who works on them.
    pub fn ahead(&self) -> Result<Ahead, LogError> {
        Ahead::new(self.samples()?)
    }

    /// Starts reading from the first row. A file that is another one than that which was opened is refused, now or at its end: what
    /// one pass found must not be mixed with what the next one reads.
    pub fn samples(&self) -> Result<Samples, LogError> {
        let has = |group| {
            self.table.has(group) || self.reference.as_ref().is_some_and(|reference| reference.has(group))
        };
        let interval = 1.0 / self.description.rate;
        let joiner = match &self.reference {
            Some(reference) => {
                let offset = self.description.reference_offset;
                Some(Joiner::new(reference.path().to_owned(), reference.rows()?, offset, interval))
            }
            None => None,
        };
        Ok(Samples {
            checker: Checker::new(self.table().to_owned(), &self.description, self.table.plan, &has),
            stillness: Stillness::new(
                self.table(),
                &self.description,
                [
                    if has(Group::GYRO_PULSE) { Group::GYRO_PULSE } else { Group::DTHETA },
                    if has(Group::ACCEL_PULSE) { Group::ACCEL_PULSE } else { Group::DVEL },
                ],
                self.unknown == UnknownPulses::default(),
            ),
            source: self.table.rows()?,
            joiner,
            batch: Batch::new(),
            next: 0,
            rows: 0,
            table: self.table().to_owned(),
            interval,
            bridge: self.bridge,
            coarse: self.coarse.clone(),
            referee: self.instead.clone().map(Referee::new),
            gap: None,
            before: None,
            rates: self.table.rates(),
            last: None,
            bridged: Bridged::default(),
            in_row: false,
            ended: false,
        })
    }
}

/// An error of the operating system with the file it is about.
fn unreadable(path: &Path, error: &io::Error) -> LogError {
    LogError::file(path, format!("cannot be read: {error}"))
}

/// Defaults that matter because of what the table holds.
fn warnings(description: &Description, has: &dyn Fn(Group) -> bool, path: &Path) -> Vec<String> {
    let mut warnings = Vec::new();
    let path = path.display();
    let groups = [
        (Group::REF_VEL, "velocity_sigma_m_s", "0.001 m/s"),
        (Group::REF_POS, "position_sigma_m", "0.002 m"),
        (Group::REF_QUAT, "attitude_sigma_deg", "0.01 deg"),
    ];
    for ((group, field, default), given) in groups.into_iter().zip(description.reference_given) {
        if has(group) && !given {
            warnings.push(format!("{path}: reference.{field} is not given, {default} is assumed"));
        }
    }
    for (group, given, field) in [
        (Group::GYRO_PULSE, description.gyro_pulse, "gyro_rad_per_pulse"),
        (Group::ACCEL_PULSE, description.accel_pulse, "accel_m_s_per_pulse"),
    ] {
        if given.is_some() && !has(group) {
            let pulses = group.names().join(", ");
            warnings.push(format!("{path}: imu.{field} is not used: the table has no {pulses}"));
        }
    }
    if description.rate < SLOW {
        warnings.push(format!(
            "{path}: {} Hz is slow: what a unit does between two rows, turns about changing axes above all, is lost to the filter; \
             {SLOW} Hz and more is usual",
            description.rate
        ));
    }
    if !description.noise_given {
        let noise = &description.noise;
        let gyro = noise.angle_random_walk / units::DEG_PER_SQRT_HOUR;
        let accel = noise.velocity_random_walk / units::MICRO_G;
        warnings.push(format!(
            "{path}: {NO_NOISE}, {gyro:.3} deg/sqrt(h) and {accel:.0} ug/sqrt(Hz) are assumed"
        ));
    }
    warnings
}

/// What is said where no noise is stated.
const NO_NOISE: &str = "[noise] is not given";
