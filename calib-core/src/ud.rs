//! The factored covariance P = U D U', by Thornton and Bierman.

use crate::form::{Fade, Form, Whitened, is_present, used_columns};
use crate::machine::{Machine, on_this_machine};
use crate::tile::{blocks, dot, in_turn, tile};
use crate::{Array, Real, Shape};

/// P = U D U' with U unit upper triangular and D diagonal: the robust form, and the only one fit for `f32`.
///
/// Stored transposed in the lower triangle, so that a column of U lies in memory in one piece: entry `[j][i]`
/// is U_ij for i < j, entry `[j][j]` is D_j, the rest is zero. With the leading states first, propagation
/// leaves the parameters' part of U and D untouched (Bierman, *Factorization Methods for Discrete Sequential
/// Estimation*, 1977, chapters V and VII).
#[derive(Clone, Copy, Debug)]
pub struct Ud;

/// `U' h`: what a measurement row sees of the factored state.
#[inline(always)]
fn through_u<S: Shape, T: Real>(cov: &S::Matrix<T>, h: &S::Vector<T>) -> S::Vector<T> {
    let mut f = h.clone();
    for j in 0..S::STATES {
        let column = &cov[j];
        let mut sum = h[j];
        for i in 0..j {
            sum += column[i] * h[i];
        }
        f[j] = sum;
    }
    f
}

/// U D U' factors of the noise in its leading block: U stored like the covariance, but for its ones, and D. A zero pivot is no
/// noise. What stands above the diagonal is computed with and thrown away, so that rows are taken whole.
#[inline(always)]
fn factor<S: Shape, T: Real, M: Machine>(noise: &S::CoreMatrix<T>) -> (S::CoreMatrix<T>, S::CoreVector<T>) {
    let mut q = noise.clone();
    let mut weights = S::core_vector(T::zero());
    for j in (0..S::CORE).rev() {
        let row = q[j].clone();
        let is_driven = row[j] > T::zero();
        weights[j] = if is_driven { row[j] } else { T::zero() };
        let inverse = if is_driven { T::one() / row[j] } else { T::zero() };
        for i in 0..j {
            in_turn();
            let w = -(row[i] * inverse);
            for k in 0..S::CORE {
                q[i][k] = M::add_product(q[i][k], w, row[k]);
            }
        }
        for k in 0..S::CORE {
            q[j][k] = if k < j { row[k] * inverse } else { T::zero() };
        }
        q[j][j] = T::one();
    }
    (q, weights)
}

/// P + c a a', of an `a` that is zero from `end` on: Agee and Turner's update, from the last column to the first.
fn add_rank_one<S: Shape, T: Real>(cov: &mut S::Matrix<T>, mut a: S::Vector<T>, mut c: T, end: usize) {
    for j in (0..end).rev() {
        let d = cov[j][j];
        let pivot = a[j];
        let grown = d + c * pivot * pivot;
        cov[j][j] = grown;
        if !(grown > T::zero()) {
            continue;
        }
        let weight = c * pivot / grown;
        for i in 0..j {
            let u = cov[j][i];
            a[i] -= pivot * u;
            cov[j][i] = u + weight * a[i];
        }
        c *= d / grown;
    }
}

/// Columns of U that are moved, or seen by a measurement, side by side.
const COLUMNS: usize = 6;
/// Measurements that are taken in together: those of a vector.
const TOGETHER: usize = 3;
/// Rows of U that a measurement changes side by side.
const ROWS: usize = 8;

/// Takes D out of the diagonal and leaves the ones of U there: columns can then be used whole.
#[inline(always)]
fn take_weights<S: Shape, T: Real>(cov: &mut S::Matrix<T>) -> S::Vector<T> {
    let mut d = S::vector(T::one());
    for j in 0..S::STATES {
        in_turn();
        core::mem::swap(&mut d[j], &mut cov[j][j]);
    }
    d
}

