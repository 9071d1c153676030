//! What still positions say of the site by themselves: the Earth's rate, the latitude, and gravity.
//!
//! In each position the gyros feel the Earth's rate, whatever the heading: along gravity `omega_ie sin L`, across it
//! `omega_ie cos L`. Biases are common to all positions. With mean rate `omega_k` of position k and the direction `u_k` of its force, least
//! squares over the bias `b` and the two parts have the residuals
//!
//! ```text
//! (omega_k - b) . u_k - omega_ie sin L        |(omega_k - b) x u_k| - omega_ie cos L
//! ```
//!
//! after those for gravity, with the accelerometers' bias, `|f_k - b| - g`. Each position has its random walk; what is left beyond it makes the
//! standard deviations grow.

use nalgebra::{SMatrix, SVector, Vector3};

use super::positions::{Position, Recorder};
use crate::{Sample, SensorNoise, Site, earth};

/// Fewer positions do not tell biases from the Earth.
const FEWEST: usize = 6;
/// Gyros that walk more than this see no Earth in a rest of a minute, rad/sqrt(s): 0.05 deg/sqrt(h).
const LARGEST_WALK: f64 = 1.5e-5;
/// Steps of the fit; it converges quadratically.
const ITERATIONS: usize = 8;
/// So many standard deviations are a contradiction.
const CONTRADICTS: f64 = 5.0;
/// What axes that are not quite square do to the latitude, rad.
const SQUARE: f64 = 2e-4;
/// Gyros that feel the specific force shift the part of the Earth's rate along it, and with it its size; a latitude does not. So good
/// scale factors do not hide that: a part of the rate.
const SCALE: f64 = 1e-4;

/// Collects still positions, sample by sample.
#[derive(Clone, Debug)]
pub struct SiteRests {
    noise: SensorNoise,
    recorder: Recorder,
}

/// What rests in several positions show of the site: values and standard deviations, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SiteShown {
    /// Still positions.
    pub positions: usize,
    /// Geodetic latitude, rad.
    pub latitude: (f64, f64),
    /// Rate of the Earth, rad/s.
    pub earth_rate: (f64, f64),
    /// Gravity as the accelerometers' scale has it, m/s^2.
    pub gravity: (f64, f64),
}

/// What the rests and the description of a log say differently.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SiteFault {
    /// The latitude.
    Latitude,
    /// The rate of the Earth: the clock, or the unit of the gyros.
    EarthRate,
    /// Gravity: height, or the unit of the accelerometers.
    Gravity,
}

impl SiteRests {
    /// Begins at the first sample of a log, sampled at `rate` Hz; nothing for gyros that do not see the Earth.
    pub fn new(rate: f64, noise: SensorNoise) -> Option<Self> {
        let sees = noise.angle_random_walk < LARGEST_WALK;
        sees.then(|| Self { noise, recorder: Recorder::new(rate).without_turns() })
    }

    /// Takes in the next sample.
    pub fn push(&mut self, sample: &Sample) {
        self.recorder.push(sample);
    }

    /// What was shown; nothing where there are too few positions, or they are too much alike.
    pub fn finish(self, site: &Site) -> Option<SiteShown> {
        let positions = self.recorder.finish().positions;
        if positions.len() < FEWEST {
            return None;
        }
        let [_, north, up] = earth::rotation_n(site.latitude).into();
        let accel = |at: &SVector<f64, 4>, position: &Position, add: &mut dyn FnMut(f64, SVector<f64, 4>)| {
            let force = position.force - at.fixed_rows::<3>(0);
            let u = force.normalize();
            add(force.norm() - at[3], SVector::from([-u.x, -u.y, -u.z, -1.0]));
        };
        let start = SVector::from([0.0, 0.0, 0.0, earth::gravity(site.latitude, site.height)]);
        let (force, q) = fit(&positions, self.noise.velocity_random_walk, start, accel)?;
        let bias = force.fixed_rows::<3>(0).into_owned();
        let gyro = |at: &SVector<f64, 5>, position: &Position, add: &mut dyn FnMut(f64, SVector<f64, 5>)| {
            let u = (position.force - bias).normalize();
            let rate = position.rate - at.fixed_rows::<3>(0);
            let along = rate.dot(&u);
            let across = rate - u * along;
            let size = across.norm();
            let row = |of: Vector3<f64>, a: f64, b: f64| SVector::from([of.x, of.y, of.z, a, b]);
            add(along - at[3], row(-u, -1.0, 0.0));
            add(size - at[4], row(-across / size, 0.0, -1.0));
        };
        let start = SVector::from([0.0, 0.0, 0.0, up, north]);
        let (found, p) = fit(&positions, self.noise.angle_random_walk, start, gyro)?;
        let (up, north) = (found[3], found[4]);
        let rate = up.hypot(north);
        let sigma = |a: f64, b: f64| {
            (a * a * p[(3, 3)] + 2.0 * a * b * p[(3, 4)] + b * b * p[(4, 4)]).max(0.0).sqrt()
        };
        let shown = SiteShown {
            positions: positions.len(),
            latitude: (up.atan2(north), sigma(north, -up) / (rate * rate)),
            earth_rate: (rate, sigma(up, north) / rate),
            gravity: (force[3], q[(3, 3)].max(0.0).sqrt()),
        };
        let all = [shown.latitude, shown.earth_rate, shown.gravity];
        all.iter().all(|(value, sigma)| value.is_finite() && sigma.is_finite()).then_some(shown)
    }
}

