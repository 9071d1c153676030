//! What samples say by themselves, before any filter does: saturation, coarse digits, a reference that never moves.

use core::fmt;

use nalgebra::Vector3;
use sinscal::{Reference, Sample};

/// The largest reading of a sensor that saturates stands in so many rows, at least...
const SATURATED: u64 = 1000;
/// ...and in so many times the rows that the next largest stands in.
const CLIFF: u64 = 10;
/// Readings are the same if they differ by less than this part of themselves: what comes of dividing by the time between rows.
const SAME: f64 = 1e-9;
/// Sensors whose readings repeat in more than this part of the rows, away from their largest, have no noise: where these are the
/// same nothing is saturated.
const NOISELESS: f64 = 0.1;
/// Readings that repeat in so much of the rows are rounded to about the size of their noise.
const ROUNDED: [f64; 2] = [0.1, 0.9];
/// Of every so many rows the digits are looked at...
const LOOKED_AT: u64 = 16;
/// ...and if nearly all have no more than six that count, it is the writing of the log that has rounded them: counted pulses lose
/// nothing from one row to the next, and have more digits.
const WRITTEN: f64 = 0.95;
/// Fewer rows than this say nothing about digits.
const FEWEST: u64 = 500;

/// A jump that the next row takes back stands out from the usual steps when it is so many times as large, and is taken back to this
/// part of it.
const STANDS_OUT: f64 = 30.0;
const TAKEN_BACK: f64 = 0.05;

/// A run begins within so much of ordinary room temperature, degC...
const ROOM: (f64, f64) = (20.0, 12.0);
/// ...and not above this, degC: what does is believed only of a unit that was heated before.
const HEATED: f64 = 55.0;

/// The six inertial sensors, rates before forces.
const SENSORS: [&str; 6] =
    ["gyro x", "gyro y", "gyro z", "accelerometer x", "accelerometer y", "accelerometer z"];

/// Looks at every sample of a log.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Look {
    sensors: [Sensor; 6],
    time: Option<f64>,
    at: Option<Vector3<f64>>,
    readings: u64,
    moves: bool,
    /// The first temperature, degC.
    began_at: Option<f64>,
}

/// One sensor: its largest readings to both sides, and how often it reads the same again.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Sensor {
    /// To the positive and to the negative side.
    sides: [Side; 2],
    last: f64,
    before: f64,
    rows: u64,
    repeats: u64,
    /// Rows whose digits were looked at, and those with few.
    looked_at: u64,
    short: u64,
    /// Sum of the sizes of all steps.
    steps: f64,
    /// The largest jump that the next row takes back, and its time.
    jump: (f64, f64),
}

/// The largest and the next largest reading to one side.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Side {
    largest: f64,
    rows: u64,
    /// Rows of the largest that repeat the row before.
    repeats: u64,
    next: f64,
    next_rows: u64,
}

impl Default for Side {
    fn default() -> Self {
        Self { largest: f64::NEG_INFINITY, rows: 0, repeats: 0, next: f64::NEG_INFINITY, next_rows: 0 }
    }
}

fn is_same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * a.abs()
}

/// Whether a number has no more than six digits that count.
fn is_short(value: f64) -> bool {
    let digits = value.abs() * 10_f64.powf(5.0 - value.abs().log10().floor());
    (digits - digits.round()).abs() < 1e-5
}

impl Side {
    fn push(&mut self, value: f64, repeated: bool) {
        if is_same(value, self.largest) {
            self.rows += 1;
            self.repeats += u64::from(repeated);
        } else if value > self.largest {
            *self = Self { largest: value, rows: 1, repeats: 0, next: self.largest, next_rows: self.rows };
        } else if is_same(value, self.next) {
            self.next_rows += 1;
        } else if value > self.next {
            (self.next, self.next_rows) = (value, 1);
        }
    }

