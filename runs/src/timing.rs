//! How late a reference is stamped, from what it and the inertial sensors say of the same motion: before any filter runs, and
//! so also where the delay is too large to be linearised.
//!
//! A reading at t shows the motion at t - tau. Over windows of the reference's time its turns are correlated with those that the
//! gyros make tau earlier; where no attitude is measured, the sizes of the specific force: |dv/dt - g|, and from positions the
//! same of second differences. A size needs no attitude and is the same in every frame.

use nalgebra::{UnitQuaternion, Vector3};
use sinscal::earth::gravity;
use sinscal::{Reference, Sample, Setup};

use crate::samples::{ReadError, Samples, each};

/// Delays are sought up to this, s...
const MOST: f64 = 0.5;
/// ...in steps of so much, s...
const COARSE: f64 = 0.02;
/// ...that are halved until they are below this, s.
const FINE: f64 = 2e-4;
/// So much of a log is looked at, s.
const LOOKED_AT: f64 = 1200.0;
/// Least time between two remembered points of the inertial motion, and between two readings, s.
const APART: f64 = 0.01;
/// Windows that are compared: those with the most motion. Fewer than the second say nothing.
const WINDOWS: (usize, usize) = (2000, 100);
/// The shortest and the longest window, s.
const WINDOW: (f64, f64) = (0.1, 2.0);
/// Noise of the reference that a window may leave: of a rate, rad/s, and of a specific force, m/s^2...
const NOISE: (f64, f64) = (0.02, 0.3);
/// ...and how many times larger the motion must be.
const MOVES: f64 = 2.0;
/// Both motions are the same one from this correlation on.
const ALIKE: f64 = 0.7;
/// At the delay so much less is left unexplained than at any other that stands out; less than the second is as good as nothing.
const CLEARLY: f64 = 0.5;
const NOTHING: f64 = 0.01;

/// The inertial motion in a frame that stood still at the beginning.
#[derive(Clone, Copy, Debug)]
struct Node {
    time: f64,
    attitude: UnitQuaternion<f64>,
    /// Integral of the specific force, and that of the integral.
    velocity: Vector3<f64>,
    position: Vector3<f64>,
}

/// Looks at every sample of a log.
#[derive(Clone, Debug, Default)]
pub struct Timing {
    now: Option<Node>,
    nodes: Vec<Node>,
    readings: Vec<(f64, Reference)>,
}

impl Timing {
    /// Of a whole log.
    ///
    /// # Errors
    /// When a sample cannot be read.
    pub fn of(samples: &dyn Samples) -> Result<Self, ReadError> {
        let mut timing = Self::default();
        each::<ReadError>(samples, |sample| {
            timing.push(sample);
            Ok(())
        })?;
        Ok(timing)
    }

    /// Takes in the next sample.
    pub fn push(&mut self, sample: &Sample) {
        let before = self.now.unwrap_or(Node {
            time: sample.time,
            attitude: UnitQuaternion::identity(),
            velocity: Vector3::zeros(),
            position: Vector3::zeros(),
        });
        if self.nodes.first().is_some_and(|first| sample.time - first.time > LOOKED_AT) {
            return;
        }
        let half = UnitQuaternion::from_scaled_axis(sample.dtheta * 0.5);
        let middle = before.attitude * half;
        let velocity = before.velocity + middle * sample.dvel;
        let now = Node {
            time: sample.time,
            attitude: middle * half,
            velocity,
            position: before.position + (before.velocity + velocity) * (0.5 * (sample.time - before.time)),
        };
        self.now = Some(now);
        let due = |last: Option<f64>| last.is_none_or(|last| sample.time - last >= 0.99 * APART);
        if due(self.nodes.last().map(|node| node.time)) {
            self.nodes.push(now);
        }
        let says = &sample.reference;
        let is_any = says.attitude.is_some() || says.velocity.is_some() || says.position.is_some();
        let is_new = || {
            self.readings.last().is_none_or(|(_, last)| {
                (last.attitude, last.velocity, last.position) != (says.attitude, says.velocity, says.position)
            })
        };
        if is_any && due(self.readings.last().map(|reading| reading.0)) && is_new() {
            self.readings.push((sample.time, *says));
        }
    }

    /// By how much the reference is stamped late, s; negative where it is the inertial sensors that are. Nothing where the motions
    /// do not tell: there is none, they are not alike, or they are alike at several delays.
    pub fn late(&self, setup: &Setup) -> Option<f64> {
        [Quantity::Turn, Quantity::Force, Quantity::Bend].into_iter().find_map(|of| self.late_by(of, setup))
    }

