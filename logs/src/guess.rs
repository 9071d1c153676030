//! A map for a file that nobody has described: which columns are meant is in their names, in which units they are in the numbers.

use std::path::Path;

use super::columns::{Batch, Group};
use super::files::Kind;
use super::layout::Part;
use super::map::ColumnMap;
use super::reading::Reading;
use super::stamps::Stamps;
use super::still::STANDARD_GRAVITY;
use super::table::{Known, Table};

/// Rates of logs, Hz: wider apart than these are from each other no two units of time are.
const RATES: (f64, f64) = (4.0, 4000.0);
/// Specific force is gravity to this part.
const GRAVITY: f64 = 0.2;
/// Counts of g are powers of two, to this part of gravity.
const COUNTS: f64 = 0.1;
/// Nothing that is turned by hand turns faster, rad/s: such numbers are degrees.
const FASTEST: f64 = 40.0;

/// Which columns likely are gyros, accelerometers and time.
#[derive(Clone, Debug)]
pub(super) struct Suggestion {
    pub(super) gyro: Source,
    pub(super) accel: Source,
    pub(super) time: Option<Source>,
}

/// A name, and the unit behind it.
#[derive(Clone, Debug)]
pub(super) struct Source {
    pub(super) name: String,
    pub(super) unit: Unit,
}

/// Where a unit comes from.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Unit {
    /// The name says it.
    Named,
    /// It is the usual one, or what the numbers look like.
    Usual(String),
}

impl Source {
    fn text(&self) -> String {
        match &self.unit {
            Unit::Named => self.name.clone(),
            Unit::Usual(unit) => format!("{}:{unit}", self.name),
        }
    }

    /// Settles a unit that the name does not say.
    fn settle(&mut self, unit: Option<String>) {
        if let (Unit::Usual(usual), Some(unit)) = (&mut self.unit, unit) {
            *usual = unit;
        }
    }
}

impl Suggestion {
    fn text(&self) -> String {
        let time = self.time.as_ref().map(|time| format!(",time={}", time.text())).unwrap_or_default();
        format!("gyro={},accel={}{time}", self.gyro.text(), self.accel.text())
    }

    /// As it is typed.
    pub(super) fn argument(&self) -> String {
        let text = self.text();
        let plain = |c: char| c.is_ascii_alphanumeric() || "_=,:./^+-[]".contains(c);
        if text.chars().all(plain) { format!("--map {text}") } else { format!("--map '{text}'") }
    }

    /// As it is read; none where a name cannot be typed.
    pub(super) fn map(&self) -> ColumnMap {
        self.text().parse().unwrap_or_default()
    }

    /// The same with the units that the first numbers look like.
    pub(super) fn by_numbers(&self, path: &Path, kind: Kind, reading: &Reading, known: Known) -> Self {
        let mut better = self.clone();
        // each stamp as it stands, whatever they are worth
        let reading = Reading { map: self.map(), stamps: Some(Stamps::Trust), ..reading.clone() };
        let rate = known.rate;
        let known = Known { rate: Some(rate.unwrap_or(1.0)), ..known };
        let Ok(table) = Table::open_as(path, kind, &reading, Part::Unit, known) else { return better };
        let Ok(rows) = table.first_rows() else { return better };
        let force = middle(norms(&rows, Group::DVEL));
        let accel = force.and_then(|force| force_unit(force, rate));
        let turns = norms(&rows, Group::DTHETA).fold(0.0, f64::max);
        better.gyro.settle(rate_unit(&better.gyro.name, turns, accel.as_deref()));
        better.accel.settle(accel);
        if let Some(time) = &mut better.time {
            time.settle(time_unit(rows.times(), rate));
        }
        better
    }
}

fn norms(rows: &Batch, group: Group) -> impl Iterator<Item = f64> {
    let norm = move |row| group.slots().map(|slot| rows.cell(slot, row).powi(2)).sum::<f64>().sqrt();
    (0..rows.rows).map(norm).filter(|norm| norm.is_finite())
}

