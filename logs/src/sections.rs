//! The tables of a description, one by one.

use nalgebra::{Quaternion, UnitQuaternion};
use sinscal::{BiasWander, EffectInfo, InitialAttitude, SensorNoise, Site};
use toml::de::{DeTable, DeValue};

use super::axes;
use super::description::{Stated, UNCERTAINTIES};
use super::fields::{self, Document, Must, Section};
use super::increments::Values;
use super::reading::{self, Reading};
use crate::{suggest, units};

/// A quaternion's norm may differ from 1 by this much; it is normalised then.
pub(super) const UNIT_TOLERANCE: f64 = 1e-3;
/// Random walks, from far below any sensor to far above: deg/sqrt(h), ug/sqrt(Hz).
const WALKS: [(f64, f64); 2] = [(1e-9, 1e4), (1e-6, 1e7)];
/// What else `[noise]` may say: deg/h/sqrt(h), ug/sqrt(h), deg/h with s, ug with s.
const WANDERS: [(f64, f64); 6] =
    [(1e-9, 1e6), (1e-6, 1e7), (1e-9, 1e6), (1e-3, 1e9), (1e-6, 1e7), (1e-3, 1e9)];
/// Priors in SI units that a filter can compute with.
const PRIORS: (f64, f64) = (1e-15, 1e6);
const SITE: &[&str] = &["latitude_deg", "longitude_deg", "height_m"];
const TIME: &[&str] = &["stamps", "bridge_gaps_s"];
const TABLE: &[&str] = &["columns", "map"];
const NOISE: &[&str] = &[
    "gyro_arw_deg_sqrt_h",
    "accel_vrw_ug_sqrt_hz",
    "gyro_bias_random_walk_deg_h_sqrt_h",
    "accel_bias_random_walk_ug_sqrt_h",
    "gyro_bias_instability_deg_h",
    "gyro_bias_correlation_s",
    "accel_bias_instability_ug",
    "accel_bias_correlation_s",
];

/// Reads `[noise]`; nothing where it is not there, and nothing in it where it is faulty.
pub(super) fn read_noise(doc: &mut Document<'_>, root: &DeTable<'_>) -> Option<Option<Stated>> {
    let section = doc.section(root, "noise", Some(NOISE))?;
    let mut walk = |i: usize| {
        let (least, most) = WALKS[i];
        let help = "a figure of the data sheet; it belongs to [noise]";
        doc.required(section, NOISE[i], Must::LieWithin(least, most), help)
    };
    let white = (walk(0), walk(1));
    let mut stated = |i: usize, unit: f64| {
        let (least, most) = WANDERS[i - 2];
        doc.optional(section, NOISE[i], Must::LieWithin(least, most)).map(|value| value * unit)
    };
    let rate = units::DEGREE / 3600.0;
    let random_walk = [stated(2, rate / 60.0), stated(3, units::MICRO_G / 60.0)];
    let sizes = [(stated(4, rate), stated(5, 1.0)), (stated(6, units::MICRO_G), stated(7, 1.0))];
    for ((size, time), at) in sizes.iter().zip([4, 6]) {
        let lacking = match (size, time) {
            (Some(_), None) => at + 1,
            (None, Some(_)) => at,
            _ => continue,
        };
        let help = "the size of a wander and its correlation time come together";
        doc.lack(Some(section), &section.field(NOISE[lacking]), help);
    }
    let wander = BiasWander { random_walk, gauss_markov: sizes.map(|(size, time)| size.zip(time)) };
    let (Some(angle), Some(velocity)) = white else { return Some(None) };
    let white = SensorNoise {
        angle_random_walk: angle * units::DEG_PER_SQRT_HOUR,
        velocity_random_walk: velocity * units::MICRO_G,
    };
    Some(Some(Stated { white, wander }))
}

/// What `imu.samples` may be.
pub(super) fn samples(text: &str) -> Result<Values, String> {
    match text {
        "averages" => Ok(Values::Averages),
        "instants" => Ok(Values::Instants),
        _ => Err(format!("`{text}` is neither averages (over the interval before the stamp) nor instants")),
    }
}

/// How the table is read: `[axes]`, `[time]` and `[table]`.
pub(super) fn read_reading(doc: &mut Document<'_>, root: &DeTable<'_>, values: Option<Values>) -> Reading {
    let mut reading = Reading { values, ..Reading::default() };
    if let Some(section) = doc.section(root, "axes", Some(&axes::NAMES)) {
        for name in axes::NAMES {
            doc.word(section, name, |text| reading.axes.set(name, text));
        }
    }
    if let Some(section) = doc.section(root, "time", Some(TIME)) {
        reading.stamps = doc.word(section, "stamps", str::parse);
        reading.bridge = doc.optional(section, "bridge_gaps_s", Must::LieWithin(0.0, 10.0));
    }
    if let Some(section) = doc.section(root, "table", Some(TABLE)) {
        reading.columns = doc.word(section, "columns", reading::column_names);
        if let Some(map) = doc.word(section, "map", str::parse) {
            reading.map = map;
        }
    }
    reading
}

pub(super) fn read_site(doc: &mut Document<'_>, root: &DeTable<'_>) -> Option<Site> {
    let Some(section) = doc.section(root, "site", Some(SITE)) else {
        if !root.contains_key("site") {
            let help = "give [site] latitude_deg, longitude_deg and height_m: gravity and the Earth's rate \
                        depend on them";
            doc.lack(None, "site", help);
        }
        return None;
    };
    let latitude = doc.required(
        section,
        "latitude_deg",
        Must::LieWithin(-89.9, 89.9),
        "north is positive; at a pole there is no east",
    );
    let longitude =
        doc.required(section, "longitude_deg", Must::LieWithin(-180.0, 360.0), "east is positive");
    let height =
        doc.required(section, "height_m", Must::LieWithin(-1000.0, 20_000.0), "height over the ellipsoid");
    Some(Site { latitude: latitude? * units::DEGREE, longitude: longitude? * units::DEGREE, height: height? })
}