    fn late_by(&self, of: Quantity, setup: &Setup) -> Option<f64> {
        let windows = self.windows(of, setup)?;
        let unexplained = |tau: f64| 1.0 - self.correlation(of, &windows, tau);
        let steps = (MOST / COARSE).round() as i32;
        let scan: Vec<(f64, f64)> = (-steps..=steps)
            .map(|i| f64::from(i) * COARSE)
            .map(|tau| (tau, unexplained(tau)))
            .filter(|(_, left)| left.is_finite())
            .collect();
        let least =
            |scan: &mut dyn Iterator<Item = &(f64, f64)>| scan.min_by(|a, b| a.1.total_cmp(&b.1)).copied();
        let (mut tau, mut left) = least(&mut scan.iter())?;
        if left > 1.0 - ALIKE || tau.abs() > MOST - COARSE {
            return None;
        }
        let mut step = 0.5 * COARSE;
        while step > FINE {
            for near in [tau - step, tau + step] {
                let there = unexplained(near);
                if there < left {
                    (tau, left) = (near, there);
                }
            }
            step *= 0.5;
        }
        // other valleys: lower than both neighbours, and not this one
        let valleys = scan.windows(3).filter(|w| w[1].1 <= w[0].1.min(w[2].1)).map(|w| &w[1]);
        let other = least(&mut valleys.filter(|(at, _)| (at - tau).abs() > 2.0 * COARSE));
        other.is_none_or(|(_, there)| left.max(NOTHING) < CLEARLY * there).then_some(tau)
    }

    /// The windows with the most motion, in the order of time, with what the reference says of each.
    fn windows(&self, of: Quantity, setup: &Setup) -> Option<Vec<Window>> {
        let length = of.length(setup);
        let up = Vector3::new(0.0, 0.0, gravity(setup.site.latitude, setup.site.height));
        let of_quantity: Vec<&(f64, Reference)> = self.readings.iter().filter(|r| of.is_read(&r.1)).collect();
        // the reading that follows another by the length of a window, where there is no gap
        let after = |i: usize| {
            let from = of_quantity[i].0;
            let more = of_quantity[i..].iter().position(|r| r.0 - from >= length)?;
            (of_quantity[i + more].0 - from < 2.0 * length + APART).then_some(i + more)
        };
        let window = |i: usize| {
            let j = after(i)?;
            let k = if of == Quantity::Bend { after(j)? } else { j };
            let [a, b, c] = [i, j, k].map(|i| of_quantity[i]);
            let read = of.read([&a.1, &b.1, &c.1], [a.0, b.0, c.0], &up)?;
            Some(Window { times: [a.0, b.0, c.0], read })
        };
        let mut windows: Vec<Window> = (0..of_quantity.len()).filter_map(window).collect();
        if windows.len() < WINDOWS.1 {
            return None;
        }
        let mean = windows.iter().map(|w| w.read).sum::<Vector3<f64>>() / windows.len() as f64;
        let motion = |w: &Window| (w.read - mean).norm_squared();
        windows.sort_by(|a, b| motion(b).total_cmp(&motion(a)));
        windows.truncate(WINDOWS.0);
        let moves = (windows.iter().map(motion).sum::<f64>() / windows.len() as f64).sqrt();
        windows.sort_by(|a, b| a.times[0].total_cmp(&b.times[0]));
        (moves > MOVES * of.noise(setup, length)).then_some(windows)
    }

    /// How much alike both motions are when the reference is late by `tau`: their means, which biases move, are left out.
    fn correlation(&self, of: Quantity, windows: &[Window], tau: f64) -> f64 {
        let pairs =
            || windows.iter().filter_map(|w| Some((w.read, of.felt(self, w.times.map(|t| t - tau))?)));
        let (count, read, felt) = pairs().fold((0, Vector3::zeros(), Vector3::zeros()), |sum, pair| {
            (sum.0 + 1, sum.1 + pair.0, sum.2 + pair.1)
        });
        if 2 * count < windows.len() {
            return f64::NAN;
        }
        let (read, felt) = (read / count as f64, felt / count as f64);
        let products = pairs().fold([0.0; 3], |sum, (r, f)| {
            let (r, f) = (r - read, f - felt);
            [sum[0] + r.dot(&f), sum[1] + r.norm_squared(), sum[2] + f.norm_squared()]
        });
        products[0] / (products[1] * products[2]).sqrt()
    }

