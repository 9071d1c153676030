//! Units as people and their files write them: `rad s^-1`, `m/s²`, `dps`, `mG`, `131 LSB/(deg/s)`, `kelvin`.
//!
//! A unit is read as a product of powers, so that every spelling of one is the same; it is then looked up among the units of
//! what it is for.

use crate::suggest;
use crate::units::{self, DEGREE, Units};

use super::columns::Group;
use super::map::Unit;

/// Further units that stand in files and are not offered for figures of a description.
const RATES: Units = &[("mdeg/s", DEGREE * 1e-3), ("deg/min", DEGREE / 60.0), ("rpm", 6.0 * DEGREE)];
const VELOCITIES: Units = &[
    ("cm/s", 1e-2),
    ("km/h", 1.0 / 3.6),
    ("ft/s", 0.3048),
    ("knots", 1852.0 / 3600.0),
    ("g s", units::MICRO_G * 1e6),
];
const LENGTHS: Units = &[("km", 1e3), ("ft", 0.3048)];
const FORCES: Units = &[("cm/s^2", 1e-2), ("mm/s^2", 1e-3), ("ft/s^2", 0.3048)];
const ONE: Units = &[("1", 1.0)];
/// Units of temperature: size of a degree, and what is 0 degC.
const TEMPERATURES: [(&str, f64, f64); 3] =
    [("degC", 1.0, 0.0), ("K", 1.0, 273.15), ("degF", 5.0 / 9.0, 32.0)];

/// Whole spellings that are no products.
const WHOLE: [(&str, &str); 23] = [
    ("c", "degC"),
    ("degc", "degC"),
    ("deg c", "degC"),
    ("deg.c", "degC"),
    ("celsius", "degC"),
    ("degree celsius", "degC"),
    ("degrees celsius", "degC"),
    ("k", "K"),
    ("kelvin", "K"),
    ("f", "degF"),
    ("degf", "degF"),
    ("deg f", "degF"),
    ("fahrenheit", "degF"),
    ("dps", "deg/s"),
    ("mdps", "mdeg/s"),
    ("dph", "deg/h"),
    ("mps", "m/s"),
    ("mps2", "m/s^2"),
    ("mpss", "m/s^2"),
    ("mps^2", "m/s^2"),
    ("radps", "rad/s"),
    ("kph", "km/h"),
    ("kmh", "km/h"),
];

/// Spellings of one factor.
const FACTORS: [(&str, &[&str]); 16] = [
    ("s", &["sec", "secs", "second", "seconds"]),
    ("ms", &["msec", "millis", "millisecond", "milliseconds"]),
    ("us", &["usec", "micros", "microsecond", "microseconds"]),
    ("ns", &["nsec", "nanos", "nanosec", "nanosecond", "nanoseconds"]),
    ("min", &["mins", "minute", "minutes"]),
    ("h", &["hr", "hrs", "hour", "hours"]),
    ("days", &["day"]),
    ("deg", &["degs", "degree", "degrees"]),
    ("rad", &["rads", "radian", "radians"]),
    ("m", &["meter", "meters", "metre", "metres"]),
    ("g", &["G", "gn", "gee"]),
    ("mg", &["mG", "milli-g", "millig"]),
    ("ug", &["uG", "micro-g", "microg"]),
    ("knots", &["knot", "kn", "kt", "kts"]),
    ("ft", &["foot", "feet"]),
    ("LSB", &["lsb", "LSb", "count", "counts", "digit", "digits", "raw", "tick", "ticks", "adc"]),
];

