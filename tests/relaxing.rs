//! A parameter that forgets, from its declaration through the prediction and a whole calibration.

mod common;

use calib_core::{Conventional, Filter, Form, Kalman, Relaxation, Shape, Transition, Ud};
use common::{Numbers, point, sample, setup, signals};
use nalgebra::{DMatrix, DVector, Vector3};
use sinscal::prelude::*;
use sinscal::{Calibration, FORCE, ReferenceSigma, Setup, Signals};

/// s.
const CORRELATION_TIME: f64 = 100.0;
/// Stationary standard deviation, m/s^2.
const STATIONARY: f64 = 1e-3;
/// Before the run, m/s^2.
const PRIOR: f64 = 1e-2;

const FORGETS: Relaxation<f64> =
    Relaxation { rate: 1.0 / CORRELATION_TIME, density: 2.0 * STATIONARY * STATIONARY / CORRELATION_TIME };

/// Accelerometer biases that wander.
struct Wander;

impl Block for Wander {
    type Dynamics = Strapdown;
    type View<'a, T: Real> = BlockView<'a, Self, T>;
    const NAME: &'static str = "wander";
    const DIM: usize = 3;
    const RELAXATIONS: &'static [(usize, Relaxation<f64>)] = &[(0, FORGETS), (1, FORGETS), (2, FORGETS)];

    fn states(visit: &mut dyn FnMut(StateInfo)) {
        for component in ["x", "y", "z"] {
            visit(StateInfo {
                block: Self::NAME,
                component,
                unit: "m/s^2",
                prior_sigma: PRIOR,
                sheet_unit: "ug",
                sheet_scale: 9.80665e-6,
            });
        }
    }

    fn input_jacobian<T: Real>(_: &Signals<T>, put: &mut impl FnMut(usize, usize, T)) {
        for i in 0..3 {
            put(FORCE + i, i, T::one());
        }
    }
}

#[derive(StateBlocks)]
#[filter(measures(velocity, position))]
struct Wandering {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    wander: Wander,
}

type F = Wandering;
const N: usize = 12;

/// What the prediction does to a mean and a covariance, against the same as dense matrices.
fn predicted<C: Form>() {
    let mut numbers = Numbers(3);
    let mut sigmas = <F as Filter>::Shape::vector(0.0);
    let mut kalman = {
        (0..N).for_each(|i| sigmas[i] = 0.1 + 0.05 * i as f64);
        Kalman::<F, f64, C>::new(&sigmas)
    };
    let mut x = DVector::from_fn(N, |_, _| numbers.next());
    (0..N).for_each(|i| kalman.x_mut()[i] = x[i]);
    let mut p = DMatrix::from_fn(N, N, |i, j| if i == j { sigmas[i] * sigmas[i] } else { 0.0 });
    let mut density = <F as Filter>::Shape::core_vector(0.0);
    (0..9).for_each(|i| density[i] = 1e-4);
    for interval in [7.0, 40.0] {
        let mut transition = Transition::<F, f64>::new();
        for k in 0..10 {
            let at = point(&mut numbers);
            transition.absorb(&at, &signals(k as f64), 0.1 * interval);
            transition.advance(&at, 0.1 * interval);
        }
        assert!((transition.elapsed() - interval).abs() < 1e-9);
        kalman.predict(&transition, &density);
        let (rows, noise) = (transition.rows(), transition.noise(&density));
        let keep = (-interval / CORRELATION_TIME).exp();
        let f = DMatrix::from_fn(N, N, |i, j| match (i < 9, i == j) {
            (true, _) => rows[i][j],
            (false, true) => keep,
            _ => 0.0,
        });
        x = &f * x;
        p = &f * p * f.transpose();
        for i in 0..N {
            if i >= 9 {
                p[(i, i)] += STATIONARY * STATIONARY * (1.0 - keep * keep);
            }
            for j in 0..9 {
                if i < 9 {
                    p[(i, j)] += noise[i][j];
                }
            }
        }
        let found = kalman.covariance();
        for i in 0..N {
            assert!((kalman.x()[i] - x[i]).abs() < 1e-12 * x.amax(), "{i}");
            for j in 0..N {
                let scale = (p[(i, i)] * p[(j, j)]).sqrt();
                assert!(
                    (found[i][j] - p[(i, j)]).abs() < 1e-10 * scale,
                    "{i}, {j}: {} {}",
                    found[i][j],
                    p[(i, j)]
                );
            }
        }
    }
}

#[test]
fn a_prediction_fades_what_relaxes() {
    predicted::<Conventional>();
    predicted::<Ud>();
}

/// With a reference that says nothing, a parameter goes from its prior to its stationary size as time goes by.
fn forgotten<C: Form>() {
    let blind = ReferenceSigma { velocity: 1e6, position: 1e9, attitude: 1e3 };
    let setup = Setup { reference: blind, ..setup() };
    let mut run = Calibration::<F, C>::new(&setup).expect("a sound set-up");
    let still = setup.initial.attitude.inverse() * Vector3::new(0.0, 0.0, 9.794) * 0.01;
    let mut last = 0.0;
    for k in 0..=15_000 {
        let mut sample = sample(f64::from(k) * 0.01, Vector3::zeros(), still);
        sample.reference.velocity = Some(Vector3::zeros());
        sample.reference.position = Some(Vector3::zeros());
        if run.step(&sample).expect("the run converges").is_some() {
            last = sample.time;
        }
    }
    assert!(last > 149.0, "{last}");
    let fade = (-2.0 * last / CORRELATION_TIME).exp();
    let by_hand = (STATIONARY * STATIONARY * (1.0 - fade) + PRIOR * PRIOR * fade).sqrt();
    let mut count = 0;
    run.parameters(&mut |p| {
        count += 1;
        assert!((p.sigma / by_hand - 1.0).abs() < 1e-3, "{} {by_hand}", p.sigma);
        assert!(p.value.abs() < 1e-6, "{}", p.value);
    });
    assert_eq!(count, 3);
}

#[test]
fn a_calibration_forgets_what_relaxes() {
    forgotten::<Conventional>();
    forgotten::<Ud>();
}
