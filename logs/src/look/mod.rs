//! What a log holds, before anything is estimated and without a description: how it was read, its rests, what is odd in it, with rows
//! and what to do, and the description that it suggests.

mod axes;
#[cfg(test)]
mod cases;
mod channels;
mod describe;
mod steps;
mod text;

use std::path::Path;

use nalgebra::Vector3;
use serde::Serialize;
use sinscal::Sample;

use super::description::Description;
use super::fault::LogError;
use super::reading::Reading;
use super::rests::{Rest, RestFinder, Rests};
use super::signals::{Opened, Signals};
use super::still::{STANDARD_GRAVITY, force_unit};
use super::table::Table;
use crate::units::{DEG_PER_SQRT_HOUR, DEGREE, MICRO_G};
pub(super) use axes::{Contradiction, contradictions};
pub(super) use channels::Channels;
use steps::Steps;

/// A unit at rest feels gravity to this part.
const GRAVITY: f64 = 0.1;
/// Below this part of it gravity was taken out.
const NO_GRAVITY: f64 = 0.2;
/// So many findings of one kind are told.
const TOLD: usize = 4;

/// What is in a log.
#[derive(Clone, Debug, Serialize)]
pub struct Look {
    /// Rows.
    pub samples: u64,
    /// From the beginning of the first interval to the last stamp, s.
    pub duration_s: f64,
    /// By the stamps, or by the description where there are none, Hz.
    pub rate_hz: f64,
    /// Scatter of the steps about the interval, rms, gaps left out, s.
    pub jitter_s: f64,
    /// Over the rests, or over all where there is none, rad/s.
    pub mean_rate_rad_s: [f64; 3],
    /// The same of the specific force, m/s^2.
    pub mean_force_m_s2: [f64; 3],
    /// Where the unit does not move.
    pub rests: Vec<Rest>,
    /// In the rests.
    pub noise: Option<Noise>,
    /// Lowest and highest, degC.
    pub temperature_c: Option<[f64; 2]>,
    /// What the axes of the file likely are, as `--axes` says it; nothing where they are ours or nothing shows.
    pub likely_axes: Option<String>,
    /// How the columns were read: what is said of them, and what was recognised.
    pub read: Vec<String>,
    /// What is odd, where, and what to do.
    pub warnings: Vec<String>,
    /// A description to begin with.
    #[serde(skip)]
    pub description: String,
}

/// What the sensors scatter by in the rests.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Noise {
    /// Angle random walk of each axis.
    pub gyro_arw_deg_sqrt_h: [f64; 3],
    /// Velocity random walk of each axis.
    pub accel_vrw_ug_sqrt_hz: [f64; 3],
}

/// Reads a log once and says what is in it; `each` sees its rows, without a reference. A description that lies beside it is heeded.
///
/// # Errors
/// When the files cannot be read, or nothing says which columns are which.
pub fn look(log: &Path, reading: &Reading, each: &mut dyn FnMut(&Sample)) -> Result<Look, LogError> {
    let Opened { table, reading, description } = Opened::of(log, reading)?;
    let seen = Seen::of(&table, description.as_ref(), each)?;
    Ok(seen.told(&table, &reading, description.as_ref()))
}

/// What one pass over the rows shows.
struct Seen {
    steps: Steps,
    channels: Channels,
    rests: Rests,
    rows: u64,
    sums: [Vector3<f64>; 2],
    force: f64,
    temperature: Option<[f64; 2]>,
    counts: bool,
}

impl Seen {
    fn of(
        table: &Table,
        description: Option<&Description>,
        each: &mut dyn FnMut(&Sample),
    ) -> Result<Self, LogError> {
        let interval = table.interval;
        let mut finder = RestFinder::new(interval);
        let mut seen = Self {
            steps: Steps::new(interval),
            channels: Channels::new(interval),
            rests: Rests::default(),
            rows: 0,
            sums: [Vector3::zeros(); 2],
            force: 0.0,
            temperature: None,
            counts: false,
        };
        let signals = Signals::new(table, description);
        seen.counts = signals.unscaled;
        signals.each(table, |row| {
            seen.steps.push(row.time);
            seen.rows += 1;
            seen.channels.push(&row.rate, &row.force);
            finder.push(row.time, &row.rate, &row.force);
            if row.is_sound() {
                each(&row.sample());
                seen.sums[0] += row.rate;
                seen.sums[1] += row.force;
                seen.force += row.force.norm();
            }
            for value in row.gyro_temperature.iter().chain(&row.temperature).filter(|value| value.is_finite())
            {
                let [low, high] = seen.temperature.unwrap_or([*value; 2]);
                seen.temperature = Some([low.min(*value), high.max(*value)]);
            }
            Ok(())
        })?;
        if seen.rows == 0 {
            return Err(
                LogError::file(table.path(), "has no rows").help("one row per IMU sample was expected")
            );
        }
        seen.rests = finder.finish();
        Ok(seen)
    }

    /// Means of rate and force in the rests, each by its length, or over all.
    fn means(&self) -> [Vector3<f64>; 2] {
        let rows = |rest: &Rest| (rest.last_row - rest.first_row + 1) as f64;
        let all: f64 = self.rests.rests.iter().map(rows).sum();
        if all == 0.0 {
            return self.sums.map(|sum| sum / self.rows as f64);
        }
        let mean = |of: fn(&Rest) -> [f64; 3]| {
            self.rests.rests.iter().map(|rest| Vector3::from(of(rest)) * rows(rest)).sum::<Vector3<f64>>()
                / all
        };
        [mean(|rest| rest.rate), mean(|rest| rest.force)]
    }

