//! Fixed-interval smoothing of a calibration run (needs the standard library: it remembers the run).
//!
//! The parameters of a calibration are constant, and what the filter says of them at the end is what a smoother would say
//! at any time. The navigation solution is not: the attitude an hour ago is known better with the hour since. The
//! smoother is that of Rauch, Tung and Striebel (*AIAA Journal* 3(8), 1965). With P the predicted covariance, Q its noise and
//! F the transition, their gain is `G = F^-1 (I - Q P^-1)`, and one step back
//!
//! ```text
//! x_s <- G x_s          P_s <- G P_s G^T + F^-1 (Q - Q P^-1 Q) F^-T
//! ```
//!
//! which needs no filtered covariance and keeps P_s positive. Only the leading rows of G are not those of the identity: they
//! are computed on the way there and put on a [`Tape`], which is read backwards.

use core::marker::PhantomData;
use std::io;
use std::vec::Vec;

use calib_core::{Array, Filter, Form, Matrix, Shape};
use nalgebra::{DMatrix, DVector, Quaternion, SMatrix, UnitQuaternion, Vector3};

use crate::strapdown::NavigationState;
use crate::{Event, Observer, Strapdown};

/// Leading states of every filter: attitude, velocity, position.
const C: usize = 9;
/// Time and navigation solution of an update.
const SOLUTION: usize = 11;

/// Records of one length, written one after the other and read from the last to the first.
pub trait Tape {
    /// Appends a record.
    ///
    /// # Errors
    /// When it cannot be kept.
    fn push(&mut self, record: &[f64]) -> io::Result<()>;

    /// Takes the last record; `false` when none is left.
    ///
    /// # Errors
    /// When it cannot be had back.
    fn pop(&mut self, record: &mut [f64]) -> io::Result<bool>;
}

/// A tape in memory.
impl Tape for Vec<f64> {
    fn push(&mut self, record: &[f64]) -> io::Result<()> {
        self.extend_from_slice(record);
        Ok(())
    }

    fn pop(&mut self, record: &mut [f64]) -> io::Result<bool> {
        let Some(start) = self.len().checked_sub(record.len()) else { return Ok(false) };
        record.copy_from_slice(&self[start..]);
        self.truncate(start);
        Ok(true)
    }
}

/// Remembers a run, then smooths its navigation solution. Hand it to
/// [`Calibration::step_observed`](crate::Calibration::step_observed) in the last pass.
///
/// It puts `10 N + 101` numbers on the tape for each update of a filter of N states: 15 MB for an hour of updates at 1 Hz
/// with 43 states. Elsewhere it keeps nothing that grows, but for what [`finish`](Self::finish) returns.
pub struct Smoother<F: Filter<Dynamics = Strapdown>, T: Tape = Vec<f64>> {
    steps: Steps<T>,
    filter: PhantomData<fn() -> F>,
}

/// What a smoother does whatever the filter: compiled once for all of them.
struct Steps<T: Tape> {
    tape: T,
    /// Number of states.
    states: usize,
    /// `[Phi Psi]` and noise of the last prediction.
    prediction: Option<(DMatrix<f64>, DMatrix<f64>)>,
    /// The record of the last prediction: leading rows of its gain, noise of the step back, then what an update fills in.
    record: Vec<f64>,
    pending: bool,
    failure: Option<io::Error>,
}

/// The navigation solution at one update, with everything that was measured before and after it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smoothed {
    /// Time of the update, s.
    pub time: f64,
    /// The smoothed solution.
    pub navigation: NavigationState<f64>,
    /// Covariance of the errors of attitude (rad), velocity (m/s) and position (m) in n.
    pub covariance: SMatrix<f64, C, C>,
}

impl Smoothed {
    /// Standard deviations of attitude (rad), velocity (m/s) and position (m) in n.
    pub fn sigmas(&self) -> [f64; C] {
        core::array::from_fn(|i| self.covariance[(i, i)].max(0.0).sqrt())
    }
}

impl<F: Filter<Dynamics = Strapdown>, T: Tape + Default> Default for Smoother<F, T> {
    fn default() -> Self {
        Self::new(T::default())
    }
}

