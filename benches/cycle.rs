//! One 43-state cycle: propagate with Phi and Psi over an interval, six-measurement update, full covariance. And what is
//! assembled for it.
//!
//! `cargo bench --bench cycle`. Every peer is checked to give the same covariance before it is timed. Other crates stand in
//! `benches/peers`.

mod case;

use std::hint::black_box;

use calib_core::{Conventional, Form, Shape, Ud};
use case::{Case, F, N, S, case, check, cycle, interval, point, signals};
use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use nalgebra::{DMatrix, SMatrix};
use sinscal::Transition;

type M = SMatrix<f64, N, N>;

/// The same with nalgebra's static matrices: the baselines of all ratios.
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

    /// Full F; P by (I - K H) P or by Joseph's formula.
    fn cycle(&self, p: &mut M, joseph: bool) {
        *p = self.f * *p * self.f.transpose() + self.q;
        let pht = *p * self.h.transpose();
        let k = pht * (self.h * pht + self.r).try_inverse().expect("positive definite");
        let rest = M::identity() - k * self.h;
        *p = if joseph { rest * *p * rest.transpose() + k * self.r * k.transpose() } else { rest * *p };
    }

    /// What one writes by hand who knows that only nine rows of F are not trivial: P - K (P H')'.
    fn nine_rows(&self, p: &mut M) {
        let rows = self.f.fixed_rows::<9>(0).into_owned();
        let moved = rows * *p;
        let corner = moved * rows.transpose() + self.q.fixed_view::<9, 9>(0, 0);
        p.fixed_rows_mut::<9>(0).copy_from(&moved);
        p.fixed_columns_mut::<9>(0).copy_from(&moved.transpose());
        p.fixed_view_mut::<9, 9>(0, 0).copy_from(&corner);
        let pht = *p * self.h.transpose();
        let k = pht * (self.h * pht + self.r).try_inverse().expect("positive definite");
        *p -= k * pht.transpose();
    }
}

/// U and D of a covariance, as the UD form stores them.
fn factors(p: &[[f64; N]; N]) -> [[f64; N]; N] {
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

fn forms(c: &mut Criterion) {
    let case = case();
    let mut want = case.p;
    cycle::<Conventional>(&case, &mut want);
    let mut group = c.benchmark_group("cycle-43");
    let mut ours = |name: &str, start: [[f64; N]; N], run: fn(&Case, &mut [[f64; N]; N]) -> f64| {
        group.bench_function(name, |b| {
            b.iter_batched_ref(|| start, |p| black_box(run(&case, p)), BatchSize::SmallInput);
        });
    };
    ours("conventional", case.p, cycle::<Conventional>);
    let ud = factors(&case.p);
    let (mut moved, mut dense) = (ud, case.p);
    cycle::<Ud>(&case, &mut moved);
    Ud::dense::<S, f64>(&moved, &mut dense);
    check("ud", |i, j| dense[i][j], &want);
    ours("ud", ud, cycle::<Ud>);

    let nalgebra = Dense::new(&case);
    let start = M::from_fn(|i, j| case.p[i][j]);
    let peers: [(&str, fn(&Dense, &mut M)); 3] = [
        ("nalgebra static, nine rows", Dense::nine_rows),
        ("nalgebra static, (I-KH)P", |dense, p| dense.cycle(p, false)),
        ("nalgebra static, Joseph", |dense, p| dense.cycle(p, true)),
    ];
    for (name, run) in peers {
        let mut p = start;
        run(&nalgebra, &mut p);
        check(name, |i, j| p[(i, j)], &want);
        group.bench_function(name, |b| {
            b.iter_batched_ref(|| start, |p| run(&nalgebra, p), BatchSize::SmallInput);
        });
    }
    let heap = |m: &M| DMatrix::from_fn(N, N, |i, j| m[(i, j)]);
    let (f, q, h) = (heap(&nalgebra.f), heap(&nalgebra.q), DMatrix::from_fn(6, N, |i, j| case.h[i][j]));
    let r = DMatrix::from_fn(6, 6, |i, j| nalgebra.r[(i, j)]);
    let start = heap(&start);
    let dynamic = || {
        let p = &f * black_box(&start) * f.transpose() + &q;
        let pht = &p * h.transpose();
        let k = &pht * (&h * &pht + &r).try_inverse().expect("positive definite");
        (DMatrix::identity(N, N) - k * &h) * p
    };
    let p = dynamic();
    check("nalgebra dynamic", |i, j| p[(i, j)], &want);
    group.bench_function("nalgebra dynamic, (I-KH)P", |b| b.iter(|| black_box(dynamic())));
    group.finish();
}

fn assembly(c: &mut Criterion) {
    let mut group = c.benchmark_group("assembly-43");
    let (at, signals) = (point(), signals());
    let mut transition = Transition::<F, f64>::new();
    group.bench_function("absorb", |b| {
        b.iter(|| {
            transition.absorb(black_box(&at), black_box(&signals), 0.005);
            black_box(&mut transition);
        });
    });
    let mut transition = interval();
    group.bench_function("advance", |b| {
        b.iter(|| {
            transition.advance(black_box(&at), 1e-9);
            black_box(&mut transition);
        });
    });
    let transition = interval();
    let density = [1e-13; 9];
    group.bench_function("noise", |b| b.iter(|| black_box(transition.noise(black_box(&density)))));
    group.bench_function("measurement rows", |b| {
        b.iter(|| black_box(calib_core::measurement_rows::<F, f64>(black_box(&at), black_box(&signals))));
    });
    group.finish();
}

criterion_group!(benches, forms, assembly);
criterion_main!(benches);
