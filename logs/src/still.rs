//! What a unit must feel while it stands still: gravity and the Earth's rate. A wrong unit, a wrong order of numbers or a wrong
//! site show there at once, where the signals of a turn could be anything.
//!
//! Limits are wide enough for errors that the coarse stage captures (1 %, 20 mg, 5 deg/h) and for any sensor of its class; whoever
//! goes beyond them has written something else than what was expected.

use std::f64::consts::PI;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use nalgebra::{UnitQuaternion, Vector3};
use sinscal::{Aligner, Sample, Site, earth};

use super::columns::Group;
use super::description::Description;
use super::fault::LogError;
use crate::units::{DEGREE, MICRO_G};

/// m/s^2.
pub(super) const STANDARD_GRAVITY: f64 = MICRO_G * 1e6;
const DEG_PER_HOUR: f64 = DEGREE / 3600.0;

/// Enough stillness to judge by, s.
const ENOUGH: f64 = 20.0;
/// An attitude may differ from what gravity says by this much, or by ten of its sigmas, rad.
const TILT: f64 = 5.0 * DEGREE;
/// So may the latitude from what the Earth's rate says; a bias of 5 deg/h makes 20 deg of it.
const LATITUDE: f64 = 30.0 * DEGREE;
/// Largest error of a gyro of the navigation class before its calibration, rad/s.
const GYRO_BIAS: f64 = 5.0 * DEG_PER_HOUR;
/// A position so near to the figures of longitude and latitude is one in degrees.
const DEGREES: f64 = 0.02;
/// A still unit feels gravity to this fraction.
const FORCE: f64 = 0.1;
/// On a centrifuge one feels more than gravity, and turns faster than this, rad/s.
const CENTRIFUGE: f64 = 0.1;

/// Where an attitude is given.
#[derive(Clone, Copy)]
enum Given {
    Initial,
    Reference,
}

impl Given {
    /// What is said of its tilt, rad.
    fn level_sigma(self, description: &Description) -> f64 {
        match (self, &description.initial) {
            (Self::Initial, Some(initial)) => initial.level_sigma,
            _ => description.reference.attitude,
        }
    }

    /// What is said of its heading, rad.
    fn heading_sigma(self, description: &Description) -> f64 {
        match (self, &description.initial) {
            (Self::Initial, Some(initial)) => initial.heading_sigma,
            _ => description.reference.attitude,
        }
    }
}

/// Listens to the first still stretch of a log.
pub(super) struct Stillness {
    table: PathBuf,
    aligner: Aligner,
    description: Description,
    /// The columns of gyros and accelerometers.
    columns: [Group; 2],
    reference: Option<UnitQuaternion<f64>>,
    /// Whether a position was seen.
    placed: bool,
    judged: bool,
}

impl Stillness {
    /// `columns` are those of gyros and accelerometers; increments of unknown size (not `scaled`) are not judged.
    pub(super) fn new(table: &Path, description: &Description, columns: [Group; 2], scaled: bool) -> Self {
        let Description { site, rate, noise, .. } = description;
        Self {
            table: table.to_owned(),
            // the biases limit only an attitude, which is not asked for here
            aligner: Aligner::new(*site, *rate, *noise, 0.0, 0.0),
            description: description.clone(),
            columns,
            reference: None,
            placed: false,
            judged: !scaled,
        }
    }

    /// Takes in the next sample; a fault once enough of them contradict the description.
    pub(super) fn push(&mut self, sample: &Sample) -> Result<(), LogError> {
        if self.judged {
            return Ok(());
        }
        if self.reference.is_none() {
            self.reference = sample.reference.attitude;
        }
        if let Some(position) =
            sample.reference.position.filter(|_| !std::mem::replace(&mut self.placed, true))
        {
            self.place(&position)?;
        }
        let more = self.aligner.push(sample);
        let enough = self.aligner.still().is_some_and(|(time, ..)| time >= ENOUGH);
        if more && !enough { Ok(()) } else { self.judge() }
    }

