//! What a unit must feel while it stands still: gravity and the Earth's rate. A wrong unit, a wrong order of numbers or a wrong
//! site show there at once, where the signals of a turn could be anything.
//!
//! Limits are wide enough for errors that the coarse stage captures (1 %, 20 mg, 5 deg/h) and for any sensor of its class; whoever
//! goes beyond them has written something else than what was expected.

use std::path::{Path, PathBuf};

use nalgebra::{UnitQuaternion, Vector3};
use sinscal::{Aligner, Sample, Site, earth};

use super::columns::Group;
use super::description::Description;
use super::fault::LogError;
use rig::units::{DEGREE, MICRO_G};

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
/// A still unit feels gravity to this fraction.
const FORCE: f64 = 0.1;

/// Listens to the first still stretch of a log.
pub(super) struct Stillness {
    table: PathBuf,
    aligner: Aligner,
    description: Description,
    /// The columns of gyros and accelerometers.
    columns: [Group; 2],
    reference: Option<UnitQuaternion<f64>>,
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
        self.force(time, &force)?;
        self.tilt(time, &force)?;
        if self.description.is_navigation_grade() { self.rate(time, &rate, &force) } else { Ok(()) }
    }

    fn force(&self, time: f64, force: &Vector3<f64>) -> Result<(), LogError> {
        let Site { latitude, height, .. } = self.description.site;
        let gravity = earth::gravity(latitude, height);
        let felt = force.norm();
        if (felt / gravity - 1.0).abs() < FORCE {
            return Ok(());
        }
        let Some(unit) = force_unit(felt / gravity, self.description.rate) else { return Ok(()) };
        let problem = format!(
            "standing still for its first {time:.0} s the unit feels {felt:.3} m/s^2, gravity is {gravity:.3}: \
             this looks like {unit}"
        );
        Err(LogError::column(&self.table, &self.columns[1].names().join("`, `"), problem).help(VELOCITY))
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
            return Ok(());
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
        Err(self.field("site.latitude_deg", &problem).help(help))
    }

    fn tilt(&self, time: f64, force: &Vector3<f64>) -> Result<(), LogError> {
        let off = |attitude: &UnitQuaternion<f64>| (attitude * force).angle(&Vector3::z());
        let says = |angle: f64| {
            format!(
                "gravity would be {:.1} deg off the vertical where the unit stands still (its first {time:.0} s)",
                angle / DEGREE
            )
        };
        if let Some(initial) = &self.description.initial {
            let angle = off(&initial.attitude);
            if angle > TILT.max(10.0 * initial.level_sigma) {
                let field = "initial.quaternion_wxyz";
                return Err(self.field(field, &says(angle)).help(reading(&initial.attitude, off)));
            }
        }
        if let Some(reference) = &self.reference {
            let angle = off(reference);
            if angle > TILT.max(10.0 * self.description.reference.attitude) {
                let columns = Group::REF_QUAT.names().join("`, `");
                let fault = LogError::column(&self.table, &columns, says(angle));
                return Err(fault.help(reading(reference, off)));
            }
        }
        Ok(())
    }

    fn field(&self, field: &str, problem: &str) -> LogError {
        let description = self.table.with_extension("toml");
        LogError::file(&description, format!("field `{field}`: {problem}"))
    }
}

const VELOCITY: &str = "velocity increments over one interval are expected, in m/s";
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

/// How else the four numbers may have been meant, if that agrees with gravity.
fn reading(attitude: &UnitQuaternion<f64>, off: impl Fn(&UnitQuaternion<f64>) -> f64) -> String {
    let [x, y, z, w] = attitude.coords.into();
    let exchanged = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(z, w, x, y));
    if off(&exchanged) < TILT {
        "the order is w, x, y, z: these numbers are in the order x, y, z, w".into()
    } else if off(&attitude.inverse()) < TILT {
        "it must turn components in b into components in n (east, north, up): this one is its inverse".into()
    } else {
        "it must turn components in b (x right, y forward, z up) into components in n (east, north, up)"
            .into()
    }
}
