//! The description beside a table, `NAME.toml`: what was recorded where, and how good it is.
//!
//! `[imu]` and `[site]` must be there. Every other table may be missing:
//!
//! | table | without it |
//! |---|---|
//! | `[initial]` | the library aligns on the first still stretch |
//! | `[reference]` | 0.001 m/s, 0.002 m, 0.01 deg; a warning when the table of samples has reference columns |
//! | `[noise]` | 0.001 deg/sqrt(h), 5 ug/sqrt(Hz), with a warning |
//! | `[temperature]` | 25 degC |
//! | `[outer_lever]` | zero |
//! | `[prior]` | the priors of the blocks |
//! | `[axes]` | the axes are ours: right, forward, up; east, north, up |
//! | `[time]` | stamps stand as they are, gaps are not bridged |
//! | `[table]` | names are those of the format or of `--map` |
//!
//! A table that is there is complete, except `[reference]`: a figure in it may be left out where nothing
//! of the kind was measured; and the figures of `[noise]` on biases.

use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::str::FromStr;
use std::sync::Arc;

use crate::{suggest, units};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use sinscal::{EffectInfo, InitialAttitude, ReferenceSigma, SensorNoise, Site};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::axes;
use super::fault::LogError;
use super::fields::{self, Document, Must, Section};
use super::increments::Values;
use super::reading::{self, Reading};

/// Descriptions are small; what is larger is some other file.
const LARGEST: u64 = 1 << 20;

/// A quaternion's norm may differ from 1 by this much; it is normalised then.
pub(super) const UNIT_TOLERANCE: f64 = 1e-3;
/// Sensors lie within this many degC, and so do their reference temperatures.
pub(super) const TEMPERATURES: (f64, f64) = (-80.0, 150.0);

/// Sigmas of a reading that a filter can compute with, and beyond which nothing is measured: m/s, m, deg.
const SIGMAS: [(f64, f64); 3] = [(1e-9, 1e3), (1e-9, 1e6), (1e-9, 180.0)];
/// Random walks, from far below any sensor to far above: deg/sqrt(h), ug/sqrt(Hz).
const WALKS: [(f64, f64); 2] = [(1e-9, 1e4), (1e-6, 1e7)];
/// What else `[noise]` may say: deg/h/sqrt(h), ug/sqrt(h), deg/h with s, ug with s.
const WANDERS: [(f64, f64); 6] =
    [(1e-9, 1e6), (1e-6, 1e7), (1e-9, 1e6), (1e-3, 1e9), (1e-6, 1e7), (1e-3, 1e9)];
/// Priors in SI units that a filter can compute with.
const PRIORS: (f64, f64) = (1e-15, 1e6);

/// What a line of a description may be.
const TOML: &str = "a line is [TABLE] or NAME = VALUE; numbers have a point, no unit and no quotes (32.06), lists brackets ([1.0, \
                    0.0]), names of units straight quotes (\"ug\"); remarks begin with #";

const IMU: &[&str] = &["rate_hz", "gyro_rad_per_pulse", "accel_m_s_per_pulse", "samples"];
const SITE: &[&str] = &["latitude_deg", "longitude_deg", "height_m"];
const INITIAL: &[&str] = &["quaternion_wxyz", "level_sigma_deg", "heading_sigma_deg"];
const REFERENCE: &[&str] = &[
    "velocity_sigma_m_s",
    "position_sigma_m",
    "attitude_sigma_deg",
    "kind",
    "file",
    "offset_s",
    "accept_fix",
];
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
const SECTIONS: &[&str] = &[
    "imu",
    "site",
    "initial",
    "reference",
    "noise",
    "temperature",
    "outer_lever",
    "prior",
    "axes",
    "time",
    "table",
];

/// What the reference of a log is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReferenceKind {
    /// What stands in its columns.
    Readings,
    /// A point that does not move.
    FixedPoint,
    /// The rests of the unit.
    Rests,
}

