//! The accumulated rows `[Phi Psi]` against finite differences of the nonlinear mechanisation over an interval.

mod common;

use calib_core::{Filter, Kalman, Shape};
use common::{Numbers, setup, signals};
use nalgebra::{UnitQuaternion, Vector3};
use sinscal::strapdown::{Before, Increments, NavigationState};
use sinscal::{Point, Sins43B, Transition, earth, input_errors};

const RATE: f64 = 200.0;
const SECONDS: f64 = 1.0;
type F = Sins43B;
type State = [f64; F::DIM];

/// Runs the nonlinear mechanisation from `start` with sensors whose errors are `errors` (SI, truth of the parameters), and
/// returns the navigation solutions.
fn run(
    start: &NavigationState<f64>,
    errors: &State,
    mut each: impl FnMut(usize, &NavigationState<f64>),
) -> NavigationState<f64> {
    let mut state = *start;
    let mut before = Before::nothing();
    let dt = 1.0 / RATE;
    for k in 0..(SECONDS * RATE) as usize {
        // increments by Simpson's rule of true signal and error
        let mut now = Increments::zero();
        for (t, weight) in [(0.0, 1.0 / 6.0), (0.5, 4.0 / 6.0), (1.0, 1.0 / 6.0)] {
            let s = signals((k as f64 + t) * dt);
            let (rate, force) = input_errors::<F, f64>(&s, errors);
            now.dtheta += (s.rate + rate) * (weight * dt);
            now.dvel += (s.force + force) * (weight * dt);
        }
        if k == 0 {
            before.follow(&now);
        }
        each(k, &state);
        state.step(&now, &mut before, dt);
    }
    state
}

/// Errors `computed - true` of a navigation solution, as the leading states define them.
fn difference(computed: &NavigationState<f64>, truth: &NavigationState<f64>) -> [f64; 9] {
    let phi = -(computed.attitude * truth.attitude.inverse()).scaled_axis();
    let dv = computed.velocity - truth.velocity;
    let (meridian, prime_vertical) = earth::radii(truth.latitude);
    let dp = Vector3::new(
        (computed.longitude - truth.longitude) * (prime_vertical + truth.height) * truth.latitude.cos(),
        (computed.latitude - truth.latitude) * (meridian + truth.height),
        computed.height - truth.height,
    );
    [phi.x, phi.y, phi.z, dv.x, dv.y, dv.z, dp.x, dp.y, dp.z]
}

/// The largest error of the rows against the derivative of the mechanisation, relative to the largest entry of the same
/// column among the rows of one kind (attitude, velocity, position), with `samples` to a step of the leading dynamics.
fn worst_error(samples: usize) -> f64 {
    let mut numbers = Numbers(11);
    let site = setup().site;
    let mut start = NavigationState::at_rest(&site, UnitQuaternion::new(numbers.vector(2.0)));
    start.velocity = numbers.vector(3.0);

    // the rows, accumulated as the calibration does: a step of the leading dynamics every few samples
    let dt = 1.0 / RATE;
    let mut transition = Transition::<F, f64>::new();
    let (mut step, mut velocity_n) = (0.0, Vector3::zeros());
    let truth = run(&start, &[0.0; F::DIM], |k, state| {
        let s = signals((k as f64 + 0.5) * dt);
        let c = state.c_bn();
        let c_bn = c + c * (s.rate * dt).cross_matrix() * 0.5;
        velocity_n += c_bn * s.force * dt;
        step += dt;
        let at = Point {
            c_bn,
            velocity: state.velocity,
            latitude: state.latitude,
            height: state.height,
            position: Vector3::zeros(),
            force_n: velocity_n / step,
            rate_eb: s.rate,
            lever: Vector3::zeros(),
            point_velocity: state.velocity,
            point_acceleration: Vector3::zeros(),
            point_position: Vector3::zeros(),
            ..Point::default()
        };
        transition.absorb(&at, &s, dt);
        if (k + 1) % samples == 0 {
            transition.advance(&at, step);
            (step, velocity_n) = (0.0, Vector3::zeros());
        }
    });

    let mut worst = 0.0_f64;
    for j in 0..F::DIM {
        let end = |sign: f64| {
            let mut changed = start;
            let mut errors = [0.0; F::DIM];
            let size = if j < 9 { [1e-4, 1e-2, 1.0][j / 3] } else { 1e-3 } * sign;
            if j < 9 {
                let mut error = [0.0; 9];
                error[j] = -size;
                let [a, b, c, d, e, f, g, h, i] = error;
                changed.correct(&Vector3::new(a, b, c), &Vector3::new(d, e, f), &Vector3::new(g, h, i));
            } else {
                errors[j] = size;
            }
            (size, difference(&run(&changed, &errors, |_, _| ()), &truth))
        };
        let ((size, up), (_, down)) = (end(1.0), end(-1.0));
        let rows = transition.rows();
        let derivative: [f64; 9] = std::array::from_fn(|i| (up[i] - down[i]) / (2.0 * size));
        for i in 0..9 {
            let kind = i / 3 * 3;
            let scale = (kind..kind + 3).fold(0.0_f64, |scale, i| scale.max(derivative[i].abs()));
            // attitude by accelerometer parameters, through the transport rate: 1e-6 rad per m/s^2, known to half a sample
            if scale > 1e-4 {
                worst = worst.max((rows[i][j] - derivative[i]).abs() / scale);
            } else {
                assert!(
                    rows[i][j].abs() < 1e-5,
                    "row {i}, column {j} should be negligible: {:e}",
                    rows[i][j]
                );
            }
        }
    }
    worst
}

#[test]
fn rows_are_the_derivative_of_the_mechanisation() {
    // 40 deg/s: steps of 5 ms turn the body by 0.2 deg, steps of 20 ms by 0.8 deg
    let (fine, coarse) = (worst_error(1), worst_error(4));
    assert!(fine < 2e-4, "{fine:e}");
    assert!(coarse < 6e-4, "{coarse:e}");
}

/// Below the rows of the leading states there are none: parameters and what is known of them stay to the bit.
#[test]
fn parameters_below_the_rows_stay() {
    let core = <<F as Filter>::Shape as Shape>::CORE;
    let mut numbers = Numbers(5);
    let mut kalman = Kalman::<F>::new(&Kalman::<F>::prior());
    (0..F::DIM).for_each(|i| kalman.x_mut()[i] = numbers.next());
    let mut transition = Transition::<F, f64>::new();
    for k in 0..5 {
        let at = common::point(&mut numbers);
        transition.absorb(&at, &signals(f64::from(k)), 0.1);
        transition.advance(&at, 0.1);
    }
    let (x, p) = (*kalman.x(), kalman.covariance());
    kalman.predict(&transition, &<F as Filter>::Shape::core_vector(1e-6));
    let after = kalman.covariance();
    for i in core..F::DIM {
        assert_eq!(kalman.x()[i].to_bits(), x[i].to_bits());
        assert!((core..F::DIM).all(|j| after[i][j].to_bits() == p[i][j].to_bits()));
    }
    // and the leading states do not stay
    assert!((0..core).all(|i| kalman.x()[i] != x[i] && after[i][i] > p[i][i]));
}
