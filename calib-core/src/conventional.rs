//! The covariance itself, kept symmetric by construction.

use crate::form::{Fade, Form, Whitened, cholesky, is_present};
use crate::tile::product;
use crate::{Array, Real, Shape};

/// P as it is: the default form.
///
/// Every kernel computes entry (i, j) and entry (j, i) by the same operations in the same order, so that P is
/// symmetric to the bit and never needs to be symmetrised. The update is `P - Y'Y` with `Y = L^-1 H P` and
/// `L L' = H P H' + R`.
#[derive(Clone, Copy, Debug)]
pub struct Conventional;

/// `H P`, row by row; structural zeros of H are skipped.
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

/// `H (H P)'`, both triangles of it.
fn innovation<S: Shape, T: Real>(
    h: &S::MeasurementRows<T>,
    hp: &S::MeasurementRows<T>,
) -> S::MeasurementMatrix<T> {
    let mut s = S::measurement_matrix(T::zero());
    for k in 0..S::STATES {
        for i in 0..S::ROWS {
            let a = h[i][k];
            if a != T::zero() {
                for j in 0..=i {
                    s[i][j] += a * hp[j][k];
                }
            }
        }
    }
    for i in 0..S::ROWS {
        for j in 0..i {
            s[j][i] = s[i][j];
        }
    }
    s
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
        product(rows.as_slice(), cov.as_slice(), |i, first, values| {
            moved[i].as_mut_slice()[first..first + values.len()].copy_from_slice(values);
        });
        let mut across = S::core_columns(T::zero());
        for i in 0..S::CORE {
            for j in 0..S::STATES {
                across[j][i] = rows[i][j];
            }
        }
        product(moved.as_slice(), across.as_slice(), |i, first, values| {
            for (l, value) in (first..=i).zip(values) {
                cov[i][l] = noise[i][l] + *value;
                cov[l][i] = cov[i][l];
            }
        });
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
        let mut s = innovation::<S, T>(h, &y);
        for i in 0..S::ROWS {
            s[i][i] += if is_present::<S, T>(&h[i]) { r[i] } else { T::one() };
        }
        cholesky::<S, T>(&mut s)?;
        let mut whitened = Whitened { nis: T::zero(), log_det: T::zero() };
        let mut e = S::measurement(T::zero());
        for i in 0..S::ROWS {
            let mut residual = z[i];
            for j in 0..S::STATES {
                residual -= h[i][j] * x[j];
            }
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
        let mut across = S::measurement_columns(T::zero());
        for m in 0..S::ROWS {
            for j in 0..S::STATES {
                across[j][m] = y[m][j];
            }
        }
        product(across.as_slice(), y.as_slice(), |i, first, values| {
            for (p, value) in cov[i].as_mut_slice()[first..].iter_mut().zip(values) {
                *p -= *value;
            }
        });
        Some(whitened)
    }

    fn project<S: Shape, T: Real>(cov: &S::Matrix<T>, h: &S::MeasurementRows<T>) -> S::MeasurementMatrix<T> {
        innovation::<S, T>(h, &measure::<S, T>(h, cov))
    }

    fn variance<S: Shape, T: Real>(cov: &S::Matrix<T>, i: usize) -> T {
        cov[i][i]
    }

    fn dense<S: Shape, T: Real>(cov: &S::Matrix<T>, p: &mut S::Matrix<T>) {
        p.clone_from(cov);
    }
}