    /// Whether readings pile up at the largest one.
    fn is_cliff(&self) -> bool {
        self.rows >= SATURATED && self.rows >= CLIFF * self.next_rows && self.next_rows > 0
    }
}

impl Sensor {
    /// Takes in a reading, as an increment and as a rate; `time` is that of the one before.
    fn push(&mut self, increment: f64, value: f64, time: f64) {
        if self.rows.is_multiple_of(LOOKED_AT) && value != 0.0 {
            self.looked_at += 1;
            self.short += u64::from(is_short(increment) || is_short(value));
        }
        if self.rows > 1 {
            let (there, back) = (self.last - self.before, self.last - value);
            if (there - back).abs() < TAKEN_BACK * there.abs() && there.abs() > self.jump.0.abs() {
                self.jump = (there, time);
            }
        }
        if self.rows > 0 {
            self.steps += (value - self.last).abs();
        }
        self.before = self.last;
        let repeated = self.rows > 0 && is_same(value, self.last);
        self.rows += 1;
        self.repeats += u64::from(repeated);
        self.last = value;
        self.sides[0].push(value, repeated);
        self.sides[1].push(-value, repeated);
    }

    fn saturated(&self) -> Option<(f64, u64)> {
        let elsewhere = self.rows - self.sides.iter().map(|side| side.rows).sum::<u64>().min(self.rows);
        let repeats =
            self.repeats - self.sides.iter().map(|side| side.repeats).sum::<u64>().min(self.repeats);
        if repeats as f64 > NOISELESS * elsewhere as f64 {
            return None;
        }
        let [up, down] = &self.sides;
        let found = [(up, 1.0), (down, -1.0)].into_iter().find(|(side, _)| side.is_cliff());
        found.map(|(side, sign)| (sign * side.largest, side.rows))
    }
}

/// A sensor that reads its largest value again and again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Saturated {
    /// Which.
    pub sensor: &'static str,
    /// The value, rad/s or m/s^2.
    pub at: f64,
    /// Number of rows that it stands in.
    pub rows: u64,
}

impl fmt::Display for Saturated {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { sensor, at, rows } = self;
        let unit = if sensor.starts_with("gyro") { "rad/s" } else { "m/s^2" };
        write!(f, "{sensor} is saturated: it reads {at:.4} {unit} in {rows} rows and nothing beyond")
    }
}

impl Look {
    /// Takes in the next sample.
    pub fn push(&mut self, sample: &Sample) {
        let interval = self.time.map(|time| sample.time - time);
        self.time = Some(sample.time);
        self.reference(&sample.reference);
        let mut temperatures = sample.temperature.iter().chain(&sample.gyro_temperature);
        self.began_at = self.began_at.or_else(|| temperatures.find(|t| t.is_finite()).copied());
        // of the first interval nothing is known
        let Some(interval) = interval else { return };
        let values = sample.dtheta.iter().chain(&sample.dvel);
        let time = sample.time - interval;
        self.sensors
            .iter_mut()
            .zip(values)
            .for_each(|(sensor, value)| sensor.push(*value, value / interval, time));
    }

    fn reference(&mut self, reference: &Reference) {
        if !reference.is_read() {
            return;
        }
        self.readings += 1;
        let Reference { velocity, position, rate, .. } = reference;
        let at_rest = [velocity, rate].into_iter().flatten().all(|reading| reading.amax() == 0.0);
        let away = position.zip(self.at).is_some_and(|(here, there)| here != there);
        // whoever reads anything else reads
        let more = Reference { velocity: None, position: None, rate: None, ..*reference }.is_read();
        self.moves |= away || !at_rest || more;
        self.at = self.at.or(*position);
    }

    /// Whether the reference is a point that never moves, to the bit: nobody has read it.
    pub fn is_fixed_point(&self) -> bool {
        self.readings > 1 && !self.moves
    }

