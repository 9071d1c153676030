//! Least squares over positions and turns.

use std::vec::Vec;

use nalgebra::{DMatrix, DVector, Matrix3, UnitQuaternion, Vector3};

use super::positions::{Increment, Position, Track};
use super::{N, RANGE};

/// Derivatives are differences over this part of a parameter's range.
const STEP: f64 = 1e-4;
/// Steps of the fit.
const ITERATIONS: usize = 40;
/// The fit has settled when no parameter moves by more than this part of its standard deviation.
const SETTLED: f64 = 1e-2;
/// Rounds in which the weights follow what the fit leaves.
const ROUNDS: usize = 3;
/// Standard deviations of the three kinds of residuals to begin with: m/s^2, m/s^2, rad/s.
const FIRST_SIGMAS: [f64; 3] = [0.01, 0.01, 1e-4];

/// What is known around the unit.
#[derive(Clone, Copy, Debug)]
pub(super) struct World {
    /// Size of gravity, m/s^2.
    pub(super) gravity: f64,
    /// Rate of the Earth in n, rad/s.
    pub(super) rate: Vector3<f64>,
    /// Random walks, rad/sqrt(s) and (m/s)/sqrt(s).
    pub(super) gyro_noise: f64,
    pub(super) accel_noise: f64,
}

/// What was found.
pub(super) struct Solution {
    pub(super) values: [f64; N],
    pub(super) sigmas: [f64; N],
    /// m/s^2.
    pub(super) force_residual: f64,
}

/// `I + K` of gyros and accelerometers.
fn matrices(p: &[f64; N]) -> [Matrix3<f64>; 2] {
    let gyro = Matrix3::new(1.0 + p[0], 0.0, 0.0, p[3], 1.0 + p[1], 0.0, p[4], p[5], 1.0 + p[2]);
    let accel = Matrix3::new(1.0 + p[9], p[12], p[13], p[14], 1.0 + p[10], p[15], p[16], p[17], 1.0 + p[11]);
    [gyro, accel]
}

/// Biases of gyros and accelerometers.
fn biases(p: &[f64; N]) -> [Vector3<f64>; 2] {
    [Vector3::new(p[6], p[7], p[8]), Vector3::new(p[18], p[19], p[20])]
}

/// The errors of a unit that shows `second` once `first` has been taken out.
pub(super) fn compose(first: &[f64; N], second: &[f64; N]) -> [f64; N] {
    let ([gyro, accel], [gyro_rest, accel_rest]) = (matrices(first), matrices(second));
    let (g, a) = (gyro * gyro_rest, accel * accel_rest);
    let ([gyro_bias, accel_bias], [gyro_left, accel_left]) = (biases(first), biases(second));
    let (e, n) = (gyro_bias + gyro * gyro_left, accel_bias + accel * accel_left);
    [
        g[(0, 0)] - 1.0,
        g[(1, 1)] - 1.0,
        g[(2, 2)] - 1.0,
        g[(1, 0)],
        g[(2, 0)],
        g[(2, 1)],
        e.x,
        e.y,
        e.z,
        a[(0, 0)] - 1.0,
        a[(1, 1)] - 1.0,
        a[(2, 2)] - 1.0,
        a[(0, 1)],
        a[(0, 2)],
        a[(1, 0)],
        a[(1, 2)],
        a[(2, 0)],
        a[(2, 1)],
        n.x,
        n.y,
        n.z,
    ]
}

/// Takes sensor errors out.
pub(super) struct Model {
    gyro: Matrix3<f64>,
    gyro_bias: Vector3<f64>,
    accel: Matrix3<f64>,
    accel_bias: Vector3<f64>,
}

impl Model {
    pub(super) fn new(p: &[f64; N]) -> Self {
        let [gyro, accel] = matrices(p).map(|m| m.try_inverse().unwrap_or_else(Matrix3::identity));
        let [gyro_bias, accel_bias] = biases(p);
        Self { gyro, gyro_bias, accel, accel_bias }
    }