impl SiteShown {
    /// What they contradict, where the scale factors of gyros and accelerometers have those standard deviations.
    pub fn contradicts(&self, site: &Site, [gyro_scale, accel_scale]: [f64; 2]) -> Option<SiteFault> {
        let off = |(value, sigma): (f64, f64), stated: f64, beside: f64| {
            (value - stated).abs() > CONTRADICTS * sigma.hypot(beside)
        };
        let gravity = earth::gravity(site.latitude, site.height);
        // on the equator they do not tell north from south, and anywhere they do not tell a scale factor from gravity
        if off(self.earth_rate, earth::ROTATION_RATE, gyro_scale * earth::ROTATION_RATE) {
            Some(SiteFault::EarthRate)
        } else if off(self.latitude, site.latitude, SQUARE) {
            Some(SiteFault::Latitude)
        } else if off(self.gravity, gravity, accel_scale * gravity) {
            Some(SiteFault::Gravity)
        } else {
            None
        }
    }

    /// Whether the log was taken at another latitude than `site` has, and nothing else explains it.
    pub fn is_elsewhere(&self, site: &Site) -> bool {
        let (rate, sigma) = self.earth_rate;
        let keeps_its_size =
            (rate - earth::ROTATION_RATE).abs() < 3.0 * sigma.hypot(SCALE * earth::ROTATION_RATE);
        let (latitude, sigma) = self.latitude;
        keeps_its_size && (latitude - site.latitude).abs() > CONTRADICTS * sigma.hypot(SQUARE)
    }
}

