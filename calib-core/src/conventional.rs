//! The covariance itself, kept symmetric by construction.

use crate::form::{Fade, Form, Whitened, cholesky, is_present, used_columns};
use crate::machine::{Machine, on_this_machine};
use crate::tile::{dot, product, small_product};
use crate::{Array, Real, Shape};

/// P as it is: the default form.
///
/// Every kernel computes entry (i, j) and entry (j, i) by the same operations in the same order, so that P is
/// symmetric to the bit and never needs to be symmetrised. The update is `P - Y'Y` with `Y = L^-1 H P` and
/// `L L' = H P H' + R`.
///
/// With priors further apart than any unit's, fifteen orders of magnitude, rounding can make it indefinite; an innovation covariance
/// that is not positive definite is then an error. [`Ud`](crate::Ud) stays definite.
#[derive(Clone, Copy, Debug)]
pub struct Conventional;

/// `H P`, and the lower triangle of `H P H'`. Structural zeros of H are skipped, three rows at a time since measurements are
/// vectors.
#[inline(always)]
fn measure<S: Shape, T: Real>(
    machine: impl Machine,
    h: &S::MeasurementRows<T>,
    p: &S::Matrix<T>,
) -> (S::MeasurementRows<T>, S::MeasurementMatrix<T>) {
    const R: usize = 3;
    let mut hp = S::measurement_rows(T::zero());
    let mut s = S::measurement_matrix(T::zero());
    let mut list = S::indices();
    for first in (0..S::ROWS).step_by(R) {
        let rows = R.min(S::ROWS - first);
        let used = used_columns::<S, T>(&h.as_slice()[first..first + rows], &mut list);
        let ks = list.as_slice()[..used].iter().copied();
        let left = |r: usize, k: usize| h[first + r][k];
        product::<_, _, _, false>(
            machine,
            (rows, S::STATES),
            left,
            p.as_slice(),
            ks.clone(),
            |r, at, values| {
                hp[first + r].as_mut_slice()[at..at + values.len()].copy_from_slice(values);
            },
        );
        for against in (0..first + rows).step_by(R) {
            if rows == R {
                let right = |c: usize, k: usize| hp[against + c][k];
                let sums = small_product::<_, _, R, R>(machine, left, right, ks.clone());
                for r in 0..R {
                    for c in 0..R {
                        s[first + r][against + c] = sums[r][c];
                    }
                }
            } else {
                for r in 0..rows {
                    for j in against..(against + R).min(first + rows) {
                        let right = |_: usize, k: usize| hp[j][k];
                        s[first + r][j] =
                            small_product::<_, _, 1, 1>(machine, |_, k| left(r, k), right, ks.clone())[0][0];
                    }
                }
            }
        }
    }
    (hp, s)
}

#[inline(always)]
pub(crate) fn propagate<S: Shape, T: Real, M: Machine>(
    machine: M,
    cov: &mut S::Matrix<T>,
    rows: &S::CoreRows<T>,
    noise: &S::CoreMatrix<T>,
) {
    let mut moved = S::core_rows(T::zero());
    let left = |i: usize, k: usize| rows[i][k];
    let size = (S::CORE, S::STATES);
    product::<_, _, _, false>(machine, size, left, cov.as_slice(), 0..S::STATES, |i, first, values| {
        moved[i].as_mut_slice()[first..first + values.len()].copy_from_slice(values);
    });
    // its transpose goes where it belongs, and serves there as the second factor of the leading block
    for j in 0..S::STATES {
        for i in 0..S::CORE {
            cov[j][i] = moved[i][j];
        }
    }
    let mut leading = S::core_matrix(T::zero());
    let size = (S::CORE, S::CORE);
    product::<_, _, _, false>(machine, size, left, cov.as_slice(), 0..S::STATES, |i, first, values| {
        leading[i].as_mut_slice()[first..first + values.len()].copy_from_slice(values);
    });
    for i in 0..S::CORE {
        cov[i].as_mut_slice()[S::CORE..].copy_from_slice(&moved[i].as_slice()[S::CORE..]);
        for l in 0..=i {
            cov[i][l] = noise[i][l] + leading[i][l];
            cov[l][i] = cov[i][l];
        }
    }
}