    /// Judges by what there was.
    pub(super) fn judge(&mut self) -> Result<(), LogError> {
        if std::mem::replace(&mut self.judged, true) {
            return Ok(());
        }
        let Some((time, rate, force)) = self.aligner.still() else { return Ok(()) };
        self.force(time, &rate, &force)?;
        self.tilt(time, &force)?;
        if self.description.is_navigation_grade() { self.rate(time, &rate, &force) } else { Ok(()) }
    }

    fn force(&self, time: f64, rate: &Vector3<f64>, force: &Vector3<f64>) -> Result<(), LogError> {
        let Site { latitude, height, .. } = self.description.site;
        let gravity = earth::gravity(latitude, height);
        let felt = force.norm();
        let off = (felt / gravity - 1.0).abs();
        let unit = match force_unit(felt / gravity, self.description.rate) {
            _ if off < FORCE => return Ok(()),
            Some(unit) => format!(": this looks like {unit}"),
            None => String::new(),
        };
        let prior = |effect| 10.0 * self.description.prior(effect);
        let largest = FORCE + prior("accel-bias") / gravity + prior("accel-scale");
        if unit.is_empty() && (off < largest || rate.norm() > CENTRIFUGE) {
            return Ok(());
        }
        let problem = format!(
            "standing still for its first {time:.0} s the unit feels {felt:.3} m/s^2, gravity is {gravity:.3}{unit}"
        );
        Err(LogError::column(&self.table, &self.columns[1].names().join("`, `"), problem).help(VELOCITY))
    }

    /// The first position of the reference: metres from the site, not the degrees where the site is.
    fn place(&self, position: &Vector3<f64>) -> Result<(), LogError> {
        let Site { latitude, longitude, .. } = self.description.site;
        let site = [longitude / DEGREE, latitude / DEGREE];
        let is = |east: f64, north: f64| (east - site[0]).hypot(north - site[1]) < DEGREES;
        if !is(position.x, position.y) && !is(position.y, position.x) || site[0].hypot(site[1]) < 1.0 {
            return Ok(());
        }
        let problem =
            format!("begins with {} and {}: the longitude and latitude of the site", position.x, position.y);
        let help = "east, north and up of the site are expected, in m";
        Err(LogError::column(&self.table, &Group::REF_POS.names().join("`, `"), problem).help(help))
    }

    fn rate(&self, time: f64, rate: &Vector3<f64>, force: &Vector3<f64>) -> Result<(), LogError> {
        let noise = 6.0 * self.description.noise.angle_random_walk / time.sqrt();
        let bias = 10.0 * self.description.prior("gyro-bias");
        let spread = GYRO_BIAS + bias + noise;
        let felt = rate.norm();
        let says = format!(
            "standing still for its first {time:.0} s the unit turns by {:.4} deg/h, the Earth by {:.2}",
            felt / DEG_PER_HOUR,
            earth::ROTATION_RATE / DEG_PER_HOUR
        );
        let columns = self.columns[0].names().join("`, `");
        let fault = |problem: String| LogError::column(&self.table, &columns, problem);
        // rate and force of a unit at rest enclose the complement of the latitude, whatever the unit of each
        let latitude = (rate.dot(force) / (felt * force.norm())).clamp(-1.0, 1.0).asin();
        let off = |other: f64| (latitude - other).abs();
        let site = &self.description.site;
        if felt > earth::ROTATION_RATE + spread {
            let unit = angle_unit(felt / earth::ROTATION_RATE, self.description.rate);
            return match unit.filter(|_| off(site.latitude) < LATITUDE) {
                Some(unit) => Err(fault(format!("{says}: this looks like {unit}")).help(ANGLE)),
                // it may stand on a table that turns evenly about the vertical
                None => Ok(()),
            };
        }
        if spread >= earth::ROTATION_RATE {
            return Ok(());
        }
        if felt < earth::ROTATION_RATE - spread {
            return Err(fault(says).help(ANGLE));
        }
        if off(site.latitude) < LATITUDE + noise / earth::ROTATION_RATE {
            return self.heading(time, rate, spread);
        }
        let problem = format!(
            "is {:.2}, but {} shows about {:.0} where the unit stands still",
            site.latitude / DEGREE,
            self.table.display(),
            latitude / DEGREE
        );
        let help = if (latitude - site.latitude / DEGREE).abs() < 0.2 {
            "this looks like rad: degrees are expected"
        } else if off(site.longitude) < LATITUDE {
            "latitude and longitude exchanged?"
        } else if off(-site.latitude) < LATITUDE {
            "north is positive; or an axis of the gyros or accelerometers points the other way"
        } else {
            "the axes of gyros and accelerometers must be the same, right-handed: x right, y forward, z up"
        };
        let names = self.columns.iter().flat_map(|group| group.names());
        let dead = names.zip(rate.iter().chain(force)).filter(|(_, felt)| **felt == 0.0);
        let dead: Vec<String> = dead.map(|(name, _)| format!("`{name}`")).collect();
        let fault = self.field("site.latitude_deg", &problem).help(help);
        Err(if dead.is_empty() {
            fault
        } else {
            fault.note(format!("{} read nothing but 0", dead.join(", ")))
        })
    }

