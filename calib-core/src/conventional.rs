//! The covariance itself, kept symmetric by construction.

use core::marker::PhantomData;

use crate::form::{Fade, Form, Whitened, cholesky, is_present, used_columns};
use crate::machine::{Machine, on_this_machine};
use crate::tile::{Panel, add_tile, dot, in_turn, panels, product, small_product, tile};
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
    hp: &mut S::MeasurementRows<T>,
    s: &mut S::MeasurementMatrix<T>,
) {
    const R: usize = 3;
    let mut list = S::vector(0);
    for first in (0..S::ROWS).step_by(R) {
        let rows = R.min(S::ROWS - first);
        let used = used_columns::<S, T>(&h.as_slice()[first..first + rows], &mut list);
        let ks = list.as_slice()[..used].iter().copied();
        let left = |r: usize, k: usize| h[first + r][k];
        product(machine, (rows, S::STATES), left, p.as_slice(), ks.clone(), |r, at, values| {
            hp[first + r].as_mut_slice()[at..at + values.len()].copy_from_slice(values);
        });
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
}

/// Writes the tile that begins at `(i, first)` to its mirror image.
#[inline(always)]
fn mirror<S: Shape, T: Real, const R: usize, const C: usize>(
    cov: &mut S::Matrix<T>,
    tile: &[[T; C]; R],
    (i, first): (usize, usize),
) {
    for c in 0..C {
        if let Some(mirrored) = cov[first + c].as_mut_slice()[i..].first_chunk_mut::<R>() {
            for r in 0..R {
                mirrored[r] = tile[r][c];
            }
        }
    }
}

/// `[Phi Psi] P` in place of the leading rows of P, in tiles of `TALL` rows, and its transpose in place of the leading columns
/// below.
struct Move<'a, S: Shape, T: Real, M: Machine, const TALL: usize> {
    cov: &'a mut S::Matrix<T>,
    rows: &'a S::CoreRows<T>,
    machine: PhantomData<M>,
}

impl<S: Shape, T: Real, M: Machine, const TALL: usize> Move<'_, S, T, M, TALL> {
    /// Rows `i..i + R` of the columns from `first` on, whose leading rows were `old`.
    #[inline(always)]
    fn rows<const R: usize, const C: usize>(&mut self, i: usize, first: usize, old: &[[T; C]]) {
        let left = |i: usize, k: usize| self.rows[i][k];
        let sums = tile::<M, T, _, R, C>(&left, old, 0..S::CORE, (i, 0));
        let sums =
            add_tile::<M, T, _, R, C>(sums, &left, self.cov.as_slice(), S::CORE..S::STATES, (i, first));
        for r in 0..R {
            if let Some(row) = self.cov[i + r].as_mut_slice()[first..].first_chunk_mut::<C>() {
                *row = sums[r];
            }
        }
        if first >= S::CORE {
            mirror::<S, T, R, C>(self.cov, &sums, (i, first));
        }
    }
}

impl<S: Shape, T: Real, M: Machine, const TALL: usize> Panel for Move<'_, S, T, M, TALL> {
    #[inline(always)]
    fn columns<const C: usize>(&mut self, first: usize, done: usize) {
        let mut old: S::CoreVector<[T; C]> = S::core_vector([T::zero(); C]);
        for i in 0..S::CORE {
            if let Some(row) = self.cov[i].as_slice()[first..].first_chunk::<C>() {
                old[i] = *row;
            }
        }
        let whole = S::CORE / TALL * TALL;
        for i in (0..whole).step_by(TALL) {
            self.rows::<TALL, C>(i, first, old.as_slice());
        }
        for i in whole..S::CORE {
            self.rows::<1, C>(i, first, old.as_slice());
        }
        for i in 0..S::CORE {
            self.cov[i].as_mut_slice()[first..first + done].copy_from_slice(&old[i][..done]);
        }
        // what could not be mirrored while others read it, and what was with the columns that were done
        let end = if first < S::CORE { first + C } else { first + done };
        for j in S::CORE.max(first)..end {
            in_turn();
            for i in 0..S::CORE {
                self.cov[j][i] = self.cov[i][j];
            }
        }
    }
}