/// The tables of a group's units: those of the format, and those that become them over an interval.
fn tables(group: Group) -> ([Units; 2], [Units; 2]) {
    let within = |of: Group| of.slots().contains(&group.first);
    let none: [Units; 2] = [&[], &[]];
    if within(Group::TIME) || within(Group::TIME_NANOS) {
        ([units::TIME, &[]], none)
    } else if within(Group::DTHETA) {
        ([units::ANGLE, &[]], [units::ANGULAR_RATE, RATES])
    } else if within(Group::DVEL) {
        ([units::VELOCITY, VELOCITIES], [units::FORCE, FORCES])
    } else if within(Group::DITHER) {
        ([units::ANGULAR_RATE, RATES], none)
    } else if within(Group::REF_VEL) || within(Group::REF_VEL_SIGMA) {
        ([units::VELOCITY, VELOCITIES], none)
    } else if within(Group::REF_POS) || within(Group::REF_POS_SIGMA) || within(Group::REF_HEIGHT) {
        ([units::LENGTH, LENGTHS], none)
    } else if within(Group::REF_LATLON)
        || within(Group::REF_HEADING)
        || within(Group::REF_EULER)
        || within(Group::REF_ATT_SIGMA)
    {
        ([units::ANGLE, &[]], none)
    } else {
        ([ONE, &[]], none)
    }
}

/// Reads the unit of a group's columns; says what is accepted otherwise.
pub(super) fn unit(group: Group, text: &str) -> Result<Unit, String> {
    let within = |of: Group| of.slots().contains(&group.first);
    if within(Group::TEMP) || within(Group::TEMP_GYRO) {
        let (number, name) = number(text);
        let wanted = Factors::read(name);
        let found = TEMPERATURES
            .iter()
            .find(|(unit, ..)| *unit == name || wanted.as_ref() == Some(&Factors::one(unit)));
        return match found {
            Some((_, size, zero)) => {
                Ok(Unit { scale: number.unwrap_or(1.0) * size, zero: *zero, per_interval: false })
            }
            None => Err(refusal(text, TEMPERATURES.iter().map(|(unit, ..)| *unit))),
        };
    }
    let (own, rates) = tables(group);
    if let Some(unit) = sized(text, own.into_iter().flatten()) {
        return Ok(Unit { scale: unit, zero: 0.0, per_interval: false });
    }
    if let Some(unit) = sized(text, rates.into_iter().flatten()) {
        return Ok(Unit { scale: unit, zero: 0.0, per_interval: true });
    }
    if Factors::read(text).is_some_and(|factors| factors == Factors::one("LSB")) {
        return Err("counts need a size: such as `131 LSB/(deg/s)`, `16384 LSB/g` or `0.061 mg/LSB`".into());
    }
    let offered: Vec<&str> = own[0].iter().chain(rates[0]).map(|(name, _)| *name).collect();
    Err(refusal(text, offered.iter().copied()))
}

/// Whether a text is a unit of anything that a log holds.
pub(super) fn is_unit(text: &str) -> bool {
    let groups = [Group::TIME, Group::DTHETA, Group::DVEL, Group::TEMP, Group::REF_VEL, Group::REF_POS];
    let counts = || Factors::read(text).is_some_and(|factors| factors == Factors::one("LSB"));
    groups.into_iter().any(|group| unit(group, text).is_ok()) || counts()
}

fn refusal<'a>(text: &str, names: impl Iterator<Item = &'a str> + Clone) -> String {
    let near = suggest::nearest(text, names.clone()).map(|near| format!("did you mean `{near}`? "));
    let all = names.collect::<Vec<_>>().join(", ");
    format!("`{text}` is not a unit of it; {}accepted: {all}", near.unwrap_or_default())
}

/// Size of what `text` says, a unit with or without a number, in the SI unit of the table.
fn sized<'a>(text: &str, units: impl Iterator<Item = &'a (&'static str, f64)> + Clone) -> Option<f64> {
    let text = text.trim();
    let size = |factors: &Factors| {
        units.clone().find(|(name, _)| Factors::read(name).as_ref() == Some(factors)).map(|(_, size)| *size)
    };
    if let Some((_, size)) = units.clone().find(|(name, _)| *name == text) {
        return Some(*size);
    }
    if let Some((unit, divisor)) = text.rsplit_once('/')
        && let Ok(divisor) = divisor.trim().parse::<f64>()
    {
        return (divisor != 0.0).then(|| size(&Factors::read(unit)?).map(|size| size / divisor))?;
    }
    let (number, unit) = number(text);
    let mut factors = Factors::read(unit)?;
    match (factors.take("LSB"), number) {
        (0, number) => Some(number.unwrap_or(1.0) * size(&factors)?),
        (-1, number) => Some(number.unwrap_or(1.0) * size(&factors)?),
        (1, Some(number)) if number != 0.0 => Some(size(&factors.inverse())? / number),
        _ => None,
    }
}

