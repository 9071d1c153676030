//! The closed table of units in which people may write figures: in scenarios, and in the descriptions of logs.

use sinscal::EffectInfo;

use crate::suggest;

/// Standard gravity, m/s^2: what data sheets mean by g.
const G: f64 = 9.806_65;
const DEG: f64 = std::f64::consts::PI / 180.0;
const HOUR: f64 = 3600.0;

/// 1 degree, rad.
pub const DEGREE: f64 = DEG;
/// 1 micro-g, m/s^2; as a random walk 1 ug/sqrt(Hz) in (m/s)/sqrt(s).
pub const MICRO_G: f64 = G * 1e-6;
/// 1 deg/sqrt(h), rad/sqrt(s): an hour is 3600 s, its root 60.
pub const DEG_PER_SQRT_HOUR: f64 = DEG / 60.0;

/// Units of one dimension with their size in the first of them, the SI unit.
pub type Units = &'static [(&'static str, f64)];

/// Units of a frequency.
pub const FREQUENCY: Units = &[("Hz", 1.0), ("kHz", 1e3)];
/// Units of time.
pub const TIME: Units = &[
    ("s", 1.0),
    ("ms", 1e-3),
    ("us", 1e-6),
    ("ns", 1e-9),
    ("min", 60.0),
    ("h", HOUR),
    ("days", 24.0 * HOUR),
];
/// Units of angle.
pub const ANGLE: Units = &[
    ("rad", 1.0),
    ("mrad", 1e-3),
    ("urad", 1e-6),
    ("deg", DEG),
    ("arcmin", DEG / 60.0),
    ("arcsec", DEG / 3600.0),
];
/// Units of a ratio.
pub const RATIO: Units = &[("1", 1.0), ("%", 1e-2), ("ppm", 1e-6)];
/// Units of length.
pub const LENGTH: Units = &[("m", 1.0), ("cm", 1e-2), ("mm", 1e-3)];
/// Units of velocity.
pub const VELOCITY: Units = &[("m/s", 1.0), ("mm/s", 1e-3), ("um/s", 1e-6)];
/// Units of angular rate.
pub const ANGULAR_RATE: Units = &[("rad/s", 1.0), ("mrad/s", 1e-3), ("deg/s", DEG), ("deg/h", DEG / HOUR)];
/// Units of angular acceleration.
pub const ANGULAR_ACCELERATION: Units = &[("rad/s^2", 1.0), ("deg/s^2", DEG)];
/// Units of specific force.
pub const FORCE: Units = &[("m/s^2", 1.0), ("g", G), ("mg", G * 1e-3), ("ug", G * 1e-6), ("mGal", 1e-5)];
/// Units of temperature.
pub const TEMPERATURE: Units = &[("degC", 1.0)];
/// Units of a temperature difference.
pub const DIFFERENCE: Units = &[("K", 1.0)];
/// Units of angle random walk.
pub const ANGLE_WALK: Units = &[("rad/sqrt(s)", 1.0), ("deg/sqrt(h)", DEG / 60.0), ("deg/sqrt(s)", DEG)];
/// Units of velocity random walk.
pub const VELOCITY_WALK: Units = &[
    ("m/s/sqrt(s)", 1.0),
    ("m/s/sqrt(h)", 1.0 / 60.0),
    ("ug/sqrt(Hz)", G * 1e-6),
    ("mg/sqrt(Hz)", G * 1e-3),
];
/// Units of the random walk of an angular rate.
pub const RATE_WALK: Units = &[("rad/s/sqrt(s)", 1.0), ("deg/h/sqrt(h)", DEG / HOUR / 60.0)];
/// Units of the random walk of a specific force.
pub const FORCE_WALK: Units =
    &[("m/s^2/sqrt(s)", 1.0), ("ug/sqrt(s)", G * 1e-6), ("ug/sqrt(h)", G * 1e-6 / 60.0)];

/// Units of the parameters of effects.
const PARAMETERS: &[Units] = &[
    // a small angle is a ratio too
    &[
        ("rad", 1.0),
        ("mrad", 1e-3),
        ("urad", 1e-6),
        ("deg", DEG),
        ("arcmin", DEG / 60.0),
        ("arcsec", DEG / 3600.0),
        ("1", 1.0),
        ("%", 1e-2),
        ("ppm", 1e-6),
    ],
    RATIO,
    LENGTH,
    TIME,
    ANGULAR_RATE,
    FORCE,
    DIFFERENCE,
    &[("s^2/m", 1.0), ("mg/g^2", 1e-3 / G), ("ug/g^2", 1e-6 / G)],
    &[("s^4/m^2", 1.0), ("mg/g^3", 1e-3 / (G * G)), ("ug/g^3", 1e-6 / (G * G))],
    &[("1/K", 1.0), ("ppm/K", 1e-6)],
    &[("m/s^2/K", 1.0), ("mg/K", G * 1e-3), ("ug/K", G * 1e-6)],
    &[("rad/s/K", 1.0), ("deg/s/K", DEG), ("deg/h/K", DEG / HOUR)],
    &[
        ("m/s/K", 1.0),
        ("m/s^2/(K/s)", 1.0),
        ("ug/(K/s)", G * 1e-6),
        ("ug/(K/min)", G * 1e-6 * 60.0),
        ("ug/(K/h)", G * 1e-6 * HOUR),
    ],
    &[("rad/s/(m/s^2)", 1.0), ("deg/s/g", DEG / G), ("deg/h/g", DEG / HOUR / G)],
    &[("s/rad", 1.0), ("ppm/(rad/s)", 1e-6), ("ppm/(deg/s)", 1e-6 / DEG)],
    &[
        ("m/s^3", 1.0),
        ("m/s^2/s", 1.0),
        ("ug/s", G * 1e-6),
        ("ug/h", G * 1e-6 / HOUR),
        ("mg/h", G * 1e-3 / HOUR),
    ],
    &[("rad/s^2", 1.0), ("deg/s/h", DEG / HOUR), ("deg/h/h", DEG / (HOUR * HOUR))],
];

