//! The size effect of dither: Eq. 8 to 11.
//!
//! Dither about x with rate `A sin(2 pi F t)` makes the accelerometers at `r_y`, `r_z` feel, beyond the specific force,
//!
//! ```text
//! y: -A^2/2 r_yy + A^2/2 cos(2 (2 pi F) t) r_yy - 2 pi F A cos(2 pi F t) r_yz
//! z: -A^2/2 r_zz + A^2/2 cos(2 (2 pi F) t) r_zz + 2 pi F A cos(2 pi F t) r_zy
//! ```
//!
//! (Eq. 8): a constant that does not depend on F, a term at F through the tangential arms and a term at 2F. The constant makes the
//! velocity error grow linearly and the position error quadratically (Eq. 9 and 11).

use std::f64::consts::TAU;

use nalgebra::{Matrix3, Vector3};

use crate::dither::DitherMotion;
use crate::random::Seed;
use crate::scenario::{DitherMode, DitherPlan};
use crate::sensors::size_effect;

/// Samples in a period of the dither.
const PER_PERIOD: u32 = 128;
/// Periods over which components are found.
const PERIODS: u32 = 200;

/// A steady dither of one gyro and where the accelerometers are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dithering {
    /// Axis of the dithering gyro: 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// Amplitude A of the rate, rad/s.
    pub amplitude: f64,
    /// Frequency F, Hz.
    pub frequency: f64,
    /// Row i: position of accelerometer i, m.
    pub arms: Matrix3<f64>,
}

/// Components of the size effect on each accelerometer, m/s^2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Components {
    /// The constant.
    pub constant: Vector3<f64>,
    /// Factor of `cos(2 pi F t)`.
    pub first: Vector3<f64>,
    /// Factor of `cos(2 (2 pi F) t)`.
    pub second: Vector3<f64>,
    /// Root mean square of what these three do not explain.
    pub rest: Vector3<f64>,
}

fn steady(amplitude: Vector3<f64>, frequency: Vector3<f64>, dt: f64) -> DitherMotion {
    let plan = DitherPlan {
        mode: DitherMode::Full,
        amplitude,
        spread: 0.0,
        change: 0.0,
        period: 1.0,
        reading_noise: 0.0,
        rate: 1.0,
        frequency,
        modulation: 0.0,
        frequency_noise: 0.0,
        simulation_rate: 1.0 / dt,
    };
    DitherMotion::new(&plan, Seed { unit: 0, run: 0 }, dt).with_phases(&Vector3::zeros())
}

impl Dithering {
    fn amplitudes(&self) -> Vector3<f64> {
        let mut amplitudes = Vector3::zeros();
        amplitudes[self.axis] = self.amplitude;
        amplitudes
    }

    /// Eq. 8, for dither about any axis.
    pub fn closed_form(&self) -> Components {
        let half_square = 0.5 * self.amplitude * self.amplitude;
        let tangential = TAU * self.frequency * self.amplitude;
        let (i, j, k) = (self.axis, (self.axis + 1) % 3, (self.axis + 2) % 3);
        let mut components = Components {
            constant: Vector3::zeros(),
            first: Vector3::zeros(),
            second: Vector3::zeros(),
            rest: Vector3::zeros(),
        };
        for other in [j, k] {
            components.constant[other] = -half_square * self.arms[(other, other)];
            components.second[other] = half_square * self.arms[(other, other)];
        }
        components.first[j] = -tangential * self.arms[(j, k)];
        components.first[k] = tangential * self.arms[(k, j)];
        debug_assert!(components.constant[i] == 0.0);
        components
    }