    /// The first temperature as it stands in the log and what it would be in degC, where it looks as if it were in degF.
    pub fn fahrenheit(&self) -> Option<(f64, f64)> {
        let read = self.began_at?;
        let told = (read - 32.0) / 1.8;
        (read > HEATED && (told - ROOM.0).abs() < ROOM.1).then_some((read, told))
    }

    /// The first sensor that saturates.
    pub fn saturated(&self) -> Option<Saturated> {
        self.sensors
            .iter()
            .zip(SENSORS)
            .find_map(|(found, sensor)| found.saturated().map(|(at, rows)| Saturated { sensor, at, rows }))
    }

    /// Sensors that read nothing but zero.
    pub fn dead(&self) -> impl Iterator<Item = &'static str> + '_ {
        let is_dead = |found: &Sensor| found.rows > 1 && found.steps == 0.0 && found.last == 0.0;
        self.sensors.iter().zip(SENSORS).filter(move |(found, _)| is_dead(found)).map(|(_, sensor)| sensor)
    }

    /// The reading that stands out most from both its neighbours: which sensor, when (s), and by how much (rad/s or m/s^2).
    pub fn spike(&self) -> Option<(&'static str, f64, f64)> {
        let size = |found: &Sensor| found.jump.0.abs() / (found.steps / found.rows as f64);
        let jumps = self.sensors.iter().zip(SENSORS).filter(|(found, _)| size(found) > STANDS_OUT);
        let largest = jumps.max_by(|a, b| size(a.0).total_cmp(&size(b.0)));
        largest.map(|(found, sensor)| (sensor, found.jump.1, found.jump.0))
    }

