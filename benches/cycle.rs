//! One 43-state cycle: propagate with Phi and Psi over an interval, six-measurement update, full covariance. And what is
//! assembled for it.
//!
//! `cargo bench --bench cycle`; `cargo bench --bench cycle -- --least` prints the least of many short repetitions instead of
//! statistics, which a busy machine disturbs little. Every peer is checked to give the same covariance before it is timed.
//! Other crates stand in `benches/peers`.

mod case;

use std::hint::black_box;
use std::time::{Duration, Instant};

use calib_core::{Conventional, Form, Ud};
use case::{Case, F, N, S, case, check, cycle, factors, interval, point, signals};
use criterion::{BatchSize, Criterion};
use nalgebra::{DMatrix, SMatrix};

type M = SMatrix<f64, N, N>;
type Peer = fn(&Dense, &mut M);

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

/// Times routines with criterion, or on its own where that is `None`.
struct Bench {
    criterion: Option<Criterion>,
}

impl Bench {
    /// `routine` on a fresh copy of `start`; copying is not counted.
    fn run<P: Clone, R>(&mut self, name: &str, start: &P, mut routine: impl FnMut(&mut P) -> R) {
        if let Some(criterion) = &mut self.criterion {
            criterion.bench_function(name, |b| {
                b.iter_batched_ref(|| start.clone(), |p| black_box(routine(p)), BatchSize::SmallInput);
            });
            return;
        }
        // routines without a start take nanoseconds: the clock needs many of them
        let times = if size_of::<P>() == 0 { 100 } else { 1 };
        let mut least = Duration::MAX;
        for _ in 0..20_000 {
            let mut copy = start.clone();
            let begin = Instant::now();
            for _ in 0..times {
                black_box(routine(black_box(&mut copy)));
            }
            least = least.min(begin.elapsed());
        }
        println!("{name:40} {:8.3} us", least.as_secs_f64() * 1e6 / f64::from(times));
    }
}

fn forms(bench: &mut Bench) {
    let case = case();
    let mut want = case.p;
    cycle::<Conventional>(&case, &mut want);
    bench.run("conventional", &case.p, |p| cycle::<Conventional>(&case, p));
    let ud = factors(&case.p);
    let (mut moved, mut dense) = (ud, case.p);
    cycle::<Ud>(&case, &mut moved);
    Ud::dense::<S, f64>(&moved, &mut dense);
    check("ud", |i, j| dense[i][j], &want);
    bench.run("ud", &ud, |p| cycle::<Ud>(&case, p));

    let nalgebra = Dense::new(&case);
    let start = M::from_fn(|i, j| case.p[i][j]);
    let peers: [(&str, Peer); 3] = [
        ("nalgebra static, nine rows", Dense::nine_rows),
        ("nalgebra static, (I-KH)P", |dense, p| dense.cycle(p, false)),
        ("nalgebra static, Joseph", |dense, p| dense.cycle(p, true)),
    ];
    for (name, run) in peers {
        let mut p = start;
        run(&nalgebra, &mut p);
        check(name, |i, j| p[(i, j)], &want);
        bench.run(name, &start, |p| run(&nalgebra, p));
    }
    let heap = |m: &M| DMatrix::from_fn(N, N, |i, j| m[(i, j)]);
    let (f, q, h) = (heap(&nalgebra.f), heap(&nalgebra.q), DMatrix::from_fn(6, N, |i, j| case.h[i][j]));
    let r = DMatrix::from_fn(6, 6, |i, j| nalgebra.r[(i, j)]);
    let dynamic = |p: &mut DMatrix<f64>| {
        *p = &f * &*p * f.transpose() + &q;
        let pht = &*p * h.transpose();
        let k = &pht * (&h * &pht + &r).try_inverse().expect("positive definite");
        *p = (DMatrix::identity(N, N) - k * &h) * &*p;
    };
    let mut p = heap(&start);
    dynamic(&mut p);
    check("nalgebra dynamic", |i, j| p[(i, j)], &want);
    bench.run("nalgebra dynamic, (I-KH)P", &heap(&start), dynamic);
}

fn assembly(bench: &mut Bench) {
    let (at, signals) = (point(), signals());
    let density = [1e-13; 9];
    let mut transition = interval();
    bench.run("absorb a sample", &(), |()| {
        transition.absorb(black_box(&at), black_box(&signals), 1e-9);
        black_box(&mut transition);
    });
    bench.run("advance", &(), |()| {
        transition.advance(black_box(&at), 1e-9);
        black_box(&mut transition);
    });
    bench.run("process noise", &(), |()| transition.noise(black_box(&density)));
    bench.run("measurement rows", &(), |()| {
        calib_core::measurement_rows::<F, f64>(black_box(&at), black_box(&signals))
    });
}

fn main() {
    let least = std::env::args().any(|argument| argument == "--least");
    let mut bench = Bench { criterion: (!least).then(|| Criterion::default().configure_from_args()) };
    forms(&mut bench);
    assembly(&mut bench);
    if let Some(criterion) = bench.criterion {
        criterion.final_summary();
    }
}
