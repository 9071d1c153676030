//! A filter in `f32`, from its Jacobians to its covariance, for days: what an embedded user may expect of it.

use nalgebra::{Matrix3, Rotation3, Vector3};
use sinscal::{
    Conventional, Form, Kalman, OpenBlocks, Point, Real, Residuals, Signals, Sins43B, Transition, Ud, earth,
};

type F = Sins43B;

/// Samples between two updates, which come once a second.
const SAMPLES: u32 = 10;
/// Rates of heading, pitch and roll, rad/s: a slow tumbling that turns every axis to gravity and never repeats.
const RATES: [f64; 3] = [0.031, 0.047, 0.073];
/// Standard deviations of the leading states at the beginning, as in a calibration; the parameters have their priors.
const START: [f64; 9] = [5e-4, 5e-4, 2e-3, 0.5, 0.5, 0.5, 10.0, 10.0, 10.0];

/// Attitude, and the rate over ground in b, `t` seconds into the run.
fn motion(t: f64) -> (Matrix3<f64>, Vector3<f64>) {
    let [heading, pitch, roll] = RATES.map(|rate| rate * t);
    let c_bn = Rotation3::from_euler_angles(roll, pitch, heading).into_inner();
    let about_z = c_bn.transpose() * Vector3::z() * RATES[0];
    let rest = Vector3::new(RATES[2], RATES[1] * roll.cos(), -RATES[1] * roll.sin());
    (c_bn, about_z + rest)
}

/// Where the filter is linearised and what its sensors feel, in the scalar it computes with.
fn instant<T: Real + Default>(t: f64) -> (Point<T>, Signals<T>) {
    let (c_bn, rate_eb) = motion(t);
    let (latitude, height) = (0.56, 20.0);
    let gravity = Vector3::z() * earth::gravity(latitude, height);
    let warm = 5.0 + 4.0 * (t / 3600.0).sin();
    let of = |v: Vector3<f64>| v.map(T::of);
    let lever = Vector3::new(0.2, 0.1, -0.1);
    let point = Point {
        c_bn: c_bn.map(T::of),
        velocity: Vector3::zeros(),
        latitude: T::of(latitude),
        height: T::of(height),
        position: Vector3::zeros(),
        force_n: of(gravity),
        rate_eb: of(rate_eb),
        lever: of(lever),
        point_velocity: of(c_bn * rate_eb.cross(&lever)),
        point_acceleration: of(c_bn * rate_eb.cross(&rate_eb.cross(&lever))),
        point_position: of(c_bn * lever),
        open: OpenBlocks::NONE,
    };
    let signals = Signals {
        rate: of(rate_eb + c_bn.transpose() * earth::rotation_n(latitude)),
        angular_acceleration: Vector3::zeros(),
        force_rate: Vector3::zeros(),
        force: of(c_bn.transpose() * gravity),
        temperature: of(Vector3::new(warm, warm + 2.0, warm - 1.0)),
        temperature_rate: Vector3::zeros(),
        gyro_temperature: of(Vector3::repeat(warm)),
        dither: of(Vector3::repeat(3e-3)),
        coupled_dither: of(Vector3::repeat(3e-3)),
        time: T::of(t),
        ..Signals::default()
    };
    (point, signals)
}

/// One filter: what it is made of does not leave its scalar.
struct Run<T: Real + Default, C: Form> {
    kalman: Kalman<F, T, C>,
    transition: Transition<F, T>,
}

impl<T: Real + Default, C: Form> Run<T, C> {
    fn new() -> Self {
        let mut prior = Kalman::<F, T, C>::prior();
        for (i, sigma) in START.iter().enumerate() {
            prior[i] = T::of(*sigma);
        }
        Self { kalman: Kalman::new(&prior), transition: Transition::new() }
    }