#[inline(always)]
pub(crate) fn propagate<S: Shape, T: Real, M: Machine>(
    machine: M,
    cov: &mut S::Matrix<T>,
    rows: &S::CoreRows<T>,
    noise: &S::CoreMatrix<T>,
) {
    let size = (S::STATES, S::STATES);
    if M::WIDE {
        panels::<12>(size, &mut Move::<S, T, M, 3> { cov, rows, machine: PhantomData });
    } else {
        panels::<8>(size, &mut Move::<S, T, M, 2> { cov, rows, machine: PhantomData });
    }
    // with the transpose of its own in place of the leading block, they serve as the second factor of the new one
    for j in 0..S::CORE {
        in_turn();
        for i in 0..j {
            let moved = cov[i][j];
            cov[i][j] = cov[j][i];
            cov[j][i] = moved;
        }
    }
    // the leading block on and below its diagonal: whole columns of tiles, and what they leave
    let left = |i: usize, k: usize| rows[i][k];
    let mut leading = S::core_matrix(T::zero());
    let tiled = S::CORE / 8 * 8;
    product(machine, (S::CORE, tiled), left, cov.as_slice(), 0..S::STATES, |i, first, values| {
        leading[i].as_mut_slice()[first..first + values.len()].copy_from_slice(values);
    });
    for i in tiled..S::CORE {
        for l in tiled..=i {
            let mut moved = cov[l].clone();
            for k in 0..S::CORE {
                moved[k] = cov[k][l];
            }
            leading[i][l] = dot(machine, rows[i].as_slice(), moved.as_slice());
        }
    }
    for i in 0..S::CORE {
        for l in 0..=i {
            cov[i][l] = noise[i][l] + leading[i][l];
            cov[l][i] = cov[i][l];
        }
    }
}

/// Turns `H P` into `Y = L^-1 H P`, and with it corrects the state and sums up the variance that is removed from each.
struct Whiten<'a, S: Shape, T: Real, M: Machine> {
    y: &'a mut S::MeasurementRows<T>,
    x: &'a mut S::Vector<T>,
    removed: &'a mut S::Vector<T>,
    factor: &'a S::MeasurementMatrix<T>,
    e: &'a S::Measurement<T>,
    machine: PhantomData<M>,
}

impl<S: Shape, T: Real, M: Machine> Panel for Whiten<'_, S, T, M> {
    #[inline(always)]
    fn columns<const C: usize>(&mut self, first: usize, done: usize) {
        let mut y: S::Measurement<[T; C]> = Array::from_fn(|| [T::zero(); C]);
        for i in 0..S::ROWS {
            if let Some(row) = self.y[i].as_slice()[first..].first_chunk::<C>() {
                y[i] = *row;
            }
        }
        let (mut gain, mut removed) = ([T::zero(); C], [T::zero(); C]);
        for i in 0..S::ROWS {
            let mut row = y[i];
            for k in 0..i {
                for c in 0..C {
                    row[c] = M::add_product(row[c], -self.factor[i][k], y[k][c]);
                }
            }
            for c in 0..C {
                row[c] *= self.factor[i][i];
                gain[c] = M::add_product(gain[c], self.e[i], row[c]);
                removed[c] = M::add_product(removed[c], row[c], row[c]);
            }
            y[i] = row;
            self.y[i].as_mut_slice()[first + done..first + C].copy_from_slice(&row[done..]);
        }
        for c in done..C {
            self.x[first + c] += gain[c];
            self.removed[first + c] = removed[c];
        }
    }
}

/// `P - Y'Y`: what is on and above the diagonal is computed, in tiles, and mirrored.
struct Remove<'a, S: Shape, T: Real, M: Machine> {
    cov: &'a mut S::Matrix<T>,
    y: &'a S::MeasurementRows<T>,
    machine: PhantomData<M>,
}

impl<S: Shape, T: Real, M: Machine> Remove<'_, S, T, M> {
    /// Rows `i..i + R` of the columns from `first` on.
    #[inline(always)]
    fn rows<const R: usize, const C: usize>(&mut self, i: usize, first: usize, y: &[[T; C]]) -> [[T; C]; R] {
        let left = |i: usize, m: usize| self.y[m][i];
        // a length the compiler does not know keeps it from unrolling this loop and gathering across the tiles instead
        let ks = 0..core::hint::black_box(S::ROWS);
        let mut rest = tile::<M, T, _, R, C>(&left, y, ks, (i, 0));
        for r in 0..R {
            if let Some(row) = self.cov[i + r].as_mut_slice()[first..].first_chunk_mut::<C>() {
                for c in 0..C {
                    rest[r][c] = row[c] - rest[r][c];
                }
                *row = rest[r];
            }
        }
        rest
    }

    /// [`rows`](Self::rows) above the diagonal, and their mirror image.
    #[inline(always)]
    fn rows_above<const R: usize, const C: usize>(&mut self, i: usize, first: usize, y: &[[T; C]]) {
        let rest = self.rows::<R, C>(i, first, y);
        mirror::<S, T, R, C>(self.cov, &rest, (i, first));
    }
}