pub(super) fn read_initial(doc: &mut Document<'_>, section: Section<'_>) -> Option<InitialAttitude> {
    let level = doc.required(section, "level_sigma_deg", Must::BePositiveUpTo(180.0), "sigma of the tilt");
    let heading =
        doc.required(section, "heading_sigma_deg", Must::BePositiveUpTo(180.0), "sigma of the heading");
    let field = section.field("quaternion_wxyz");
    let Some(span) = section.span_of("quaternion_wxyz") else {
        doc.lack(
            Some(section),
            &field,
            "the attitude at the first row; without [initial] it is found from the data",
        );
        return None;
    };
    // Any finite number here: what counts is the norm.
    let [w, x, y, z] = doc.list::<4>(section, "quaternion_wxyz", Must::BeFinite)?;
    let quaternion = Quaternion::new(w, x, y, z);
    let norm = quaternion.norm();
    if (norm - 1.0).abs() > UNIT_TOLERANCE {
        let problem = format!("has norm {norm:.6}, a unit quaternion was expected (within 0.001)");
        doc.refuse(span, &field, &problem, Some("the order is w, x, y, z; w is the scalar".into()));
        return None;
    }
    Some(InitialAttitude {
        attitude: UnitQuaternion::from_quaternion(quaternion),
        level_sigma: level? * units::DEGREE,
        heading_sigma: heading? * units::DEGREE,
    })
}

/// What is not the unit's may be wrong by so much: texts with units, one standard deviation each.
pub(super) fn read_uncertainty(doc: &mut Document<'_>, section: Section<'_>) -> Vec<(&'static str, f64)> {
    let mut stated = Vec::new();
    for (key, name) in UNCERTAINTIES {
        let Some(effect) = sinscal::effect(name) else { continue };
        let sigma = read_standard_deviation(doc, section, key, effect.unit());
        stated.extend(sigma.map(|sigma| (name, sigma)));
    }
    stated
}

/// A text with a unit that `si` can be read in.
fn read_standard_deviation(doc: &mut Document<'_>, section: Section<'_>, key: &str, si: &str) -> Option<f64> {
    doc.word(section, key, |text| {
        let read = units::read(text, units::of_parameters(si));
        let sigma = read.map_err(|accepted| format!("is `{text}`, expected was {accepted}"))?;
        if (PRIORS.0..=PRIORS.1).contains(&sigma) {
            Ok(sigma)
        } else {
            Err(format!("is `{text}`: no filter can compute with this standard deviation"))
        }
    })
}

pub(super) fn read_priors(
    doc: &mut Document<'_>,
    section: Section<'_>,
    own: &[&'static EffectInfo],
) -> Vec<(&'static str, f64)> {
    let mut priors = Vec::new();
    for (key, value) in section.table() {
        if doc.is_full() {
            break;
        }
        let name = key.get_ref().as_ref();
        let field = section.field(name);
        let of_own = own.iter().copied().find(|effect| effect.name() == name);
        let Some(effect) = of_own.or_else(|| sinscal::effect(name)) else {
            let known = sinscal::EFFECTS.iter().chain(own.iter().copied());
            let hint = suggest::hint(name, known.map(EffectInfo::name));
            doc.refuse(key.span(), &field, "is not an effect", Some(hint));
            continue;
        };
        let accepted = units::of_effect(effect);
        let DeValue::Table(table) = value.get_ref() else {
            let example = format!("write \"{name}\" = {{ sigma = 1.0, unit = \"{}\" }}", effect.unit());
            doc.refuse(value.span(), &field, "must give a sigma and its unit", Some(example));
            continue;
        };
        doc.only(table, &field, &["sigma", "unit"]);
        let (sigma_field, unit_field) = (format!("{field}.sigma"), format!("{field}.unit"));
        let names =
            || format!("accepted: {}", accepted.iter().map(|(unit, _)| *unit).collect::<Vec<_>>().join(", "));
        let sigma = match table.get("sigma") {
            Some(sigma) => doc.number(sigma, &sigma_field, Must::BePositive),
            None => {
                doc.refuse(key.span(), &sigma_field, "is missing", Some("one standard deviation".into()));
                None
            }
        };
        let scale = match table.get("unit").map(|unit| (unit.span(), unit.get_ref())) {
            Some((span, DeValue::String(unit))) => match units::scale(accepted, unit) {
                Ok(scale) => Some(scale),
                Err(help) => {
                    doc.refuse(
                        span,
                        &unit_field,
                        &format!("`{unit}` is not a unit of this effect"),
                        Some(help),
                    );
                    None
                }
            },
            Some((span, other)) => {
                let problem = format!("is {}, the name of a unit was expected", fields::kind(other));
                doc.refuse(span, &unit_field, &problem, Some(names()));
                None
            }
            None => {
                doc.refuse(key.span(), &unit_field, "is missing", Some(names()));
                None
            }
        };
        if let (Some(sigma), Some(scale)) = (sigma, scale) {
            let si_sigma = sigma * scale;
            if (PRIORS.0..=PRIORS.1).contains(&si_sigma) {
                priors.push((effect.name(), si_sigma));
            } else {
                let unit = effect.unit();
                let problem = format!("is {si_sigma:e} {unit}: no filter can compute with this");
                let help = format!("a sigma from {:e} to {:e} {unit} was expected", PRIORS.0, PRIORS.1);
                doc.refuse(key.span(), &field, &problem, Some(help));
            }
        }
    }
    priors
}
