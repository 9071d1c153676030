//! A file as rows in our units, axes and time: source, times, increments, axes, reference, one stage after the other, batch by batch.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use nalgebra::Vector3;
use sinscal::Site;

use super::arrays::{Memory, MemorySource};
use super::axes::{Axes, Pointing};
use super::columns::{Batch, Group, Source};
use super::csv::CsvSource;
use super::fault::LogError;
use super::files::{self, Kind};
use super::geodetic;
use super::held::{Held, Period};
use super::increments::{Increments, Values};
use super::layout::{Asked, Layout, Part};
use super::parquet::ParquetSource;
use super::reading::Reading;
use super::rewrite::Column;
use super::stamp::Stamp;
use super::stamps::{self, Line, Plan, Residuals, Shown, Stamps};
use super::unreadable;

/// Sizes of the units of time in which a whole second is a whole number.
const WHOLE: [f64; 4] = [1.0, 1e-3, 1e-6, 1e-9];

/// What a table must be known with.
#[derive(Clone, Debug)]
pub(super) struct Known {
    /// Sampling rate, Hz; without, it is that of the stamps.
    pub(super) rate: Option<f64>,
    /// Where latitude and longitude become metres.
    pub(super) site: Option<Site>,
    /// Which fixes of a receiver count; without, all but 0.
    pub(super) fixes: Option<Vec<f64>>,
    /// Whole seconds taken off every time; without, those of a calendar are found.
    pub(super) origin: Option<i64>,
}

/// A file whose columns are found.
#[derive(Debug)]
pub(super) struct Table {
    path: PathBuf,
    holds: Contents,
    reading: Reading,
    part: Part,
    known: Known,
    layout: Layout,
    /// As it was when its columns were found.
    stamp: Stamp,
    /// Rows or bytes: what reading it counts.
    pub(super) size: u64,
    pub(super) plan: Plan,
    held: Period,
    /// Sampling interval, s.
    pub(super) interval: f64,
    /// What was recognised, assumed or left out.
    pub(super) notes: Vec<String>,
}

/// Where the rows are.
#[derive(Debug)]
enum Contents {
    Parquet,
    Csv,
    Memory(Arc<Memory>, Kind),
}

impl Table {
    /// Finds the columns of a file and what its first rows show. The fault of a file of which nothing is known carries the map that
    /// names and numbers suggest.
    pub(super) fn open(
        path: &Path,
        kind: Kind,
        reading: &Reading,
        part: Part,
        known: Known,
    ) -> Result<Self, LogError> {
        Self::open_as(path, kind, reading, part, known.clone()).map_err(|fault| match fault.suggestion() {
            Some(map) => {
                let map = map.by_numbers(path, kind, reading, known);
                fault.suggest(map)
            }
            None => fault,
        })
    }

    /// The numbers of the first rows as they stand in the file.
    pub(super) fn first_rows(&self) -> Result<Batch, LogError> {
        let mut batch = Batch::new();
        self.source()?.read(&mut batch)?;
        Ok(batch)
    }

    /// The same for a file whose columns must be known.
    pub(super) fn open_as(
        path: &Path,
        kind: Kind,
        reading: &Reading,
        part: Part,
        known: Known,
    ) -> Result<Self, LogError> {
        let asked = asked(reading, part);
        if asked.columns.is_some() && kind != Kind::Csv {
            let help = "leave --columns out: it names the columns of a text that has no names";
            return Err(LogError::file(path, "names its columns itself").help(help));
        }
        let stamp = Stamp::of(path)?;
        let (holds, layout, size) = match kind {
            Kind::Parquet => {
                let (_, layout, rows) = ParquetSource::open(path, asked)?;
                (Contents::Parquet, layout, rows)
            }
            Kind::Csv => {
                let (_, layout) = CsvSource::open(path, asked)?;
                let size = path.metadata().map_err(|error| unreadable(path, &error))?.len();
                (Contents::Csv, layout, size)
            }
            _ => {
                let (memory, layout) = files::load(path, kind, asked)?;
                let size = memory.rows as u64;
                (Contents::Memory(Arc::new(memory), kind), layout, size)
            }
        };
        let mut table = Self {
            path: path.to_owned(),
            holds,
            reading: reading.clone(),
            part,
            known,
            notes: layout.notes.clone(),
            layout,
            stamp,
            size,
            plan: Plan::AS_THEY_STAND,
            held: Period::NONE,
            interval: 0.0,
        };
        table.look()?;
        Ok(table)
    }