/// The units for parameters whose SI unit is `si`.
pub fn of_parameters(si: &str) -> Units {
    PARAMETERS
        .iter()
        .find(|units| units.first().is_some_and(|(unit, _)| *unit == si))
        .copied()
        .unwrap_or_default()
}

/// The units for the parameters of an effect: those of their SI unit, or where nobody else has it the effect's own.
pub fn of_effect(effect: &'static EffectInfo) -> Units {
    match of_parameters(effect.unit()) {
        [] => effect.units(),
        usual => usual,
    }
}

/// Size of `unit` in the SI unit of `units`; otherwise what is accepted, the nearest first.
///
/// # Errors
/// When it is none of the units.
pub fn scale(units: Units, unit: &str) -> Result<f64, String> {
    let unit = &plain(unit);
    let names = || units.iter().map(|(name, _)| *name);
    names().zip(units).find(|(name, _)| *name == unit).map(|(_, (_, size))| *size).ok_or_else(|| {
        let all = names().collect::<Vec<_>>().join(", ");
        match suggest::nearest(unit, names()) {
            Some(near) => format!("did you mean `{near}`? accepted: {all}"),
            None => format!("accepted: {all}"),
        }
    })
}

/// A unit as the tables write it: both letters that stand for micro are `u`.
fn plain(unit: &str) -> String {
    unit.replace(['µ', 'μ'], "u")
}

/// Reads `NUMBER UNIT`; says what is accepted otherwise.
pub fn read(text: &str, units: Units) -> Result<f64, String> {
    let (number, unit) = split(text);
    let Ok(value) = number.parse::<f64>() else {
        let names = units.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
        return Err(format!("a number, a space and its unit in quotes; units: {names}"));
    };
    let unit = &plain(unit);
    match units.iter().find(|(name, _)| name == unit) {
        Some((_, size)) => Ok(value * size),
        None => {
            Err(format!("one of the units {}", suggest::accepted(unit, units.iter().map(|(name, _)| *name))))
        }
    }
}

fn split(text: &str) -> (&str, &str) {
    let (number, unit) = text.trim().split_once(char::is_whitespace).unwrap_or((text.trim(), ""));
    (number, unit.trim())
}

/// A value in SI units as people write it: in the unit of the quantity `like`, or else in the SI unit.
pub fn write(value: f64, units: Units, like: &str) -> String {
    let wanted = split(like).1;
    let unit = units.iter().find(|(name, _)| *name == wanted).or(units.first());
    let (name, size) = unit.copied().unwrap_or(("", 1.0));
    // what was written as 89.9 deg is to read so again
    let tidy = format!("{:.11e}", value / size).parse().unwrap_or(value / size);
    format!("{tidy} {name}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_effect_has_units_and_the_sheets_unit_is_among_them() {
        for effect in sinscal::EFFECTS {
            let units = of_parameters(effect.unit());
            assert!(!units.is_empty(), "{}", effect.name());
            let sheet = units.iter().find(|(name, _)| *name == effect.sheet_unit);
            let size = sheet.map(|(_, size)| *size).unwrap_or_default();
            assert!(
                (size / effect.sheet_scale - 1.0).abs() < 1e-12,
                "{} {}",
                effect.name(),
                effect.sheet_unit
            );
        }
    }

    #[test]
    fn units_of_data_sheets() {
        let of = |name: &str, unit: &str| {
            sinscal::effect(name).and_then(|effect| scale(of_parameters(effect.unit()), unit).ok())
        };
        assert_eq!(read("5 µg", FORCE), read("5 ug", FORCE));
        assert!(of("accel-bias", "ug").is_some_and(|k| (k - 9.80665e-6).abs() < 1e-18));
        assert_eq!(of("gyro-bias", "deg/h"), Some(std::f64::consts::PI / 180.0 / 3600.0));
        assert_eq!(of("outer-lever-arm", "mm"), Some(1e-3));
        assert!(of("accel-quadratic", "ug/g^2").is_some_and(|k| (k - 1.019_716e-7).abs() < 1e-12));
        assert_eq!(of("accel-bias", "mm"), None);
        let wrong = scale(of_parameters("rad/s"), "deg/hr");
        assert!(wrong.is_err_and(|text| text.starts_with("did you mean `deg/h`?")));
    }

    #[test]
    fn limits_are_written_in_the_unit_of_the_figure() {
        assert_eq!(write(89.9 * DEG, ANGLE, "95 deg"), "89.9 deg");
        assert_eq!(write(1.5, ANGLE, "95"), "1.5 rad");
    }

    #[test]
    fn quantities() {
        assert_eq!(read("20 mm", LENGTH), Ok(0.02));
        assert_eq!(read(" -1e3   mm ", LENGTH), Ok(-1.0));
        assert!((read("0.001 deg/sqrt(h)", ANGLE_WALK).unwrap() - 2.9089e-7).abs() < 1e-11);
        assert!(read("20", LENGTH).unwrap_err().contains("m, cm, mm"));
        assert!(read("20 s", LENGTH).unwrap_err().contains("m, cm, mm"));
        assert!(read("much", LENGTH).unwrap_err().contains("a number, a space and its unit"));
    }
}
