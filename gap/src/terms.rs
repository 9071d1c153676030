//! Monomials of what was measured, up to the third degree: the neighbours of every effect, and what a law is made of.

use core::fmt::Write as _;

use crate::dictionary::Moment;

/// What a term multiplies; axes are counted from the sensor's own: i, j, k.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Signal {
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

use Signal::{Dither, Force, OwnForce, OwnTurn, Rate, Temperature, TemperatureRate, Time, Turn};

const AXES: [&str; 3] = ["i", "j", "k"];

impl Signal {
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

    fn value(self, moment: &Moment, is_gyro: bool, i: usize) -> f64 {
        let motion = moment.motion;
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
            Time => moment.time,
            Dither => 2.0 * motion.dither[i],
        }
    }
}

/// A product of signals.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Term(Vec<Signal>);

impl Term {
    /// All of them: products of rates, forces, temperature and its rate up to the third degree, and of sizes, time and dither up to the
    /// second.
    pub(crate) fn all() -> Vec<Self> {
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
    fn powers(&self) -> Vec<(Signal, usize)> {
        let mut powers: Vec<(Signal, usize)> = Vec::new();
        for signal in &self.0 {
            match powers.iter_mut().find(|known| known.0 == *signal) {
                Some(known) => known.1 += 1,
                None => powers.push((*signal, 1)),
            }
        }
        powers
    }

    /// As equations write it.
    pub(crate) fn formula(&self) -> String {
        let factor = |(signal, power): (Signal, usize)| match (signal.words(), power) {
            ((symbol, ..), 1) => symbol,
            ((symbol, true, ..), power) => format!("({symbol})^{power}"),
            ((symbol, ..), power) => format!("{symbol}^{power}"),
        };
        self.powers().into_iter().map(factor).collect::<Vec<_>>().join(" ")
    }

    /// As names do, for instance `temperature-times-force-i-squared`.
    pub(crate) fn words(&self) -> String {
        let factor = |(signal, power): (Signal, usize)| {
            let word = signal.words().2;
            match power {
                1 => word,
                2 => word + "-squared",
                _ => word + "-cubed",
            }
        };
        self.powers().into_iter().map(factor).collect::<Vec<_>>().join("-times-")
    }

    /// Unit of a coefficient that makes it something of `unit`.
    pub(crate) fn unit(&self, unit: &str) -> String {
        let powers = self.powers();
        let mut text = format!("{unit}/");
        if powers.len() > 1 {
            text.push('(');
        }
        for (at, (signal, power)) in powers.iter().enumerate() {
            let own = signal.words().3;
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

    /// Its value for the gyro or the accelerometer of axis i.
    pub(crate) fn value(&self, moment: &Moment, is_gyro: bool, i: usize) -> f64 {
        self.0.iter().map(|signal| signal.value(moment, is_gyro, i)).product()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_are_written_with_their_powers_and_units() {
        let written = |signals: &[Signal]| {
            let term = Term(signals.to_vec());
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
