//! Monomials of what was measured, up to the third degree: the neighbours of every effect, and what a law is made of.

use core::fmt::Write as _;

use nalgebra::Vector3;

use crate::Signals;

/// What was measured at an instant and an error may go with, in b; temperatures are against the reference temperature.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Angular rate, rad/s.
    pub rate: Vector3<f64>,
    /// Specific force, m/s^2.
    pub force: Vector3<f64>,
    /// Of the accelerometers, K.
    pub temperature: Vector3<f64>,
    /// Its rate of change, K/s.
    pub temperature_rate: Vector3<f64>,
    /// Of the gyros, K.
    pub gyro_temperature: Vector3<f64>,
    /// Its rate of change, K/s.
    pub gyro_temperature_rate: Vector3<f64>,
    /// Mean square of the dither rate, (rad/s)^2.
    pub dither: Vector3<f64>,
    /// Since the first sample, s.
    pub time: f64,
}

impl From<&Signals<f64>> for Motion {
    fn from(signals: &Signals<f64>) -> Self {
        Self {
            rate: signals.rate,
            force: signals.force,
            temperature: signals.temperature,
            temperature_rate: signals.temperature_rate,
            gyro_temperature: signals.gyro_temperature,
            gyro_temperature_rate: signals.gyro_temperature_rate,
            dither: signals.dither,
            time: signals.time,
        }
    }
}

/// What a term multiplies; axes are counted from the sensor's own: i, j, k.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Factor {
    Rate(usize),
    Force(usize),
    /// |omega|
    Turn,
    /// |omega_i|
    OwnTurn,
    /// |f_i|
    OwnForce,
    Temperature,
    TemperatureRate,
    Time,
    /// A_i^2
    Dither,
}

use Factor::{Dither, Force, OwnForce, OwnTurn, Rate, Temperature, TemperatureRate, Time, Turn};

const AXES: [&str; 3] = ["i", "j", "k"];

impl Factor {
    /// As equations write it, whether a power needs brackets around it, as names do, and its unit.
    fn words(self) -> (String, bool, String, &'static str) {
        let plain = |symbol: &str, word: &str, unit| (symbol.into(), false, word.into(), unit);
        match self {
            Rate(axis) => (format!("omega_{}", AXES[axis]), false, format!("rate-{}", AXES[axis]), "rad/s"),
            Force(axis) => (format!("f_{}", AXES[axis]), false, format!("force-{}", AXES[axis]), "m/s^2"),
            Turn => plain("|omega|", "size-of-rate", "rad/s"),
            OwnTurn => plain("|omega_i|", "size-of-rate-i", "rad/s"),
            OwnForce => plain("|f_i|", "size-of-force-i", "m/s^2"),
            Temperature => ("(T_i - T_ref)".into(), false, "temperature".into(), "K"),
            TemperatureRate => ("dT_i/dt".into(), true, "temperature-rate".into(), "K/s"),
            Time => plain("t", "time", "s"),
            Dither => ("A_i^2".into(), true, "dither".into(), "rad^2/s^2"),
        }
    }

    /// Where it is large, SI: what a turntable and a warm-up reach.
    fn large(self) -> f64 {
        match self {
            Rate(_) | Turn | OwnTurn | Dither => 1.0,
            Force(_) | OwnForce => 10.0,
            Temperature => 10.0,
            TemperatureRate => 0.01,
            Time => 3600.0,
        }
    }

    /// As a block in Rust reads it of its `signals` for axis `i`.
    fn code(self, is_gyro: bool) -> String {
        let axis = |axis: usize| if axis == 0 { "i".into() } else { format!("(i + {axis}) % 3") };
        let of = if is_gyro { "gyro_temperature" } else { "temperature" };
        match self {
            Rate(k) => format!("signals.rate[{}]", axis(k)),
            Force(k) => format!("signals.force[{}]", axis(k)),
            Turn => "signals.rate.norm()".into(),
            OwnTurn => "signals.rate[i].abs()".into(),
            OwnForce => "signals.force[i].abs()".into(),
            Temperature => format!("signals.{of}[i]"),
            TemperatureRate => format!("signals.{of}_rate[i]"),
            Time => "signals.time".into(),
            Dither => "(signals.dither[i] * T::of(2.0))".into(),
        }
    }

    fn value(self, motion: &Motion, is_gyro: bool, i: usize) -> f64 {
        match self {
            Rate(axis) => motion.rate[(i + axis) % 3],
            Force(axis) => motion.force[(i + axis) % 3],
            Turn => motion.rate.norm(),
            OwnTurn => motion.rate[i].abs(),
            OwnForce => motion.force[i].abs(),
            Temperature if is_gyro => motion.gyro_temperature[i],
            Temperature => motion.temperature[i],
            TemperatureRate if is_gyro => motion.gyro_temperature_rate[i],
            TemperatureRate => motion.temperature_rate[i],
            Time => motion.time,
            Dither => 2.0 * motion.dither[i],
        }
    }
}

/// A product of what was measured.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Term(Vec<Factor>);

