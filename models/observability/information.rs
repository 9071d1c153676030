//! The information that a run's measurements carry about its states, with the run's real transition matrices.

use calib_core::{
    CoreRows, Decomposition, Filter, Residuals, Shape, Transition, Triangle, Vector, measurement_rows,
};

use crate::{Calibration, Event, Form, Observer, Point, Signals, Strapdown};

/// The Gramian `sum (H Phi)' R^-1 (H Phi)` of a run, as a triangle: what the measurements say about the states at the first
/// sample, the random walks of the sensors left aside. Hand it to
/// [`Calibration::step_observed`](crate::Calibration::step_observed).
///
/// Residuals play no part: the numbers are there before any unit has been calibrated, from the motion alone. States
/// are counted in their prior standard deviations. Parameters that relax count as constant.
pub struct Information<F: Filter<Dynamics = Strapdown>> {
    prior: Vector<F, f64>,
    /// Leading states now by all states at the beginning.
    rows: CoreRows<F, f64>,
    triangle: Triangle<F::Shape, f64>,
}

impl<F: Filter<Dynamics = Strapdown>> Information<F> {
    /// Of a run that has seen nothing yet.
    pub fn new<C: Form>(run: &Calibration<F, C>) -> Self {
        let mut rows = F::Shape::core_rows(0.0);
        for i in 0..F::Shape::CORE {
            rows[i][i] = 1.0;
        }
        Self { prior: prior(run), rows, triangle: Triangle::default() }
    }

    /// Singular values and directions: how many standard deviations of the measurements, all together, one prior
    /// standard deviation along a direction is worth.
    pub fn decompose(&self) -> Decomposition<F::Shape, f64> {
        self.triangle.decompose()
    }

    /// Standard deviation of each state at the first sample, prior and measurements together, were the sensors free of random
    /// walk: a bound that no filter passes.
    pub fn sigmas(&self) -> Vector<F, f64> {
        let mut all = self.triangle.clone();
        for i in 0..F::Shape::STATES {
            let mut row = F::Shape::vector(0.0);
            row[i] = 1.0;
            all.append(&row);
        }
        let mut sigmas = all.sigmas();
        for i in 0..F::Shape::STATES {
            sigmas[i] *= self.prior[i];
        }
        sigmas
    }

    /// Squares of the sigmas of a run's posterior against its prior, by directions, largest first: a value near one is a
    /// combination of states that the run has taught nothing about, random walks included.
    pub fn ignorance<C: Form>(&self, run: &Calibration<F, C>) -> Decomposition<F::Shape, f64> {
        let p = run.covariance();
        let mut scaled = Triangle::<F::Shape, f64>::default();
        for i in 0..F::Shape::STATES {
            let mut row = p[i].clone();
            for j in 0..F::Shape::STATES {
                let scale = self.prior[i] * self.prior[j];
                row[j] = if scale > 0.0 { row[j] / scale } else { 0.0 };
            }
            scaled.append(&row);
        }
        scaled.decompose()
    }
}

impl<F: Filter<Dynamics = Strapdown>> Observer<F> for Information<F> {
    fn observe<C: Form>(&mut self, event: Event<'_, F, C>) {
        match event {
            Event::Predicted { transition, .. } => self.carry(transition),
            Event::Measured { at, signals, residuals, .. } => self.append(at, signals, residuals),
            _ => {}
        }
    }
}

impl<F: Filter<Dynamics = Strapdown>> Information<F> {
    /// Takes the leading states over an interval.
    fn carry(&mut self, transition: &Transition<F, f64>) {
        let step = transition.rows();
        let mut moved = step.clone();
        for i in 0..F::Shape::CORE {
            for j in 0..F::Shape::STATES {
                let mut sum = if j < F::Shape::CORE { 0.0 } else { step[i][j] };
                for k in 0..F::Shape::CORE {
                    sum += step[i][k] * self.rows[k][j];
                }
                moved[i][j] = sum;
            }
        }
        self.rows = moved;
    }

    /// Adds what the channels of an update say.
    fn append(&mut self, at: &Point<f64>, signals: &Signals<f64>, residuals: &Residuals<F, f64>) {
        let h = measurement_rows::<F, f64>(at, signals);
        for m in 0..F::Shape::ROWS {
            if !residuals.is_present(m) {
                continue;
            }
            let scale = 1.0 / nalgebra::ComplexField::sqrt(residuals.variances()[m]);
            let mut row = F::Shape::vector(0.0);
            for j in 0..F::Shape::STATES {
                let mut sum = if j < F::Shape::CORE { 0.0 } else { h[m][j] };
                for k in 0..F::Shape::CORE {
                    sum += h[m][k] * self.rows[k][j];
                }
                row[j] = sum * scale * self.prior[j];
            }
            self.triangle.append(&row);
        }
    }
}

/// Standard deviations of the states of a run; of one that has seen nothing, the prior.
pub fn prior<F: Filter<Dynamics = Strapdown>, C: Form>(run: &Calibration<F, C>) -> Vector<F, f64> {
    let p = run.covariance();
    let mut sigmas = F::Shape::vector(0.0);
    for i in 0..F::Shape::STATES {
        sigmas[i] = nalgebra::ComplexField::sqrt(p[i][i]);
    }
    sigmas
}
