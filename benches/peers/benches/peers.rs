//! The cycle of `benches/cycle.rs`, all that is timed there, and with other filters from crates.io, each fed the same dense
//! matrices.
//!
//! Each is checked to give the same covariance before it is timed.

#[path = "../../cycle.rs"]
mod cycle;

use adskalman::{
    CovarianceUpdateMethod, ObservationModel, StateAndCovariance, TransitionModelLinearNoControl,
};
use calib_core::Conventional;
use cycle::bench::Bench;
use cycle::case::{Case, N, case, check};
use cycle::{CYCLES, all};
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

fn adskalman(bench: &mut Bench, case: &Case, want: &[[f64; N]; N]) {
    let model = Adskalman {
        f: SMatrix::from_fn(|i, j| f(case, i, j)),
        ft: SMatrix::from_fn(|i, j| f(case, j, i)),
        q: SMatrix::from_fn(|i, j| q(case, i, j)),
        h: SMatrix::from_fn(|i, j| case.h[i][j]),
        ht: SMatrix::from_fn(|i, j| case.h[j][i]),
        r: SMatrix::from_fn(|i, j| r(case, i, j)),
    };
    let z = SVector::<f64, 6>::from(case.z);
    let start = || StateAndCovariance::new(SVector::zeros(), SMatrix::from_fn(|i, j| case.p[i][j]));
    let run = |at: &mut StateAndCovariance<f64, U43>| {
        let prior = model.predict(at);
        *at = model.update(&prior, &z, CovarianceUpdateMethod::OptimalKalman).expect("positive definite");
    };
    let mut found = start();
    run(&mut found);
    check("adskalman", |i, j| found.covariance()[(i, j)], want);
    bench.run("adskalman", CYCLES, start, run);
}

fn kfilter(bench: &mut Bench, case: &Case, want: &[[f64; N]; N]) {
    use nalgebra_034::{SMatrix, SVector};
    type Filter = kfilter::Kalman1MLinearNoInput<f64, N, 6>;
    let z = SVector::<f64, 6>::from(case.z);
    let start = || {
        let mut filter = Filter::new(
            SMatrix::from_fn(|i, j| f(case, i, j)),
            SMatrix::from_fn(|i, j| q(case, i, j)),
            SMatrix::from_fn(|i, j| case.h[i][j]),
            SMatrix::from_fn(|i, j| r(case, i, j)),
            SMatrix::zeros(),
        );
        *filter.covariance_mut() = SMatrix::from_fn(|i, j| case.p[i][j]);
        filter
    };
    let run = |filter: &mut Filter| {
        filter.predict().expect("linear");
        filter.update(z).expect("positive definite");
    };
    let mut found = start();
    run(&mut found);
    check("kfilter", |i, j| found.covariance()[(i, j)], want);
    bench.run("kfilter", CYCLES, start, run);
}

fn minikalman(bench: &mut Bench, case: &Case, want: &[[f64; N]; N]) {
    let builder = KalmanFilterBuilder::<N, f64>::default();
    let start = || {
        let (mut filter, mut measurement) = (builder.build(), builder.observations().build::<6>());
        for i in 0..N {
            for j in 0..N {
                filter.state_transition_mut().set_at(i, j, f(case, i, j));
                filter.direct_process_noise_mut().set_at(i, j, q(case, i, j));
                filter.estimate_covariance_mut().set_at(i, j, case.p[i][j]);
            }
        }
        for i in 0..6 {
            for j in 0..N {
                measurement.observation_matrix_mut().set_at(i, j, case.h[i][j]);
            }
            for j in 0..6 {
                measurement.measurement_noise_covariance_mut().set_at(i, j, r(case, i, j));
            }
            measurement.measurement_vector_mut().set_at(i, 0, case.z[i]);
        }
        (filter, measurement)
    };
    let mut found = start();
    found.0.predict();
    found.0.correct(&mut found.1);
    check("minikalman", |i, j| found.0.estimate_covariance().get_at(i, j), want);
    bench.run("minikalman", CYCLES, start, |(filter, measurement)| {
        filter.predict();
        filter.correct(measurement);
    });
}

fn main() {
    let mut bench = Bench::from_arguments();
    all(&mut bench);
    let case = case();
    let mut want = case.p;
    cycle::case::cycle::<Conventional>(&case, &mut want);
    adskalman(&mut bench, &case, &want);
    kfilter(&mut bench, &case, &want);
    minikalman(&mut bench, &case, &want);
    bench.finish();
}
