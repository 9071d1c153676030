//! The cycle of `benches/cycle.rs` with other filters from crates.io, each fed the same dense matrices.
//!
//! Each is checked to give the same covariance before it is timed.

#[path = "../../case/mod.rs"]
mod case;

use std::hint::black_box;

use adskalman::{CovarianceUpdateMethod, ObservationModel, StateAndCovariance, TransitionModelLinearNoControl};
use calib_core::Conventional;
use case::{Case, N, case, check, cycle};
use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use kfilter::{KalmanFilter, KalmanPredict};
use minikalman::prelude::*;
use minikalman::regular::builder::KalmanFilterBuilder;
use nalgebra::{OMatrix, SMatrix, SVector, U6};

type U43 = nalgebra::Const<N>;

fn f(case: &Case, i: usize, j: usize) -> f64 {
    if i < 9 { case.rows[i][j] } else { f64::from(u8::from(i == j)) }
}

fn q(case: &Case, i: usize, j: usize) -> f64 {
    if i < 9 && j < 9 { case.noise[i][j] } else { 0.0 }
}

fn r(case: &Case, i: usize, j: usize) -> f64 {
    if i == j { case.r[i] } else { 0.0 }
}

/// adskalman wants its transposes stored.
struct Adskalman {
    f: OMatrix<f64, U43, U43>,
    ft: OMatrix<f64, U43, U43>,
    q: OMatrix<f64, U43, U43>,
    h: OMatrix<f64, U6, U43>,
    ht: OMatrix<f64, U43, U6>,
    r: OMatrix<f64, U6, U6>,
}

impl TransitionModelLinearNoControl<f64, U43> for Adskalman {
    fn F(&self) -> &OMatrix<f64, U43, U43> {
        &self.f
    }
    fn FT(&self) -> &OMatrix<f64, U43, U43> {
        &self.ft
    }
    fn Q(&self) -> &OMatrix<f64, U43, U43> {
        &self.q
    }
}

impl ObservationModel<f64, U43, U6> for Adskalman {
    fn H(&self) -> &OMatrix<f64, U6, U43> {
        &self.h
    }
    fn HT(&self) -> &OMatrix<f64, U43, U6> {
        &self.ht
    }
    fn R(&self) -> &OMatrix<f64, U6, U6> {
        &self.r
    }
}

fn peers(c: &mut Criterion) {
    let case = case();
    let mut want = case.p;
    cycle::<Conventional>(&case, &mut want);
    let mut group = c.benchmark_group("peers-43");
    group.sample_size(20);
    group.bench_function("sinscal", |b| {
        b.iter_batched_ref(|| case.p, |p| black_box(cycle::<Conventional>(&case, p)), BatchSize::SmallInput);
    });

    let model = Adskalman {
        f: SMatrix::from_fn(|i, j| f(&case, i, j)),
        ft: SMatrix::from_fn(|i, j| f(&case, j, i)),
        q: SMatrix::from_fn(|i, j| q(&case, i, j)),
        h: SMatrix::from_fn(|i, j| case.h[i][j]),
        ht: SMatrix::from_fn(|i, j| case.h[j][i]),
        r: SMatrix::from_fn(|i, j| r(&case, i, j)),
    };
    let start = StateAndCovariance::new(SVector::zeros(), SMatrix::from_fn(|i, j| case.p[i][j]));
    let z = SVector::<f64, 6>::from(case.z);
    let run = || {
        let prior = model.predict(black_box(&start));
        model.update(&prior, &z, CovarianceUpdateMethod::OptimalKalman).expect("positive definite")
    };
    let found = run();
    check("adskalman", |i, j| found.covariance()[(i, j)], &want);
    group.bench_function("adskalman", |b| b.iter(|| black_box(run())));

    let start = {
        use nalgebra_034::SMatrix;
        let mut filter = kfilter::Kalman1MLinearNoInput::<f64, N, 6>::new(
            SMatrix::from_fn(|i, j| f(&case, i, j)),
            SMatrix::from_fn(|i, j| q(&case, i, j)),
            SMatrix::from_fn(|i, j| case.h[i][j]),
            SMatrix::from_fn(|i, j| r(&case, i, j)),
            SMatrix::zeros(),
        );
        *filter.covariance_mut() = SMatrix::from_fn(|i, j| case.p[i][j]);
        filter
    };
    let z = nalgebra_034::SVector::<f64, 6>::from(case.z);
    let fresh = *start.covariance();
    let mut filter = start;
    let mut run = || {
        *filter.covariance_mut() = fresh;
        filter.predict().expect("linear");
        filter.update(z).expect("positive definite");
        *filter.covariance()
    };
    let found = run();
    check("kfilter", |i, j| found[(i, j)], &want);
    group.bench_function("kfilter", |b| b.iter(|| black_box(run())));

    let builder = KalmanFilterBuilder::<N, f64>::default();
    let mut filter = builder.build();
    let mut measurement = builder.observations().build::<6>();
    for i in 0..N {
        for j in 0..N {
            filter.state_transition_mut().set_at(i, j, f(&case, i, j));
            filter.direct_process_noise_mut().set_at(i, j, q(&case, i, j));
        }
    }
    for i in 0..6 {
        for j in 0..N {
            measurement.observation_matrix_mut().set_at(i, j, case.h[i][j]);
        }
        for j in 0..6 {
            measurement.measurement_noise_covariance_mut().set_at(i, j, r(&case, i, j));
        }
        measurement.measurement_vector_mut().set_at(i, 0, case.z[i]);
    }
    let mut run = || {
        for i in 0..N {
            for j in 0..N {
                filter.estimate_covariance_mut().set_at(i, j, case.p[i][j]);
            }
        }
        filter.predict();
        filter.correct(&mut measurement);
        let mut p = [[0.0; N]; N];
        for i in 0..N {
            for j in 0..N {
                p[i][j] = filter.estimate_covariance().get_at(i, j);
            }
        }
        p
    };
    let found = run();
    check("minikalman", |i, j| found[i][j], &want);
    group.bench_function("minikalman", |b| b.iter(|| black_box(run())));
    group.finish();
}

criterion_group!(benches, peers);
criterion_main!(benches);