    /// Sensors whose readings are written with so few digits that these are about the size of their noise, and the part of the rows that repeat the row before.
    pub fn rounded(&self) -> impl Iterator<Item = (&'static str, f64)> + '_ {
        let is_written = |found: &Sensor| found.short as f64 > WRITTEN * found.looked_at as f64;
        let sensors = self.sensors.iter().zip(SENSORS);
        let written = sensors.filter(move |(found, _)| found.rows >= FEWEST && is_written(found));
        written.filter_map(|(found, sensor)| {
            let part = found.repeats as f64 / found.rows as f64;
            (ROUNDED[0]..ROUNDED[1]).contains(&part).then_some((sensor, part))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Forces on the z axis, m/s^2, at 100 Hz; the other sensors read noise.
    fn look(forces: impl IntoIterator<Item = f64>) -> Look {
        let mut look = Look::default();
        for (k, force) in forces.into_iter().enumerate() {
            let noise = |by: f64| (by * (k * k % 997) as f64).sin() * 1e-4;
            look.push(&Sample {
                time: 0.01 * k as f64,
                dtheta: Vector3::new(noise(1.1), noise(1.3), noise(1.7)) * 0.01,
                dvel: Vector3::new(noise(1.9), noise(2.3), force) * 0.01,
                temperature: Vector3::repeat(f64::NAN),
                gyro_temperature: Vector3::repeat(f64::NAN),
                dither: Vector3::repeat(f64::NAN),
                reference: Reference { velocity: Some(Vector3::zeros()), ..Reference::default() },
            });
        }
        look
    }

    /// A unit that turns over slowly, with noise.
    fn turning(k: usize) -> f64 {
        9.8 * (1e-3 * k as f64).cos() + 1e-3 * ((k * 7919 % 1009) as f64 / 504.5 - 1.0)
    }

    #[test]
    fn what_is_clipped_is_seen_to_either_side() {
        assert_eq!(look((0..40_000).map(turning)).saturated(), None);
        for (low, high) in [(-9.7, 20.0), (-20.0, 9.7)] {
            let found = look((0..40_000).map(|k| turning(k).clamp(low, high))).saturated();
            let found = found.expect("a saturated sensor");
            assert_eq!(found.sensor, "accelerometer z");
            assert!((found.at.abs() - 9.7).abs() < 1e-6 && (1000..3000).contains(&found.rows), "{found}");
            assert_eq!(found.at > 0.0, high < 10.0);
        }
        let said = Saturated { sensor: "gyro x", at: -2.0, rows: 1200 }.to_string();
        assert_eq!(said, "gyro x is saturated: it reads -2.0000 rad/s in 1200 rows and nothing beyond");
    }

    #[test]
    fn rests_without_noise_are_not_saturated() {
        let at_rest = |k: usize| [9.79, 1.0, -3.0, 0.5][k / 3000 % 4];
        assert_eq!(look((0..24_000).map(at_rest)).saturated(), None);
        assert_eq!(look([9.79; 5000]).saturated(), None);
        // and neither are counts of pulses
        let pulses = |k: usize| (turning(k) * 50.0).round() / 50.0;
        assert_eq!(look((0..40_000).map(pulses)).saturated(), None);
    }

    #[test]
    fn digits_as_coarse_as_the_noise_are_seen() {
        assert_eq!(look((0..5000).map(turning)).rounded().count(), 0);
        let steps = |step: f64| {
            let look = look((0..5000).map(|k| {
                let noise = 1.5 * ((k * 7919 % 1009) as f64 / 504.5 - 1.0);
                (9.79 / step + noise).round() * step
            }));
            look.rounded().map(|(sensor, _)| sensor).collect::<Vec<_>>()
        };
        assert_eq!(steps(1e-3), ["accelerometer z"]);
        // pulses of any size are counted, not rounded
        assert!(steps(1.234_567_89e-3).is_empty());
    }

    #[test]
    fn a_spike_of_one_row_is_found_and_a_turn_is_none() {
        assert_eq!(look((0..5000).map(turning)).spike(), None);
        let spiked = look((0..5000).map(|k| turning(k) + if k == 700 { 5.0 } else { 0.0 }));
        let (sensor, time, by) = spiked.spike().expect("a spike");
        assert_eq!(sensor, "accelerometer z");
        assert!((time - 7.0).abs() < 1e-9 && (by - 5.0).abs() < 0.1, "{time} {by}");
        // a step stays
        assert_eq!(look((0..5000).map(|k| turning(k) + if k > 700 { 5.0 } else { 0.0 })).spike(), None);
    }

    #[test]
    fn a_room_that_is_hot_is_looked_at_in_fahrenheit() {
        let begun_at = |temperature: f64| {
            let mut look = Look::default();
            for temperature in [f64::NAN, temperature, temperature + 30.0] {
                look.push(&Sample {
                    time: 0.0,
                    dtheta: Vector3::zeros(),
                    dvel: Vector3::zeros(),
                    temperature: Vector3::repeat(temperature),
                    gyro_temperature: Vector3::repeat(f64::NAN),
                    dither: Vector3::repeat(f64::NAN),
                    reference: Reference::default(),
                });
            }
            look.fahrenheit()
        };
        assert_eq!(begun_at(77.0), Some((77.0, 25.0)));
        for sound in [-20.0, 25.0, 50.0, 95.0] {
            assert_eq!(begun_at(sound), None, "{sound}");
        }
    }

    #[test]
    fn a_dead_sensor_reads_nothing_but_zero() {
        assert_eq!(look((0..100).map(turning)).dead().count(), 0);
        assert_eq!(look([0.0; 100]).dead().collect::<Vec<_>>(), ["accelerometer z"]);
        assert_eq!(look([9.79; 100]).dead().count(), 0);
    }

    #[test]
    fn a_point_that_moves_is_not_fixed() {
        let mut still = look([9.8; 100]);
        assert!(still.is_fixed_point());
        let reference = |position: Option<Vector3<f64>>| Reference { position, ..Reference::default() };
        still.reference(&reference(Some(Vector3::new(1.0, 2.0, 3.0))));
        assert!(still.is_fixed_point());
        still.reference(&reference(Some(Vector3::new(1.0, 2.0, 3.001))));
        assert!(!still.is_fixed_point());
        assert!(!Look::default().is_fixed_point());
    }
}