impl<S: Shape, T: Real, M: Machine> Panel for Remove<'_, S, T, M> {
    #[inline(always)]
    fn columns<const C: usize>(&mut self, first: usize, done: usize) {
        const R: usize = 4;
        // nothing is removed once more from what is done
        let mut y: S::Measurement<[T; C]> = Array::from_fn(|| [T::zero(); C]);
        for m in 0..S::ROWS {
            y[m][done..].copy_from_slice(&self.y[m].as_slice()[first + done..first + C]);
        }
        let (y, above, end) = (y.as_slice(), first + done, first + C);
        let whole = above / R * R;
        for i in (0..whole).step_by(R) {
            self.rows_above::<R, C>(i, first, y);
        }
        for i in whole..above {
            self.rows_above::<1, C>(i, first, y);
        }
        let whole = above + (end - above) / R * R;
        for i in (above..whole).step_by(R) {
            self.rows::<R, C>(i, first, y);
        }
        for i in whole..end {
            self.rows::<1, C>(i, first, y);
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
    let (mut y, mut s) = (S::measurement_rows(T::zero()), S::measurement_matrix(T::zero()));
    measure::<S, T>(machine, h, cov, &mut y, &mut s);
    for i in 0..S::ROWS {
        s[i][i] += if is_present::<S, T>(&h[i]) { r[i] } else { T::one() };
    }
    let pivots = cholesky::<S, T, M>(&mut s)?;
    let mut whitened = Whitened { nis: T::zero(), log_det: T::zero() };
    let mut e = S::measurement(T::zero());
    for i in 0..S::ROWS {
        let mut residual = z[i] - dot(machine, h[i].as_slice(), x.as_slice());
        for k in 0..i {
            residual = M::add_product(residual, -s[i][k], e[k]);
        }
        e[i] = residual * s[i][i];
        if is_present::<S, T>(&h[i]) {
            whitened.nis += e[i] * e[i];
            whitened.log_det += pivots[i].ln();
        }
    }
    let size = (S::STATES, S::STATES);
    let mut removed = S::vector(T::zero());
    let mut whiten =
        Whiten::<S, T, M> { y: &mut y, x, removed: &mut removed, factor: &s, e: &e, machine: PhantomData };
    panels::<8>(size, &mut whiten);
    let mut remove = Remove::<S, T, M> { cov, y: &y, machine: PhantomData };
    if M::WIDE {
        panels::<8>(size, &mut remove);
    } else {
        panels::<4>(size, &mut remove);
    }
    // what was measured far better than it was known is a small difference of large numbers: it is known no better than
    // those are rounded, and certainly not better than exactly
    for i in 0..S::STATES {
        in_turn();
        let least = removed[i] * T::default_epsilon();
        if cov[i][i] < least {
            cov[i][i] = least;
        }
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

    fn times<S: Shape, T: Real>(cov: &S::Matrix<T>, h: &S::Vector<T>) -> S::Vector<T> {
        let mut ph = S::vector(T::zero());
        for k in 0..S::STATES {
            let weight = h[k];
            if weight != T::zero() {
                for i in 0..S::STATES {
                    ph[i] += cov[k][i] * weight;
                }
            }
        }
        ph
    }

    /// Entry (i, j) and entry (j, i) by the same operation.
    fn add_square<S: Shape, T: Real>(cov: &mut S::Matrix<T>, v: &S::Vector<T>) {
        for i in 0..S::STATES {
            if v[i] != T::zero() {
                for j in 0..S::STATES {
                    cov[i][j] += v[i] * v[j];
                }
            }
        }
    }

    fn project<S: Shape, T: Real>(cov: &S::Matrix<T>, h: &S::MeasurementRows<T>) -> S::MeasurementMatrix<T> {
        let (mut hp, mut s) = (S::measurement_rows(T::zero()), S::measurement_matrix(T::zero()));
        on_this_machine!(machine => measure::<S, T>(machine, h, cov, &mut hp, &mut s));
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
