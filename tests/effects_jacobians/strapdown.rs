//! The strapdown error model against the nonlinear mechanisation and measurement.

use calib_core::{Block, Dynamics};
use nalgebra::{DMatrix, Matrix3, Rotation3, Vector3};
use sinscal::{Point, Signals, Sins43B, Sins43P, Strapdown, tables};

use crate::fields::{Inputs, Random, poison};
use crate::reference::{attitude_residual, stack};
use crate::{POINTS, differences};

const A: f64 = 6_378_137.0;
const F: f64 = 1.0 / 298.257_223_563;
const OMEGA_IE: f64 = 7.292_115e-5;

/// Meridian and transverse radius.
fn radii(latitude: f64) -> (f64, f64) {
    let b = A * (1.0 - F);
    let (s, c) = latitude.sin_cos();
    let d = (A * c).hypot(b * s);
    ((A * b).powi(2) / d.powi(3), A * A / d)
}

/// Somigliana with its two axes, second order in height.
fn gravity(latitude: f64, height: f64) -> f64 {
    let (b, s2) = (A * (1.0 - F), latitude.sin().powi(2));
    let equator = 9.780_325_335_9;
    // k = (b gamma_p) / (a gamma_e) - 1
    let pole = equator * (1.0 + 0.001_931_852_652_41) * A / b;
    let surface = (A * equator * (1.0 - s2) + b * pole * s2) / (A * A * (1.0 - s2) + b * b * s2).sqrt();
    let m = OMEGA_IE.powi(2) * A * A * b / 3.986_004_418e14;
    surface * (1.0 - 2.0 * height / A * (1.0 + F + m - 2.0 * F * s2) + 3.0 * (height / A).powi(2))
}

/// A navigation state: attitude, velocity, and latitude, longitude, height.
#[derive(Clone, Copy)]
struct Navigation {
    attitude: Matrix3<f64>,
    velocity: Vector3<f64>,
    place: Vector3<f64>,
}

impl Navigation {
    fn at(point: &Point<f64>) -> Self {
        Self {
            attitude: point.c_bn,
            velocity: point.velocity,
            place: Vector3::new(point.latitude, 0.4, point.height),
        }
    }

    /// Radians of longitude and latitude, and height, in metres east, north, up.
    fn metres(&self) -> Vector3<f64> {
        let (meridian, transverse) = radii(self.place.x);
        let h = self.place.z;
        Vector3::new((transverse + h) * self.place.x.cos(), meridian + h, 1.0)
    }

    fn rates(&self, rate: &Vector3<f64>, force: &Vector3<f64>) -> Self {
        let (latitude, h, v) = (self.place.x, self.place.z, self.velocity);
        let (meridian, transverse) = radii(latitude);
        let earth = OMEGA_IE * Vector3::new(0.0, latitude.cos(), latitude.sin());
        let transport = Vector3::new(
            -v.y / (meridian + h),
            v.x / (transverse + h),
            v.x / (transverse + h) * latitude.tan(),
        );
        let turn = earth + transport;
        let gravity = Vector3::new(0.0, 0.0, -gravity(latitude, h));
        Self {
            attitude: self.attitude * rate.cross_matrix() - turn.cross_matrix() * self.attitude,
            velocity: self.attitude * force - (earth + turn).cross(&v) + gravity,
            place: Vector3::new(v.y / (meridian + h), v.x / ((transverse + h) * latitude.cos()), v.z),
        }
    }

    /// This state some time later, to first order.
    fn moved(&self, rates: &Self, time: f64) -> Self {
        Self { place: self.place + rates.place * time, ..*self }
    }
}

