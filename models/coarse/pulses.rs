//! Sizes and signs of pulses, well enough to begin a fit with.

use std::vec::Vec;

use nalgebra::{DMatrix, DVector, UnitQuaternion, Vector3};

use super::UnknownPulses;
use super::fit::{World, integrate};
use super::positions::{Increment, Track};
use crate::InitialAttitude;

/// Turns are searched with increments over this time, s.
const GROUP: f64 = 0.1;
/// Steps of the search for a common scale of the gyros, over all scales for which no turn is longer than a revolution.
const COMMON_STEPS: usize = 160;
/// Steps of the search for the scale of one gyro, from half the common one to twice.
const AXIS_STEPS: usize = 48;
/// Rounds over the axes.
const ROUNDS: usize = 3;
/// Beyond this angle a direction contradicts the initial attitude, rad.
const CONTRADICTION: f64 = 0.8;
/// The gyros feel the Earth when their noise at a position is below this part of its rate.
const FEELS: f64 = 0.25;

type V = Vector3<f64>;

/// Sizes of a gyro and an accelerometer pulse on each axis, signs included; ones where they are known.
pub(super) fn search(
    track: &Track,
    world: &World,
    unknown: UnknownPulses,
    initial: Option<&InitialAttitude>,
) -> Option<(V, V)> {
    let (accel, accel_bias) =
        if unknown.accel { ellipsoid(track, world.gravity)? } else { (V::repeat(1.0), V::zeros()) };
    let rest = track.positions.iter().map(|position| position.rate).sum::<V>() / track.positions.len() as f64;
    let directions = |signs: &V| -> Vec<V> {
        let force = |f: &V| (f - accel_bias).component_mul(&accel).component_mul(signs).normalize();
        track.positions.iter().map(|position| force(&position.force)).collect()
    };
    let turns: Vec<Vec<Increment>> = track.turns.iter().map(|turn| thinned(turn, &rest)).collect();
    let misfit = |gyro: &V, up: &[V]| -> f64 {
        up.windows(2)
            .zip(&turns)
            .map(|(pair, turn)| (pair[1] - turned(turn, gyro).inverse() * pair[0]).norm_squared())
            .sum()
    };
    // every way of calling axes positive has a twin with known or positive accelerometers, but where the gyros are known
    let all = signs();
    let ones = [V::repeat(1.0)];
    let (gyro_signs, accel_signs): (&[V], &[V]) = if unknown.gyro { (&all, &ones) } else { (&ones, &all) };
    let mut best = (f64::INFINITY, V::repeat(1.0), V::repeat(1.0));
    for accel_sign in accel_signs {
        let up = directions(accel_sign);
        for gyro_sign in gyro_signs {
            let mut consider = |gyro: V| {
                let misfit = misfit(&gyro, &up);
                if misfit < best.0 {
                    best = (misfit, gyro, *accel_sign);
                }
            };
            if unknown.gyro {
                let (least, most) = bounds(&turns, &up)?;
                let step = (most - least) / COMMON_STEPS as f64;
                (0..=COMMON_STEPS).for_each(|k| consider(gyro_sign * (least + step * k as f64)));
            } else {
                consider(*gyro_sign);
            }
        }
    }
    let (mut least, mut gyro, accel_sign) = best;
    if unknown.gyro {
        let up = directions(&accel_sign);
        for _ in 0..ROUNDS {
            for axis in 0..3 {
                let from = gyro[axis];
                for k in 0..=AXIS_STEPS {
                    let mut tried = gyro;
                    // a geometric series
                    tried[axis] = from * 2.0_f64.powf(2.0 * k as f64 / AXIS_STEPS as f64 - 1.0);
                    let misfit = misfit(&tried, &up);
                    if misfit < least {
                        (least, gyro) = (misfit, tried);
                    }
                }
            }
        }
    }
    let up = directions(&accel_sign);
    let felt = Felt::new(track, world, &up, &rest.component_mul(&gyro), &gyro);
    Some(name_axes(gyro, accel.component_mul(&accel_sign), unknown, &felt, world, initial))
}

/// Scales and biases for which all positions feel gravity: `sum s_i^2 (a_i - b_i)^2 = g^2`, linear in what it is expanded to.
fn ellipsoid(track: &Track, gravity: f64) -> Option<(V, V)> {
    let size = track.positions.iter().map(|position| position.force.amax()).fold(0.0, f64::max);
    let rows: Vec<V> = track.positions.iter().map(|position| position.force / size).collect();
    let matrix =
        DMatrix::from_fn(rows.len(), 6, |k, i| if i < 3 { rows[k][i].powi(2) } else { rows[k][i - 3] });
    let ones = DVector::from_element(rows.len(), 1.0);
    let normal = matrix.transpose() * &matrix;
    // positions that leave an axis out make this singular
    let eigenvalues = normal.clone().symmetric_eigenvalues();
    if !(eigenvalues.min() > 1e-4 * eigenvalues.max()) {
        return None;
    }
    let x = normal.cholesky()?.solve(&(matrix.transpose() * ones));
    let (p, q) = (V::new(x[0], x[1], x[2]), V::new(x[3], x[4], x[5]));
    if !(p.min() > 0.0) {
        return None;
    }
    let bias = V::from_fn(|i, _| -0.5 * q[i] / p[i]);
    let total = 1.0 + (0..3).map(|i| p[i] * bias[i] * bias[i]).sum::<f64>();
    let scale = V::from_fn(|i, _| gravity * (p[i] / total).sqrt() / size);
    Some((scale, bias * size))
}

