//! The effects a prior can be given for, and the units it can be given in.

use sinscal::{EFFECTS, EffectInfo};

/// Standard gravity, m/s^2: what data sheets mean by g.
const G: f64 = 9.806_65;
const DEG: f64 = std::f64::consts::PI / 180.0;
const HOUR: f64 = 3600.0;

/// Units of one physical dimension with their size in the first of them, which is the SI unit.
type Units = &'static [(&'static str, f64)];

const ANGLE: Units = &[
    ("rad", 1.0),
    ("mrad", 1e-3),
    ("urad", 1e-6),
    ("deg", DEG),
    ("arcmin", DEG / 60.0),
    ("arcsec", DEG / 3600.0),
    ("1", 1.0),
    ("%", 1e-2),
    ("ppm", 1e-6),
];
const RATIO: Units = &[("1", 1.0), ("%", 1e-2), ("ppm", 1e-6)];
const LENGTH: Units = &[("m", 1.0), ("cm", 1e-2), ("mm", 1e-3)];
const TIME: Units = &[("s", 1.0), ("ms", 1e-3), ("us", 1e-6)];
const RATE: Units = &[("rad/s", 1.0), ("mrad/s", 1e-3), ("deg/s", DEG), ("deg/h", DEG / HOUR)];
const FORCE: Units = &[("m/s^2", 1.0), ("g", G), ("mg", G * 1e-3), ("ug", G * 1e-6)];
const QUADRATIC: Units = &[("s^2/m", 1.0), ("mg/g^2", 1e-3 / G), ("ug/g^2", 1e-6 / G)];
const CUBIC: Units = &[("s^4/m^2", 1.0), ("mg/g^3", 1e-3 / (G * G)), ("ug/g^3", 1e-6 / (G * G))];
const RATIO_PER_KELVIN: Units = &[("1/K", 1.0), ("ppm/K", 1e-6)];
const FORCE_PER_KELVIN: Units = &[("m/s^2/K", 1.0), ("mg/K", G * 1e-3), ("ug/K", G * 1e-6)];
const RATE_PER_KELVIN: Units = &[("rad/s/K", 1.0), ("deg/s/K", DEG), ("deg/h/K", DEG / HOUR)];
const FORCE_PER_KELVIN_RATE: Units = &[
    ("m/s/K", 1.0),
    ("m/s^2/(K/s)", 1.0),
    ("ug/(K/s)", G * 1e-6),
    ("ug/(K/min)", G * 1e-6 * 60.0),
    ("ug/(K/h)", G * 1e-6 * HOUR),
];
const RATE_PER_FORCE: Units = &[("rad/s/(m/s^2)", 1.0), ("deg/s/g", DEG / G), ("deg/h/g", DEG / HOUR / G)];
const PER_RATE: Units = &[("s/rad", 1.0), ("ppm/(rad/s)", 1e-6), ("ppm/(deg/s)", 1e-6 / DEG)];
const FORCE_DRIFT: Units = &[
    ("m/s^3", 1.0),
    ("m/s^2/s", 1.0),
    ("ug/s", G * 1e-6),
    ("ug/h", G * 1e-6 / HOUR),
    ("mg/h", G * 1e-3 / HOUR),
];
const RATE_DRIFT: Units = &[("rad/s^2", 1.0), ("deg/s/h", DEG / HOUR), ("deg/h/h", DEG / (HOUR * HOUR))];

const DIMENSIONS: &[Units] = &[
    ANGLE,
    RATIO,
    LENGTH,
    TIME,
    RATE,
    FORCE,
    QUADRATIC,
    CUBIC,
    RATIO_PER_KELVIN,
    FORCE_PER_KELVIN,
    RATE_PER_KELVIN,
    FORCE_PER_KELVIN_RATE,
    RATE_PER_FORCE,
    PER_RATE,
    FORCE_DRIFT,
    RATE_DRIFT,
];

/// Names of the effects a log may carry a prior for.
pub(super) fn effect_names() -> impl Iterator<Item = &'static str> + Clone {
    EFFECTS.iter().filter(|effect| !effect.components().is_empty()).map(EffectInfo::name)
}

/// The effect of this name and the SI unit of its parameters; the unit is empty when it has no parameters.
pub(super) fn effect_units(name: &str) -> Option<(&'static str, &'static str)> {
    let effect = sinscal::effect(name)?;
    Some((effect.name(), if effect.components().is_empty() { "" } else { effect.unit() }))
}

/// The units in which a figure of this SI unit may be written.
pub(super) fn accepted(si: &str) -> Units {
    DIMENSIONS
        .iter()
        .find(|units| units.first().is_some_and(|(unit, _)| *unit == si))
        .copied()
        .unwrap_or_default()
}

/// Size of `unit` in the SI unit of `units`.
pub(super) fn scale(units: Units, unit: &str) -> Option<f64> {
    units.iter().find(|(known, _)| *known == unit).map(|(_, scale)| *scale)
}

/// Data-sheet units of the description's own fields, in SI.
pub(super) mod sheet {
    /// 1 deg/sqrt(h) in rad/sqrt(s): an hour is 3600 s, its root 60.
    pub(crate) const DEG_PER_SQRT_HOUR: f64 = super::DEG / 60.0;
    /// 1 ug/sqrt(Hz) in (m/s)/sqrt(s).
    pub(crate) const MICRO_G: f64 = super::G * 1e-6;
    /// 1 degree in rad.
    pub(crate) const DEGREE: f64 = super::DEG;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_effect_with_parameters_has_units() {
        assert_eq!(EFFECTS.len(), 27);
        for effect in &EFFECTS {
            let units = effect_units(effect.name()).map(|(_, si)| accepted(si)).unwrap_or_default();
            assert_eq!(units.is_empty(), effect.components().is_empty(), "{}", effect.name());
            assert_eq!(scale(units, effect.unit()).unwrap_or(1.0), 1.0, "{}", effect.name());
        }
    }

    #[test]
    fn units_of_data_sheets() {
        let of = |name: &str, unit: &str| effect_units(name).and_then(|(_, si)| scale(accepted(si), unit));
        assert!(of("accel-bias", "ug").is_some_and(|k| (k - 9.80665e-6).abs() < 1e-18));
        assert_eq!(of("gyro-bias", "deg/h"), Some(std::f64::consts::PI / 180.0 / 3600.0));
        assert_eq!(of("outer-lever-arm", "mm"), Some(1e-3));
        assert!(of("accel-quadratic", "ug/g^2").is_some_and(|k| (k - 1.019_716e-7).abs() < 1e-12));
        assert_eq!(of("accel-bias", "mm"), None);
    }
}