    /// The file.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Whether all columns of a group are there, found or made of others.
    pub(super) fn has(&self, group: Group) -> bool {
        has(&self.layout, group)
    }

    /// Whether the gyros, and the accelerometers, are given as rates: then increments last as long as their step.
    pub(super) fn rates(&self) -> [bool; 2] {
        [Group::DTHETA, Group::DVEL].map(|group| self.layout.unit(group.first).per_interval)
    }

    pub(super) fn kind(&self) -> Kind {
        match self.holds {
            Contents::Csv => Kind::Csv,
            Contents::Parquet => Kind::Parquet,
            Contents::Memory(_, kind) => kind,
        }
    }

    /// Which way the axes of the file point.
    pub(super) fn axes(&self) -> &Axes {
        &self.reading.axes
    }

    /// In which column of the file a slot stands, and its unit.
    pub(super) fn place(&self, slot: usize) -> Option<(Column, super::map::Unit)> {
        let (_, place) = self.layout.columns().find(|(of, _)| *of == slot)?;
        Some((Column { variable: place.variable, column: place.column }, place.unit))
    }

    /// What is in the file and not read.
    pub(super) fn unused(&self) -> Option<String> {
        self.layout.unused()
    }

    /// Looks at the first rows: which clock, what its stamps are worth, whether readings are held.
    fn look(&mut self) -> Result<(), LogError> {
        let timed = self.layout.has(Group::TIME);
        let mut batch = Batch::new();
        // a fault is told with its row, when that is read
        let mut source = self.source()?;
        let _ = source.read(&mut batch);
        if timed {
            let mut first = Batch::new();
            first.rows = batch.rows.min(1);
            for slot in Group::TIME.slots().chain(Group::TIME_NANOS.slots()) {
                first.column_mut(slot).extend(batch.column_mut(slot).first());
            }
            Increments::times(&self.layout, &mut first);
            let first = first.times().first().copied().unwrap_or(0.0);
            let whole = WHOLE.contains(&self.layout.unit(Group::TIME.first).scale);
            let origin = self.known.origin.unwrap_or_else(|| stamps::origin(first));
            self.plan.origin = if whole { origin } else { 0 };
            if self.plan.origin != 0 {
                // once more, counted from there
                let mut source = self.source()?;
                let _ = source.read(&mut batch);
                if self.part != Part::Reference {
                    self.notes
                        .push(format!("times are counted from {} s, where the log begins", self.plan.origin));
                }
            }
            Increments::times(&self.layout, &mut batch);
        }
        let mut steps: Vec<f64> =
            batch.times().windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
        let middle = steps.len() / 2;
        let median = (!steps.is_empty()).then(|| *steps.select_nth_unstable_by(middle, f64::total_cmp).1);
        self.interval = match self.known.rate.map(|rate| 1.0 / rate).or(median) {
            Some(interval) => interval,
            None => {
                let help = "[imu] rate_hz of its description says how far apart the rows are";
                return Err(LogError::file(&self.path, "has no times").help(help));
            }
        };
        if self.part == Part::Reference {
            return Ok(());
        }
        self.stamps(&batch, timed)?;
        self.convert_reference(&mut batch);
        self.held = Period::of(&batch);
        self.notes.extend(self.held.notes());
        Ok(())
    }

    /// Settles what becomes of the stamps.
    fn stamps(&mut self, first: &Batch, timed: bool) -> Result<(), LogError> {
        let start = first.times().first().copied().filter(|_| timed);
        let by_rate = (start.unwrap_or(self.interval), self.interval);
        if !timed {
            self.plan.line = Some(by_rate);
            return Ok(());
        }
        let shown = stamps::judge(first.times(), self.interval);
        match (self.reading.stamps, shown) {
            (Some(Stamps::Rate), _) => {
                self.plan.line = Some(by_rate);
                let note = "the stamps are not used: rows are taken to be evenly spaced by imu.rate_hz";
                self.notes.push(note.into());
            }
            (Some(Stamps::Fit), _) => self.fit("a straight line is put through the stamps")?,
            (None, Shown::Bunched) => self.fit(
                "many rows have the stamp of the row before, and none is missing: a straight line is put through the stamps, as \
                 `--stamps fit` asks for",
            )?,
            (Some(Stamps::Trust), _) => {
                self.plan = Plan { origin: self.plan.origin, ..Plan::trusted() };
            }
            (None, shown) => self.plan.uneven = shown == Shown::Uneven,
        }
        Ok(())
    }

