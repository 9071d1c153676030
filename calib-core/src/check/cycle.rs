//! One cycle of a declared filter against the same with dense matrices: for a benchmark, which nothing is worth whose results
//! differ.

use nalgebra::DMatrix;

use super::Mismatch;
use crate::{
    Array, Conventional, Dynamics, Entries, Fade, Filter, Form, Kalman, Matrix, MeasurementRows,
    MeasurementVector, Shape, Transition, Ud, Vector, measurement_rows, relaxations,
};

/// Cycles until everything is correlated, and cycles more until two covariances are compared.
const CYCLES: u32 = 10;
/// Cycles in a row before a routine of [`bench`] begins again.
const IN_A_ROW: u32 = 100;
/// Two covariances are the same when every entry differs by less than this part of its standard deviations.
const SAME: f64 = 1e-9;

/// Times one cycle of filter `F`, propagation over an interval and update with every measurement, in both forms of the
/// covariance, and with dense matrices of nalgebra in the shortest form, `(I - K H) P`.
///
/// The interval is a second at `at` and `signals`, which should be typical: with a rate of zero much of a Jacobian vanishes. Noise
/// and measurements are made to the priors of the blocks, so that every block counts. `time(name, routine)` times a
/// routine; each of its calls is one cycle. With criterion:
///
/// ```text
/// check::bench::<MyUnit>(&at, &signals, &mut |name, routine| {
///     criterion.bench_function(name, |b| b.iter(&mut *routine));
/// })
/// .expect("three equal covariances");
/// ```
///
/// # Errors
/// Before anything is timed: an entry of the covariance after ten cycles that is not that of the dense matrices.
pub fn bench<F: Filter>(
    at: &<F::Dynamics as Dynamics>::Point<f64>,
    signals: &<F::Dynamics as Dynamics>::Signals<f64>,
    time: &mut dyn FnMut(&str, &mut dyn FnMut()),
) -> Result<(), Mismatch> {
    let cycle = Cycle::<F>::new(at, signals);
    let mut dense = Dense::new(&cycle);
    dense.repeat();
    let (conventional, ud) = (cycle.start::<Conventional>(), cycle.start::<Ud>());
    let start = dense.p.clone();
    dense.repeat();
    cycle.check::<Conventional>(&conventional, &dense.p)?;
    cycle.check::<Ud>(&ud, &dense.p)?;
    cycle.time::<Conventional>("conventional", &conventional, time);
    cycle.time::<Ud>("UD", &ud, time);
    let mut done = IN_A_ROW;
    time("nalgebra, dynamic, (I - K H) P", &mut || {
        if done == IN_A_ROW {
            dense.p.copy_from(&start);
            done = 0;
        }
        dense.cycle();
        done += 1;
    });
    Ok(())
}

/// An interval and its measurements.
struct Cycle<F: Filter> {
    transition: Transition<F, f64>,
    noise: <F::Shape as Shape>::CoreMatrix<f64>,
    h: MeasurementRows<F, f64>,
    r: MeasurementVector<F, f64>,
}

impl<F: Filter> Cycle<F> {
    fn new(
        at: &<F::Dynamics as Dynamics>::Point<f64>,
        signals: &<F::Dynamics as Dynamics>::Signals<f64>,
    ) -> Self {
        let mut transition = Transition::new();
        for _ in 0..10 {
            transition.absorb(at, signals, 0.1);
            transition.advance(at, 0.1);
        }
        let prior = variances::<F>();
        let mut density = F::Shape::core_vector(0.0);
        for i in 0..F::Shape::CORE {
            density[i] = 1e-4 * prior[i];
        }
        let h = measurement_rows::<F, f64>(at, signals);
        let mut r = F::Shape::measurement(1.0);
        for m in 0..F::Shape::ROWS {
            let variance: f64 = (0..F::Shape::STATES).map(|j| h[m][j] * h[m][j] * prior[j]).sum();
            r[m] = if variance > 0.0 { 0.1 * variance } else { 1.0 };
        }
        let noise = transition.noise(&density);
        Self { transition, noise, h, r }
    }

    /// A covariance in which everything is correlated.
    fn start<C: Form>(&self) -> Matrix<F, f64> {
        let mut cov = F::Shape::matrix(0.0);
        C::set_diagonal::<F::Shape, f64>(&mut cov, &variances::<F>());
        for _ in 0..CYCLES {
            self.run::<C>(&mut cov);
        }
        cov
    }

