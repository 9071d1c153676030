//! The description beside a table, `NAME.toml`: what was recorded where, and how good it is.
//!
//! `[imu]` and `[site]` must be there. Every other table may be missing:
//!
//! | table | without it |
//! |---|---|
//! | `[initial]` | the library aligns on the first still stretch |
//! | `[reference]` | 0.001 m/s, 0.002 m, 0.01 deg; a warning when the table of samples has reference columns |
//! | `[noise]` | that of the class, or 0.001 deg/sqrt(h), 5 ug/sqrt(Hz), with a warning |
//! | `[temperature]` | 25 degC |
//! | `[outer_lever]` | zero |
//! | `[prior]` | the priors of the class that `imu.grade` names, or of the blocks |
//! | `[uncertainty]` | site, clock, thermometers and reference are taken as exact |
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

use crate::grade::Grade;
use crate::units;
use nalgebra::Vector3;
use sinscal::{BiasWander, EffectInfo, InitialAttitude, ReferenceSigma, SensorNoise, Site};
use toml::Spanned;
use toml::de::DeTable;

use super::fault::LogError;
use super::fields::{Document, Must};
use super::reading::Reading;
use super::sections::{
    read_initial, read_noise, read_priors, read_reading, read_site, read_uncertainty, samples,
};

/// Descriptions are small; what is larger is some other file.
const LARGEST: u64 = 1 << 20;

/// Sensors lie within this many degC, and so do their reference temperatures.
pub(super) const TEMPERATURES: (f64, f64) = (-80.0, 150.0);

/// Sigmas of a reading that a filter can compute with, and beyond which nothing is measured: m/s, m, deg.
const SIGMAS: [(f64, f64); 3] = [(1e-9, 1e3), (1e-9, 1e6), (1e-9, 180.0)];

/// What a line of a description may be.
const TOML: &str = "a line is [TABLE] or NAME = VALUE; numbers have a point, no unit and no quotes (32.06), lists brackets ([1.0, \
                    0.0]), names of units straight quotes (\"ug\"); remarks begin with #";

const IMU: &[&str] = &["rate_hz", "gyro_rad_per_pulse", "accel_m_s_per_pulse", "samples", "grade"];
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
const SECTIONS: &[&str] = &[
    "imu",
    "site",
    "initial",
    "reference",
    "noise",
    "temperature",
    "outer_lever",
    "prior",
    "uncertainty",
    "axes",
    "time",
    "table",
];

/// What `[uncertainty]` may state, and the effect whose standard deviation it is.
pub(super) const UNCERTAINTIES: [(&str, &str); 11] = [
    ("latitude", "site-latitude"),
    ("height", "site-height"),
    ("gravity", "site-gravity"),
    ("clock", "clock-scale"),
    ("thermometer_lag", "thermometer-lag"),
    ("thermometer_scale", "thermometer-scale"),
    ("thermometer_offset", "thermometer-offset"),
    ("dither_scale", "dither-scale"),
    ("reference_delay", "reference-delay"),
    ("reference_scale", "reference-scale"),
    ("table_orthogonality", "table-orthogonality"),
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

/// What a table `[noise]` says.
#[derive(Clone, Copy)]
pub(super) struct Stated {
    pub(super) white: SensorNoise,
    pub(super) wander: BiasWander,
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
    /// The class of the unit, where that is said.
    pub grade: Option<Grade>,
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
    /// Effects whose priors are those of the class.
    pub(super) presumed: Vec<&'static str>,
    /// Standard deviations of what is not the unit's, by effect, SI: those that the description states. They stand among the priors too.
    pub uncertainty: Vec<(&'static str, f64)>,
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

    /// Priors that are not given become those of a class.
    pub(super) fn presume(&mut self, grade: Grade) {
        for (name, sigma, _) in grade.priors() {
            if !self.priors.iter().any(|(given, _)| given == name) {
                self.priors.push((name, *sigma));
                self.presumed.push(name);
            }
        }
        for (name, sigma) in grade.influences() {
            if !self.priors.iter().any(|(given, _)| given == name) {
                self.priors.push((name, *sigma));
            }
        }
    }

    /// Prior standard deviation of an effect: the one given, or that of its block; SI.
    pub fn prior(&self, effect: &str) -> f64 {
        let given = self.priors.iter().find(|(name, _)| *name == effect).map(|(_, sigma)| *sigma);
        given.or_else(|| sinscal::effect(effect).map(|effect| effect.prior_sigma)).unwrap_or(f64::INFINITY)
    }

    /// Reads and checks `path`, reporting every fault at once; priors may be of effects of the library and of `own` ones.
    pub(super) fn read(path: &Path, own: &[&'static EffectInfo]) -> Result<Self, LogError> {
        Self::parse(path, text_of(path)?, own)
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

    fn parse(path: &Path, text: Arc<str>, own: &[&'static EffectInfo]) -> Result<Self, LogError> {
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
        let grade = imu.and_then(|imu| doc.word(imu, "grade", Grade::from_str));
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
            Some(section) => read_priors(doc, section, own),
            None => Vec::new(),
        };
        let keys = UNCERTAINTIES.map(|(key, _)| key);
        let section = doc.section(root, "uncertainty", Some(&keys));
        let uncertainty = section.map_or_else(Vec::new, |section| read_uncertainty(doc, section));
        let priors: Vec<_> = uncertainty
            .iter()
            .filter(|(name, _)| priors.iter().all(|(stated, _)| stated != name))
            .copied()
            .chain(priors.iter().copied())
            .collect();
        document.finish()?;

        // What is missing here has been refused above; the fallbacks are never used.
        let incomplete = || LogError::file(path, "is incomplete");
        let initial = match initial {
            Some(initial) => Some(initial.ok_or_else(incomplete)?),
            None => None,
        };
        let mut description = Self {
            rate: rate.ok_or_else(incomplete)?,
            grade,
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
            presumed: Vec::new(),
            uncertainty,
            reference_kind,
            reference_file,
            reference_offset,
            fixes,
            reading,
        };
        if let Some(grade) = grade {
            if !noise_given {
                description.noise = grade.noise();
            }
            description.presume(grade);
        }
        Ok(description)
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