    /// The components found in a simulated signal, by projection over whole periods.
    pub fn simulated(&self) -> Components {
        let dt = 1.0 / (self.frequency * f64::from(PER_PERIOD));
        let mut motion = steady(self.amplitudes(), Vector3::repeat(self.frequency), dt);
        let amplitudes = self.amplitudes();
        let n = PERIODS * PER_PERIOD;
        let zero = Vector3::zeros();
        let (mut constant, mut first, mut second, mut square) = (zero, zero, zero, zero);
        for step in 0..n {
            let (rate, acceleration) = motion.step(&amplitudes);
            let felt = size_effect(&self.arms, &rate, &acceleration);
            let phase = TAU * (f64::from(step % PER_PERIOD) + 0.5) / f64::from(PER_PERIOD);
            constant += felt;
            first += felt * (2.0 * phase.cos());
            second += felt * (2.0 * (2.0 * phase).cos());
            square += felt.component_mul(&felt);
        }
        let n = f64::from(n);
        let (constant, first, second) = (constant / n, first / n, second / n);
        let explained = constant.component_mul(&constant)
            + (first.component_mul(&first) + second.component_mul(&second)) * 0.5;
        let rest = (square / n - explained).map(|x| x.max(0.0).sqrt());
        Components { constant, first, second, rest }
    }

    /// Velocity and position errors of each accelerometer's axis over `seconds`, about `points` of them, each after whole periods: Eq. 9
    /// and 11 beside the simulated signal integrated twice.
    pub fn drift(&self, seconds: f64, points: u32) -> Vec<Drift> {
        let dt = 1.0 / (self.frequency * f64::from(PER_PERIOD));
        let amplitudes = self.amplitudes();
        let mut motion = steady(amplitudes, Vector3::repeat(self.frequency), dt);
        let constant = self.closed_form().constant;
        let periods = (seconds * self.frequency / f64::from(points.max(1))).round().max(1.0) as u64;
        let steps = periods * u64::from(PER_PERIOD);
        let (mut velocity, mut position) = (Vector3::zeros(), Vector3::zeros());
        let mut series = Vec::with_capacity(points as usize);
        for point in 1..=u64::from(points) {
            for _ in 0..steps {
                let (rate, acceleration) = motion.step(&amplitudes);
                let felt = size_effect(&self.arms, &rate, &acceleration);
                position += velocity * dt + felt * (0.5 * dt * dt);
                velocity += felt * dt;
            }
            let time = (point * steps) as f64 * dt;
            series.push(Drift {
                time,
                velocity: constant * time,
                position: constant * (0.5 * time * time),
                simulated_velocity: velocity,
                simulated_position: position,
            });
        }
        series
    }
}

/// Errors by the constant component, along the axes of the accelerometers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// s.
    pub time: f64,
    /// Linear in time, m/s.
    pub velocity: Vector3<f64>,
    /// Quadratic in time, m.
    pub position: Vector3<f64>,
    /// From the simulated signal, m/s.
    pub simulated_velocity: Vector3<f64>,
    /// From the simulated signal, m.
    pub simulated_position: Vector3<f64>,
}

/// Constant components with dither of all three gyros, Eq. 10: `-r_i sum over j != i of A_j^2 / 2`, m/s^2.
pub fn three_gyros(amplitudes: &Vector3<f64>, arms: &Matrix3<f64>) -> Vector3<f64> {
    let squares = amplitudes.component_mul(amplitudes) * 0.5;
    Vector3::from_fn(|i, _| -(squares.sum() - squares[i]) * arms[(i, i)])
}

/// The mean of the size effect of three gyros, from the signal simulated at `rate` Hz over `seconds`, m/s^2.
///
/// Gyros that dither at different frequencies add up as Eq. 10 assumes. At the same frequency the products of their rates have a
/// mean as well, which acts through the tangential arms: the superposition of the paper needs different frequencies.
pub fn three_gyros_simulated(
    amplitudes: &Vector3<f64>,
    frequencies: &Vector3<f64>,
    arms: &Matrix3<f64>,
    rate: f64,
    seconds: f64,
) -> Vector3<f64> {
    let mut motion = steady(*amplitudes, *frequencies, 1.0 / rate);
    let n = (rate * seconds).round().max(1.0) as u64;
    let mut sum = Vector3::zeros();
    for _ in 0..n {
        let (dither, acceleration) = motion.step(amplitudes);
        sum += size_effect(arms, &dither, &acceleration);
    }
    sum / n as f64
}

/// The constant component over frequencies and over amplitudes: pairs of what is varied and the simulated constants.
pub fn sweep(dithering: &Dithering, frequencies: &[f64], amplitudes: &[f64]) -> Sweep {
    let constant = |dithering: Dithering| dithering.simulated().constant;
    Sweep {
        by_frequency: frequencies
            .iter()
            .map(|&frequency| (frequency, constant(Dithering { frequency, ..*dithering })))
            .collect(),
        by_amplitude: amplitudes
            .iter()
            .map(|&amplitude| (amplitude, constant(Dithering { amplitude, ..*dithering })))
            .collect(),
    }
}