    fn told(self, table: &Table, reading: &Reading, description: Option<&Description>) -> Look {
        let means = self.means();
        let noise = self.rests.noise.filter(|_| !self.counts).map(|[gyro, accel]| Noise {
            gyro_arw_deg_sqrt_h: (gyro / DEG_PER_SQRT_HOUR).into(),
            accel_vrw_ug_sqrt_hz: (accel / MICRO_G).into(),
        });
        let mut warnings = Vec::new();
        warnings.extend(self.steps.warnings(description.map(|description| description.rate)));
        warnings.extend(self.channels.warnings(&self.rests));
        if self.counts {
            warnings.push(
                "the columns are pulses of unknown size: rates and forces are in pulses per second; \
                 imu.gyro_rad_per_pulse and imu.accel_m_s_per_pulse say the sizes, and `calibrate` finds them where there are rests"
                    .into(),
            );
        } else {
            warnings.extend(self.gravity(table, &means));
            warnings.extend(contradictions(&self.rests).map(Contradiction::told));
        }
        if self.rests.rests.is_empty() {
            warnings.push(
                "the unit never rests for a second: no noise can be measured, and filters that use rests need a reference".into(),
            );
        }
        let likely_axes = if self.counts { None } else { axes::likely(&self.rests, reading) };
        let mut read = table.notes.clone();
        read.extend(table.unused().map(|unused| format!("not used: {unused}")));
        let mut look = Look {
            samples: self.rows,
            duration_s: self.steps.duration(),
            rate_hz: self.steps.rate(),
            jitter_s: self.steps.jitter(),
            mean_rate_rad_s: means[0].into(),
            mean_force_m_s2: means[1].into(),
            noise,
            temperature_c: self.temperature,
            likely_axes,
            read,
            warnings,
            description: String::new(),
            rests: self.rests.rests,
        };
        look.description = describe::suggest(&look, reading, description);
        look
    }

    /// What rests feel that is not gravity, and what that looks like.
    fn gravity(&self, table: &Table, means: &[Vector3<f64>; 2]) -> Vec<String> {
        let rests = &self.rests.rests;
        let at_rest = !rests.is_empty();
        let forces = rests.iter().map(|rest| Vector3::from(rest.force).norm());
        let felt =
            if at_rest { forces.sum::<f64>() / rests.len() as f64 } else { self.force / self.rows as f64 };
        let rows = match rests.first() {
            Some(rest) => format!("rows {} to {}", rest.first_row, rest.last_row),
            None => format!("rows 1 to {}", self.rows),
        };
        let ratio = felt / STANDARD_GRAVITY;
        let mut warnings = Vec::new();
        if (ratio - 1.0).abs() > GRAVITY && at_rest || !(0.3..3.0).contains(&ratio) {
            let rate = 1.0 / table.interval;
            let counts = (10..=15)
                .map(|power| f64::from(1 << power))
                .find(|counts| (ratio * STANDARD_GRAVITY / counts - 1.0).abs() < GRAVITY);
            let what = if ratio < NO_GRAVITY && (ratio * STANDARD_GRAVITY - 1.0).abs() > GRAVITY {
                "gravity was taken out: a calibration needs the specific force as the accelerometers give it (ROS and phones have it in \
                 another topic or column)"
                    .into()
            } else if (ratio * STANDARD_GRAVITY - 1.0).abs() < GRAVITY {
                "this looks like g: --map accel=NAME:g".into()
            } else if (ratio / rate - 1.0).abs() < GRAVITY && !table.rates()[1] {
                "these are forces, read as increments: --map accel=NAME:m/s^2, and for the gyros gyro=NAME:rad/s".into()
            } else if (ratio / rate * STANDARD_GRAVITY - 1.0).abs() < GRAVITY && !table.rates()[1] {
                "these are forces in g, read as increments: --map accel=NAME:g, and for the gyros gyro=NAME:deg/s or rad/s".into()
            } else if let Some(counts) = counts {
                format!("this looks like counts: --map 'accel=NAME:{counts} LSB/g'")
            } else if let Some(unit) = force_unit(ratio, rate) {
                format!("this looks like {unit}")
            } else if (ratio * rate - 1.0).abs() < GRAVITY {
                "this looks like increments in m/s read as forces: leave the unit m/s^2 out of --map".into()
            } else {
                "its unit is another, or the accelerometers err by more than a tenth: --map accel=NAME:UNIT"
                    .into()
            };
            let still = if at_rest { "at rest " } else { "" };
            warnings.push(format!(
                "{rows}: {still}the specific force is {felt:.4} m/s^2 and not {STANDARD_GRAVITY:.2}: {what}"
            ));
        }
        let rate = means[0].norm();
        if at_rest && rate > 20.0 * DEGREE {
            warnings.push(format!(
                "{rows}: at rest the gyros read {:.1} deg/s: a bias so large is another unit, or an offset of counts: \
                 --map gyro=NAME:deg/s, or gyro=NAME-32768:131 LSB/(deg/s)",
                rate / DEGREE
            ));
        }
        warnings
    }
}