    /// The inertial motion at a time.
    fn at(&self, time: f64) -> Option<Node> {
        let next = self.nodes.partition_point(|node| node.time < time);
        let (a, b) = (self.nodes.get(next.checked_sub(1)?)?, self.nodes.get(next)?);
        let elapsed = time - a.time;
        let part = elapsed / (b.time - a.time);
        let gained = b.velocity - a.velocity;
        Some(Node {
            time,
            attitude: a.attitude.nlerp(&b.attitude, part),
            velocity: a.velocity + gained * part,
            position: a.position + (a.velocity + gained * (0.5 * part)) * elapsed,
        })
    }
}

/// What the reference says over a window of time: from its first reading to its last, with one between for a second difference.
struct Window {
    times: [f64; 3],
    read: Vector3<f64>,
}

/// What both say something about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quantity {
    /// The mean rate, rad/s, from attitudes.
    Turn,
    /// The size of the mean specific force, m/s^2, from velocities.
    Force,
    /// The same from positions.
    Bend,
}

impl Quantity {
    fn is_read(self, says: &Reference) -> bool {
        match self {
            Self::Turn => says.attitude.is_some(),
            Self::Force => says.velocity.is_some(),
            Self::Bend => says.position.is_some(),
        }
    }

    /// Standard deviation of what a window of that length says.
    fn noise(self, setup: &Setup, length: f64) -> f64 {
        let sigma = &setup.reference;
        match self {
            Self::Turn => 2.0_f64.sqrt() * sigma.attitude / length,
            Self::Force => 2.0_f64.sqrt() * sigma.velocity / length,
            Self::Bend => 6.0_f64.sqrt() * sigma.position / (length * length),
        }
    }

    /// How long windows must be for their noise.
    fn length(self, setup: &Setup) -> f64 {
        let length = match self {
            Self::Turn => self.noise(setup, 1.0) / NOISE.0,
            Self::Force => self.noise(setup, 1.0) / NOISE.1,
            Self::Bend => (self.noise(setup, 1.0) / NOISE.1).sqrt(),
        };
        length.clamp(WINDOW.0, WINDOW.1)
    }

    /// What the reference says of a window; `up` is minus gravity.
    fn read(self, [a, b, c]: [&Reference; 3], times: [f64; 3], up: &Vector3<f64>) -> Option<Vector3<f64>> {
        let elapsed = times[1] - times[0];
        Some(match self {
            Self::Turn => (a.attitude?.inverse() * b.attitude?).scaled_axis() / elapsed,
            Self::Force => size((b.velocity? - a.velocity?) / elapsed + up),
            Self::Bend => size(second([a.position?, b.position?, c.position?], times) + up),
        })
    }

    /// What the inertial sensors say of it.
    fn felt(self, of: &Timing, times: [f64; 3]) -> Option<Vector3<f64>> {
        let (a, b) = (of.at(times[0])?, of.at(times[1])?);
        let elapsed = times[1] - times[0];
        Some(match self {
            Self::Turn => (a.attitude.inverse() * b.attitude).scaled_axis() / elapsed,
            Self::Force => size((b.velocity - a.velocity) / elapsed),
            Self::Bend => size(second([a.position, b.position, of.at(times[2])?.position], times)),
        })
    }
}

/// The mean second derivative of three values.
fn second(x: [Vector3<f64>; 3], t: [f64; 3]) -> Vector3<f64> {
    let slope = |i: usize| (x[i + 1] - x[i]) / (t[i + 1] - t[i]);
    (slope(1) - slope(0)) * (2.0 / (t[2] - t[0]))
}

/// A size as a vector along one axis.
fn size(of: Vector3<f64>) -> Vector3<f64> {
    Vector3::new(of.norm(), 0.0, 0.0)
}

#[cfg(test)]
mod tests {
    use nalgebra::{UnitQuaternion, Vector3};
    use sinscal::{InitialAttitude, ReferenceSigma, Sample, SensorNoise, Setup, Site};

    use super::*;