impl FromStr for ReferenceKind {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "readings" => Ok(Self::Readings),
            "fixed-point" => Ok(Self::FixedPoint),
            "rests" => Ok(Self::Rests),
            _ => Err(format!("`{text}` is none of readings, fixed-point, rests")),
        }
    }
}

/// How biases wander, SI: what `[noise]` says beside the random walks of angle and velocity. Nothing stands for what is not said.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BiasWander {
    /// Random walk of the gyros' biases, rad/s/sqrt(s), and of those of the accelerometers, m/s^2/sqrt(s).
    pub random_walk: [Option<f64>; 2],
    /// Gauss-Markov process of the same: standard deviation, rad/s and m/s^2, and correlation time, s.
    pub gauss_markov: [Option<(f64, f64)>; 2],
}

/// What a table `[noise]` says.
#[derive(Clone, Copy)]
struct Stated {
    white: SensorNoise,
    wander: BiasWander,
}

impl Stated {
    /// Without one: 0.001 deg/sqrt(h), 5 ug/sqrt(Hz).
    const ASSUMED: Self = Self {
        white: SensorNoise {
            angle_random_walk: 0.001 * units::DEG_PER_SQRT_HOUR,
            velocity_random_walk: 5.0 * units::MICRO_G,
        },
        wander: BiasWander { random_walk: [None; 2], gauss_markov: [None; 2] },
    };
}

/// A checked description, in SI units.
#[derive(Clone, Debug)]
pub struct Description {
    /// Nominal sampling rate, Hz.
    pub rate: f64,
    /// Angle per gyro pulse, rad.
    pub gyro_pulse: Option<Vector3<f64>>,
    /// Velocity per accelerometer pulse, m/s.
    pub accel_pulse: Option<Vector3<f64>>,
    /// Where it was taken.
    pub site: Site,
    /// `None`: to be found from the first still stretch.
    pub initial: Option<InitialAttitude>,
    /// Standard deviations of one reading of the reference.
    pub reference: ReferenceSigma,
    /// Which of velocity, position and attitude sigma the file itself gives.
    pub(super) reference_given: [bool; 3],
    /// Random walks of the sensors.
    pub noise: SensorNoise,
    /// How their biases wander, where that is said.
    pub wander: BiasWander,
    pub(super) noise_given: bool,
    /// degC.
    pub reference_temperature: f64,
    /// m, body frame.
    pub outer_lever: Vector3<f64>,
    /// Standard deviations by effect, SI.
    pub priors: Vec<(&'static str, f64)>,
    /// What the reference is, where that is said.
    pub reference_kind: Option<ReferenceKind>,
    /// File of the reference, where it has one of its own.
    pub(super) reference_file: Option<String>,
    /// What is added to the times of that file, s.
    pub(super) reference_offset: f64,
    /// Fixes of a receiver that count.
    pub(super) fixes: Option<Vec<f64>>,
    /// How the table is read.
    pub(super) reading: Reading,
}

/// Angle random walk that separates gyros that feel the Earth's rate from others, rad/sqrt(s).
const NAVIGATION_WALK: f64 = 0.1 * units::DEG_PER_SQRT_HOUR;

impl Description {
    /// Whether the gyros are good enough to feel the Earth's rate.
    pub(super) fn is_navigation_grade(&self) -> bool {
        self.noise.angle_random_walk < NAVIGATION_WALK
    }

    /// Prior standard deviation of an effect: the one given, or that of its block; SI.
    pub fn prior(&self, effect: &str) -> f64 {
        let given = self.priors.iter().find(|(name, _)| *name == effect).map(|(_, sigma)| *sigma);
        given.or_else(|| sinscal::effect(effect).map(|effect| effect.prior_sigma)).unwrap_or(f64::INFINITY)
    }

    /// Reads and checks `path`, reporting every fault at once.
    pub(super) fn read(path: &Path) -> Result<Self, LogError> {
        Self::parse(path, text_of(path)?)
    }