/// A number before a unit.
fn number(text: &str) -> (Option<f64>, &str) {
    let text = text.trim();
    match text.split_once(char::is_whitespace) {
        Some((number, unit)) => match number.parse::<f64>() {
            Ok(number) if number.is_finite() => (Some(number), unit.trim()),
            _ => (None, text),
        },
        None => (None, text),
    }
}

/// A product of powers, sorted.
#[derive(Clone, Debug, PartialEq)]
struct Factors(Vec<(String, i32)>);

impl Factors {
    fn one(name: &str) -> Self {
        Self(vec![(name.to_owned(), 1)])
    }

    /// Reads a product; nothing where it is none.
    fn read(text: &str) -> Option<Self> {
        let text = plain(text);
        let whole = text.to_lowercase();
        if let Some(unit) = whole_unit(&whole) {
            return if unit.contains('/') { Self::read(unit) } else { Some(Self::one(unit)) };
        }
        let mut factors = Vec::new();
        let mut rest = text.chars().peekable();
        // inside of brackets after a slash everything is below it
        let (mut below, mut nested) = (false, vec![1]);
        while let Some(c) = rest.next() {
            let outer = *nested.last()?;
            match c {
                ' ' | '*' | '.' => {}
                '/' => below = !below,
                '(' => {
                    nested.push(if below { -outer } else { outer });
                    below = false;
                }
                ')' => {
                    nested.pop();
                    nested.last()?;
                }
                c if c.is_alphabetic() || c == '%' => {
                    let mut name = String::from(c);
                    while let Some(c) = rest.next_if(|c| c.is_alphabetic()) {
                        name.push(c);
                    }
                    let mut power = String::new();
                    rest.next_if_eq(&'^');
                    while let Some(c) = rest.next_if(|c| c.is_ascii_digit() || "+-{}".contains(*c)) {
                        if !"{}".contains(c) {
                            power.push(c);
                        }
                    }
                    let power = if power.is_empty() {
                        1
                    } else {
                        power.parse::<i32>().ok().filter(|p| p.abs() < 9)?
                    };
                    let power = if below { -outer * power } else { outer * power };
                    match whole_unit(&name.to_lowercase()).filter(|unit| unit.contains('/')) {
                        Some(unit) => {
                            factors.extend(Self::read(unit)?.0.into_iter().map(|(of, p)| (of, p * power)))
                        }
                        None => factors.push((factor(&name), power)),
                    }
                    below = false;
                }
                '1' if rest.peek().is_none_or(|next| !next.is_ascii_digit()) => {}
                _ => return None,
            }
            if factors.len() > 8 {
                return None;
            }
        }
        factors.sort();
        let mut product: Vec<(String, i32)> = Vec::new();
        for (name, power) in factors {
            match product.last_mut() {
                Some((last, sum)) if *last == name => *sum += power,
                _ => product.push((name, power)),
            }
        }
        product.retain(|(_, power)| *power != 0);
        (!product.is_empty() && nested.len() == 1 && !below).then_some(Self(product))
    }

    /// Takes a factor out; its power.
    fn take(&mut self, name: &str) -> i32 {
        let power = self.0.iter().find(|(factor, _)| factor == name).map_or(0, |(_, power)| *power);
        self.0.retain(|(factor, _)| factor != name);
        power
    }

    fn inverse(mut self) -> Self {
        self.0.iter_mut().for_each(|(_, power)| *power = -*power);
        self
    }
}

/// The unit of a spelling that is no product.
fn whole_unit(spelling: &str) -> Option<&'static str> {
    WHOLE.iter().find(|(known, _)| *known == spelling).map(|(_, unit)| *unit)
}

/// One spelling of signs and powers.
fn plain(text: &str) -> String {
    let text = text.trim().replace("**", "^").replace('°', "deg").replace(['µ', 'μ'], "u");
    let text: String = text
        .chars()
        .map(|c| match c {
            '·' | '⋅' | '×' => ' ',
            '⁻' | '−' => '-',
            '¹' => '1',
            '²' => '2',
            '³' => '3',
            c => c,
        })
        .collect();
    text
}

