//! How a covariance is kept: [`Conventional`](crate::Conventional) or [`Ud`](crate::Ud).

use crate::machine::Machine;
use crate::{Array, Real, Relaxation, Shape};

/// One parameter state that is not constant, over an interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fade<T> {
    /// Index of the state.
    pub state: usize,
    /// What remains of it, exp(-dt / tau).
    pub keep: T,
    /// Variance it gains.
    pub variance: T,
}

impl<T: Real> Fade<T> {
    /// The exact discretisation of a first-order Gauss-Markov state over `dt` seconds.
    pub fn over(relaxation: Relaxation<T>, state: usize, dt: T) -> Self {
        let Relaxation { rate, density } = relaxation;
        let keep = (-rate * dt).exp();
        let two = T::of(2.0);
        let variance = if rate > T::zero() {
            // (1 - exp(-2 dt/tau)) tau/2, without cancellation for a long correlation time
            density * -(-two * rate * dt).exp_m1() / (two * rate)
        } else {
            density * dt
        };
        Self { state, keep, variance }
    }
}

/// What an update makes of a residual, once whitened with the innovation covariance S.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Whitened<T> {
    /// Normalised innovation squared, `r' S^-1 r`.
    pub nis: T,
    /// `ln det S` over the rows that were present.
    pub log_det: T,
}

/// A way to keep a covariance P of a filter of shape `S`, with the kernels that move it.
///
/// `rows` are the C non-trivial rows `[Phi Psi]` of the transition matrix; below them stand the parameters,
/// which keep their value unless they [`fade`](Self::fade). A measurement row of zeros is no measurement and changes nothing.
pub trait Form: Copy + 'static {
    /// Sets P to a diagonal of variances.
    fn set_diagonal<S: Shape, T: Real>(cov: &mut S::Matrix<T>, variances: &S::Vector<T>);

    /// P <- F P F' + Q, with Q given in its leading C x C block; parameters stay as they are.
    fn propagate<S: Shape, T: Real>(cov: &mut S::Matrix<T>, rows: &S::CoreRows<T>, noise: &S::CoreMatrix<T>);

    /// Lets one parameter fade, after [`propagate`](Self::propagate).
    fn fade<S: Shape, T: Real>(cov: &mut S::Matrix<T>, fade: &Fade<T>);

    /// Kalman update of `x` and P with residual `z`, measurement matrix `h` and variances `r` of independent
    /// noise. `None` when the innovation covariance is not positive definite: nothing is changed then.
    fn update<S: Shape, T: Real>(
        cov: &mut S::Matrix<T>,
        x: &mut S::Vector<T>,
        h: &S::MeasurementRows<T>,
        r: &S::Measurement<T>,
        z: &S::Measurement<T>,
    ) -> Option<Whitened<T>>;

    /// `P h`.
    fn times<S: Shape, T: Real>(cov: &S::Matrix<T>, h: &S::Vector<T>) -> S::Vector<T>;

    /// P <- P + v v'.
    fn add_square<S: Shape, T: Real>(cov: &mut S::Matrix<T>, v: &S::Vector<T>);

    /// `H P H'`, without measurement noise.
    fn project<S: Shape, T: Real>(cov: &S::Matrix<T>, h: &S::MeasurementRows<T>) -> S::MeasurementMatrix<T>;

    /// Variance of state `i`.
    fn variance<S: Shape, T: Real>(cov: &S::Matrix<T>, i: usize) -> T;

    /// P itself.
    fn dense<S: Shape, T: Real>(cov: &S::Matrix<T>, p: &mut S::Matrix<T>);
}

/// Cholesky factor L (lower, S = L L') in place, but for the inverse of its diagonal there; returns the squares of that.
/// `None` when a pivot is not positive. The next pivot waits for one division, not for the root.
#[inline(always)]
pub(crate) fn cholesky<S: Shape, T: Real, M: Machine>(
    s: &mut S::MeasurementMatrix<T>,
) -> Option<S::Measurement<T>> {
    let mut pivots = S::measurement(T::zero());
    for j in 0..S::ROWS {
        pivots[j] = s[j][j];
        if !(pivots[j] > T::zero()) {
            return None;
        }
        let (inverse, root) = (T::one() / pivots[j], T::one() / pivots[j].sqrt());
        for i in j + 1..S::ROWS {
            let weight = -(s[i][j] * inverse);
            for k in j + 1..=i {
                s[i][k] = M::add_product(s[i][k], weight, s[k][j]);
            }
        }
        for i in j + 1..S::ROWS {
            s[i][j] *= root;
        }
        s[j][j] = root;
    }
    Some(pivots)
}

/// Whether measurement `row` is present: a row of zeros measures nothing.
#[inline(always)]
pub(crate) fn is_present<S: Shape, T: Real>(row: &S::Vector<T>) -> bool {
    row.as_slice().iter().any(|h| *h != T::zero())
}

/// Writes down which columns of some measurement rows have entries, and returns how many.
#[inline(always)]
pub(crate) fn used_columns<S: Shape, T: Real>(rows: &[S::Vector<T>], list: &mut S::Vector<usize>) -> usize {
    let mut size = S::vector(T::zero());
    for row in rows {
        for k in 0..S::STATES {
            size[k] += row[k].abs();
        }
    }
    let mut used = 0;
    for k in 0..S::STATES {
        list[used] = k;
        used += usize::from(size[k] != T::zero());
    }
    used
}
