//! One 43-state cycle: propagate with Phi and Psi over an interval, six-measurement update, full covariance.
//!
//! `cargo bench --bench cycle`. Every peer is checked to give the same covariance before it is timed.

use std::hint::black_box;

use calib_core::{Conventional, Form, Shape, Ud};
use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::{DMatrix, Matrix3, Rotation3, SMatrix, Vector3};
use sinscal::{Filter, Point, Signals, Sins43B, Transition};

type F = Sins43B;
type S = <F as Filter>::Shape;
const N: usize = F::DIM;

/// One interval of a unit turning at 10 deg/s, and its measurement.
struct Case {
    rows: <S as Shape>::CoreRows<f64>,
    noise: <S as Shape>::CoreMatrix<f64>,
    h: <S as Shape>::MeasurementRows<f64>,
    r: <S as Shape>::Measurement<f64>,
    z: <S as Shape>::Measurement<f64>,
    p: <S as Shape>::Matrix<f64>,
}

fn signals() -> Signals<f64> {
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
    }
}

fn point() -> Point<f64> {
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
    }
}

fn interval() -> Transition<F, f64> {
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

fn case() -> Case {
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
        cycle::<Conventional>(&case.clone_parts(), &mut case.p);
    }
    case
}

impl Case {
    fn clone_parts(&self) -> Self {
        Self { rows: self.rows, noise: self.noise, h: self.h, r: self.r, z: self.z, p: self.p }
    }
}

fn cycle<C: Form>(case: &Case, p: &mut [[f64; N]; N]) -> f64 {
    let mut x = [0.0; N];
    C::propagate::<S, f64>(p, &case.rows, &case.noise);
    C::update::<S, f64>(p, &mut x, &case.h, &case.r, &case.z).map_or(f64::NAN, |whitened| x[0] + whitened.nis)
}

type M = SMatrix<f64, N, N>;

/// The same with nalgebra's static matrices and full F: the baseline of all ratios.
struct Dense {
    f: M,
    q: M,
    h: SMatrix<f64, 6, N>,
    r: SMatrix<f64, 6, 6>,
}

impl Dense {
    fn new(case: &Case) -> Self {
        Self {
            f: M::from_fn(|i, j| if i < 9 { case.rows[i][j] } else { f64::from(u8::from(i == j)) }),
            q: M::from_fn(|i, j| if i < 9 && j < 9 { case.noise[i][j] } else { 0.0 }),
            h: SMatrix::from_fn(|i, j| case.h[i][j]),
            r: SMatrix::from_fn(|i, j| if i == j { case.r[i] } else { 0.0 }),
        }
    }

    fn cycle(&self, p: &mut M, joseph: bool) {
        *p = self.f * *p * self.f.transpose() + self.q;
        let pht = *p * self.h.transpose();
        let s = self.h * pht + self.r;
        let k = pht * s.try_inverse().expect("positive definite");
        let rest = M::identity() - k * self.h;
        *p = if joseph { rest * *p * rest.transpose() + k * self.r * k.transpose() } else { rest * *p };
    }
}

fn check(name: &str, got: impl Fn(usize, usize) -> f64, want: &[[f64; N]; N]) {
    for i in 0..N {
        for j in 0..N {
            let scale = (want[i][i] * want[j][j]).sqrt();
            let error = (got(i, j) - want[i][j]).abs() / scale;
            assert!(error < 1e-10, "{name} differs at ({i}, {j}): {error:e}");
        }
    }
}

fn benches(c: &mut Criterion) {
    let case = case();
    let mut want = case.p;
    cycle::<Conventional>(&case, &mut want);

    let mut group = c.benchmark_group("cycle-43");
    group.bench_function("conventional", |b| {
        let mut p = case.p;
        b.iter(|| {
            p.clone_from(black_box(&case.p));
            black_box(cycle::<Conventional>(&case, &mut p))
        });
    });
    // factors of the same covariance
    let mut ud = case.p;
    {
        let n = N;
        let mut q = case.p;
        for j in (0..n).rev() {
            let d = q[j][j];
            for i in 0..j {
                q[j][i] /= d;
            }
            for i in 0..j {
                for k in 0..=i {
                    let change = q[j][i] * q[j][k] * d;
                    q[i][k] -= change;
                }
            }
        }
        ud.clone_from(&q);
    }
    let (mut moved, mut dense) = (ud, case.p);
    cycle::<Ud>(&case, &mut moved);
    Ud::dense::<S, f64>(&moved, &mut dense);
    check("ud", |i, j| dense[i][j], &want);
    group.bench_function("ud", |b| {
        let mut p = ud;
        b.iter(|| {
            p.clone_from(black_box(&ud));
            black_box(cycle::<Ud>(&case, &mut p))
        });
    });
    let nalgebra = Dense::new(&case);
    let start = M::from_fn(|i, j| case.p[i][j]);
    for (name, joseph) in [("nalgebra-dense", false), ("nalgebra-joseph", true)] {
        let mut p = start;
        nalgebra.cycle(&mut p, joseph);
        check(name, |i, j| p[(i, j)], &want);
        group.bench_function(name, |b| {
            let mut p = start;
            b.iter(|| {
                p.copy_from(black_box(&start));
                nalgebra.cycle(&mut p, joseph);
                black_box(p[(0, 0)])
            });
        });
    }
    let heap = |m: &M| DMatrix::from_fn(N, N, |i, j| m[(i, j)]);
    let (f, q, h) = (heap(&nalgebra.f), heap(&nalgebra.q), DMatrix::from_fn(6, N, |i, j| case.h[i][j]));
    let r = DMatrix::from_fn(6, 6, |i, j| nalgebra.r[(i, j)]);
    group.bench_function("nalgebra-dynamic", |b| {
        let start = heap(&start);
        b.iter(|| {
            let p = &f * black_box(&start) * f.transpose() + &q;
            let pht = &p * h.transpose();
            let s = &h * &pht + &r;
            let k = &pht * s.try_inverse().expect("positive definite");
            black_box((DMatrix::identity(N, N) - k * &h) * p)
        });
    });
    group.finish();

    let mut group = c.benchmark_group("assembly-43");
    let (at, signals) = (point(), signals());
    group.bench_function("absorb", |b| {
        let mut transition = Transition::<F, f64>::new();
        b.iter(|| transition.absorb(black_box(&at), black_box(&signals), 0.02));
    });
    group.bench_function("advance", |b| {
        let mut transition = Transition::<F, f64>::new();
        b.iter(|| transition.advance(black_box(&at), 0.02));
    });
    group.bench_function("measurement rows", |b| {
        b.iter(|| black_box(calib_core::measurement_rows::<F, f64>(black_box(&at), black_box(&signals))));
    });
    group.finish();
}

criterion_group!(cycles, benches);
criterion_main!(cycles);
