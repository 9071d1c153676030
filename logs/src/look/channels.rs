//! Each channel by itself: clipped at the end of its range, stuck, written twice.

use nalgebra::Vector3;

use crate::rests::Rests;

/// So many rows at the very same extreme, so many of them in a row, are a limit of the range.
const CLIPPED: (u64, u64) = (5, 3);
/// And so many times those at the next value.
const CROWD: u64 = 3;
/// A value stands for so long before it is stuck, s, and for so many rows.
const STUCK: (f64, u64) = (1.0, 30);
/// A sensor that counts pulses rests at one value, and goes from it by this many of its smallest steps at most.
const PULSES: f64 = 2.5;
/// This part of the rows repeats the row before where a sensor is slower than the log.
const REPEATED: f64 = 0.2;

const NAMES: [&str; 6] = ["gyro x", "gyro y", "gyro z", "accel x", "accel y", "accel z"];

/// Rows at the largest and at the next value, of one sign.
#[derive(Clone, Copy, Default)]
struct Extreme {
    value: f64,
    count: u64,
    first: u64,
    last: u64,
    /// The longest run of rows at it, and the present one.
    longest: u64,
    run: u64,
    next: f64,
    next_count: u64,
}

impl Extreme {
    fn push(&mut self, value: f64, row: u64) {
        // a rate that was made of an increment and back differs in the last digit
        let same = |a: f64, b: f64| (a - b).abs() <= 1e-9 * b.abs();
        if self.count > 0 && same(value, self.value) {
            self.count += 1;
            self.run = if self.last + 1 == row { self.run + 1 } else { 1 };
            self.last = row;
        } else if value > self.value || self.count == 0 {
            let (next, next_count) = (self.value, self.count);
            *self = Self { value, count: 1, first: row, last: row, run: 1, longest: 0, next, next_count };
        } else if same(value, self.next) {
            self.next_count += 1;
        } else if value > self.next {
            (self.next, self.next_count) = (value, 1);
        }
        self.longest = self.longest.max(self.run);
    }

    fn is_limit(&self) -> bool {
        self.count >= CLIPPED.0 && self.longest >= CLIPPED.1 && self.count > CROWD * self.next_count
    }
}

/// A value that stays.
#[derive(Clone, Copy)]
struct Still {
    value: f64,
    run: u64,
    changes: u64,
    /// The longest run, rows.
    longest: u64,
    /// The longest run that is not what a sensor that counts pulses does where it feels next to nothing: rows, and its last row.
    hung: (u64, u64),
    /// The largest value without its sign, the smallest step from a value to another, and the step to this value.
    largest: f64,
    least: f64,
    step: f64,
}

impl Still {
    const NOTHING: Self = Self {
        value: 0.0,
        run: 0,
        changes: 0,
        longest: 0,
        hung: (0, 0),
        largest: 0.0,
        least: f64::INFINITY,
        step: 0.0,
    };

    fn push(&mut self, value: f64, row: u64) {
        let step = (value - self.value).abs();
        self.largest = self.largest.max(value.abs());
        if self.changes > 0 && step <= 1e-9 * value.abs() {
            self.run += 1;
        } else {
            if self.changes > 0 {
                // what differs in the last digits is the same
                if step > 1e-9 * self.largest {
                    self.least = self.least.min(step);
                }
                self.hung = self.hung_after(step, row - 1);
                self.step = step;
            }
            self.changes += 1;
            (self.value, self.run) = (value, 1);
        }
        self.longest = self.longest.max(self.run);
    }

    /// The longest hung run where the present one ends with a row and a step.
    fn hung_after(&self, step: f64, row: u64) -> (u64, u64) {
        let counts = self.step.max(step) <= PULSES * self.least;
        if counts || self.run <= self.hung.0 { self.hung } else { (self.run, row) }
    }

    /// The same where the log ends with a row.
    fn hung_until(&self, row: u64) -> (u64, u64) {
        if self.changes <= 1 { (self.run, row) } else { self.hung_after(0.0, row) }
    }
}

/// Takes in rates and forces.
pub(crate) struct Channels {
    interval: f64,
    rows: u64,
    extremes: [[Extreme; 2]; 6],
    still: [Still; 6],
    last: [f64; 6],
    repeated: u64,
}

impl Channels {
    pub(crate) fn new(interval: f64) -> Self {
        Self {
            interval,
            rows: 0,
            extremes: [[Extreme::default(); 2]; 6],
            still: [Still::NOTHING; 6],
            last: [f64::NAN; 6],
            repeated: 0,
        }
    }