/// Rates of the navigation errors for errors `x` (9) and sensor errors `u` (6).
fn error_rates(point: &Point<f64>, rate: &Vector3<f64>, x: &[f64], u: &[f64]) -> Vec<f64> {
    let v = |values: &[f64]| Vector3::from_column_slice(values);
    let truth = Navigation::at(point);
    let force = point.c_bn.transpose() * point.force_n;
    let metres = truth.metres();
    let shift = v(&x[6..]).component_div(&metres); // longitude, latitude, height
    let computed = Navigation {
        attitude: Rotation3::from_scaled_axis(-v(&x[..3])) * truth.attitude,
        velocity: truth.velocity + v(&x[3..6]),
        place: truth.place + Vector3::new(shift.y, shift.x, shift.z),
    };
    let true_rates = truth.rates(rate, &force);
    let rates = computed.rates(&(rate + v(&u[..3])), &(force + v(&u[3..])));

    // E = C_hat C^T = I - [phi x]. Terms of second order are even and central differences drop them.
    let e = rates.attitude * truth.attitude.transpose() + computed.attitude * true_rates.attitude.transpose();
    let phi = -Vector3::new(e.m32 - e.m23, e.m13 - e.m31, e.m21 - e.m12) / 2.0;
    let dv = rates.velocity - true_rates.velocity;
    // d/dt of metres times shift; the rate of the metres by differences along the motion, of fourth order.
    let slope =
        |h: f64| (truth.moved(&true_rates, h).metres() - truth.moved(&true_rates, -h).metres()) / (2.0 * h);
    let (coarse, fine) = (slope(20.0), slope(10.0));
    let metres_rate = fine + (fine - coarse) / 3.0;
    let place = rates.place - true_rates.place;
    let dp =
        metres_rate.component_mul(&shift) + metres.component_mul(&Vector3::new(place.y, place.x, place.z));
    stack(phi, dv, dp)
}

/// Residuals for navigation errors `x` (9) and sensor errors `u` (6).
fn residuals(point: &Point<f64>, x: &[f64], u: &[f64]) -> Vec<f64> {
    let v = |values: &[f64]| Vector3::from_column_slice(values);
    let c = Rotation3::from_matrix_unchecked(point.c_bn);
    let c_hat = Rotation3::from_scaled_axis(-v(&x[..3])) * c;
    let (w, l) = (point.rate_eb, point.lever);
    // Velocity and position themselves cancel.
    let z_v = v(&x[3..6]) + (c_hat * (w + v(&u[..3])).cross(&l) - c * w.cross(&l));
    let z_p = v(&x[6..]) + (c_hat * l - c * l);
    // the Earth's rate at the computed latitude, in the computed b; the rate itself cancels
    let earth = |latitude: f64| OMEGA_IE * Vector3::new(0.0, latitude.cos(), latitude.sin());
    let shifted = point.latitude + x[7] / (radii(point.latitude).0 + point.height);
    let z_r = v(&u[..3]) - (c_hat.inverse() * earth(shifted) - c.inverse() * earth(point.latitude));
    let mut all = stack(z_v, z_p, attitude_residual(&c_hat, &c));
    all.extend(&z_r);
    all
}

fn core(at: &Point<f64>) -> DMatrix<f64> {
    let mut a = DMatrix::zeros(9, 9);
    Strapdown::core_jacobian(at, &mut |row, column, value| a[(row, column)] += value);
    a
}

fn residual(at: &Point<f64>) -> DMatrix<f64> {
    let mut h = DMatrix::zeros(12, 9);
    Strapdown::measurement_jacobian(at, &mut |row, column, value| h[(row, column)] += value);
    h
}

fn injection(at: &Point<f64>) -> DMatrix<f64> {
    let mut b = DMatrix::zeros(9, 6);
    for input in 0..6 {
        // Twice, halved: the value must scale the column.
        Strapdown::inject(at, input, 2.0, &mut |row, value| b[(row, input)] += value / 2.0);
    }
    b
}

fn residual_input(at: &Point<f64>) -> DMatrix<f64> {
    let mut l = DMatrix::zeros(12, 6);
    for input in 0..6 {
        Strapdown::measure_input(at, input, 2.0, &mut |row, value| l[(row, input)] += value / 2.0);
    }
    l
}

