//! The case that every benchmark of a cycle computes.
#![allow(dead_code, reason = "not every benchmark uses all of it")]

use calib_core::{Conventional, Form, Shape};
use nalgebra::{Matrix3, Rotation3, Vector3};
use sinscal::{Filter, Point, Signals, Sins43B, Transition};

pub(crate) type F = Sins43B;
pub(crate) type S = <F as Filter>::Shape;
pub(crate) const N: usize = F::DIM;

/// One interval of a unit turning at 10 deg/s, and its measurement.
#[derive(Clone)]
pub(crate) struct Case {
    pub(crate) rows: <S as Shape>::CoreRows<f64>,
    pub(crate) noise: <S as Shape>::CoreMatrix<f64>,
    pub(crate) h: <S as Shape>::MeasurementRows<f64>,
    pub(crate) r: <S as Shape>::Measurement<f64>,
    pub(crate) z: <S as Shape>::Measurement<f64>,
    pub(crate) p: <S as Shape>::Matrix<f64>,
}

pub(crate) fn signals() -> Signals<f64> {
    Signals {
        rate: Vector3::new(0.1, -0.12, 0.08),
        angular_acceleration: Vector3::new(0.01, 0.02, -0.01),
        force: Vector3::new(3.0, -5.0, 7.8),
        temperature: Vector3::new(5.0, 7.0, 9.0),
        temperature_rate: Vector3::repeat(1e-3),
        gyro_temperature: Vector3::new(5.0, 7.0, 9.0),
        dither: Vector3::repeat(3e-3),
        coupled_dither: Vector3::repeat(3e-3),
        time: 100.0,
        ..Signals::default()
    }
}

pub(crate) fn point() -> Point<f64> {
    let c_bn: Matrix3<f64> = Rotation3::from_euler_angles(0.3, -0.8, 1.9).into_inner();
    let lever = Vector3::new(0.2, 0.1, -0.1);
    Point {
        c_bn,
        velocity: Vector3::new(0.01, -0.02, 0.005),
        latitude: 0.56,
        height: 20.0,
        position: Vector3::zeros(),
        force_n: Vector3::new(0.01, 0.02, 9.79),
        rate_eb: signals().rate,
        lever,
        point_velocity: Vector3::zeros(),
        point_acceleration: Vector3::zeros(),
        point_position: Vector3::zeros(),
        ..Point::default()
    }
}

pub(crate) fn interval() -> Transition<F, f64> {
    let (at, signals) = (point(), signals());
    let mut transition = Transition::new();
    for k in 1..=50 {
        transition.absorb(&at, &signals, 0.02);
        if k % 5 == 0 {
            transition.advance(&at, 0.1);
        }
    }
    transition
}

pub(crate) fn case() -> Case {
    let transition = interval();
    let mut sigmas = calib_core::Kalman::<F>::prior();
    sigmas[6] = 0.1;
    let mut p = S::matrix(0.0);
    let variances = sigmas.map(|s| s * s);
    Conventional::set_diagonal::<S, f64>(&mut p, &variances);
    let density = [1e-13, 1e-13, 1e-13, 2.5e-9, 2.5e-9, 2.5e-9, 0.0, 0.0, 0.0];
    let mut case = Case {
        rows: *transition.rows(),
        noise: transition.noise(&density),
        h: calib_core::measurement_rows::<F, f64>(&point(), &signals()),
        r: [1e-6, 1e-6, 1e-6, 4e-6, 4e-6, 4e-6],
        z: [1e-3, -1e-3, 5e-4, 2e-3, 1e-3, -3e-3],
        p,
    };
    // a covariance in which everything is correlated
    for _ in 0..20 {
        let mut p = case.p;
        cycle::<Conventional>(&case, &mut p);
        case.p = p;
    }
    case
}

pub(crate) fn cycle<C: Form>(case: &Case, p: &mut [[f64; N]; N]) -> f64 {
    let mut x = [0.0; N];
    C::propagate::<S, f64>(p, &case.rows, &case.noise);
    C::update::<S, f64>(p, &mut x, &case.h, &case.r, &case.z).map_or(f64::NAN, |whitened| x[0] + whitened.nis)
}

/// U and D of a covariance, as the UD form stores them.
pub(crate) fn factors(p: &[[f64; N]; N]) -> [[f64; N]; N] {
    let (mut rest, mut ud) = (*p, [[0.0; N]; N]);
    for j in (0..N).rev() {
        let d = rest[j][j];
        ud[j][j] = d;
        for i in 0..j {
            ud[j][i] = rest[j][i] / d;
        }
        for i in 0..j {
            for k in 0..j {
                rest[i][k] -= ud[j][i] * ud[j][k] * d;
            }
        }
    }
    ud
}

/// Asserts that a peer has the covariance that is wanted, each entry relative to its standard deviations.
pub(crate) fn check(name: &str, got: impl Fn(usize, usize) -> f64, want: &[[f64; N]; N]) {
    for i in 0..N {
        for j in 0..N {
            let scale = (want[i][i] * want[j][j]).sqrt();
            let error = (got(i, j) - want[i][j]).abs() / scale;
            assert!(error < 1e-10, "{name} differs at ({i}, {j}): {error:e}");
        }
    }
}
