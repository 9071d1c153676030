//! Coarse alignment: attitude from the first still stretch of a log.
//!
//! Level comes from gravity, heading from the Earth's rate (analytic coarse alignment; Titterton and Weston, *Strapdown
//! Inertial Navigation Technology*, 2nd ed., section 10.3). It serves where a log has no attitude of its own.

use nalgebra::{ComplexField, Matrix3, Rotation3, UnitQuaternion, Vector3};

use crate::{InitialAttitude, Sample, SensorNoise, Site, earth};

/// Stillness is judged over windows of this length, s.
const WINDOW: f64 = 0.5;
/// At least this much stillness is needed, s.
const SHORTEST: f64 = 5.0;
/// Longer stretches say little more, s.
const LONGEST: f64 = 600.0;
/// Mean rate of a window may differ from the first window's by this much beside noise, rad/s (0.01 deg/s).
const RATE_STEP: f64 = 1.7e-4;
/// Mean specific force of a window may differ from the first window's by this much beside noise, m/s^2.
const FORCE_STEP: f64 = 0.02;
/// A heading less certain than this is none, rad (10 deg): the error model is linear in it.
const WORST_HEADING: f64 = 0.175;

/// Finds the attitude at the start of a log, sample by sample.
#[derive(Clone, Copy, Debug)]
pub struct Aligner {
    site: Site,
    noise: SensorNoise,
    gyro_bias_sigma: f64,
    accel_bias_sigma: f64,
    rate: f64,
    first: Option<(Vector3<f64>, Vector3<f64>)>,
    window: Sums,
    total: Sums,
    moved: bool,
}

/// Increments added up.
#[derive(Clone, Copy, Debug)]
struct Sums {
    dtheta: Vector3<f64>,
    dvel: Vector3<f64>,
    time: f64,
}

impl Sums {
    const EMPTY: Self =
        Self { dtheta: Vector3::new(0.0, 0.0, 0.0), dvel: Vector3::new(0.0, 0.0, 0.0), time: 0.0 };
}

/// Why a log does not give its own initial attitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AlignError {
    /// The unit moves before five seconds have passed.
    NotStill {
        /// Length of the still stretch found, s.
        still: f64,
    },
    /// The sensors are not good enough to find north by the Earth's rate.
    HeadingUnknown {
        /// Standard deviation that the heading would have, rad.
        sigma: f64,
    },
}

impl core::fmt::Display for AlignError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::NotStill { still } => write!(
                f,
                "the log begins with {still:.1} s of stillness, and {SHORTEST} s are needed to find the attitude; \
                 give it in the table [initial]"
            ),
            Self::HeadingUnknown { sigma } => write!(
                f,
                "the gyros find north only to {:.0} deg from the Earth's rate; give the attitude in the table [initial]",
                sigma.to_degrees()
            ),
        }
    }
}

impl core::error::Error for AlignError {}

impl Aligner {
    /// Begins at the first sample of a log at `site` sampled at `rate` Hz; the bias priors (rad/s, m/s^2) limit what
    /// stillness can say.
    pub fn new(
        site: Site,
        rate: f64,
        noise: SensorNoise,
        gyro_bias_sigma: f64,
        accel_bias_sigma: f64,
    ) -> Self {
        Self {
            site,
            noise,
            gyro_bias_sigma,
            accel_bias_sigma,
            rate,
            first: None,
            window: Sums::EMPTY,
            total: Sums::EMPTY,
            moved: false,
        }
    }

    /// Takes in the next sample. `false` when the rest of the log is of no use.
    pub fn push(&mut self, sample: &Sample) -> bool {
        if self.moved || self.total.time >= LONGEST {
            return false;
        }
        self.window.dtheta += sample.dtheta;
        self.window.dvel += sample.dvel;
        self.window.time += 1.0 / self.rate;
        if self.window.time >= WINDOW {
            let rate = self.window.dtheta / self.window.time;
            let force = self.window.dvel / self.window.time;
            let (first_rate, first_force) = *self.first.get_or_insert((rate, force));
            let six_sigma = 6.0 * ComplexField::sqrt(2.0 / self.window.time);
            let still = (rate - first_rate).norm() < RATE_STEP + six_sigma * self.noise.angle_random_walk
                && (force - first_force).norm() < FORCE_STEP + six_sigma * self.noise.velocity_random_walk;
            self.moved = !still;
            if still {
                self.total.dtheta += self.window.dtheta;
                self.total.dvel += self.window.dvel;
                self.total.time += self.window.time;
            }
            self.window = Sums::EMPTY;
        }
        !self.moved
    }

    /// Length (s) of the still stretch so far, mean angular rate (rad/s) and specific force (m/s^2) in it, in b; nothing while
    /// it is shorter than five seconds.
    pub fn still(&self) -> Option<(f64, Vector3<f64>, Vector3<f64>)> {
        let Sums { dtheta, dvel, time } = self.total;
        (time >= SHORTEST).then(|| (time, dtheta / time, dvel / time))
    }

    /// The attitude during the still stretch, with its uncertainty.
    ///
    /// # Errors
    /// When the log does not begin with stillness, or the gyros cannot find north.
    pub fn finish(&self) -> Result<InitialAttitude, AlignError> {
        let time = self.total.time;
        if time < SHORTEST {
            return Err(AlignError::NotStill { still: time });
        }
        let gravity = earth::gravity(self.site.latitude, self.site.height);
        let horizontal_rate = earth::ROTATION_RATE * ComplexField::cos(self.site.latitude);
        let force_error = combined(self.accel_bias_sigma, self.noise.velocity_random_walk, time);
        let rate_error = combined(self.gyro_bias_sigma, self.noise.angle_random_walk, time);
        let heading_sigma = rate_error / horizontal_rate;
        if !(heading_sigma < WORST_HEADING) {
            return Err(AlignError::HeadingUnknown { sigma: heading_sigma });
        }
        // rows of C_bn: east, north and up in b
        let up = self.total.dvel.normalize();
        let rate = self.total.dtheta / time;
        let north = (rate - up * rate.dot(&up)).normalize();
        let east = north.cross(&up);
        let c_bn = Matrix3::from_rows(&[east.transpose(), north.transpose(), up.transpose()]);
        Ok(InitialAttitude {
            attitude: UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(c_bn)),
            level_sigma: force_error / gravity,
            heading_sigma,
        })
    }
}

/// Standard deviation of a mean over `time` of a sensor with a bias and a random walk.
fn combined(bias_sigma: f64, random_walk: f64, time: f64) -> f64 {
    ComplexField::sqrt(bias_sigma * bias_sigma + random_walk * random_walk / time)
}