impl Term {
    /// All of them: products of rates, forces, temperature and its rate up to the third degree, and of sizes, time and dither up to the
    /// second.
    pub(super) fn all() -> Vec<Self> {
        let letters = [Temperature, TemperatureRate, Rate(0), Rate(1), Rate(2), Force(0), Force(1), Force(2)];
        let mut terms = Vec::new();
        for (a, first) in letters.iter().enumerate() {
            terms.push(vec![*first]);
            for (b, second) in letters.iter().enumerate().skip(a) {
                terms.push(vec![*first, *second]);
                terms.extend(letters[b..].iter().map(|third| vec![*first, *second, *third]));
            }
        }
        for size in [Turn, Time] {
            terms.extend([vec![size], vec![size, size]]);
            terms.extend(letters.iter().map(|letter| vec![size, *letter]));
        }
        for size in [OwnTurn, OwnForce] {
            terms.extend([vec![size], vec![Temperature, size], vec![Turn, size]]);
        }
        terms.extend([vec![Dither], vec![Dither, Force(0)]]);
        terms.into_iter().map(Self).collect()
    }

    /// Its factors with their powers.
    fn powers(&self) -> Vec<(Factor, usize)> {
        let mut powers: Vec<(Factor, usize)> = Vec::new();
        for factor in &self.0 {
            match powers.iter_mut().find(|known| known.0 == *factor) {
                Some(known) => known.1 += 1,
                None => powers.push((*factor, 1)),
            }
        }
        powers
    }

    /// As equations write it.
    pub(super) fn formula(&self) -> String {
        let written = |(factor, power): (Factor, usize)| match (factor.words(), power) {
            ((symbol, ..), 1) => symbol,
            ((symbol, true, ..), power) => format!("({symbol})^{power}"),
            ((symbol, ..), power) => format!("{symbol}^{power}"),
        };
        self.powers().into_iter().map(written).collect::<Vec<_>>().join(" ")
    }

    /// As names do, for instance `temperature-times-force-i-squared`.
    pub(super) fn words(&self) -> String {
        let word = |(factor, power): (Factor, usize)| {
            let word = factor.words().2;
            match power {
                1 => word,
                2 => word + "-squared",
                _ => word + "-cubed",
            }
        };
        self.powers().into_iter().map(word).collect::<Vec<_>>().join("-times-")
    }

    /// Unit of a coefficient that makes it something of `unit`.
    pub(super) fn unit(&self, unit: &str) -> String {
        let powers = self.powers();
        let mut text = format!("{unit}/");
        if powers.len() > 1 {
            text.push('(');
        }
        for (at, (factor, power)) in powers.iter().enumerate() {
            let own = factor.words().3;
            let space = if at > 0 { " " } else { "" };
            // Writing to a string does not fail.
            let _ = match (own.contains('/'), *power) {
                (false, 1) => write!(text, "{space}{own}"),
                (true, 1) => write!(text, "{space}({own})"),
                (false, power) => write!(text, "{space}{own}^{power}"),
                (true, power) => write!(text, "{space}({own})^{power}"),
            };
        }
        if powers.len() > 1 {
            text.push(')');
        }
        text
    }

    /// Where all its factors are large, SI.
    pub(super) fn large(&self) -> f64 {
        self.0.iter().map(|factor| factor.large()).product()
    }

    /// As a block in Rust has it, of `signals` and the axis `i`.
    pub(super) fn code(&self, is_gyro: bool) -> String {
        let code = |(factor, power): (Factor, usize)| match power {
            1 => factor.code(is_gyro),
            power => format!("{}.powi({power})", factor.code(is_gyro)),
        };
        self.powers().into_iter().map(code).collect::<Vec<_>>().join(" * ")
    }

    /// Its value for the gyro or the accelerometer of axis i.
    pub(super) fn value(&self, motion: &Motion, is_gyro: bool, i: usize) -> f64 {
        self.0.iter().map(|factor| factor.value(motion, is_gyro, i)).product()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_are_written_with_their_powers_and_units() {
        let written = |factors: &[Factor]| {
            let term = Term(factors.to_vec());
            (term.formula(), term.words(), term.unit("m/s^2"))
        };
        assert_eq!(
            written(&[TemperatureRate, TemperatureRate]),
            ("(dT_i/dt)^2".into(), "temperature-rate-squared".into(), "m/s^2/(K/s)^2".into())
        );
        assert_eq!(
            written(&[Temperature, Force(1), Force(1)]),
            (
                "(T_i - T_ref) f_j^2".into(),
                "temperature-times-force-j-squared".into(),
                "m/s^2/(K (m/s^2)^2)".into()
            )
        );
        assert_eq!(written(&[Time]), ("t".into(), "time".into(), "m/s^2/s".into()));
    }

    #[test]
    fn no_term_is_there_twice() {
        let all = Term::all();
        for (i, term) in all.iter().enumerate() {
            assert!(!all[..i].contains(term), "{}", term.formula());
            assert!(all.iter().filter(|other| other.words() == term.words()).count() == 1);
        }
        // 8 + 36 + 120, twice 10, six with sizes and two with dither
        assert_eq!(all.len(), 192);
    }
}
