//! The covariance itself, kept symmetric by construction.

use crate::form::{Fade, Form, Whitened, cholesky, is_present};
use crate::{Array, Real, Shape};

/// P as it is: the default form.
///
/// Every kernel computes entry (i, j) and entry (j, i) by the same operations in the same order, so that P is
/// symmetric to the bit and never needs to be symmetrised. The update is `P - Y'Y` with `Y = L^-1 H P` and
/// `L L' = H P H' + R`.
#[derive(Clone, Copy, Debug)]
pub struct Conventional;

/// `out += a[0] p[0] + a[1] p[1] + ...`: a linear combination of rows, four at a time.
#[inline(always)]
fn combine<S: Shape, T: Real>(out: &mut S::Vector<T>, a: &S::Vector<T>, p: &S::Matrix<T>) {
    let n = S::STATES;
    let quads = n - n % 4;
    for k in (0..quads).step_by(4) {
        let (a0, a1, a2, a3) = (a[k], a[k + 1], a[k + 2], a[k + 3]);
        let (p0, p1, p2, p3) = (&p[k], &p[k + 1], &p[k + 2], &p[k + 3]);
        for j in 0..n {
            out[j] += a0 * p0[j] + a1 * p1[j] + a2 * p2[j] + a3 * p3[j];
        }
    }
    for k in quads..n {
        for j in 0..n {
            out[j] += a[k] * p[k][j];
        }
    }
}

#[inline(always)]
fn dot<S: Shape, T: Real>(a: &S::Vector<T>, b: &S::Vector<T>) -> T {
    let mut sum = T::zero();
    for k in 0..S::STATES {
        sum += a[k] * b[k];
    }
    sum
}

/// `H P`, row by row; structural zeros of H are skipped.
#[inline(always)]
fn measure<S: Shape, T: Real>(h: &S::MeasurementRows<T>, p: &S::Matrix<T>) -> S::MeasurementRows<T> {
    let mut hp = S::measurement_rows(T::zero());
    for k in 0..S::STATES {
        for m in 0..S::ROWS {
            let a = h[m][k];
            if a != T::zero() {
                for j in 0..S::STATES {
                    hp[m][j] += a * p[k][j];
                }
            }
        }
    }
    hp
}

impl Form for Conventional {
    fn set_diagonal<S: Shape, T: Real>(cov: &mut S::Matrix<T>, variances: &S::Vector<T>) {
        *cov = S::matrix(T::zero());
        for i in 0..S::STATES {
            cov[i][i] = variances[i];
        }
    }

    fn propagate<S: Shape, T: Real>(cov: &mut S::Matrix<T>, rows: &S::CoreRows<T>, noise: &S::CoreMatrix<T>) {
        let mut moved = S::core_rows(T::zero());
        for i in 0..S::CORE {
            combine::<S, T>(&mut moved[i], &rows[i], cov);
        }
        for i in 0..S::CORE {
            for l in 0..=i {
                let value = noise[i][l] + dot::<S, T>(&moved[i], &rows[l]);
                cov[i][l] = value;
                cov[l][i] = value;
            }
        }
        for i in 0..S::CORE {
            for j in S::CORE..S::STATES {
                cov[i][j] = moved[i][j];
                cov[j][i] = moved[i][j];
            }
        }
    }

    fn fade<S: Shape, T: Real>(cov: &mut S::Matrix<T>, fade: &Fade<T>) {
        let s = fade.state;
        for j in 0..S::STATES {
            cov[s][j] *= fade.keep;
            cov[j][s] *= fade.keep;
        }
        cov[s][s] += fade.variance;
    }

    fn update<S: Shape, T: Real>(
        cov: &mut S::Matrix<T>,
        x: &mut S::Vector<T>,
        h: &S::MeasurementRows<T>,
        r: &S::Measurement<T>,
        z: &S::Measurement<T>,
    ) -> Option<Whitened<T>> {
        let mut y = measure::<S, T>(h, cov);
        let mut s = S::measurement_matrix(T::zero());
        for i in 0..S::ROWS {
            for j in 0..=i {
                s[i][j] = dot::<S, T>(&h[i], &y[j]);
            }
            s[i][i] += if is_present::<S, T>(&h[i]) { r[i] } else { T::one() };
        }
        cholesky::<S, T>(&mut s)?;
        let mut whitened = Whitened { nis: T::zero(), log_det: T::zero() };
        let mut e = S::measurement(T::zero());
        for i in 0..S::ROWS {
            let mut residual = z[i] - dot::<S, T>(&h[i], x);
            for k in 0..i {
                let factor = s[i][k];
                residual -= factor * e[k];
                let (done, rest) = y.as_mut_slice().split_at_mut(i);
                for j in 0..S::STATES {
                    rest[0][j] -= factor * done[k][j];
                }
            }
            let inverse = T::one() / s[i][i];
            for j in 0..S::STATES {
                y[i][j] *= inverse;
            }
            e[i] = residual * inverse;
            if is_present::<S, T>(&h[i]) {
                whitened.nis += e[i] * e[i];
                whitened.log_det += T::of(2.0) * s[i][i].ln();
            }
        }
        for m in 0..S::ROWS {
            for j in 0..S::STATES {
                x[j] += y[m][j] * e[m];
            }
        }
        for i in 0..S::STATES {
            let row = &mut cov[i];
            for m in 0..S::ROWS {
                let a = y[m][i];
                for j in 0..S::STATES {
                    row[j] -= a * y[m][j];
                }
            }
        }
        Some(whitened)
    }

    fn project<S: Shape, T: Real>(cov: &S::Matrix<T>, h: &S::MeasurementRows<T>) -> S::MeasurementMatrix<T> {
        let hp = measure::<S, T>(h, cov);
        let mut s = S::measurement_matrix(T::zero());
        for i in 0..S::ROWS {
            for j in 0..=i {
                s[i][j] = dot::<S, T>(&h[i], &hp[j]);
                s[j][i] = s[i][j];
            }
        }
        s
    }

    fn variance<S: Shape, T: Real>(cov: &S::Matrix<T>, i: usize) -> T {
        cov[i][i]
    }

    fn dense<S: Shape, T: Real>(cov: &S::Matrix<T>, p: &mut S::Matrix<T>) {
        p.clone_from(cov);
    }
}
