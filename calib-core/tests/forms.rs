//! Both covariance forms against a slow dense oracle, on random filters of several shapes.

use calib_core::{Conventional, Dim, Fade, Form, Relaxation, Shape, Ud};
use nalgebra::DMatrix;

/// A small linear congruential generator: the tests need numbers, not statistics.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// A random filter of shape `S`, one step of it, and the same as dense matrices.
struct Case<S: Shape> {
    rows: S::CoreRows<f64>,
    noise: S::CoreMatrix<f64>,
    h: S::MeasurementRows<f64>,
    r: S::Measurement<f64>,
    z: S::Measurement<f64>,
    start: S::Vector<f64>,
    x: S::Vector<f64>,
}

impl<S: Shape> Case<S> {
    fn new(numbers: &mut Numbers) -> Self {
        let mut case = Self {
            rows: S::core_rows(0.0),
            noise: S::core_matrix(0.0),
            h: S::measurement_rows(0.0),
            r: S::measurement(0.0),
            z: S::measurement(0.0),
            start: S::vector(0.0),
            x: S::vector(0.0),
        };
        let root = DMatrix::from_fn(S::CORE, S::CORE, |_, _| numbers.next());
        let noise = &root * root.transpose();
        for i in 0..S::CORE {
            for j in 0..S::STATES {
                case.rows[i][j] = numbers.next() + if i == j { 1.0 } else { 0.0 };
            }
            for j in 0..S::CORE {
                case.noise[i][j] = noise[(i, j)];
            }
        }
        for m in 0..S::ROWS {
            // every third state is not seen at all
            for j in (0..S::STATES).filter(|j| j % 3 != 2) {
                case.h[m][j] = numbers.next();
            }
            case.r[m] = numbers.next().abs() + 0.1;
            case.z[m] = numbers.next();
        }
        for j in 0..S::STATES {
            case.start[j] = numbers.next().abs() + 0.5;
            case.x[j] = numbers.next();
        }
        case
    }

    fn transition(&self) -> DMatrix<f64> {
        DMatrix::from_fn(S::STATES, S::STATES, |i, j| {
            if i < S::CORE { self.rows[i][j] } else { f64::from(u8::from(i == j)) }
        })
    }

    fn noise(&self) -> DMatrix<f64> {
        DMatrix::from_fn(S::STATES, S::STATES, |i, j| {
            if i < S::CORE && j < S::CORE { self.noise[i][j] } else { 0.0 }
        })
    }

    fn h(&self) -> DMatrix<f64> {
        DMatrix::from_fn(S::ROWS, S::STATES, |i, j| self.h[i][j])
    }
}

fn dense<S: Shape, C: Form>(cov: &S::Matrix<f64>) -> DMatrix<f64> {
    let mut p = S::matrix(0.0);
    C::dense::<S, f64>(cov, &mut p);
    DMatrix::from_fn(S::STATES, S::STATES, |i, j| p[i][j])
}

fn assert_close(what: &str, got: &DMatrix<f64>, want: &DMatrix<f64>) {
    let error = (got - want).amax() / want.amax();
    assert!(error < 1e-12, "{what}: relative error {error:e}");
}

/// Several cycles of `C` on shape `S` beside the oracle: propagate, fade, update by Joseph's formula.
fn follows_the_oracle<S: Shape, C: Form>(seed: u64) {
    let mut numbers = Numbers(seed);
    let case = Case::<S>::new(&mut numbers);
    let mut cov = S::matrix(0.0);
    C::set_diagonal::<S, f64>(&mut cov, &case.start);
    let mut p = DMatrix::from_diagonal(&nalgebra::DVector::from_fn(S::STATES, |i, _| case.start[i]));
    assert_close("start", &dense::<S, C>(&cov), &p);
    for cycle in 0..4 {
        let case = Case::<S>::new(&mut numbers);
        let f = case.transition();
        C::propagate::<S, f64>(&mut cov, &case.rows, &case.noise);
        p = &f * &p * f.transpose() + case.noise();
        assert_close("propagate", &dense::<S, C>(&cov), &p);

        let fade = Fade::over(Relaxation { rate: 0.3, density: 0.2 }, S::STATES - 1 - cycle % 2, 0.7);
        C::fade::<S, f64>(&mut cov, &fade);
        let mut f = DMatrix::identity(S::STATES, S::STATES);
        f[(fade.state, fade.state)] = fade.keep;
        p = &f * &p * f.transpose();
        p[(fade.state, fade.state)] += fade.variance;
        assert_close("fade", &dense::<S, C>(&cov), &p);

        let h = case.h();
        let projected = C::project::<S, f64>(&cov, &case.h);
        let hph = &h * &p * h.transpose();
        assert_close("project", &DMatrix::from_fn(S::ROWS, S::ROWS, |i, j| projected[i][j]), &hph);

        let mut x = case.x.clone();
        let whitened = C::update::<S, f64>(&mut cov, &mut x, &case.h, &case.r, &case.z).unwrap();
        let r = DMatrix::from_fn(S::ROWS, S::ROWS, |i, j| if i == j { case.r[i] } else { 0.0 });
        let s = hph + &r;
        let inverse = s.clone().try_inverse().unwrap();
        let gain = &p * h.transpose() * &inverse;
        let before = DMatrix::from_fn(S::STATES, 1, |i, _| case.x[i]);
        let residual = DMatrix::from_fn(S::ROWS, 1, |i, _| case.z[i]) - &h * &before;
        let rest = DMatrix::identity(S::STATES, S::STATES) - &gain * &h;
        p = &rest * &p * rest.transpose() + &gain * r * gain.transpose();
        assert_close("update of P", &dense::<S, C>(&cov), &p);
        let after = before + &gain * &residual;
        assert_close("update of x", &DMatrix::from_fn(S::STATES, 1, |i, _| x[i]), &after);
        let nis = (residual.transpose() * inverse * &residual)[(0, 0)];
        assert!((whitened.nis - nis).abs() < 1e-11 * nis, "nis {} for {nis}", whitened.nis);
        assert!((whitened.log_det - s.determinant().ln()).abs() < 1e-10);
        for i in 0..S::STATES {
            assert!((C::variance::<S, f64>(&cov, i) - p[(i, i)]).abs() < 1e-12 * p.amax());
        }
    }
}