/// The increments of a turn added up over tenths of a second, what rest reads taken out.
fn thinned(turn: &[Increment], rest: &V) -> Vec<Increment> {
    let mut sums: Vec<Increment> = Vec::new();
    for (dt, dtheta) in turn {
        match sums.last_mut() {
            Some(sum) if sum.0 + dt <= GROUP => *sum = (sum.0 + dt, sum.1 + dtheta - rest * *dt),
            _ => sums.push((*dt, dtheta - rest * *dt)),
        }
    }
    sums
}

fn turned(turn: &[Increment], gyro: &V) -> UnitQuaternion<f64> {
    integrate(turn, &V::zeros(), |dtheta, _| dtheta.component_mul(gyro))
}

/// Between which sizes a pulse lies: no turn is shorter than gravity's way in the body, and the longest is one revolution.
fn bounds(turns: &[Vec<Increment>], up: &[V]) -> Option<(f64, f64)> {
    let length = |turn: &Vec<Increment>| turn.iter().map(|(_, dtheta)| dtheta.norm()).sum::<f64>();
    let longest = turns.iter().map(length).fold(0.0, f64::max);
    let least = up
        .windows(2)
        .zip(turns)
        .filter(|(_, turn)| length(turn) > 0.05 * longest)
        .map(|(pair, turn)| pair[0].angle(&pair[1]) / length(turn))
        .fold(0.0, f64::max);
    // axes may differ by a third
    let (least, most) = (least * 0.75, core::f64::consts::TAU / longest * 1.25);
    (least < most && most.is_finite()).then_some((least, most))
}

/// The eight signs of three axes, all positive first.
fn signs() -> [V; 8] {
    core::array::from_fn(|k| V::from_fn(|i, _| if k >> i & 1 == 0 { 1.0 } else { -1.0 }))
}

/// What the unit feels in its first position, in the axes found first.
struct Felt {
    up: V,
    /// The rate of the Earth, if the gyros feel it.
    earth: Option<V>,
    /// Whether `up` points down, as far as the Earth's rate can say.
    upside_down: bool,
}

impl Felt {
    fn new(track: &Track, world: &World, up: &[V], rest: &V, gyro: &V) -> Self {
        let time = track.positions.iter().map(|position| position.time).fold(f64::INFINITY, f64::min);
        let feels = world.gyro_noise / time.sqrt() < FEELS * world.rate.norm();
        // rates along `up` are the Earth's beside the biases
        let rows = DMatrix::from_fn(up.len(), 4, |k, i| if i < 3 { up[k][i] } else { 1.0 });
        let rates: Vec<V> = track.positions.iter().map(|p| p.rate.component_mul(gyro)).collect();
        let along = DVector::from_fn(up.len(), |k, _| rates[k].dot(&up[k]));
        let solved = (rows.transpose() * &rows).cholesky().map(|f| f.solve(&(rows.transpose() * along)));
        let bias = solved.as_ref().map_or(*rest, |x| V::new(x[0], x[1], x[2]));
        let vertical = solved.map_or(world.rate.z, |x| x[3]);
        Self {
            up: up[0],
            earth: feels.then(|| rates[0] - bias),
            upside_down: feels && vertical * world.rate.z < 0.0,
        }
    }
}

/// Chooses between the ways of calling axes positive that no motion tells apart: accelerometers times P, gyros times det(P) P.
fn name_axes(
    gyro: V,
    accel: V,
    unknown: UnknownPulses,
    felt: &Felt,
    world: &World,
    initial: Option<&InitialAttitude>,
) -> (V, V) {
    let mut candidates: Vec<(bool, bool, usize, usize, V, V)> = Vec::new();
    for p in signs() {
        let det = p.x * p.y * p.z;
        let (a, g) = (accel.component_mul(&p), gyro.component_mul(&p) * det);
        // what is known stays as it is
        if !unknown.gyro && g != gyro || !unknown.accel && a != accel {
            continue;
        }
        let up = felt.up.component_mul(&p);
        let right_way_up = felt.upside_down == (det < 0.0) || felt.earth.is_none();
        let agrees = initial.is_none_or(|initial| {
            let in_body = |v: V| initial.attitude.inverse() * v;
            let level = initial.level_sigma > CONTRADICTION || up.angle(&in_body(V::z())) < CONTRADICTION;
            let north = felt.earth.is_none_or(|earth| {
                let earth = earth.component_mul(&p) * det;
                initial.heading_sigma > CONTRADICTION || earth.angle(&in_body(world.rate)) < CONTRADICTION
            });
            level && north
        });
        let positive = |v: &V| v.iter().filter(|x| **x > 0.0).count();
        candidates.push((agrees, right_way_up, positive(&g) + positive(&a), positive(&g), g, a));
    }
    let best =
        candidates.iter().max_by_key(|(agrees, way, all, of_gyros, ..)| (*agrees, *way, *all, *of_gyros));
    best.map_or((gyro, accel), |(.., g, a)| (*g, *a))
}
