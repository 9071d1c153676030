//! Logs: a table of samples and the description beside it, read in one streaming pass and checked throughout.
//!
//! A log is named by its path with or without ending. Without one, the table beside `NAME.toml` is taken; when there
//! is both `NAME.parquet` and `NAME.csv` the ending must say which is meant, so that no stale copy is read unnoticed.
//!
//! Tables in text (`csv`) and `parquet` are read in pieces; files of arrays (`mat5`, `hdf5`, `npz`) are read into memory. A
//! `layout` says where the columns of the format stand in a file, from its names and the `map` given on the command line.

mod ahead;
#[cfg_attr(
    not(all(feature = "mat", feature = "npz", feature = "hdf5")),
    allow(dead_code, reason = "what every reader uses, whichever are built in")
)]
mod arrays;
mod columns;
mod csv;
mod description;
mod fault;
mod fields;
mod files;
#[cfg(test)]
mod foreign;
#[cfg(test)]
mod fuzz;
mod guard;
#[cfg(feature = "hdf5")]
mod hdf5;
mod layout;
mod map;
#[cfg(feature = "mat")]
mod mat5;
#[cfg(feature = "npz")]
mod npz;
mod pages;
mod parquet;
mod rows;
mod still;
pub mod suggest;
#[cfg(test)]
mod tests;
pub mod units;

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use sinscal::{CoarseCalibration, Sample, UnknownPulses};

use self::arrays::{Memory, MemorySource};
use self::columns::{Batch, Group, Source};
use self::csv::CsvSource;
use self::files::Kind;
use self::layout::Layout;
use self::parquet::ParquetSource;
use self::rows::{Checker, Row};
use self::still::Stillness;

pub use self::ahead::Ahead;
pub use self::description::Description;
pub use self::fault::LogError;
pub use self::guard::decoding;
pub use self::map::ColumnMap;

/// A fixed point's reference holds at every instant; it is used at this rate, Hz.
const FIXED_POINT_RATE: f64 = 1.0;
/// A measured reference is used at most at this rate, Hz: the errors of neighbouring readings of a real one (a camera
/// system's calibration, a still unit's creep) are not independent, and counting them as if they were makes sigmas
/// that are too small.
const MEASURED_RATE: f64 = 10.0;
/// So many faulty rows are described, the rest is counted.
const DESCRIBED_ROWS: usize = 8;

/// A log whose description and columns are sound. Rows are checked as they are read.
#[derive(Debug)]
pub struct Log {
    description: Description,
    table: PathBuf,
    rows: Rows,
    map: ColumnMap,
    layout: Layout,
    /// Rows or bytes: what reading it counts.
    size: u64,
    fixed_point: bool,
    bridge: f64,
    unknown: UnknownPulses,
    coarse: Option<CoarseCalibration>,
    warnings: Vec<String>,
}

/// Where the rows are.
#[derive(Debug)]
enum Rows {
    Parquet,
    Csv,
    Memory(Arc<Memory>),
}

impl Log {
    /// Finds the files of a log, reads the description and checks the columns. Pulses must have known sizes.
    pub fn open(log: &Path, map: &ColumnMap) -> Result<Self, LogError> {
        let log = Self::open_counting(log, map)?;
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
        let description = self.table.with_extension("toml");
        let problem = format!("holds pulse counts, but {} lacks imu.{field}", description.display());
        Some(LogError::column(&self.table, group.names()[0], problem).help(help))
    }

