//! Readings of one channel as running sums in a temporary file.

use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};

/// Takes in the readings of one channel, stretch by stretch.
#[derive(Debug)]
pub struct Recorder {
    file: BufWriter<File>,
    interval: f64,
    /// Points of each stretch: one more than readings.
    stretches: Vec<u64>,
    first: f64,
    sum: f64,
    begun: bool,
}

/// Running sums (u s) of the readings of one channel.
#[derive(Debug)]
pub struct Recorded {
    file: File,
    interval: f64,
    stretches: Vec<u64>,
    bytes: Vec<u8>,
}

impl Recorder {
    /// For readings that are so far apart, s. They are kept in a file without a name, which goes with the program.
    ///
    /// # Errors
    /// When there is no room for temporary files.
    pub fn new(interval: f64) -> io::Result<Self> {
        let file = BufWriter::with_capacity(1 << 16, tempfile::tempfile()?);
        Ok(Self { file, interval, stretches: Vec::new(), first: 0.0, sum: 0.0, begun: false })
    }

    /// What comes next does not follow what came before.
    pub fn interrupt(&mut self) {
        self.begun = false;
    }

    /// Takes in a reading, u.
    ///
    /// # Errors
    /// When the file is full.
    pub fn push(&mut self, reading: f64) -> io::Result<()> {
        if !self.begun {
            // a constant is invisible to what follows: taken out, the sums keep their digits
            (self.begun, self.first, self.sum) = (true, reading, 0.0);
            self.stretches.push(0);
            self.write(0.0)?;
        }
        self.sum += (reading - self.first) * self.interval;
        self.write(self.sum)
    }

    fn write(&mut self, sum: f64) -> io::Result<()> {
        if let Some(points) = self.stretches.last_mut() {
            *points += 1;
        }
        self.file.write_all(&sum.to_le_bytes())
    }

    /// No more readings.
    ///
    /// # Errors
    /// When the file is full.
    pub fn finish(self) -> io::Result<Recorded> {
        let file = self.file.into_inner().map_err(io::IntoInnerError::into_error)?;
        Ok(Recorded { file, interval: self.interval, stretches: self.stretches, bytes: Vec::new() })
    }
}

impl Recorded {
    /// Of readings that are at hand.
    ///
    /// # Errors
    /// As [`Recorder::push`].
    pub fn of(readings: &[f64], interval: f64) -> io::Result<Self> {
        let mut recorder = Recorder::new(interval)?;
        readings.iter().try_for_each(|reading| recorder.push(*reading))?;
        recorder.finish()
    }

    /// Between readings, s.
    pub fn interval(&self) -> f64 {
        self.interval
    }

    /// Number of readings in each stretch.
    pub fn readings(&self) -> Vec<u64> {
        self.stretches.iter().map(|points| points - 1).collect()
    }

    /// Points of each stretch.
    pub(crate) fn stretches(&self) -> &[u64] {
        &self.stretches
    }

    /// Fills `points` with those from number `from` on.
    pub(crate) fn read(&mut self, from: u64, points: &mut [f64]) -> io::Result<()> {
        self.bytes.resize(8 * points.len(), 0);
        self.file.seek(SeekFrom::Start(8 * from))?;
        self.file.read_exact(&mut self.bytes)?;
        for (point, bytes) in points.iter_mut().zip(self.bytes.chunks_exact(8)) {
            *point = f64::from_le_bytes(bytes.try_into().map_err(io::Error::other)?);
        }
        Ok(())
    }

    /// Takes so many times the readings of another channel with the same stretches out of this one.
    pub(crate) fn subtract(&mut self, factor: f64, other: &mut Self) -> io::Result<()> {
        let all: u64 = self.stretches.iter().sum();
        let (mut own, mut others) = (Vec::new(), Vec::new());
        let mut from = 0;
        while from < all {
            let length = (all - from).min(1 << 16) as usize;
            own.resize(length, 0.0);
            others.resize(length, 0.0);
            self.read(from, &mut own)?;
            other.read(from, &mut others)?;
            self.bytes.clear();
            let left = own.iter().zip(&others).map(|(own, other)| own - factor * other);
            self.bytes.extend(left.flat_map(f64::to_le_bytes));
            self.file.seek(SeekFrom::Start(8 * from))?;
            self.file.write_all(&self.bytes)?;
            from += length as u64;
        }
        Ok(())
    }
}