    fn tilt(&self, time: f64, force: &Vector3<f64>) -> Result<(), LogError> {
        let off = |attitude: &UnitQuaternion<f64>| (attitude * force).angle(&Vector3::z());
        for (of, attitude) in self.attitudes() {
            let angle = off(&attitude);
            let limit = TILT.max(10.0 * of.level_sigma(&self.description));
            if angle > limit {
                let problem = format!(
                    "gravity would be {:.1} deg off the vertical where the unit stands still (its first {time:.0} s)",
                    angle / DEGREE
                );
                let turned = "specific force points up at rest: the accelerometers have the other sign, or the axes are \
                              forward, right, down";
                let turned = (angle > PI - TILT).then_some(turned);
                let meant = readings(&attitude, |attitude| off(attitude) < TILT);
                let other = (meant.is_empty() && turned.is_none()).then_some(AXES);
                let help: Vec<&str> = turned.into_iter().chain(meant).chain(other).collect();
                return Err(self.attitude_fault(of, &problem).help(help.join("; or ")));
            }
        }
        Ok(())
    }

    /// Whether an attitude that is given points the Earth's rate to the north, as far as gyros that may err by `spread` can tell.
    fn heading(&self, time: f64, rate: &Vector3<f64>, spread: f64) -> Result<(), LogError> {
        let latitude = self.description.site.latitude;
        let north = earth::ROTATION_RATE * latitude.cos();
        let off = |attitude: &UnitQuaternion<f64>| {
            let felt = attitude * rate;
            (felt.x.hypot(felt.y - north), felt.x.atan2(felt.y).abs())
        };
        for (of, attitude) in self.attitudes() {
            let (wrong, angle) = off(&attitude);
            let limit =
                spread + earth::ROTATION_RATE * TILT + north * 10.0 * of.heading_sigma(&self.description);
            if wrong > limit {
                let problem = format!(
                    "the Earth's rate would point {:.0} deg off north where the unit stands still (its first {time:.0} s)",
                    angle / DEGREE
                );
                let meant = readings(&attitude, |attitude| off(attitude).0 < limit);
                let other = "x and y exchanged, or a heading that does not count from north? It must turn components in b (x \
                             right, y forward, z up) into components in n (east, north, up)";
                let help = if meant.is_empty() { other.to_owned() } else { meant.join("; or ") };
                return Err(self.attitude_fault(of, &problem).help(help));
            }
        }
        Ok(())
    }

    /// The attitudes that are given for the still stretch.
    fn attitudes(&self) -> impl Iterator<Item = (Given, UnitQuaternion<f64>)> {
        let initial = self.description.initial.as_ref().map(|initial| (Given::Initial, initial.attitude));
        initial.into_iter().chain(self.reference.map(|attitude| (Given::Reference, attitude)))
    }

    /// A fault of an attitude that is given.
    fn attitude_fault(&self, of: Given, problem: &str) -> LogError {
        match of {
            Given::Initial => self.field("initial.quaternion_wxyz", problem),
            Given::Reference => LogError::column(&self.table, &Group::REF_QUAT.names().join("`, `"), problem),
        }
    }