    /// Puts a straight line through all stamps.
    fn fit(&mut self, why: &str) -> Result<(), LogError> {
        let mut line = Line::default();
        self.each_time(|time| line.push(time))?;
        let Some(line) = line.fitted() else {
            return Err(LogError::column(
                &self.path,
                "time_s",
                "has no line through its stamps: they do not increase",
            ));
        };
        let mut residuals = Residuals::new(line);
        self.each_time(|time| residuals.push(time))?;
        let (farthest, row) = residuals.farthest;
        if let Some((off, row)) = residuals.breaks() {
            let problem = format!("lies {off:.4} s off the line through all stamps, with the rows before it");
            let help =
                "rows are missing somewhere, or the clock jumped: cut the log there, or use `--stamps trust`";
            return Err(LogError::row(&self.path, row, Some("time_s"), problem).help(help));
        }
        self.notes.push(format!(
            "{why}: {:.6} Hz; they scatter about it by {:.2e} s (rms), at most {farthest:.2e} s in row {row}",
            1.0 / line.1,
            residuals.rms()
        ));
        self.plan.line = Some(line);
        Ok(())
    }

    /// Reads all stamps.
    fn each_time(&self, mut each: impl FnMut(f64)) -> Result<(), LogError> {
        let mut source = self.source()?;
        let mut batch = Batch::new();
        loop {
            source.read(&mut batch).map_err(|fault| self.layout.explain(fault))?;
            if batch.rows == 0 {
                return Ok(());
            }
            Increments::times(&self.layout, &mut batch);
            batch.times().iter().for_each(|time| each(*time));
        }
    }

    fn source(&self) -> Result<Box<dyn Source + Send>, LogError> {
        if let Some((stamp, path)) = self.watched() {
            stamp.check(&path)?;
        }
        let asked = asked(&self.reading, self.part);
        let mut source: Box<dyn Source + Send> = match &self.holds {
            Contents::Parquet => Box::new(ParquetSource::open(&self.path, asked)?.0),
            Contents::Csv => Box::new(CsvSource::open(&self.path, asked)?.0),
            Contents::Memory(memory, _) => Box::new(MemorySource::new(Arc::clone(memory))),
        };
        if self.plan.origin != 0 {
            let scale = self.layout.unit(Group::TIME.first).scale;
            // whole: that is what an origin needs
            source.count_from((self.plan.origin as f64 / scale).round() as i64);
        }
        Ok(source)
    }

    /// What a file must still be that is read anew for each pass.
    fn watched(&self) -> Option<(Stamp, PathBuf)> {
        (!matches!(self.holds, Contents::Memory(..))).then(|| (self.stamp, self.path.clone()))
    }

    /// Latitude and longitude as metres, angles as a quaternion, all in our axes.
    fn convert_reference(&self, batch: &mut Batch) {
        convert_reference(&self.layout, &self.reading.axes, &self.known, batch);
    }

    /// Starts reading from the first row.
    pub(super) fn rows(&self) -> Result<Rows, LogError> {
        let values = self.reading.values.unwrap_or(Values::Averages);
        Ok(Rows {
            source: self.source()?,
            increments: Increments::new(values, self.interval, self.plan.longest_step),
            held: Held::new(self.held),
            layout: self.layout.clone(),
            axes: self.reading.axes.clone(),
            known: self.known.clone(),
            plan: self.plan,
            watched: self.watched(),
            read: 0,
            batch: 0,
        })
    }
}

fn asked(reading: &Reading, part: Part) -> Asked<'_> {
    Asked {
        map: &reading.map,
        axes: &reading.axes,
        part,
        by_rate: reading.stamps == Some(Stamps::Rate) && part != Part::Reference,
        columns: reading.columns.as_deref().filter(|_| part != Part::Reference),
        own: &reading.own,
    }
}

fn has(layout: &Layout, group: Group) -> bool {
    layout.has(group)
        || group == Group::REF_QUAT && layout.has(Group::REF_EULER)
        || group == Group::REF_POS && layout.has(Group::REF_LATLON) && layout.has(Group::REF_HEIGHT)
}

/// The rows of a table in order.
pub(super) struct Rows {
    source: Box<dyn Source + Send>,
    increments: Increments,
    held: Held,
    layout: Layout,
    axes: Axes,
    known: Known,
    plan: Plan,
    watched: Option<(Stamp, PathBuf)>,
    /// Rows so far, and those of the batch before.
    read: u64,
    batch: u64,
}