    /// The angle turned in an increment over `dt`.
    pub(super) fn rate(&self, dtheta: &Vector3<f64>, dt: f64) -> Vector3<f64> {
        self.gyro * (dtheta - self.gyro_bias * dt)
    }

    /// The same of velocity.
    pub(super) fn force(&self, dvel: &Vector3<f64>, dt: f64) -> Vector3<f64> {
        self.accel * (dvel - self.accel_bias * dt)
    }
}

/// Attitude after a turn relative to that before, over the Earth. `earth` is its rate in the body before.
pub(super) fn integrate(
    turn: &[Increment],
    earth: &Vector3<f64>,
    angle: impl Fn(&Vector3<f64>, f64) -> Vector3<f64>,
) -> UnitQuaternion<f64> {
    let mut q = UnitQuaternion::identity();
    for (dt, dtheta) in turn {
        q *= UnitQuaternion::from_scaled_axis(angle(dtheta, *dt) - q.inverse() * earth * *dt);
    }
    q
}

/// The rate of the Earth in the body at a position: its part along gravity is known, what the gyros say of the rest counts as
/// far as their noise lets them say it.
fn earth_rate(position: &Position, up: &Vector3<f64>, rate: &Vector3<f64>, world: &World) -> Vector3<f64> {
    let level = rate - up * rate.dot(up);
    let signal = 0.5 * world.rate.y * world.rate.y;
    let noise = world.gyro_noise * world.gyro_noise / position.time;
    up * world.rate.z + level * (signal / (signal + noise))
}

/// Turns as the gyros of `model` see them.
fn rotations(track: &Track, world: &World, model: &Model) -> Vec<UnitQuaternion<f64>> {
    let turns = track.positions.iter().zip(&track.turns);
    turns
        .map(|(position, turn)| {
            let up = model.force(&position.force, 1.0).normalize();
            let earth = earth_rate(position, &up, &model.rate(&position.rate, 1.0), world);
            integrate(turn, &earth, |dtheta, dt| model.rate(dtheta, dt))
        })
        .collect()
}

/// The three kinds of residuals one after the other: sizes of gravity, gravity from position to position, rates along gravity.
fn residuals(track: &Track, world: &World, model: &Model, turns: &[UnitQuaternion<f64>]) -> DVector<f64> {
    let forces: Vec<Vector3<f64>> =
        track.positions.iter().map(|position| model.force(&position.force, 1.0)).collect();
    let sizes = forces.iter().map(|force| force.norm() - world.gravity);
    let carried = forces.windows(2).zip(turns).flat_map(|(pair, q)| {
        let left = pair[1] - q.inverse() * pair[0];
        [left.x, left.y, left.z]
    });
    let rates = track
        .positions
        .iter()
        .zip(&forces)
        .map(|(position, force)| model.rate(&position.rate, 1.0).dot(&force.normalize()) - world.rate.z);
    DVector::from_vec(sizes.chain(carried).chain(rates).collect())
}

/// Kind of each residual.
fn kind(track: &Track, row: usize) -> usize {
    let (n, turns) = (track.positions.len(), 3 * track.turns.len());
    usize::from(row >= n) + usize::from(row >= n + turns)
}

/// Fits the 21 parameters.
pub(super) fn fit(track: &Track, world: &World) -> Solution {
    let mut values = [0.0; N];
    let mut sigmas = FIRST_SIGMAS;
    let mut deviations = RANGE;
    let mut left = DVector::zeros(0);
    for round in 0..ROUNDS {
        (values, deviations, left) = settle(track, world, values, &sigmas);
        if round + 1 < ROUNDS {
            sigmas = spread(track, world, &left);
        }
    }
    let sigma = spread(track, world, &left);
    Solution { values, sigmas: deviations, force_residual: sigma[1] }
}