    fn setup() -> Setup<'static> {
        Setup::new(
            100.0,
            Site { latitude: 0.9, longitude: 0.2, height: 40.0 },
            InitialAttitude::unknown_heading(),
            ReferenceSigma { velocity: 2e-3, position: 5e-4, attitude: 1e-3 },
            SensorNoise { angle_random_walk: 1e-5, velocity_random_walk: 1e-4 },
        )
    }

    /// A unit carried and turned about, its reference read every 50 ms and `late`; the motion in closed form.
    fn moved(late: f64, of: Quantity) -> Timing {
        let setup = setup();
        let g = gravity(setup.site.latitude, setup.site.height);
        let place = |t: f64| {
            Vector3::new(
                0.2 * (1.7 * t).sin(),
                0.3 * (1.1 * t + 0.1 * t * (0.3 * t).sin()).sin(),
                0.1 * (2.3 * t).cos(),
            )
        };
        let turned = |t: f64| {
            let x = UnitQuaternion::from_scaled_axis(
                Vector3::x() * (0.8 * (0.9 * t + 2.0 * (0.21 * t).sin()).sin()),
            );
            x * UnitQuaternion::from_scaled_axis(Vector3::new(
                0.0,
                0.5 * (1.3 * t).cos(),
                0.7 * (0.37 * t).sin(),
            ))
        };
        // by differences so small that they are derivatives
        let h = 1e-4;
        let speed = |t: f64| (place(t + h) - place(t - h)) / (2.0 * h);
        let dt = 0.01;
        let mut timing = Timing::default();
        for i in 1..6000 {
            let t = f64::from(i) * dt;
            let dvel_n = speed(t) - speed(t - dt) + Vector3::z() * (g * dt);
            let mut reference = Reference::default();
            if i % 5 == 0 {
                match of {
                    Quantity::Turn => reference.attitude = Some(turned(t - late)),
                    Quantity::Force => reference.velocity = Some(speed(t - late)),
                    Quantity::Bend => reference.position = Some(place(t - late)),
                }
            }
            timing.push(&Sample {
                time: t,
                // a bias of a degree a second, and accelerometers that are off by a hundredth
                dtheta: (turned(t - dt).inverse() * turned(t)).scaled_axis()
                    + Vector3::new(0.017, 0.0, 0.0) * dt,
                dvel: turned(t - 0.5 * dt).inverse() * dvel_n * 1.01,
                temperature: Vector3::zeros(),
                gyro_temperature: Vector3::zeros(),
                dither: Vector3::zeros(),
                reference,
            });
        }
        timing
    }

    #[test]
    fn a_late_reference_is_known_by_any_of_its_readings() {
        for of in [Quantity::Turn, Quantity::Force, Quantity::Bend] {
            for late in [0.25, 0.1373, 0.02, 0.0, -0.08] {
                let found = moved(late, of).late(&setup()).unwrap_or(f64::NAN);
                assert!((found - late).abs() < 2e-3, "{of:?}: {found} for {late}");
            }
        }
    }

    #[test]
    fn what_does_not_move_or_moves_otherwise_tells_nothing() {
        let still = |sample: &mut Sample| {
            sample.reference.position = sample.reference.position.map(|_| Vector3::zeros())
        };
        let mut timing = Timing::default();
        let moving = moved(0.1, Quantity::Bend);
        assert!(moving.late(&setup()).is_some());
        for (time, reference) in &moving.readings {
            let mut sample = Sample {
                time: *time,
                dtheta: Vector3::zeros(),
                dvel: Vector3::zeros(),
                temperature: Vector3::zeros(),
                gyro_temperature: Vector3::zeros(),
                dither: Vector3::zeros(),
                reference: *reference,
            };
            still(&mut sample);
            timing.push(&sample);
        }
        assert_eq!(timing.late(&setup()), None);
        // the readings of another motion
        let other = moved(0.1, Quantity::Turn);
        let mixed = Timing {
            readings: other.readings.iter().rev().zip(&other.readings).map(|(r, t)| (t.0, r.1)).collect(),
            ..other.clone()
        };
        assert_eq!(mixed.late(&setup()), None);
        assert_eq!(Timing::default().late(&setup()), None);
    }

    #[test]
    fn a_motion_that_repeats_itself_has_no_single_delay() {
        let mut timing = Timing::default();
        let angle = |t: f64| Vector3::x() * (0.5 * (core::f64::consts::TAU * t / 0.4).sin());
        for i in 1..6000 {
            let t = f64::from(i) * 0.01;
            let attitude = Some(UnitQuaternion::from_scaled_axis(angle(t - 0.1)));
            let reference = Reference { attitude, ..Reference::default() };
            timing.push(&Sample {
                time: t,
                dtheta: angle(t) - angle(t - 0.01),
                dvel: Vector3::zeros(),
                temperature: Vector3::zeros(),
                gyro_temperature: Vector3::zeros(),
                dither: Vector3::zeros(),
                reference,
            });
        }
        assert_eq!(timing.late(&setup()), None);
    }
}