/// The constant component of the size effect, m/s^2, as one thing varies.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// Frequency, Hz, and the constants.
    pub by_frequency: Vec<(f64, Vector3<f64>)>,
    /// Amplitude, rad/s, and the constants.
    pub by_amplitude: Vec<(f64, Vector3<f64>)>,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dithering(axis: usize) -> Dithering {
        // all nine components, a few centimetres
        let arms = Matrix3::new(0.04, 0.005, -0.01, 0.012, 0.045, 0.006, -0.008, 0.011, 0.035);
        Dithering { axis, amplitude: 0.08, frequency: 410.0, arms }
    }

    fn close(a: &Vector3<f64>, b: &Vector3<f64>, share: f64, floor: f64) -> bool {
        (0..3).all(|i| (a[i] - b[i]).abs() <= share * b[i].abs() + floor)
    }

    #[test]
    fn equation_8_constant_first_and_second_component() {
        for axis in 0..3 {
            let closed = dithering(axis).closed_form();
            let simulated = dithering(axis).simulated();
            assert!(close(&simulated.constant, &closed.constant, 0.01, 1e-12), "{simulated:?} {closed:?}");
            assert!(close(&simulated.first, &closed.first, 0.01, 1e-9), "{simulated:?} {closed:?}");
            assert!(close(&simulated.second, &closed.second, 0.01, 1e-12), "{simulated:?} {closed:?}");
            assert!(simulated.rest.amax() < 1e-5 * closed.first.amax(), "{}", simulated.rest);
        }
    }

    #[test]
    fn equations_9_and_11_velocity_is_linear_and_position_quadratic() {
        let series = dithering(0).drift(50.0, 10);
        assert_eq!(series.len(), 10);
        for point in &series {
            assert!(close(&point.simulated_velocity, &point.velocity, 0.01, 1e-9), "{point:?}");
            assert!(close(&point.simulated_position, &point.position, 0.01, 2e-6), "{point:?}");
        }
        let last = series.last().unwrap();
        assert!((last.time - 50.0).abs() < 0.1);
        // 0.08^2 / 2 * 45 mm * t^2 / 2
        assert!((last.position.y / (-0.0032 * 0.045 * 0.5 * last.time * last.time) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn constant_does_not_depend_on_frequency_and_grows_with_the_square_of_the_amplitude() {
        let frequencies: Vec<f64> = (0..=12).map(|i| 300.0 + 25.0 * f64::from(i)).collect();
        let amplitudes = [0.01, 0.02, 0.04, 0.08, 0.16];
        let sweep = sweep(&dithering(0), &frequencies, &amplitudes);
        let (_, first) = sweep.by_frequency[0];
        for (frequency, constant) in &sweep.by_frequency {
            assert!(close(constant, &first, 1e-6, 1e-12), "{frequency}: {constant}");
        }
        for (amplitude, constant) in &sweep.by_amplitude {
            let law = first * (amplitude / 0.08).powi(2);
            assert!(close(constant, &law, 1e-6, 1e-12), "{amplitude}: {constant}");
        }
    }

    #[test]
    fn equation_10_three_gyros_add_up_when_their_frequencies_differ() {
        let arms = dithering(0).arms;
        let amplitudes = Vector3::new(0.08, 0.07, 0.09);
        let closed = three_gyros(&amplitudes, &arms);
        let apart = Vector3::new(375.0, 410.0, 445.0);
        let simulated = three_gyros_simulated(&amplitudes, &apart, &arms, 32e3, 10.0);
        assert!(close(&simulated, &closed, 0.01, 0.0), "{simulated} {closed}");
        // in step, the products of rates do not vanish
        let together = Vector3::repeat(400.0);
        let simulated = three_gyros_simulated(&amplitudes, &together, &arms, 32e3, 10.0);
        assert!(!close(&simulated, &closed, 0.05, 0.0), "{simulated} {closed}");
    }
}