    /// The same with pulses of unknown size: until [`correct`](Self::correct) says it, samples hold counts.
    pub fn open_counting(log: &Path, map: &ColumnMap) -> Result<Self, LogError> {
        let (table, kind, description_path) = files::find(log)?;
        let description = Description::read(&description_path)?;
        let (rows, layout, size) = match kind {
            Kind::Parquet => {
                let (_, layout, rows) = ParquetSource::open(&table, map)?;
                (Rows::Parquet, layout, rows)
            }
            Kind::Csv => {
                let (_, layout) = CsvSource::open(&table, map)?;
                let size = table.metadata().map_err(|error| unreadable(&table, &error))?.len();
                (Rows::Csv, layout, size)
            }
            Kind::Mat | Kind::Hdf5 | Kind::Npz | Kind::Npy => {
                let (memory, layout) = files::load(&table, kind, map)?;
                let size = memory.rows as u64;
                (Rows::Memory(Arc::new(memory)), layout, size)
            }
        };
        let unknown = UnknownPulses {
            gyro: layout.has(Group::GYRO_PULSE) && description.gyro_pulse.is_none(),
            accel: layout.has(Group::ACCEL_PULSE) && description.accel_pulse.is_none(),
        };
        let mut warnings = warnings(&description, &layout, &description_path);
        if let Some(unused) = layout.unused() {
            warnings.push(format!("{}: not used: {unused}", table.display()));
        }
        let fixed_point =
            ![Group::REF_VEL, Group::REF_POS, Group::REF_QUAT].into_iter().any(|group| layout.has(group));
        Ok(Self {
            description,
            table,
            rows,
            map: map.clone(),
            layout,
            size,
            fixed_point,
            bridge: 0.0,
            unknown,
            coarse: None,
            warnings,
        })
    }

    /// Lets gaps of up to `seconds` be filled with interpolated increments.
    ///
    /// The rows put into a gap hold increments between those of its two ends, no reference and no new reading.
    pub fn bridge_gaps(&mut self, seconds: f64) {
        self.bridge = seconds;
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
        &self.table
    }

    /// The reference is used at most this often, Hz.
    pub fn update_rate(&self) -> f64 {
        if self.fixed_point { FIXED_POINT_RATE } else { MEASURED_RATE }
    }

    /// Defaults in use that the reader of the results should know about.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Length of the table in the unit of [`Samples::position`].
    pub fn size(&self) -> u64 {
        self.size
    }

    /// [`samples`](Self::samples) in chunks, read by another thread ahead of who works on them.
    pub fn ahead(&self) -> Result<Ahead, LogError> {
        Ahead::new(self.samples()?)
    }

    /// Starts reading from the first row.
    pub fn samples(&self) -> Result<Samples, LogError> {
        let (source, layout): (Box<dyn Source + Send>, Layout) = match &self.rows {
            Rows::Parquet => {
                let (source, layout, _) = ParquetSource::open(&self.table, &self.map)?;
                (Box::new(source), layout)
            }
            Rows::Csv => {
                let (source, layout) = CsvSource::open(&self.table, &self.map)?;
                (Box::new(source), layout)
            }
            Rows::Memory(memory) => (Box::new(MemorySource::new(Arc::clone(memory))), self.layout.clone()),
        };
        Ok(Samples {
            checker: Checker::new(self.table.clone(), &self.description, &layout),
            stillness: Stillness::new(
                &self.table,
                &self.description,
                [
                    if layout.has(Group::GYRO_PULSE) { Group::GYRO_PULSE } else { Group::DTHETA },
                    if layout.has(Group::ACCEL_PULSE) { Group::ACCEL_PULSE } else { Group::DVEL },
                ],
                self.unknown == UnknownPulses::default(),
            ),
            source,
            layout,
            batch: Batch::new(),
            last_time: None,
            next: 0,
            rows: 0,
            table: self.table.clone(),
            interval: 1.0 / self.description.rate,
            bridge: self.bridge,
            coarse: self.coarse.clone(),
            gap: None,
            last: None,
            bridged: Bridged::default(),
            in_row: false,
            ended: false,
        })
    }
}

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
    source: Box<dyn Source + Send>,
    layout: Layout,
    checker: Checker,
    stillness: Stillness,
    batch: Batch,
    /// Time of the last row of the batch before.
    last_time: Option<f64>,
    /// Next row of the batch.
    next: usize,
    rows: u64,
    table: PathBuf,
    interval: f64,
    bridge: f64,
    coarse: Option<CoarseCalibration>,
    gap: Option<Gap>,
    last: Option<Sample>,
    bridged: Bridged,
    /// Whether the last fault was that of one row, so that reading can go on after it.
    in_row: bool,
    ended: bool,
}

/// A gap being filled.
struct Gap {
    before: Sample,
    after: Sample,
    steps: u64,
    step: u64,
}

impl Samples {
    /// How far reading has come, out of [`Log::size`].
    pub fn position(&self) -> u64 {
        self.source.position()
    }