    /// A fault of a field of the description, at its line if it is still there.
    fn field(&self, field: &str, problem: &str) -> LogError {
        let description = self.table.with_extension("toml");
        let text: Arc<str> = std::fs::read_to_string(&description).unwrap_or_default().into();
        let key = field.rsplit('.').next().unwrap_or_default();
        let mut start = 0;
        let mut lines = text.split_inclusive('\n').map(|line| {
            start += line.len();
            start - line.len()..start - line.len() + line.trim_end().len()
        });
        let of_key =
            |line: &Range<usize>| text[line.clone()].split('=').next().is_some_and(|name| name.contains(key));
        let line = lines.find(of_key);
        LogError::text(&description, &text, line, Some(field), problem)
    }
}

const VELOCITY: &str = "velocity increments over one interval are expected, in m/s; where rows were left out, theirs are to be \
                        added to the next";
const AXES: &str =
    "it must turn components in b (x right, y forward, z up) into components in n (east, north, up)";
const ANGLE: &str = "angle increments over one interval are expected, in rad, the Earth's rate not taken out; gyros that err \
                     by so much need a larger sigma of gyro-bias in [prior]";

/// What is `ratio` times too large when a velocity increment in m/s was expected, at `rate` Hz.
pub(super) fn force_unit(ratio: f64, rate: f64) -> Option<String> {
    let units = [
        (1.0 / STANDARD_GRAVITY, "increments in g s, not in m/s"),
        (1.0 / 0.3048, "increments in ft/s, not in m/s"),
        (1e3, "increments in mm/s, not in m/s"),
        (rate, "accelerations in m/s^2, not increments"),
        (rate / STANDARD_GRAVITY, "accelerations in g, not increments in m/s"),
        (1e3 * rate / STANDARD_GRAVITY, "accelerations in mg, not increments in m/s"),
    ];
    nearest(ratio, FORCE, &units)
}

/// What is `ratio` times too large when an angle increment in rad was expected, at `rate` Hz.
fn angle_unit(ratio: f64, rate: f64) -> Option<String> {
    let degree = 1.0 / DEGREE;
    let units = [
        (degree, "degrees, not rad"),
        (60.0 * degree, "arc minutes, not rad"),
        (3600.0 * degree, "arc seconds, not rad"),
        (1e3, "mrad, not rad"),
        (1e6, "urad, not rad"),
        (rate, "rates in rad/s, not increments"),
        (rate * degree, "rates in deg/s, not increments in rad"),
        (3600.0 * rate * degree, "rates in deg/h, not increments in rad"),
    ];
    // a bias of 5 deg/h is a third of the Earth's rate
    nearest(ratio, 0.35, &units)
}

/// The units within `tolerance` of a ratio, the nearest first.
fn nearest(ratio: f64, tolerance: f64, units: &[(f64, &str)]) -> Option<String> {
    let mut near: Vec<(f64, &str)> =
        units.iter().map(|(size, name)| ((ratio / size).ln().abs(), *name)).collect();
    near.retain(|(off, _)| *off < tolerance.ln_1p());
    near.sort_by(|a, b| a.0.total_cmp(&b.0));
    let names: Vec<&str> = near.iter().map(|(_, name)| *name).collect();
    (!names.is_empty()).then(|| names.join("; or like "))
}

/// How else the four numbers may have been meant, if that `agrees` with what the sensors feel.
fn readings(
    attitude: &UnitQuaternion<f64>,
    agrees: impl Fn(&UnitQuaternion<f64>) -> bool,
) -> Vec<&'static str> {
    let [x, y, z, w] = attitude.coords.into();
    let exchanged = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(z, w, x, y));
    let meant = [
        (exchanged, "the order is w, x, y, z: these numbers are in the order x, y, z, w"),
        (
            attitude.inverse(),
            "it must turn components in b into components in n (east, north, up): this one is its inverse",
        ),
    ];
    meant.into_iter().filter(|(attitude, _)| agrees(attitude)).map(|(_, text)| text).collect()
}