#[inline(always)]
pub(crate) fn update<S: Shape, T: Real, M: Machine>(
    machine: M,
    cov: &mut S::Matrix<T>,
    x: &mut S::Vector<T>,
    h: &S::MeasurementRows<T>,
    r: &S::Measurement<T>,
    z: &S::Measurement<T>,
) -> Option<Whitened<T>> {
    let (mut y, mut s) = measure::<S, T>(machine, h, cov);
    for i in 0..S::ROWS {
        s[i][i] += if is_present::<S, T>(&h[i]) { r[i] } else { T::one() };
    }
    cholesky::<S, T>(&mut s)?;
    let mut whitened = Whitened { nis: T::zero(), log_det: T::zero() };
    let mut e = S::measurement(T::zero());
    let width = S::STATES;
    for i in 0..S::ROWS {
        let inverse = T::one() / s[i][i];
        let mut residual = z[i] - dot(machine, h[i].as_slice(), x.as_slice());
        for k in 0..i {
            residual -= s[i][k] * e[k];
        }
        e[i] = residual * inverse;
        let (done, rest) = y.as_mut_slice().split_at_mut(i);
        let row = rest[0].as_mut_slice();
        for v in row.iter_mut() {
            *v *= inverse;
        }
        let left = |_: usize, k: usize| s[i][k] * inverse;
        product::<_, _, _, true>(machine, (1, width), left, done, 0..i, |_, first, values| {
            for (y, value) in row[first..].iter_mut().zip(values) {
                *y -= *value;
            }
        });
        if is_present::<S, T>(&h[i]) {
            whitened.nis += e[i] * e[i];
            whitened.log_det += T::of(2.0) * s[i][i].ln();
        }
    }
    let gain = |_: usize, m: usize| e[m];
    product::<_, _, _, true>(machine, (1, width), gain, y.as_slice(), 0..S::ROWS, |_, first, values| {
        for (x, value) in x.as_mut_slice()[first..].iter_mut().zip(values) {
            *x += *value;
        }
    });
    let left = |i: usize, m: usize| y[m][i];
    // a length the compiler does not know keeps it from unrolling this loop and gathering across the tiles instead
    let ks = 0..core::hint::black_box(S::ROWS);
    product::<_, _, _, true>(machine, (width, width), left, y.as_slice(), ks, |i, first, values| {
        for (p, value) in cov[i].as_mut_slice()[first..].iter_mut().zip(values) {
            *p -= *value;
        }
    });
    // what was measured far better than it was known is a small difference of large numbers: it is known no better than
    // those are rounded, and certainly not better than exactly
    for i in 0..width {
        let mut removed = T::zero();
        for m in 0..S::ROWS {
            removed += y[m][i] * y[m][i];
        }
        cov[i][i] = cov[i][i].max(removed * T::default_epsilon());
    }
    Some(whitened)
}

impl Form for Conventional {
    fn set_diagonal<S: Shape, T: Real>(cov: &mut S::Matrix<T>, variances: &S::Vector<T>) {
        *cov = S::matrix(T::zero());
        for i in 0..S::STATES {
            cov[i][i] = variances[i];
        }
    }

    fn propagate<S: Shape, T: Real>(cov: &mut S::Matrix<T>, rows: &S::CoreRows<T>, noise: &S::CoreMatrix<T>) {
        on_this_machine!(machine => propagate::<S, T, _>(machine, cov, rows, noise));
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
        on_this_machine!(machine => update::<S, T, _>(machine, cov, x, h, r, z))
    }

    fn project<S: Shape, T: Real>(cov: &S::Matrix<T>, h: &S::MeasurementRows<T>) -> S::MeasurementMatrix<T> {
        let mut s = on_this_machine!(machine => measure::<S, T>(machine, h, cov)).1;
        for i in 0..S::ROWS {
            for j in 0..i {
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