/// Compares row by row within each unit of rows and columns, so that no unit hides another: entries are
/// judged at 1e-6 of themselves and are zero below 1e-9 of the largest of their 3 x 3 block.
fn compare_blocks(name: &str, found: &DMatrix<f64>, expected: &DMatrix<f64>) {
    for row in (0..expected.nrows()).step_by(3) {
        for column in (0..expected.ncols()).step_by(3) {
            let (a, b) = (found.view((row, column), (3, 3)), expected.view((row, column), (3, 3)));
            let floor = 1e-9 * b.amax();
            for (i, j) in (0..9).map(|k| (k / 3, k % 3)) {
                let (a, b) = (a[(i, j)], b[(i, j)]);
                let close = (a - b).abs() <= 1e-6 * b.abs() + floor;
                assert!(close, "{name} ({}, {}): {a:e}, expected {b:e}", row + i, column + j);
            }
        }
    }
}

/// Steps for phi, dv, dp: large enough that rounding stays below 1e-9 of the entries, small enough for fourth
/// order.
const STATE_STEPS: [f64; 9] = [1e-3, 1e-3, 1e-3, 10.0, 10.0, 10.0, 5e3, 5e3, 5e3];

#[test]
fn navigation_errors_follow_the_mechanisation() {
    let mut random = Random::new(10);
    for _ in 0..POINTS {
        let at = Point::random(&mut random);
        // The rate cancels; a large one would only leave its rounding.
        let rate = random.vector(1e-2);
        let expected = differences(|x| error_rates(&at, &rate, x, &[0.0; 6]), &STATE_STEPS);
        compare_blocks("A", &core(&at), &expected);
    }
}

#[test]
fn sensor_errors_enter_as_the_mechanisation_says() {
    let mut random = Random::new(11);
    for _ in 0..POINTS {
        let at = Point::random(&mut random);
        let rate = random.vector(1.0);
        let expected = differences(|u| error_rates(&at, &rate, &[0.0; 9], u), &[1e-2; 6]);
        compare_blocks("B", &injection(&at), &expected);
    }
}

#[test]
fn residuals_follow_the_measurement() {
    let mut random = Random::new(12);
    for _ in 0..POINTS {
        let at = Point::random(&mut random);
        let expected = differences(|x| residuals(&at, x, &[0.0; 6]), &STATE_STEPS);
        compare_blocks("H", &residual(&at), &expected);
        compare_blocks("L", &residual_input(&at), &differences(|u| residuals(&at, &[0.0; 9], u), &[1e-3; 6]));
    }
}

#[test]
fn matrices_use_what_their_tables_list_and_nothing_else() {
    let at = Point::random(&mut Random::new(13));
    poison("A", tables::strapdown_core::TABLE.inputs, &at, core);
    poison("B", tables::strapdown_injection::TABLE.inputs, &at, injection);
    poison("H", tables::strapdown_residual::TABLE.inputs, &at, |at| residual(at).rows(0, 9).into_owned());
    poison("H of the rate", tables::strapdown_rate::TABLE.inputs, &at, |at| {
        residual(at).rows(9, 3).into_owned()
    });
    poison("L", tables::strapdown_residual_input::TABLE.inputs, &at, residual_input);
}

#[test]
fn dither_reaches_only_those_who_declare_it() {
    let signals = Signals::random(&mut Random::new(14));
    fn restricted<F: Block<Dynamics = Strapdown>>(mut signals: Signals<f64>) -> Signals<f64> {
        Strapdown::restrict::<F, f64>(&mut signals);
        signals
    }
    assert_eq!(restricted::<Sins43B>(signals), signals);
    assert_eq!(restricted::<Sins43P>(signals), Signals { coupled_dither: Vector3::zeros(), ..signals });
}

#[test]
fn single_precision_is_enough() {
    let mut random = Random::new(15);
    for _ in 0..POINTS {
        let at = Point::random(&mut random);
        let single = at.map(|number| number as f32);
        let mut found = DMatrix::<f64>::zeros(9, 9);
        Strapdown::core_jacobian(&single, &mut |row, column, value| {
            found[(row, column)] = f64::from(value);
        });
        let expected = core(&at);
        for (row, column) in (0..81).map(|k| (k / 9, k % 9)) {
            let scale = expected.view((row / 3 * 3, column / 3 * 3), (3, 3)).amax();
            let difference = (found[(row, column)] - expected[(row, column)]).abs();
            assert!(difference <= 1e-5 * scale, "A ({row}, {column}): {difference:e} of {scale:e}");
        }
    }
}
