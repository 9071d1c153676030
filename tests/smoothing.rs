//! The smoother against the textbook: gains from stored dense covariances.

mod common;

use calib_core::{Form, Matrix};
use common::{Numbers, sample, setup, signals};
use nalgebra::{DMatrix, DVector, SMatrix, SVector, Vector3};
use sinscal::strapdown::{Before, Increments, NavigationState};
use sinscal::{Calibration, Conventional, Event, Observer, Sins36P, Smoother};

type F = Sins36P;
const N: usize = F::DIM;

/// One prediction, as dense matrices, and what the update after it did.
struct Step {
    transition: DMatrix<f64>,
    predicted: DMatrix<f64>,
    change: DVector<f64>,
    navigation: Option<NavigationState<f64>>,
}

/// Remembers everything.
#[derive(Default)]
struct Textbook {
    steps: Vec<Step>,
    transition: Option<DMatrix<f64>>,
}

impl Observer<F> for Textbook {
    fn observe<C: Form>(&mut self, event: Event<'_, F, C>) {
        match event {
            Event::Predicted { transition, .. } => {
                let rows = transition.rows();
                let entry = |i: usize, j: usize| if i < 9 { rows[i][j] } else { f64::from(u8::from(i == j)) };
                self.transition = Some(DMatrix::from_fn(N, N, entry));
            }
            Event::Moved(kalman) => {
                let p = kalman.covariance();
                self.steps.push(Step {
                    transition: self.transition.take().expect("a prediction came first"),
                    predicted: DMatrix::from_fn(N, N, |i, j| p[i][j]),
                    change: DVector::zeros(N),
                    navigation: None,
                });
            }
            Event::Updated { change, navigation, .. } => {
                if let Some(step) = self.steps.last_mut() {
                    step.change = DVector::from_fn(N, |i, _| change[i]);
                    step.navigation = Some(*navigation);
                }
            }
            _ => {}
        }
    }
}

type Both = (Textbook, Smoother<F>);

fn run(pass_two: bool) -> (Both, Vec<DMatrix<f64>>, Matrix<F, f64>) {
    let setup = setup();
    let mut calibration = Calibration::<F, Conventional>::new(&setup).expect("a sound setup");
    let mut filtered = Vec::new();
    let mut both = Both::default();
    for pass in 0..=usize::from(pass_two) {
        if pass > 0 {
            calibration.begin_pass();
        }
        let mut numbers = Numbers(17);
        both = Both::default();
        filtered.clear();
        let mut truth = NavigationState::at_rest(&setup.site, setup.initial.attitude);
        let mut before = Before::nothing();
        for k in 0..2000 {
            let time = f64::from(k) * 0.01;
            let mut now = signals(time);
            now.force = truth.attitude.inverse() * Vector3::new(0.0, 0.0, 9.79);
            let increments = Increments { dtheta: now.rate * 0.01, dvel: now.force * 0.01 };
            if k > 0 {
                truth.step(&increments, &mut before, 0.01);
            } else {
                before.follow(&increments);
            }
            let mut sample = sample(
                time,
                increments.dtheta + numbers.vector(3e-8),
                increments.dvel + numbers.vector(5e-6) + Vector3::repeat(1e-5),
            );
            sample.reference.velocity = Some(truth.velocity + numbers.vector(1e-3));
            sample.reference.position = Some(truth.position(&setup.site) + numbers.vector(2e-3));
            calibration.step_observed(&sample, &mut both).expect("the run converges");
            if both.0.steps.len() > filtered.len() {
                let p = calibration.covariance();
                filtered.push(DMatrix::from_fn(N, N, |i, j| p[i][j]));
            }
        }
    }
    (both, filtered, calibration.covariance())
}