    /// The same with the noise that the table `[noise]` of another file states.
    pub(super) fn with_noise_of(mut self, path: &Path) -> Result<Self, LogError> {
        super::files::check_file(path, "description of noise", None)?;
        let text = text_of(path)?;
        let root = parsed(path, &text)?;
        let root = root.get_ref();
        let mut document = Document::new(path, Arc::clone(&text));
        // a whole description is welcome: its other tables say nothing here
        document.only(root, "", SECTIONS);
        let noise = read_noise(&mut document, root);
        if noise.is_none() && !root.contains_key("noise") {
            let help = "`sinscal noise LOG --out DIR` writes DIR/noise.toml";
            document.lack(None, "noise", help);
        }
        document.finish()?;
        let stated = noise.flatten().ok_or_else(|| LogError::file(path, "is incomplete"))?;
        (self.noise, self.wander, self.noise_given) = (stated.white, stated.wander, true);
        Ok(self)
    }

    fn parse(path: &Path, text: Arc<str>) -> Result<Self, LogError> {
        let root = parsed(path, &text)?;
        let root = root.get_ref();
        let mut document = Document::new(path, Arc::clone(&text));
        let doc = &mut document;
        doc.only(root, "", SECTIONS);

        let imu = doc.section(root, "imu", Some(IMU));
        let rate = match imu {
            Some(imu) => {
                doc.required(imu, "rate_hz", Must::BePositiveUpTo(1e5), "the sampling rate of the table, Hz")
            }
            None => {
                if !root.contains_key("imu") {
                    doc.lack(
                        None,
                        "imu.rate_hz",
                        "give the sampling rate of the table: [imu] rate_hz = 50.0",
                    );
                }
                None
            }
        };
        let values = imu.and_then(|imu| doc.word(imu, "samples", samples));
        let mut pulse = |key| Some(Vector3::from(doc.list::<3>(imu?, key, Must::BeNonZero)?));
        let gyro_pulse = pulse("gyro_rad_per_pulse");
        let accel_pulse = pulse("accel_m_s_per_pulse");

        let site = read_site(doc, root);
        let initial = doc.section(root, "initial", Some(INITIAL)).map(|section| read_initial(doc, section));

        let section = doc.section(root, "reference", Some(REFERENCE));
        let mut sigma = |i: usize| {
            let (least, most) = SIGMAS[i];
            doc.optional(section?, REFERENCE[i], Must::LieWithin(least, most))
        };
        let given = [sigma(0), sigma(1), sigma(2)];
        let reference_kind = section.and_then(|section| doc.word(section, "kind", str::parse));
        let reference_file =
            section.and_then(|section| doc.word(section, "file", |text| Ok(text.to_owned())));
        let reference_offset =
            section.and_then(|section| doc.optional(section, "offset_s", Must::BeFinite)).unwrap_or(0.0);
        let fixes = section.and_then(|section| doc.numbers(section, "accept_fix"));
        let reading = read_reading(doc, root, values);
        let reference = ReferenceSigma {
            velocity: given[0].unwrap_or(0.001),
            position: given[1].unwrap_or(0.002),
            attitude: given[2].unwrap_or(0.01) * units::DEGREE,
        };

        let noise = read_noise(doc, root);
        let noise_given = noise.is_some();
        let noise = noise.unwrap_or(Some(Stated::ASSUMED));

        let reference_temperature = match doc.section(root, "temperature", Some(&["reference_c"])) {
            Some(section) => {
                let within = Must::LieWithin(TEMPERATURES.0, TEMPERATURES.1);
                doc.required(section, "reference_c", within, "where temperature effects vanish, degC")
            }
            None => Some(25.0),
        };
        let outer_lever = match doc.section(root, "outer_lever", Some(&["xyz_m"])) {
            Some(section) => {
                if !section.table().contains_key("xyz_m") {
                    doc.lack(
                        Some(section),
                        "outer_lever.xyz_m",
                        "xyz_m = [0.0, 0.0, 0.0] when nothing is known",
                    );
                }
                doc.list::<3>(section, "xyz_m", Must::LieWithin(-100.0, 100.0))
            }
            None => Some([0.0; 3]),
        };
        let priors = match doc.section(root, "prior", None) {
            Some(section) => read_priors(doc, section),
            None => Vec::new(),
        };
        document.finish()?;

        // What is missing here has been refused above; the fallbacks are never used.
        let incomplete = || LogError::file(path, "is incomplete");
        let initial = match initial {
            Some(initial) => Some(initial.ok_or_else(incomplete)?),
            None => None,
        };
        Ok(Self {
            rate: rate.ok_or_else(incomplete)?,
            gyro_pulse,
            accel_pulse,
            site: site.ok_or_else(incomplete)?,
            initial,
            reference,
            reference_given: given.map(|sigma| sigma.is_some()),
            noise: noise.as_ref().ok_or_else(incomplete)?.white,
            wander: noise.ok_or_else(incomplete)?.wander,
            noise_given,
            reference_temperature: reference_temperature.ok_or_else(incomplete)?,
            outer_lever: outer_lever.ok_or_else(incomplete)?.into(),
            priors,
            reference_kind,
            reference_file,
            reference_offset,
            fixes,
            reading,
        })
    }
}

/// The text of a description.
fn text_of(path: &Path) -> Result<Arc<str>, LogError> {
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|file| file.take(LARGEST + 1).read_to_end(&mut bytes))
        .map_err(|error| super::unreadable(path, &error))?;
    if bytes.len() as u64 > LARGEST {
        return Err(LogError::file(path, "is larger than 1 MiB: this is not the description of a log"));
    }
    let text = String::from_utf8(bytes).map_err(|error| {
        let sound = error.as_bytes().iter().take(error.utf8_error().valid_up_to());
        let line = 1 + sound.filter(|byte| **byte == b'\n').count();
        LogError::file(path, format!("line {line} is not UTF-8 text: this is not a TOML description"))
            .help("save it as UTF-8")
    })?;
    Ok(text.into())
}