impl Rows {
    /// Replaces the rows of `batch` by the next ones; no rows at the end of the file.
    pub(super) fn read(&mut self, batch: &mut Batch) -> Result<(), LogError> {
        self.source.read(batch).map_err(|fault| self.layout.explain(fault))?;
        if let Some((stamp, path)) = self.watched.as_ref().filter(|_| batch.rows == 0) {
            stamp.check(path)?;
        }
        self.batch = self.read;
        Increments::times(&self.layout, batch);
        self.plan.apply(batch, self.read);
        self.read += batch.rows as u64;
        self.increments.apply(&self.layout, batch);
        let (gyro, accel) = (self.axes.gyro(), self.axes.accel());
        for (group, axes) in [
            (Group::DTHETA, gyro),
            (Group::GYRO_PULSE, gyro),
            (Group::DVEL, accel),
            (Group::ACCEL_PULSE, accel),
        ] {
            if axes != Pointing::OURS {
                batch.change(group, |values| axes.apply(&Vector3::from(values)).into());
            }
        }
        for (group, axes) in [(Group::TEMP, accel), (Group::TEMP_GYRO, gyro), (Group::DITHER, gyro)] {
            if axes != Pointing::OURS {
                batch.change(group, |values| axes.permute(&Vector3::from(values)).into());
            }
        }
        convert_reference(&self.layout, &self.axes, &self.known, batch);
        self.held.apply(batch);
        Ok(())
    }

    /// How far reading has come, in the unit of the table's size.
    pub(super) fn position(&self) -> u64 {
        self.source.position()
    }

    /// Line of a text file in which a row of the batch stands, counted from 1.
    pub(super) fn line(&self, row: usize) -> Option<u64> {
        self.source.line(row)
    }

    /// Number of a row of the batch in the file, counted from 1.
    pub(super) fn row_number(&self, row: usize) -> u64 {
        self.batch + row as u64 + 1
    }

    /// Adds to a fault what the file calls the columns it is about.
    pub(super) fn explain(&self, fault: LogError) -> LogError {
        self.layout.explain(fault)
    }

    /// Whether a column of the reference is there, found or made of others.
    pub(super) fn has_slot(&self, slot: usize) -> bool {
        self.layout.columns().any(|(there, _)| there == slot) || has(&self.layout, Group::of(slot))
    }
}

/// Latitude and longitude as metres, angles as a quaternion, all in our axes; readings that a receiver does not vouch for are none.
fn convert_reference(layout: &Layout, axes: &Axes, known: &Known, batch: &mut Batch) {
    let reference = axes.reference();
    if reference != Pointing::OURS {
        for group in [Group::REF_VEL, Group::REF_POS] {
            batch.change(group, |values| reference.apply(&Vector3::from(values)).into());
        }
        for group in [Group::REF_VEL_SIGMA, Group::REF_POS_SIGMA] {
            batch.change(group, |values| reference.permute(&Vector3::from(values)).into());
        }
    }
    batch.change(Group::REF_QUAT, |wxyz| axes.attitude(wxyz));
    if layout.has(Group::REF_EULER) {
        for row in 0..batch.rows {
            let angles = Vector3::from_fn(|of, _| batch.cell(Group::REF_EULER.first + of, row));
            for (slot, value) in Group::REF_QUAT.slots().zip(axes.euler(&angles)) {
                batch.column_mut(slot).push(value);
            }
        }
    }
    if let Some(site) = known.site.as_ref().filter(|_| layout.has(Group::REF_LATLON)) {
        for row in 0..batch.rows {
            let [latitude, longitude] = [0, 1].map(|of| batch.cell(Group::REF_LATLON.first + of, row));
            let local = geodetic::local(site, latitude, longitude, batch.cell(Group::REF_HEIGHT.first, row));
            let whole = local.iter().all(|value| value.is_finite());
            for (slot, value) in Group::REF_POS.slots().zip(local) {
                batch.column_mut(slot).push(if whole { value } else { f64::NAN });
            }
        }
    }
    if layout.has(Group::REF_FIX) {
        for row in 0..batch.rows {
            let fix = batch.cell(Group::REF_FIX.first, row);
            let counts = known.fixes.as_ref().map_or(fix > 0.0, |fixes| fixes.contains(&fix));
            for group in Group::ALL.into_iter().filter(|group| !counts && group.is_of_reference()) {
                for slot in group.slots() {
                    if let Some(value) = batch.column_mut(slot).get_mut(row) {
                        *value = f64::NAN;
                    }
                }
            }
        }
    }
}