impl<F: Filter<Dynamics = Strapdown>, T: Tape> Observer<F> for Smoother<F, T> {
    fn observe<K: Form>(&mut self, event: Event<'_, F, K>) {
        match event {
            Event::Predicted { transition, density } => {
                let (rows, q) = (transition.rows(), transition.noise(density));
                let rows = DMatrix::from_fn(C, F::Shape::STATES, |i, j| rows[i][j]);
                self.steps.predicted(rows, DMatrix::from_fn(C, C, |i, j| q[i][j]));
            }
            Event::Moved(kalman) => self.steps.moved(&dense::<F>(&kalman.covariance())),
            // `Moved` comes again, with the wider covariance
            Event::Widened(variances) => self.steps.widened(variances.as_slice()),
            Event::Updated { time, change, navigation } => {
                self.steps.updated(time, change.as_slice(), navigation);
            }
            _ => {}
        }
    }
}

fn dense<F: Filter>(p: &Matrix<F, f64>) -> DMatrix<f64> {
    DMatrix::from_fn(F::Shape::STATES, F::Shape::STATES, |i, j| p[i][j])
}

impl<F: Filter<Dynamics = Strapdown>, T: Tape> Smoother<F, T> {
    /// Begins with an empty tape.
    pub fn new(tape: T) -> Self {
        let states = F::Shape::STATES;
        let steps =
            Steps { tape, states, prediction: None, record: Vec::new(), pending: false, failure: None };
        Self { steps, filter: PhantomData }
    }

    /// Smooths what was observed: one solution for each update, in the order of time. `covariance` is that of the run at its
    /// end.
    ///
    /// # Errors
    /// When the tape failed.
    pub fn finish(self, covariance: &Matrix<F, f64>) -> io::Result<Vec<Smoothed>> {
        self.steps.finish(dense::<F>(covariance))
    }
}

impl<T: Tape> Steps<T> {
    fn predicted(&mut self, rows: DMatrix<f64>, q: DMatrix<f64>) {
        self.keep();
        self.prediction = Some((rows, q));
    }

    fn widened(&mut self, variances: &[f64]) {
        if let Some((_, q)) = &mut self.prediction {
            for i in 0..C {
                q[(i, i)] += variances[i];
            }
        }
    }

    fn moved(&mut self, p: &DMatrix<f64>) {
        let Some((rows, q)) = &self.prediction else { return };
        let n = self.states;
        let factor = Factor::new(p);
        // the leading rows of P^-1
        let mut weights = DMatrix::zeros(C, n);
        for i in 0..C {
            let mut unit = DVector::zeros(n);
            unit[i] = 1.0;
            weights.set_row(i, &factor.solve(&unit).transpose());
        }
        let mut gain = -(q * &weights);
        for i in 0..C {
            gain[(i, i)] += 1.0;
            for j in C..n {
                gain[(i, j)] -= rows[(i, j)];
            }
        }
        let noise = q - q * weights.columns(0, C) * q;
        let phi = rows.columns(0, C).into_owned().lu();
        // phi^-1 exists: it is near the identity
        let (Some(gain), Some(half)) = (phi.solve(&gain), phi.solve(&noise)) else { return };
        let Some(noise) = phi.solve(&half.transpose()) else { return };
        self.record.clear();
        self.record.extend(gain.transpose().iter());
        self.record.extend(noise.iter());
        self.record.resize(length(n), 0.0);
        // no solution yet
        self.record[length(n) - SOLUTION] = f64::NAN;
        self.pending = true;
    }

    fn updated(&mut self, time: f64, change: &[f64], navigation: &NavigationState<f64>) {
        // at the first sample nothing has been predicted yet
        if !self.pending {
            return;
        }
        let n = self.states;
        let at = length(n) - SOLUTION;
        self.record[at - n..at].copy_from_slice(change);
        let NavigationState { attitude: q, velocity: v, latitude, longitude, height } = *navigation;
        let solution = [time, q.w, q.i, q.j, q.k, v.x, v.y, v.z, latitude, longitude, height];
        self.record[at..].copy_from_slice(&solution);
    }

    /// Puts the record of the last prediction on the tape.
    fn keep(&mut self) {
        if self.pending && self.failure.is_none() {
            self.failure = self.tape.push(&self.record).err();
        }
        self.pending = false;
    }