/// Root mean square of each kind of residuals, the parameters taken into account; never less than the noise.
fn spread(track: &Track, world: &World, left: &DVector<f64>) -> [f64; 3] {
    let mut squares = [(0.0, 0.0); 3];
    for (row, residual) in left.iter().enumerate() {
        let (sum, count) = &mut squares[kind(track, row)];
        *sum += residual * residual;
        *count += 1.0;
    }
    let time = track.positions.iter().map(|position| position.time).fold(f64::INFINITY, f64::min);
    let [accel, gyro] = [world.accel_noise, world.gyro_noise].map(|walk| walk / time.sqrt());
    let rows = left.len() as f64;
    let freedom = (rows - N as f64).max(1.0) / rows;
    let floors = [accel, accel, gyro];
    core::array::from_fn(|i| {
        let (sum, count) = squares[i];
        (sum / (count * freedom)).sqrt().max(floors[i])
    })
}

type Settled = ([f64; N], [f64; N], DVector<f64>);

/// Iterates from `values` with given standard deviations of the residuals; returns values, their deviations and residuals.
fn settle(track: &Track, world: &World, mut values: [f64; N], sigmas: &[f64; 3]) -> Settled {
    let weigh = |mut r: DVector<f64>| {
        for (row, residual) in r.iter_mut().enumerate() {
            *residual /= sigmas[kind(track, row)];
        }
        r
    };
    let at = |values: &[f64; N]| {
        let model = Model::new(values);
        let turns = rotations(track, world, &model);
        (residuals(track, world, &model, &turns), turns)
    };
    // parameters in units of their ranges, which are their prior standard deviations
    let cost = |r: &DVector<f64>, values: &[f64; N]| {
        let range: f64 = values.iter().zip(&RANGE).map(|(value, range)| (value / range).powi(2)).sum();
        weigh(r.clone()).norm_squared() + range
    };
    let (mut left, mut turns) = at(&values);
    let mut damping = 1e-3;
    let mut deviations = RANGE;
    for _ in 0..ITERATIONS {
        let mut jacobian = DMatrix::zeros(left.len(), N);
        for i in 0..N {
            let side = |sign: f64| {
                let mut moved = values;
                moved[i] += sign * STEP * RANGE[i];
                let model = Model::new(&moved);
                // the accelerometers do not turn anything, but for a little of the Earth's rate
                let rotated = if i < 9 { &rotations(track, world, &model) } else { &turns };
                residuals(track, world, &model, rotated)
            };
            jacobian.set_column(i, &weigh((side(1.0) - side(-1.0)) / (2.0 * STEP)));
        }
        let mut normal = jacobian.transpose() * &jacobian;
        let mut gradient = jacobian.transpose() * weigh(left.clone());
        for i in 0..N {
            normal[(i, i)] += 1.0;
            gradient[i] += values[i] / RANGE[i];
        }
        if let Some(inverse) = normal.clone().try_inverse() {
            deviations = core::array::from_fn(|i| RANGE[i] * inverse[(i, i)].max(0.0).sqrt());
        }
        let before = cost(&left, &values);
        let mut settled = true;
        // more damping until the cost falls; none that helps: this is the bottom
        for _ in 0..12 {
            let mut damped = normal.clone();
            for i in 0..N {
                damped[(i, i)] *= 1.0 + damping;
            }
            let Some(step) = damped.cholesky().map(|factor| factor.solve(&gradient)) else { break };
            let moved: [f64; N] = core::array::from_fn(|i| values[i] - step[i] * RANGE[i]);
            let (there, turned) = at(&moved);
            if cost(&there, &moved) < before {
                settled = (0..N).all(|i| (moved[i] - values[i]).abs() < SETTLED * deviations[i]);
                (values, left, turns) = (moved, there, turned);
                damping = (damping * 0.1).max(1e-9);
                break;
            }
            damping *= 10.0;
        }
        if settled {
            break;
        }
    }
    (values, deviations, left)
}