fn smoothed_as_in_the_textbook(pass_two: bool) {
    let (both, filtered, last) = run(pass_two);
    let steps = &both.0.steps;
    let mut s = DVector::<f64>::zeros(N);
    let mut p = DMatrix::from_fn(N, N, |i, j| last[i][j]);
    let mut expected = Vec::new();
    for k in (0..steps.len()).rev() {
        let Step { transition, predicted, change, navigation } = &steps[k];
        if let Some(mut navigation) = *navigation {
            let part = |i: usize| Vector3::new(s[i], s[i + 1], s[i + 2]);
            navigation.correct(&part(0), &part(3), &part(6));
            expected.push((navigation, p.diagonal().map(f64::sqrt)));
        }
        if k > 0 {
            // scaled, since variances span twenty decades
            let d = DMatrix::from_diagonal(&predicted.diagonal().map(|v| 1.0 / v.sqrt()));
            let inverse = &d * (&d * predicted * &d).try_inverse().expect("definite") * &d;
            let gain = &filtered[k - 1] * transition.transpose() * inverse;
            s = &gain * (s + change);
            p = &filtered[k - 1] + &gain * (p - predicted) * gain.transpose();
        }
    }
    expected.reverse();
    let smoothed = both.1.finish(&last).expect("memory");
    assert_eq!(smoothed.len(), expected.len());
    for (got, (want, sigmas)) in smoothed.iter().zip(&expected) {
        assert!(got.navigation.attitude.angle_to(&want.attitude) < 1e-9, "{} s", got.time);
        assert!((got.navigation.velocity - want.velocity).norm() < 1e-8, "{} s", got.time);
        assert!((got.navigation.height - want.height).abs() < 1e-7, "{} s", got.time);
        for (i, sigma) in got.sigmas().into_iter().enumerate() {
            assert!(
                (sigma / sigmas[i] - 1.0).abs() < 1e-3,
                "{} s, state {i}: {sigma} {}",
                got.time,
                sigmas[i]
            );
        }
    }
}

#[test]
fn a_closed_loop_is_smoothed_as_in_the_textbook() {
    smoothed_as_in_the_textbook(false);
}

#[test]
fn a_pass_with_held_parameters_is_smoothed_as_in_the_textbook() {
    smoothed_as_in_the_textbook(true);
}

/// Over simulated units: the smoothed solution is never less certain than the filtered one, and its errors are those that its
/// covariance says.
#[test]
fn smoothed_errors_are_those_that_the_covariance_says() {
    let scenario = rig::Scenario::parse("[motion]\nstill = \"60 s\"\ndwell = \"20 s\"").expect("a scenario");
    let scenario = scenario.modelled_by::<F>();
    let units = 25;
    let times = [30.0, 140.0, 300.0, 500.0];
    let (mut smoothed_nees, mut filtered_nees) = ([0.0; 4], [0.0; 4]);
    for unit in 1..=units {
        let simulation = rig::Simulation::new(&scenario, unit).expect("a unit");
        let setup = simulation.description().setup(&[]);
        let mut calibration = Calibration::<F>::new(&setup).expect("a sound setup");
        let mut smoother: Smoother<F> = Smoother::default();
        let mut filtered = Vec::new();
        for pass in 0..2 {
            if pass > 0 {
                calibration.begin_pass();
            }
            for sample in simulation.clone() {
                if pass == 0 {
                    calibration.step(&sample).expect("no divergence");
                } else if let Some(update) =
                    calibration.step_observed(&sample, &mut smoother).expect("no divergence")
                {
                    let p = calibration.covariance();
                    let p: SMatrix<f64, 9, 9> = SMatrix::from_fn(|i, j| p[i][j]);
                    filtered.push((update.time, calibration.navigation(), p));
                }
            }
        }
        let smoothed = smoother.finish(&calibration.covariance()).expect("memory");
        let nees = |time: f64, navigation: &NavigationState<f64>, p: &SMatrix<f64, 9, 9>| {
            let (position, velocity) = simulation.position(time);
            let truth = simulation.motion(time).0.attitude();
            // C_hat = (I - [phi x]) C
            let phi = -(navigation.attitude * truth.inverse()).scaled_axis();
            let dp = navigation.position(&setup.site) - position;
            let dv = navigation.velocity - velocity;
            let error = SVector::<f64, 9>::from_iterator(phi.iter().chain(&dv).chain(&dp).copied());
            let scale = SMatrix::<f64, 9, 9>::from_diagonal(&p.diagonal().map(|v| 1.0 / v.sqrt()));
            let scaled = scale * error;
            scaled.dot(&(scale * p * scale).cholesky().expect("definite").solve(&scaled)) / 9.0
        };
        // the first update comes before any prediction
        for (got, (time, navigation, p)) in smoothed.iter().zip(&filtered[1..]) {
            assert_eq!(got.time, *time);
            for (i, sigma) in got.sigmas().into_iter().enumerate() {
                assert!(sigma <= p[(i, i)].sqrt() * (1.0 + 1e-6), "unit {unit}, {time} s, state {i}");
            }
            if let Some(k) = times.iter().position(|wanted| (time - wanted).abs() < 0.3) {
                smoothed_nees[k] += nees(*time, &got.navigation, &got.covariance) / units as f64;
                filtered_nees[k] += nees(*time, navigation, p) / units as f64;
            }
        }
    }
    println!("NEES per degree of freedom: smoothed {smoothed_nees:.3?}, filtered {filtered_nees:.3?}");
    // 99.9 % of chi-square with 225 degrees of freedom
    assert!(smoothed_nees.iter().all(|nees| (0.718..1.340).contains(nees)), "{smoothed_nees:?}");
}