    /// What was put into gaps so far.
    pub fn bridged(&self) -> Bridged {
        self.bridged
    }

    /// Checks the next row; nothing at the end.
    fn row(&mut self) -> Result<Option<Row>, LogError> {
        self.in_row = false;
        if self.next == self.batch.rows {
            self.source.read(&mut self.batch).map_err(|fault| self.layout.explain(fault))?;
            self.next = 0;
            if self.batch.rows == 0 {
                if self.rows == 0 {
                    return Err(LogError::file(&self.table, "has no rows")
                        .help("one row per IMU sample was expected"));
                }
                return Ok(None);
            }
            self.layout.convert(&mut self.batch, self.interval, self.last_time);
            self.last_time = self.batch.times().last().copied();
            self.checker.check_batch(&self.batch).map_err(|fault| self.layout.explain(fault))?;
        }
        self.in_row = true;
        let place = |fault: LogError| self.layout.explain(fault).in_line(self.source.line(self.next));
        let row = match self.checker.check(&self.batch, self.next) {
            Ok(Row::AfterGap(sample, seconds, fault)) => Ok(Row::AfterGap(sample, seconds, place(fault))),
            row => row.map_err(place),
        };
        self.next += 1;
        self.rows += 1;
        row.map(Some)
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
            Some(Row::Next(sample)) => Ok(Some(sample)),
            Some(Row::AfterGap(sample, seconds, fault)) => {
                let Some(before) = self.last.filter(|_| seconds <= self.bridge) else { return Err(fault) };
                // A gap is at least 1.5 intervals long, so that there is a row to put in.
                let steps = ((seconds / self.interval).round() as u64).max(2);
                self.bridged.gaps += 1;
                self.gap = Some(Gap { before, after: sample, steps, step: 0 });
                self.sample()
            }
        }
    }

    /// Reads on after a fault, to tell about the other faulty rows. Rows in a row with the same column are one fault.
    fn survey(&mut self, first: LogError) -> LogError {
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
        if self.step == self.steps {
            return self.after;
        }
        let part = self.step as f64 / self.steps as f64;
        let (before, after) = (&self.before, &self.after);
        let nothing = nalgebra::Vector3::repeat(f64::NAN);
        Sample {
            time: before.time + part * (after.time - before.time),
            dtheta: before.dtheta.lerp(&after.dtheta, part),
            dvel: before.dvel.lerp(&after.dvel, part),
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
        if self.ended {
            return None;
        }
        match self.sample() {
            Ok(Some(mut sample)) => {
                if let Err(fault) = self.stillness.push(&sample) {
                    self.ended = true;
                    return Some(Err(fault));
                }
                let before = self.last.replace(sample).map(|last| last.time);
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

/// An error of the operating system with the file it is about.
fn unreadable(path: &Path, error: &io::Error) -> LogError {
    LogError::file(path, format!("cannot be read: {error}"))
}

/// Defaults that matter because of what the table holds.
fn warnings(description: &Description, layout: &Layout, path: &Path) -> Vec<String> {
    let mut warnings = Vec::new();
    let path = path.display();
    let groups = [
        (Group::REF_VEL, "velocity_sigma_m_s", "0.001 m/s"),
        (Group::REF_POS, "position_sigma_m", "0.002 m"),
        (Group::REF_QUAT, "attitude_sigma_deg", "0.01 deg"),
    ];
    for ((group, field, default), given) in groups.into_iter().zip(description.reference_given) {
        if layout.has(group) && !given {
            warnings.push(format!("{path}: reference.{field} is not given, {default} is assumed"));
        }
    }
    for (group, given, field) in [
        (Group::GYRO_PULSE, description.gyro_pulse, "gyro_rad_per_pulse"),
        (Group::ACCEL_PULSE, description.accel_pulse, "accel_m_s_per_pulse"),
    ] {
        if given.is_some() && !layout.has(group) {
            let pulses = group.names().join(", ");
            warnings.push(format!("{path}: imu.{field} is not used: the table has no {pulses}"));
        }
    }
    if !description.noise_given {
        warnings
            .push(format!("{path}: [noise] is not given, 0.001 deg/sqrt(h) and 5 ug/sqrt(Hz) are assumed"));
    }
    warnings
}