/// The name of a factor in the tables.
fn factor(name: &str) -> String {
    let of = |name: &str| FACTORS.iter().find(|(known, others)| *known == name || others.contains(&name));
    let known = of(name).or_else(|| of(&name.to_lowercase()));
    known.map_or_else(|| name.to_owned(), |(known, _)| (*known).to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scale(group: Group, text: &str) -> f64 {
        unit(group, text).unwrap_or_else(|error| panic!("{text}: {error}")).scale
    }

    #[test]
    fn every_spelling_is_the_unit() {
        for text in ["rad/s", "rad s^-1", "rad s-1", "rad*s^-1", "rad·s⁻¹", "RAD/SEC", "rad s^{-1}", "radps"]
        {
            let unit = unit(Group::DTHETA, text).expect(text);
            assert_eq!(unit, Unit { scale: 1.0, zero: 0.0, per_interval: true }, "{text}");
        }
        for text in ["deg/s", "°/s", "dps", "deg/sec", "deg s^-1", "degrees/second", "DPS"] {
            assert_eq!(scale(Group::DTHETA, text), DEGREE, "{text}");
        }
        for text in ["m/s^2", "m/s2", "m/s/s", "m s^-2", "m/s²", "m/s**2", "m s-2", "mps2", "m/(s^2)"] {
            assert_eq!(scale(Group::DVEL, text), 1.0, "{text}");
        }
        for (text, size) in [("g", 1.0), ("G", 1.0), ("mG", 1e-3), ("mg", 1e-3), ("µg", 1e-6), ("uG", 1e-6)]
        {
            assert!((scale(Group::DVEL, text) / size - 9.80665).abs() < 1e-12, "{text}");
        }
        assert_eq!(scale(Group::TIME, "ns"), 1e-9);
        assert_eq!(scale(Group::TIME, "µs"), 1e-6);
        assert_eq!(scale(Group::REF_VEL, "km/h"), 1.0 / 3.6);
    }

    #[test]
    fn counts_have_a_size() {
        let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-14, "{a} {b}");
        close(scale(Group::DTHETA, "131 LSB/(deg/s)"), DEGREE / 131.0);
        close(scale(Group::DTHETA, "16.4 LSB/dps"), DEGREE / 16.4);
        close(scale(Group::DTHETA, "deg/s/131"), DEGREE / 131.0);
        close(scale(Group::DTHETA, "8.75 mdps/LSB"), DEGREE * 8.75e-3);
        close(scale(Group::DTHETA, "0.0152 deg/s"), DEGREE * 0.0152);
        close(scale(Group::DVEL, "16384 LSB/g"), 9.80665 / 16384.0);
        close(scale(Group::DVEL, "g/16384"), 9.80665 / 16384.0);
        close(scale(Group::DVEL, "0.061 mg/LSB"), 9.80665e-3 * 0.061);
        close(scale(Group::REF_LATLON, "1e-7 deg"), DEGREE * 1e-7);
        assert!(unit(Group::DTHETA, "LSB").is_err_and(|error| error.contains("counts need a size")));
    }

    #[test]
    fn temperatures_have_a_zero() {
        for (text, zero) in
            [("K", 273.15), ("kelvin", 273.15), ("degC", 0.0), ("deg.C", 0.0), ("°C", 0.0), ("C", 0.0)]
        {
            assert_eq!(unit(Group::TEMP, text).expect(text).zero, zero, "{text}");
        }
    }

    #[test]
    fn what_is_none_is_refused() {
        for text in
            ["deg/sek", "m/s", "filtered", "", "rad/", "(rad/s", "0 LSB/(deg/s)", "rad/s)", "deg/s/0", "g"]
        {
            assert!(unit(Group::DTHETA, text).is_err(), "{text}");
        }
        assert!(unit(Group::DTHETA, "deg/sek").is_err_and(|error| error.contains("did you mean `deg/s`?")));
    }
}