    pub(crate) fn push(&mut self, rate: &Vector3<f64>, force: &Vector3<f64>) {
        self.rows += 1;
        let row = self.rows;
        let values: [f64; 6] = std::array::from_fn(|of| if of < 3 { rate[of] } else { force[of - 3] });
        for ((value, extremes), still) in values.into_iter().zip(&mut self.extremes).zip(&mut self.still) {
            if !value.is_finite() {
                continue;
            }
            extremes[0].push(value, row);
            extremes[1].push(-value, row);
            still.push(value, row);
        }
        self.repeated += u64::from(self.last == values);
        self.last = values;
    }

    pub(crate) fn warnings(&self, rests: &Rests) -> Vec<String> {
        let mut warnings = Vec::new();
        let scatter = |of: usize| rests.noise.is_none_or(|noise| noise[of / 3][of % 3] > 0.0);
        let unit = |of: usize| if of < 3 { "rad/s" } else { "m/s^2" };
        let exact = self.still.iter().filter(|still| still.longest > STUCK.1).count();
        for of in 0..6 {
            let still = &self.still[of];
            let (rows, end) = still.hung_until(self.rows);
            let long = rows as f64 * self.interval >= STUCK.0 && rows >= STUCK.1;
            // where every channel stands a log was made without noise
            // what stands at the end of its range was clipped
            let clipped =
                self.extremes[of].iter().any(|extreme| extreme.longest == rows) && still.changes > 1;
            if long && exact < 6 && !clipped {
                let what = if still.changes <= 1 {
                    format!("reads nothing but {:.6} {}", still.value, unit(of))
                } else {
                    "holds one value".to_owned()
                };
                warnings.push(format!(
                    "rows {} to {end}: {} {what} in {rows} rows: the sensor is stuck or not connected, or the rows are made up: cut them out",
                    end + 1 - rows,
                    NAMES[of]
                ));
                continue;
            }
            for (extreme, sign) in self.extremes[of].iter().zip([1.0, -1.0]) {
                if extreme.is_limit() && scatter(of) && exact < 6 {
                    warnings.push(format!(
                        "rows {} to {}: {} stands at {:.6} {} in {} rows, its {} value: the range was exceeded; turn more slowly or set a \
                         larger range, and leave this part of the log out",
                        extreme.first,
                        extreme.last,
                        NAMES[of],
                        sign * extreme.value,
                        unit(of),
                        extreme.count,
                        if sign > 0.0 { "largest" } else { "smallest" }
                    ));
                }
            }
        }
        if self.repeated as f64 > REPEATED * self.rows as f64 && exact < 6 {
            warnings.push(format!(
                "rows 1 to {}: {} rows repeat the row before in all channels: the sensor is slower than the log; leave the repeated rows \
                 out, and state the sensor's own rate",
                self.rows, self.repeated
            ));
        }
        warnings
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(value: impl Fn(usize) -> f64) -> Vec<String> {
        let mut channels = Channels::new(0.05);
        for row in 0..2000 {
            let other = |of: usize| ((row * 7 + of) as f64 * 0.37).sin();
            channels.push(
                &Vector3::new(other(1), value(row), other(2)),
                &Vector3::new(other(3), other(4), 9.81 + other(5)),
            );
        }
        channels.warnings(&Rests::default())
    }

    #[test]
    fn a_range_that_was_exceeded_is_named_with_its_rows() {
        let swing = |row: usize| 1.2 * (row as f64 * 0.02).sin();
        assert_eq!(seen(swing), Vec::<String>::new());
        let told = seen(|row| swing(row).min(0.785));
        assert_eq!(told.len(), 1, "{told:?}");
        assert!(
            told[0].contains("gyro y stands at 0.785000 rad/s") && told[0].contains("larger range"),
            "{told:?}"
        );
        // values of few bits are no limit
        assert_eq!(seen(|row| (swing(row) * 100.0).round() / 100.0), Vec::<String>::new());
    }

    #[test]
    fn a_channel_that_stands_is_stuck() {
        let told = seen(|row| if (500..700).contains(&row) { 0.25 } else { (row as f64 * 0.3).sin() });
        assert_eq!(told.len(), 1, "{told:?}");
        assert!(told[0].starts_with("rows 501 to 700: gyro y holds one value in 200 rows"), "{told:?}");
        assert!(seen(|_| 0.0)[0].contains("reads nothing but 0.000000 rad/s"));
    }

    #[test]
    fn a_sensor_that_counts_pulses_may_rest_at_one_value() {
        // a pulse now and then, none for 300 rows, and turns between
        let pulses = |row: usize| match row {
            500..800 => 3e-5,
            0..1000 => [2e-5, 3e-5, 3e-5, 4e-5][row % 4],
            _ => 0.5 + 1e-5 * (row % 5) as f64,
        };
        assert_eq!(seen(pulses), Vec::<String>::new());
        // one that hangs while the others turn does not go on where it was
        let hangs = |row: usize| if (1200..1500).contains(&row) { 3e-5 } else { pulses(row) };
        assert!(seen(hangs)[0].contains("gyro y holds one value in 300 rows"), "{:?}", seen(hangs));
    }
}