fn middle(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// The unit in which gravity reads so much.
fn force_unit(force: f64, rate: Option<f64>) -> Option<String> {
    let is = |unit: f64, part: f64| (force * unit / STANDARD_GRAVITY - 1.0).abs() < part;
    let known = [("m/s^2", 1.0), ("g", STANDARD_GRAVITY), ("mg", 1e-3 * STANDARD_GRAVITY)];
    if let Some((name, _)) = known.iter().find(|(_, size)| is(*size, GRAVITY)) {
        return Some((*name).to_owned());
    }
    let counts = (10..=15).map(|power| 1_u32 << power);
    let mut counts = counts.filter(|counts| is(STANDARD_GRAVITY / f64::from(*counts), COUNTS));
    if let Some(counts) = counts.next() {
        return Some(format!("{counts} LSB/g"));
    }
    // increments
    rate.filter(|rate| is(*rate, GRAVITY)).map(|_| "m/s".into())
}

/// The unit of gyros that goes with that of the accelerometers, where no name says it.
fn rate_unit(name: &str, fastest: f64, accel: Option<&str>) -> Option<String> {
    let name = name.to_ascii_lowercase();
    let unit = match accel {
        _ if name.contains("deg") || name.contains("dps") => "deg/s",
        Some("m/s") => "rad",
        // the narrowest range of the chips whose accelerometers have that of 2 g
        Some(counts) if counts.ends_with("LSB/g") => "131 LSB/(deg/s)",
        _ if name.contains("rad") => "rad/s",
        Some("g" | "mg") => "deg/s",
        _ if fastest > FASTEST => "deg/s",
        _ => "rad/s",
    };
    Some(unit.into())
}

/// The unit in which stamps come at the rate of a log.
fn time_unit(times: &[f64], rate: Option<f64>) -> Option<String> {
    let step = middle(times.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0))?;
    let units = [("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)];
    let fits = |(_, size): &&(&str, f64)| {
        let found = 1.0 / (step * size);
        match rate {
            Some(rate) => (found / rate).ln().abs() < 1.0,
            None => (RATES.0..RATES.1).contains(&found),
        }
    };
    units.iter().find(fits).map(|(name, _)| (*name).to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_tell_units() {
        let of = |force, rate| force_unit(force, rate);
        assert_eq!(of(9.79, None).as_deref(), Some("m/s^2"));
        assert_eq!(of(1.01, None).as_deref(), Some("g"));
        assert_eq!(of(1003.0, None).as_deref(), Some("mg"));
        assert_eq!(of(16_300.0, None).as_deref(), Some("16384 LSB/g"));
        assert_eq!((of(0.049, Some(200.0)).as_deref(), of(0.049, None)), (Some("m/s"), None));
        for (step, unit) in [(0.005, "s"), (5.0, "ms"), (5000.0, "us"), (5e6, "ns")] {
            let times: Vec<f64> = (0..40).map(|row| 1e6 + f64::from(row) * step).collect();
            assert_eq!(time_unit(&times, None).as_deref(), Some(unit));
            assert_eq!(time_unit(&times, Some(200.0)).as_deref(), Some(unit));
        }
        assert_eq!(time_unit(&[1.0, 1.0], None), None);
        let rate = |name, fastest, accel| rate_unit(name, fastest, accel);
        assert_eq!(rate("w", 0.5, Some("m/s^2")).as_deref(), Some("rad/s"));
        assert_eq!(rate("w", 0.5, Some("g")).as_deref(), Some("deg/s"));
        assert_eq!(rate("w", 90.0, Some("m/s^2")).as_deref(), Some("deg/s"));
        assert_eq!(rate("gyro_rad", 90.0, Some("g")).as_deref(), Some("rad/s"));
    }

    #[test]
    fn what_a_shell_would_take_apart_is_quoted() {
        let source = |name: &str| Source { name: name.into(), unit: Unit::Named };
        let of = |gyro: &str| Suggestion { gyro: source(gyro), accel: source("a"), time: None }.argument();
        assert_eq!(of("w"), "--map gyro=w,accel=a");
        assert_eq!(of("w (deg)"), "--map 'gyro=w (deg),accel=a'");
    }
}