#[test]
fn conventional_follows_the_oracle() {
    for seed in 0..20 {
        follows_the_oracle::<Dim<43, 9, 6>, Conventional>(seed);
        follows_the_oracle::<Dim<15, 9, 3>, Conventional>(seed);
        follows_the_oracle::<Dim<4, 2, 1>, Conventional>(seed);
        // columns that are computed twice begin among the leading ones
        follows_the_oracle::<Dim<22, 17, 4>, Conventional>(seed);
    }
}

#[test]
fn ud_follows_the_oracle() {
    for seed in 0..20 {
        follows_the_oracle::<Dim<43, 9, 6>, Ud>(seed);
        follows_the_oracle::<Dim<15, 9, 3>, Ud>(seed);
        follows_the_oracle::<Dim<4, 2, 1>, Ud>(seed);
        // columns that are computed twice begin among the leading ones
        follows_the_oracle::<Dim<22, 17, 4>, Ud>(seed);
    }
}

#[test]
fn conventional_is_symmetric_to_the_bit() {
    type S = Dim<43, 9, 6>;
    let mut numbers = Numbers(7);
    let case = Case::<S>::new(&mut numbers);
    let mut cov = S::matrix(0.0);
    Conventional::set_diagonal::<S, f64>(&mut cov, &case.start);
    for _ in 0..10 {
        let case = Case::<S>::new(&mut numbers);
        let mut x = case.x;
        Conventional::propagate::<S, f64>(&mut cov, &case.rows, &case.noise);
        Conventional::update::<S, f64>(&mut cov, &mut x, &case.h, &case.r, &case.z).unwrap();
        for i in 0..43 {
            for j in 0..i {
                assert_eq!(cov[i][j].to_bits(), cov[j][i].to_bits());
            }
        }
    }
}

/// A row of zeros is no measurement: nothing moves, whatever residual stands beside it.
fn absent_rows_change_nothing<C: Form>() {
    type S = Dim<15, 9, 3>;
    let mut numbers = Numbers(3);
    let mut case = Case::<S>::new(&mut numbers);
    let mut cov = S::matrix(0.0);
    C::set_diagonal::<S, f64>(&mut cov, &case.start);
    C::propagate::<S, f64>(&mut cov, &case.rows, &case.noise);
    let (before, x) = (cov, case.x);
    case.h = S::measurement_rows(0.0);
    case.z = S::measurement(0.0);
    let mut after = x;
    let whitened = C::update::<S, f64>(&mut cov, &mut after, &case.h, &case.r, &case.z).unwrap();
    assert_eq!((cov, after), (before, x));
    assert_eq!((whitened.nis, whitened.log_det), (0.0, 0.0));
}

#[test]
fn absent_rows_change_nothing_in_either_form() {
    absent_rows_change_nothing::<Conventional>();
    absent_rows_change_nothing::<Ud>();
}

#[test]
fn a_poisoned_update_is_refused() {
    type S = Dim<4, 2, 1>;
    let mut numbers = Numbers(5);
    let mut case = Case::<S>::new(&mut numbers);
    let mut cov = S::matrix(0.0);
    Conventional::set_diagonal::<S, f64>(&mut cov, &case.start);
    case.h[0][1] = f64::NAN;
    assert!(
        Conventional::update::<S, f64>(&mut cov, &mut case.x.clone(), &case.h, &case.r, &case.z).is_none()
    );
    Ud::set_diagonal::<S, f64>(&mut cov, &case.start);
    assert!(Ud::update::<S, f64>(&mut cov, &mut case.x, &case.h, &case.r, &case.z).is_none());
}

#[test]
fn a_fading_state_keeps_its_stationary_variance() {
    // first-order Gauss-Markov: variance q tau / 2 stays
    let relaxation = Relaxation::<f64> { rate: 1.0 / 300.0, density: 2.0 * 4.0 / 300.0 };
    let fade = Fade::over(relaxation, 0, 12.5);
    assert!((fade.keep * fade.keep * 4.0 + fade.variance - 4.0).abs() < 1e-14);
    let walk = Fade::over(Relaxation { rate: 0.0, density: 0.5 }, 0, 3.0);
    assert_eq!((walk.keep, walk.variance), (1.0, 1.5));
}