    fn finish(mut self, mut p: DMatrix<f64>) -> io::Result<Vec<Smoothed>> {
        self.keep();
        if let Some(failure) = self.failure {
            return Err(failure);
        }
        let n = self.states;
        let mut smoothed = Vec::new();
        // expectation of the errors of the filtered solution given the whole run; p is their covariance
        let mut s = DVector::<f64>::zeros(n);
        let mut record = std::vec![0.0; length(n)];
        while self.tape.pop(&mut record)? {
            let (gain, rest) = record.split_at(C * n);
            let (noise, rest) = rest.split_at(C * C);
            let (change, solution) = rest.split_at(n);
            if let Some((time, mut navigation)) = read(solution) {
                let part = |first: usize| Vector3::new(s[first], s[first + 1], s[first + 2]);
                navigation.correct(&part(0), &part(3), &part(6));
                let covariance = SMatrix::from_fn(|i, j| p[(i, j)]);
                smoothed.push(Smoothed { time, navigation, covariance });
            }
            s += DVector::from_column_slice(change);
            let gain = DMatrix::from_row_slice(C, n, gain);
            let leading = &gain * &s;
            s.rows_mut(0, C).copy_from(&leading);
            // the other rows of the gain are those of the identity
            let mixed = &gain * &p;
            let corner = &mixed * gain.transpose() + DMatrix::from_column_slice(C, C, noise);
            p.view_mut((0, C), (C, n - C)).copy_from(&mixed.columns(C, n - C));
            let side = mixed.columns(C, n - C).transpose();
            p.view_mut((C, 0), (n - C, C)).copy_from(&side);
            p.view_mut((0, 0), (C, C)).copy_from(&((&corner + corner.transpose()) * 0.5));
        }
        smoothed.reverse();
        Ok(smoothed)
    }
}

/// Numbers in a record: gain, noise, change of the state, solution.
fn length(states: usize) -> usize {
    C * states + C * C + states + SOLUTION
}

/// Time and navigation solution, where there was an update.
fn read(solution: &[f64]) -> Option<(f64, NavigationState<f64>)> {
    let &[time, w, i, j, k, east, north, up, latitude, longitude, height] = solution else { return None };
    let navigation = NavigationState {
        attitude: UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k)),
        velocity: Vector3::new(east, north, up),
        latitude,
        longitude,
        height,
    };
    (!time.is_nan()).then_some((time, navigation))
}

/// Cholesky factor of a covariance scaled to unit diagonal, of the states that are not known exactly: those that are have no weight,
/// and cost nothing.
struct Factor {
    /// The states that take part.
    taken: Vec<usize>,
    scale: DVector<f64>,
    l: DMatrix<f64>,
}

impl Factor {
    fn new(p: &DMatrix<f64>) -> Self {
        let taken: Vec<usize> = (0..p.nrows()).filter(|i| p[(*i, *i)] > 0.0).collect();
        let n = taken.len();
        let scale = DVector::from_fn(n, |i, _| 1.0 / p[(taken[i], taken[i])].sqrt());
        let mut l = DMatrix::<f64>::zeros(n, n);
        for i in 0..n {
            for j in 0..=i {
                let mut sum = p[(taken[i], taken[j])] * scale[i] * scale[j];
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
        Self { taken, scale, l }
    }

    /// `P^-1 y`.
    fn solve(&self, y: &DVector<f64>) -> DVector<f64> {
        let (n, l) = (self.taken.len(), &self.l);
        let divided = |value: f64, i: usize| if l[(i, i)] > 0.0 { value / l[(i, i)] } else { 0.0 };
        let mut w = DVector::from_fn(n, |i, _| y[self.taken[i]] * self.scale[i]);
        for i in 0..n {
            for k in 0..i {
                let known = w[k];
                w[i] -= l[(i, k)] * known;
            }
            w[i] = divided(w[i], i);
        }
        for i in (0..n).rev() {
            for k in i + 1..n {
                let known = w[k];
                w[i] -= l[(k, i)] * known;
            }
            w[i] = divided(w[i], i);
        }
        let mut solved = DVector::zeros(y.len());
        for (place, value) in self.taken.iter().zip(w.component_mul(&self.scale).iter()) {
            solved[*place] = *value;
        }
        solved
    }
}