    fn run<C: Form>(&self, cov: &mut Matrix<F, f64>) {
        let (mut x, z) = (F::Shape::vector(0.0), F::Shape::measurement(0.0));
        C::propagate::<F::Shape, f64>(cov, self.transition.rows(), &self.noise);
        relaxations::<F, f64>(|state, relaxation| {
            C::fade::<F::Shape, f64>(cov, &Fade::over(relaxation, state, self.transition.elapsed()));
        });
        core::hint::black_box(C::update::<F::Shape, f64>(cov, &mut x, &self.h, &self.r, &z));
    }

    fn check<C: Form>(&self, start: &Matrix<F, f64>, want: &DMatrix<f64>) -> Result<(), Mismatch> {
        let (mut moved, mut p) = (start.clone(), F::Shape::matrix(0.0));
        for _ in 0..CYCLES {
            self.run::<C>(&mut moved);
        }
        C::dense::<F::Shape, f64>(&moved, &mut p);
        for row in 0..F::Shape::STATES {
            for column in 0..F::Shape::STATES {
                let (found, expected) = (p.entry(row, column), want[(row, column)]);
                let scale = (want[(row, row)] * want[(column, column)]).sqrt();
                let relative = if found == expected { 0.0 } else { (found - expected).abs() / scale };
                if !(relative <= SAME) {
                    return Err(Mismatch { row, column, found, expected, relative });
                }
            }
        }
        Ok(())
    }

    fn time<C: Form>(
        &self,
        name: &str,
        start: &Matrix<F, f64>,
        time: &mut dyn FnMut(&str, &mut dyn FnMut()),
    ) {
        let (mut cov, mut done) = (start.clone(), 0);
        time(name, &mut || {
            if done == IN_A_ROW {
                cov.clone_from(start);
                done = 0;
            }
            self.run::<C>(&mut cov);
            done += 1;
        });
    }
}

/// The blocks' prior variances.
fn variances<F: Filter>() -> Vector<F, f64> {
    let mut variances = Kalman::<F>::prior();
    variances.as_mut_slice().iter_mut().for_each(|sigma| *sigma *= *sigma);
    variances
}

/// The same in matrices that know nothing of structure.
struct Dense {
    f: DMatrix<f64>,
    q: DMatrix<f64>,
    h: DMatrix<f64>,
    r: DMatrix<f64>,
    p: DMatrix<f64>,
}

impl Dense {
    fn new<F: Filter>(cycle: &Cycle<F>) -> Self {
        let (n, c, m) = (F::Shape::STATES, F::Shape::CORE, F::Shape::ROWS);
        let rows = cycle.transition.rows();
        let prior = variances::<F>();
        let mut dense = Self {
            f: DMatrix::from_fn(n, n, |i, j| if i < c { rows[i][j] } else { f64::from(u8::from(i == j)) }),
            q: DMatrix::from_fn(n, n, |i, j| if i < c && j < c { cycle.noise[i][j] } else { 0.0 }),
            h: DMatrix::from_fn(m, n, |i, j| cycle.h[i][j]),
            r: DMatrix::from_fn(m, m, |i, j| if i == j { cycle.r[i] } else { 0.0 }),
            p: DMatrix::from_fn(n, n, |i, j| if i == j { prior[i] } else { 0.0 }),
        };
        relaxations::<F, f64>(|state, relaxation| {
            let fade = Fade::over(relaxation, state, cycle.transition.elapsed());
            dense.f[(state, state)] = fade.keep;
            dense.q[(state, state)] = fade.variance;
        });
        dense
    }

    fn repeat(&mut self) {
        for _ in 0..CYCLES {
            self.cycle();
        }
    }

    fn cycle(&mut self) {
        let Self { f, q, h, r, p } = self;
        *p = &*f * &*p * f.transpose() + &*q;
        let pht = &*p * h.transpose();
        let (rows, s) = (r.nrows(), &*h * &pht + &*r);
        // R is positive, so there is an inverse; were there none, the comparison would see it
        let inverse = s.try_inverse().unwrap_or_else(|| DMatrix::from_element(rows, rows, f64::NAN));
        let k = pht * inverse;
        *p = (DMatrix::identity(p.nrows(), p.ncols()) - &k * &*h) * &*p;
    }
}