    /// One second and its update; `false` when the innovation covariance is no longer positive definite.
    fn second(&mut self, second: u32) -> bool {
        let dt = T::of(1.0 / f64::from(SAMPLES));
        for k in 0..SAMPLES {
            let (at, signals) = instant::<T>(f64::from(second) + (f64::from(k) + 0.5) / f64::from(SAMPLES));
            self.transition.absorb(&at, &signals, dt);
            self.transition.advance(&at, dt);
        }
        let density = [1e-13, 1e-13, 1e-13, 2.5e-9, 2.5e-9, 2.5e-9, 0.0, 0.0, 0.0].map(T::of);
        self.kalman.predict(&self.transition, &density);
        self.transition.reset();
        let (at, signals) = instant::<T>(f64::from(second + 1));
        let mut residuals = Residuals::<F, T>::default();
        for row in 0..6 {
            residuals.set(row, T::zero(), T::of(if row < 3 { 1e-3 } else { 2e-3 }));
        }
        self.kalman.update(&at, &signals, residuals, None).is_ok()
    }

    fn sigmas(&self) -> [T; F::DIM] {
        core::array::from_fn(|i| self.kalman.sigma(i))
    }

    /// Whether P is positive definite, judged in `f64`.
    fn is_definite(&self) -> bool {
        let p = self.kalman.covariance();
        let entry = |i: usize, j: usize| {
            let scale = p[i][i].to_subset().unwrap_or(f64::NAN) * p[j][j].to_subset().unwrap_or(f64::NAN);
            p[i][j].to_subset().unwrap_or(f64::NAN) / scale.sqrt()
        };
        nalgebra::DMatrix::from_fn(F::DIM, F::DIM, entry).cholesky().is_some()
    }
}

/// What came of some hours.
#[derive(Debug)]
struct Found {
    /// Largest relative error of a variance of the `f32` UD form against the `f64` UD form, over all minutes and states.
    ud: f64,
    /// The same of the `f64` conventional form.
    conventional: f64,
    /// When the conventional form in `f32` was first found indefinite, s.
    lost: Option<u32>,
}

fn compare(minutes: u32) -> Found {
    let mut double = Run::<f64, Ud>::new();
    let mut conventional = Run::<f64, Conventional>::new();
    let mut single = Run::<f32, Ud>::new();
    let mut other = Run::<f32, Conventional>::new();
    let mut found = Found { ud: 0.0, conventional: 0.0, lost: None };
    for second in 0..60 * minutes {
        assert!(double.second(second) && conventional.second(second), "f64 at {second} s");
        assert!(single.second(second), "f32, UD, at {second} s");
        if found.lost.is_none() && !other.second(second) {
            found.lost = Some(second);
        }
        if (second + 1) % 60 != 0 {
            continue;
        }
        if found.lost.is_none() && !other.is_definite() {
            found.lost = Some(second);
        }
        let (want, ud, f64_form) = (double.sigmas(), single.sigmas(), conventional.sigmas());
        for i in 0..F::DIM {
            assert!(ud[i] > 0.0, "state {i} at {second} s");
            let error = |sigma: f64| ((sigma / want[i]).powi(2) - 1.0).abs();
            found.ud = found.ud.max(error(ud[i].into()));
            found.conventional = found.conventional.max(error(f64_form[i]));
        }
    }
    found
}

#[test]
fn a_quarter_of_an_hour_in_single_precision_stays_close() {
    let found = compare(15);
    assert!(found.ud < 1e-3, "{found:?}");
    assert!(found.conventional < 1e-8, "{found:?}");
}

/// Half a minute in a release build: `cargo test --release --test single_precision -- --ignored --nocapture`.
#[test]
#[ignore = "48 hours of updates; run with `cargo test --release --test single_precision -- --ignored --nocapture`"]
fn two_days_in_single_precision() {
    let found = compare(48 * 60);
    println!("48 h, 1 Hz: {found:?}");
    assert!(found.ud < 1e-2, "{found:?}");
    assert!(found.lost.is_some(), "{found:?}");
}