#[inline(always)]
pub(crate) fn propagate<S: Shape, T: Real, M: Machine>(
    machine: M,
    cov: &mut S::Matrix<T>,
    rows: &S::CoreRows<T>,
    noise: &S::CoreMatrix<T>,
) {
    let mut d = take_weights::<S, T>(cov);
    let zero = S::core_vector(T::zero());
    let mut across: S::Vector<S::CoreVector<T>> = Array::from_fn(|| zero.clone());
    for j in 0..S::STATES {
        in_turn();
        for i in 0..S::CORE {
            across[j][i] = rows[i][j];
        }
    }
    // columns of [Phi Psi] U, the leading part of them: those of the parameters go where they belong
    let mut moved = S::core_matrix(T::zero());
    let mut columns = [(); COLUMNS].map(|()| S::core_vector(T::zero()));
    for j in (0..S::STATES).step_by(COLUMNS) {
        let last = S::STATES.min(j + COLUMNS);
        let left = |r: usize, k: usize| cov[j + r][k];
        let mut put = |r: usize, first: usize, values: &[T]| {
            columns[r].as_mut_slice()[first..first + values.len()].copy_from_slice(values);
        };
        // a length the compiler does not know keeps it from taking the tile apart into scalars where all blocks are whole
        let size = (core::hint::black_box(last - j), S::CORE);
        if M::WIDE {
            blocks::<M, T, _, COLUMNS, 8>(size, &left, across.as_slice(), &(0..last), &mut put);
        } else {
            blocks::<M, T, _, 2, 8>(size, &left, across.as_slice(), &(0..last), &mut put);
        }
        for j in j..last {
            let column = &columns[j % COLUMNS];
            if j < S::CORE {
                moved[j].clone_from(column);
            } else {
                cov[j].as_mut_slice()[..S::CORE].copy_from_slice(column.as_slice());
            }
        }
    }
    orthogonalise::<S, T, M>(machine, cov, &mut d, moved.as_mut_slice(), noise);
    for j in 0..S::STATES {
        in_turn();
        cov[j][j] = d[j];
    }
}

