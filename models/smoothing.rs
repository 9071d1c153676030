//! Fixed-interval smoothing of a calibration run (needs the standard library: it remembers the run).
//!
//! The parameters of a calibration are constant, and what the filter says of them at the end is what a smoother would say
//! at any time. The navigation solution is not: the attitude an hour ago is known better with the hour since. The
//! smoother is that of Rauch, Tung and Striebel (*AIAA Journal* 3(8), 1965) with the gain `G = F^-1 (I - Q P^-1)`, which is
//! theirs for an invertible F and needs no covariance but the predicted one.

use std::vec::Vec;

use calib_core::{CoreRows, CoreVector, Filter, Form, Kalman, Shape, Transition, Vector};
use nalgebra::{DMatrix, DVector, Vector3};

use crate::strapdown::NavigationState;
use crate::{Observer, Strapdown, Updated};

/// Remembers a run, then smooths its navigation solution. Hand it to
/// [`Calibration::step_observed`](crate::Calibration::step_observed) in the last pass.
///
/// It holds about `N^2 / 2 + 12 N` numbers for each update of a filter of N states: 40 MB for an hour of updates at 1 Hz
/// with 43 states.
pub struct Smoother<F: Filter<Dynamics = Strapdown>> {
    steps: Vec<Step<F>>,
}

/// One prediction with the update that followed it, if one did.
struct Step<F: Filter<Dynamics = Strapdown>> {
    rows: CoreRows<F, f64>,
    noise: DMatrix<f64>,
    /// Lower triangle of the predicted covariance, row after row.
    predicted: Vec<f64>,
    /// What the update added to the state vector.
    change: Vector<F, f64>,
    solution: Option<(f64, NavigationState<f64>)>,
}

/// The navigation solution at one update, with everything that was measured before and after it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smoothed {
    /// Time of the update, s.
    pub time: f64,
    /// The smoothed solution.
    pub navigation: NavigationState<f64>,
}

impl<F: Filter<Dynamics = Strapdown>> Default for Smoother<F> {
    fn default() -> Self {
        Self { steps: Vec::new() }
    }
}

impl<F: Filter<Dynamics = Strapdown>> Observer<F> for Smoother<F> {
    fn predicted(&mut self, transition: &Transition<F, f64>, density: &CoreVector<F, f64>) {
        let q = transition.noise(density);
        self.steps.push(Step {
            rows: transition.rows().clone(),
            noise: DMatrix::from_fn(F::Shape::CORE, F::Shape::CORE, |i, j| q[i][j]),
            predicted: Vec::new(),
            change: F::Shape::vector(0.0),
            solution: None,
        });
    }

    fn moved<C: Form>(&mut self, kalman: &Kalman<F, f64, C>) {
        let p = kalman.covariance();
        if let Some(step) = self.steps.last_mut() {
            let n = F::Shape::STATES;
            step.predicted =
                (0..n).flat_map(|i| (0..=i).map(move |j| (i, j))).map(|(i, j)| p[i][j]).collect();
        }
    }

    fn widened(&mut self, variances: &CoreVector<F, f64>) {
        if let Some(step) = self.steps.last_mut() {
            for i in 0..F::Shape::CORE {
                step.noise[(i, i)] += variances[i];
            }
        }
    }

    fn updated(&mut self, update: &Updated<'_, F>) {
        // at the first sample nothing has been predicted yet
        if let Some(step) = self.steps.last_mut() {
            step.change = update.change.clone();
            step.solution = Some((update.time, *update.navigation));
        }
    }
}

impl<F: Filter<Dynamics = Strapdown>> Smoother<F> {
    /// Smooths what was observed: one solution for each update, in the order of time.
    pub fn finish(self) -> Vec<Smoothed> {
        let core = F::Shape::CORE;
        let mut smoothed = Vec::with_capacity(self.steps.len());
        // expectation of the errors of the filtered solution given the whole run
        let mut s = DVector::<f64>::zeros(F::Shape::STATES);
        for step in self.steps.iter().rev() {
            if let Some((time, mut navigation)) = step.solution {
                let part = |first: usize| Vector3::new(s[first], s[first + 1], s[first + 2]);
                navigation.correct(&part(0), &part(3), &part(6));
                smoothed.push(Smoothed { time, navigation });
            }
            for i in 0..F::Shape::STATES {
                s[i] += step.change[i];
            }
            let weight = weigh(&step.predicted, &s);
            let pull = &step.noise * weight.rows(0, core);
            let mut right = DVector::from_fn(core, |i, _| s[i] - pull[i]);
            for i in 0..core {
                for j in core..F::Shape::STATES {
                    right[i] -= step.rows[i][j] * s[j];
                }
            }
            let phi = DMatrix::from_fn(core, core, |i, j| step.rows[i][j]);
            if let Some(solved) = phi.lu().solve(&right) {
                s.rows_mut(0, core).copy_from(&solved);
            }
        }
        smoothed.reverse();
        smoothed
    }
}

/// `P^-1 y` by Cholesky factors of P scaled to unit diagonal; a state that is known exactly has no weight.
fn weigh(packed: &[f64], y: &DVector<f64>) -> DVector<f64> {
    let n = y.len();
    let entry = |i: usize, j: usize| packed[i * (i + 1) / 2 + j];
    let scale: Vec<f64> =
        (0..n).map(|i| if entry(i, i) > 0.0 { 1.0 / entry(i, i).sqrt() } else { 0.0 }).collect();
    let mut l = DMatrix::<f64>::zeros(n, n);
    for i in 0..n {
        for j in 0..=i {
            let mut sum = entry(i, j) * scale[i] * scale[j];
            for k in 0..j {
                sum -= l[(i, k)] * l[(j, k)];
            }
            l[(i, j)] = if i != j {
                if l[(j, j)] > 0.0 { sum / l[(j, j)] } else { 0.0 }
            } else if sum > f64::EPSILON {
                sum.sqrt()
            } else {
                0.0
            };
        }
    }
    let mut w = DVector::from_fn(n, |i, _| y[i] * scale[i]);
    for i in 0..n {
        for k in 0..i {
            let known = w[k];
            w[i] -= l[(i, k)] * known;
        }
        w[i] = if l[(i, i)] > 0.0 { w[i] / l[(i, i)] } else { 0.0 };
    }
    for i in (0..n).rev() {
        for k in i + 1..n {
            let known = w[k];
            w[i] -= l[(k, i)] * known;
        }
        w[i] = if l[(i, i)] > 0.0 { w[i] / l[(i, i)] } else { 0.0 };
    }
    DVector::from_fn(n, |i, _| w[i] * scale[i])
}