/// The document in a text.
fn parsed<'t>(path: &Path, text: &'t Arc<str>) -> Result<Spanned<DeTable<'t>>, LogError> {
    DeTable::parse(text).map_err(|error| {
        let problem = format!("is not valid TOML: {}", error.message());
        LogError::text(path, text, error.span(), None, problem).help(TOML)
    })
}

/// Reads `[noise]`; nothing where it is not there, and nothing in it where it is faulty.
fn read_noise(doc: &mut Document<'_>, root: &DeTable<'_>) -> Option<Option<Stated>> {
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
fn samples(text: &str) -> Result<Values, String> {
    match text {
        "averages" => Ok(Values::Averages),
        "instants" => Ok(Values::Instants),
        _ => Err(format!("`{text}` is neither averages (over the interval before the stamp) nor instants")),
    }
}

/// How the table is read: `[axes]`, `[time]` and `[table]`.
fn read_reading(doc: &mut Document<'_>, root: &DeTable<'_>, values: Option<Values>) -> Reading {
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

fn read_site(doc: &mut Document<'_>, root: &DeTable<'_>) -> Option<Site> {
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

fn read_initial(doc: &mut Document<'_>, section: Section<'_>) -> Option<InitialAttitude> {
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

fn read_priors(doc: &mut Document<'_>, section: Section<'_>) -> Vec<(&'static str, f64)> {
    let mut priors = Vec::new();
    for (key, value) in section.table() {
        if doc.is_full() {
            break;
        }
        let name = key.get_ref().as_ref();
        let field = section.field(name);
        let Some(effect) = sinscal::effect(name) else {
            let hint = suggest::hint(name, sinscal::EFFECTS.iter().map(EffectInfo::name));
            doc.refuse(key.span(), &field, "is not an effect", Some(hint));
            continue;
        };
        let accepted = units::of_parameters(effect.unit());
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