/// The leading block: the rows of [Phi U11, Uq] made orthogonal in the weights [D1, Dq], from the last to the first. The rows
/// stand in columns, so that one step serves all of them at once.
#[inline(always)]
fn orthogonalise<S: Shape, T: Real, M: Machine>(
    _: M,
    cov: &mut S::Matrix<T>,
    d: &mut S::Vector<T>,
    moved: &mut [S::CoreVector<T>],
    noise: &S::CoreMatrix<T>,
) {
    let (mut driven, noise) = factor::<S, T, M>(noise);
    let mut weights = [S::core_vector(T::zero()), noise];
    weights[0].as_mut_slice().copy_from_slice(&d.as_slice()[..S::CORE]);
    for j in (0..S::CORE).rev() {
        let mut products = S::core_vector(T::zero());
        // the noise's columns are zero before the diagonal, and stay so
        let parts = [(&*moved, 0), (driven.as_slice(), j)];
        for ((part, first), weights) in parts.into_iter().zip(&weights) {
            for k in first..S::CORE {
                let weighted = weights[k] * part[k][j];
                for i in 0..S::CORE {
                    products[i] = M::add_product(products[i], weighted, part[k][i]);
                }
            }
        }
        d[j] = products[j];
        let inverse = if d[j] > T::zero() { T::one() / d[j] } else { T::zero() };
        for i in 0..S::CORE {
            products[i] = if i < j { products[i] * inverse } else { T::zero() };
        }
        cov[j].as_mut_slice()[..S::CORE].copy_from_slice(products.as_slice());
        for (part, first) in [(&mut *moved, 0), (driven.as_mut_slice(), j)] {
            for k in first..S::CORE {
                let w = -part[k][j];
                for i in 0..S::CORE {
                    part[k][i] = M::add_product(part[k][i], w, products[i]);
                }
            }
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
    let mut d = take_weights::<S, T>(cov);
    let mut whitened = Whitened { nis: T::zero(), log_det: T::zero() };
    let mut done = Some(());
    let (h, r, z) = (h.as_slice(), r.as_slice(), z.as_slice());
    let whole = S::ROWS / TOGETHER * TOGETHER;
    for m in (0..whole).step_by(TOGETHER) {
        let next = (&h[m..], &r[m..], &z[m..]);
        done =
            done.and_then(|()| take_in::<S, T, _, TOGETHER>(machine, (cov, &mut d), x, next, &mut whitened));
    }
    for m in whole..S::ROWS {
        let next = (&h[m..], &r[m..], &z[m..]);
        done = done.and_then(|()| take_in::<S, T, _, 1>(machine, (cov, &mut d), x, next, &mut whitened));
    }
    for j in 0..S::STATES {
        in_turn();
        cov[j][j] = d[j];
    }
    done.map(|()| whitened)
}

/// `U' h` of `R` measurements, by column of U.
#[inline(always)]
fn seen_by<S: Shape, T: Real, M: Machine, const R: usize>(
    cov: &S::Matrix<T>,
    h: &[S::Vector<T>],
    seen: &mut S::Vector<[T; 4]>,
) {
    let mut list = S::vector(0);
    let used = used_columns::<S, T>(&h[..R], &mut list);
    let mut across = S::vector([T::zero(); 4]);
    for j in 0..S::STATES {
        in_turn();
        for m in 0..R {
            across[j][m] = h[m][j];
        }
    }
    let left = |j: usize, k: usize| cov[j][k];
    let whole = S::STATES / COLUMNS * COLUMNS;
    for j in (0..whole).step_by(COLUMNS) {
        let ks = list.as_slice()[..used].iter().copied().take_while(|k| *k < j + COLUMNS);
        let sums = tile::<M, T, _, COLUMNS, 4>(&left, across.as_slice(), ks, (j, 0));
        seen.as_mut_slice()[j..j + COLUMNS].copy_from_slice(&sums);
    }
    for j in whole..S::STATES {
        let ks = list.as_slice()[..used].iter().copied().take_while(|k| *k <= j);
        seen[j] = tile::<M, T, _, 1, 4>(&left, across.as_slice(), ks, (j, 0))[0];
    }
}

/// Takes in the first `R` of the measurements, each as Bierman's scalar update; they go through the columns of U together.
///
/// Measurement l turns column j of U, u, into `u + pull g` and its gain g, so far known in its first j entries, into
/// `g + v u`. What the next measurement sees of the new column, `h'u`, follows without a look at the column from `h'g`: so all
/// v and all pulls can be had first, and each column of U is then read and written once for all measurements.
#[inline(always)]
fn take_in<S: Shape, T: Real, M: Machine, const R: usize>(
    machine: M,
    (cov, d): (&mut S::Matrix<T>, &mut S::Vector<T>),
    x: &mut S::Vector<T>,
    (h, r, z): (&[S::Vector<T>], &[T], &[T]),
    whitened: &mut Whitened<T>,
) -> Option<()> {
    let mut v = S::vector([T::zero(); 4]);
    let mut pulls = S::vector([T::zero(); 4]);
    seen_by::<S, T, M, R>(cov, h, &mut v);
    // variance of each innovation
    let mut total = [T::one(); R];
    let mut inverse = [T::one(); R];
    for l in 0..R {
        // over the columns so far, and its inverse
        let mut so_far = r[l];
        let mut inverse_so_far = if so_far > T::zero() { T::one() / so_far } else { T::zero() };
        // h_m . g_l over the columns so far
        let mut shared = [T::zero(); R];
        for j in 0..S::STATES {
            let f = v[j];
            let weighted = d[j] * f[l];
            let pull = -f[l] * inverse_so_far;
            for m in l + 1..R {
                v[j][m] = M::add_product(f[m], pull, shared[m]);
                shared[m] = M::add_product(shared[m], weighted, f[m]);
            }
            if weighted != T::zero() {
                let grown = M::add_product(so_far, weighted, f[l]);
                inverse_so_far = if grown > T::zero() { T::one() / grown } else { T::zero() };
                d[j] *= so_far * inverse_so_far;
                so_far = grown;
            }
            v[j][l] = weighted;
            pulls[j][l] = pull;
        }
        total[l] = so_far;
        inverse[l] = inverse_so_far;
    }
    let mut gains = [(); R].map(|()| S::vector(T::zero()));
    turn::<S, T, M, R>(cov, &mut gains, &v, &pulls);
    for l in 0..R {
        if !(total[l] > T::zero()) {
            return None;
        }
        if is_present::<S, T>(&h[l]) {
            let residual = z[l] - dot(machine, h[l].as_slice(), x.as_slice());
            let innovation = residual * inverse[l];
            for j in 0..S::STATES {
                x[j] = M::add_product(x[j], gains[l][j], innovation);
            }
            whitened.nis += residual * innovation;
            whitened.log_det += total[l].ln();
        }
    }
    Some(())
}

/// The columns of U after `R` measurements, whose `v` and `pulls` are given by column; and the gains.
#[inline(always)]
fn turn<S: Shape, T: Real, M: Machine, const R: usize>(
    cov: &mut S::Matrix<T>,
    gains: &mut [S::Vector<T>; R],
    v: &S::Vector<[T; 4]>,
    pulls: &S::Vector<[T; 4]>,
) {
    // as many as fit, then half as many, then one by one
    let mut i = 0;
    while i + ROWS <= S::STATES {
        turn_rows::<S, T, M, R, ROWS>(cov, gains, i, v, pulls);
        i += ROWS;
    }
    if i + ROWS / 2 <= S::STATES {
        turn_rows::<S, T, M, R, { ROWS / 2 }>(cov, gains, i, v, pulls);
        i += ROWS / 2;
    }
    while i < S::STATES {
        turn_rows::<S, T, M, R, 1>(cov, gains, i, v, pulls);
        i += 1;
    }
}

/// Rows `i..i + C` of all columns of U, from the left to the right. Below the diagonal both U and the gains are still zero.
#[inline(always)]
fn turn_rows<S: Shape, T: Real, M: Machine, const R: usize, const C: usize>(
    cov: &mut S::Matrix<T>,
    gains: &mut [S::Vector<T>; R],
    i: usize,
    v: &S::Vector<[T; 4]>,
    pulls: &S::Vector<[T; 4]>,
) {
    let mut g = [[T::zero(); C]; R];
    for j in i..S::STATES {
        if let Some(column) = cov[j].as_mut_slice()[i..].first_chunk_mut::<C>() {
            // whole arrays: an entry at a time, the compiler makes scalars of them where the loop is short
            let mut turned = *column;
            for l in 0..R {
                let u = turned;
                for c in 0..C {
                    turned[c] = M::add_product(u[c], g[l][c], pulls[j][l]);
                }
                for c in 0..C {
                    g[l][c] = M::add_product(g[l][c], u[c], v[j][l]);
                }
            }
            *column = turned;
        }
    }
    for l in 0..R {
        gains[l].as_mut_slice()[i..i + C].copy_from_slice(&g[l]);
    }
}

impl Form for Ud {
    fn set_diagonal<S: Shape, T: Real>(cov: &mut S::Matrix<T>, variances: &S::Vector<T>) {
        *cov = S::matrix(T::zero());
        for i in 0..S::STATES {
            cov[i][i] = variances[i];
        }
    }

    fn propagate<S: Shape, T: Real>(cov: &mut S::Matrix<T>, rows: &S::CoreRows<T>, noise: &S::CoreMatrix<T>) {
        on_this_machine!(machine => propagate::<S, T, _>(machine, cov, rows, noise));
    }

    /// Scales the state's row of U, then adds its noise.
    fn fade<S: Shape, T: Real>(cov: &mut S::Matrix<T>, fade: &Fade<T>) {
        let s = fade.state;
        for j in s + 1..S::STATES {
            cov[j][s] *= fade.keep;
        }
        cov[s][s] *= fade.keep * fade.keep;
        let mut a = S::vector(T::zero());
        a[s] = T::one();
        for i in 0..s {
            cov[s][i] /= fade.keep;
        }
        add_rank_one::<S, T>(cov, a, fade.variance, s + 1);
    }

    /// `U D (U' h)`.
    fn times<S: Shape, T: Real>(cov: &S::Matrix<T>, h: &S::Vector<T>) -> S::Vector<T> {
        let f = through_u::<S, T>(cov, h);
        let mut ph = S::vector(T::zero());
        for j in 0..S::STATES {
            let weighted = cov[j][j] * f[j];
            for i in 0..j {
                ph[i] += cov[j][i] * weighted;
            }
            ph[j] += weighted;
        }
        ph
    }

    fn add_square<S: Shape, T: Real>(cov: &mut S::Matrix<T>, v: &S::Vector<T>) {
        let last = (0..S::STATES).rev().find(|i| v[*i] != T::zero());
        add_rank_one::<S, T>(cov, v.clone(), T::one(), last.map_or(0, |last| last + 1));
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
        let mut f = h.clone();
        for m in 0..S::ROWS {
            f[m] = through_u::<S, T>(cov, &h[m]);
        }
        let mut s = S::measurement_matrix(T::zero());
        for i in 0..S::ROWS {
            for l in 0..=i {
                let mut sum = T::zero();
                for j in 0..S::STATES {
                    sum += f[i][j] * cov[j][j] * f[l][j];
                }
                s[i][l] = sum;
                s[l][i] = sum;
            }
        }
        s
    }

    fn variance<S: Shape, T: Real>(cov: &S::Matrix<T>, i: usize) -> T {
        let mut sum = cov[i][i];
        for j in i + 1..S::STATES {
            sum += cov[j][i] * cov[j][i] * cov[j][j];
        }
        sum
    }

    fn dense<S: Shape, T: Real>(cov: &S::Matrix<T>, p: &mut S::Matrix<T>) {
        for i in 0..S::STATES {
            for l in 0..=i {
                // sum over the columns j at or right of the diagonal of both rows
                let mut sum = if l == i { cov[i][i] } else { cov[i][l] * cov[i][i] };
                for j in i + 1..S::STATES {
                    sum += cov[j][i] * cov[j][l] * cov[j][j];
                }
                p[i][l] = sum;
                p[l][i] = sum;
            }
        }
    }
}