/// Least squares by Gauss and Newton over positions, each with its random walk: what was found and its covariance, which grows with what
/// is left beyond the walk.
fn fit<const N: usize>(
    positions: &[Position],
    walk: f64,
    start: SVector<f64, N>,
    residuals: impl Fn(&SVector<f64, N>, &Position, &mut dyn FnMut(f64, SVector<f64, N>)),
) -> Option<(SVector<f64, N>, SMatrix<f64, N, N>)> {
    let mut at = start;
    let mut covariance = SMatrix::zeros();
    let (mut squares, mut rows) = (0.0, 0);
    for _ in 0..ITERATIONS {
        let mut information = SMatrix::<f64, N, N>::zeros();
        let mut score = SVector::<f64, N>::zeros();
        (squares, rows) = (0.0, 0_usize);
        for position in positions {
            let weight = position.time / (walk * walk);
            residuals(&at, position, &mut |residual, row| {
                information += row * row.transpose() * weight;
                score -= row * (residual * weight);
                squares += residual * residual * weight;
                rows += 1;
            });
        }
        // in units of each parameter's own information: rates are small numbers
        let scale = information.diagonal().map(|own| 1.0 / own.sqrt());
        let scaled = SMatrix::<f64, N, N>::from_fn(|i, j| information[(i, j)] * scale[i] * scale[j]);
        let inverse = scaled.cholesky()?.inverse();
        covariance = SMatrix::from_fn(|i, j| inverse[(i, j)] * scale[i] * scale[j]);
        at += covariance * score;
    }
    let left = squares / rows.checked_sub(N).filter(|left| *left > 0)? as f64;
    Some((at, covariance * left.max(1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Reference;
    use nalgebra::UnitQuaternion;
    use std::vec::Vec;

    const SITE: Site = Site { latitude: 0.56, longitude: 1.9, height: 50.0 };
    const NOISE: SensorNoise = SensorNoise { angle_random_walk: 3e-7, velocity_random_walk: 5e-5 };

    /// Rests of a minute in every attitude, with turns between them, seen by a unit with biases.
    fn shown(axes: &[Vector3<f64>], biases: [Vector3<f64>; 2]) -> Option<SiteShown> {
        shown_by(axes, biases, 0.0)
    }

    /// The same by gyros that feel the specific force, rad/s per m/s^2.
    fn shown_by(axes: &[Vector3<f64>], biases: [Vector3<f64>; 2], feel: f64) -> Option<SiteShown> {
        let mut rests = SiteRests::new(10.0, NOISE)?;
        let (rate, gravity) = (earth::rotation_n(SITE.latitude), earth::gravity(SITE.latitude, SITE.height));
        let mut attitude = UnitQuaternion::identity();
        let mut time = 0.0;
        for axis in axes {
            for turning in [false, true] {
                let steps = if turning { 90 } else { 600 };
                let turn =
                    if turning { axis * (core::f64::consts::FRAC_PI_2 / 9.0) } else { Vector3::zeros() };
                for _ in 0..steps {
                    time += 0.1;
                    attitude *= UnitQuaternion::from_scaled_axis(turn * 0.1);
                    let force = attitude.inverse() * (Vector3::z() * gravity);
                    let sample = Sample {
                        dtheta: (attitude.inverse() * rate + turn + biases[0] + force * feel) * 0.1,
                        dvel: (force + biases[1]) * 0.1,
                        time,
                        temperature: Vector3::zeros(),
                        gyro_temperature: Vector3::zeros(),
                        dither: Vector3::zeros(),
                        reference: Reference::default(),
                    };
                    rests.push(&sample);
                }
            }
        }
        rests.finish(&SITE)
    }

    fn axes() -> Vec<Vector3<f64>> {
        let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
        [x, x, z, y, y, z, x, y, z, x].to_vec()
    }

    #[test]
    fn rests_show_latitude_and_gravity_whatever_the_biases() {
        let biases = [Vector3::new(2e-6, -1e-6, 3e-6), Vector3::new(2e-3, -3e-3, 1e-3)];
        let shown = shown(&axes(), biases).expect("enough positions");
        assert!((shown.latitude.0 - SITE.latitude).abs() < 1e-6, "{shown:?}");
        assert!((shown.earth_rate.0 / earth::ROTATION_RATE - 1.0).abs() < 1e-5, "{shown:?}");
        assert!((shown.gravity.0 - earth::gravity(SITE.latitude, SITE.height)).abs() < 1e-6, "{shown:?}");
        // a walk of 3e-7 over ten minutes of rests, over a rate of 7e-5
        assert!((1e-5..1e-3).contains(&shown.latitude.1), "{shown:?}");
        let scales = [1e-3, 1e-4];
        assert_eq!(shown.contradicts(&SITE, scales), None);
        assert!(!shown.is_elsewhere(&SITE));
        let elsewhere = Site { latitude: SITE.latitude + 0.009, ..SITE };
        assert_eq!(shown.contradicts(&elsewhere, scales), Some(SiteFault::Latitude));
        assert!(shown.is_elsewhere(&elsewhere));
        let above = Site { height: 3000.0, ..SITE };
        assert_eq!(shown.contradicts(&above, scales), Some(SiteFault::Gravity));
        assert_eq!(shown.contradicts(&above, [1e-3; 2]), None);
        // gyros that feel the specific force, 0.05 deg/h/g on each axis, are no other latitude
        let feel = shown_by(&axes(), biases, 0.05 * 4.85e-6 / 9.8).expect("enough positions");
        assert!(feel.contradicts(&SITE, scales).is_some() && !feel.is_elsewhere(&SITE), "{feel:?}");
    }

    #[test]
    fn too_few_attitudes_and_poor_gyros_show_nothing() {
        let none = [Vector3::zeros(); 2];
        assert_eq!(shown(&axes()[..4], none), None);
        // always level: the bias about the vertical is not told from the Earth
        let level = [Vector3::z(); 10];
        let of_level = shown(&level, none);
        assert!(of_level.is_none_or(|shown| shown.latitude.1 > 0.1), "{of_level:?}");
        assert!(SiteRests::new(10.0, SensorNoise { angle_random_walk: 1e-4, ..NOISE }).is_none());
    }
}
