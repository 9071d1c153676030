//! The non-trivial rows of a filter's transition matrix, accumulated over an interval.

use crate::machine::{Machine, on_this_machine};
use crate::tile::in_turn;
use crate::{Array, CoreRows, CoreVector, Dynamics, Filter, Real, Shape};

/// Columns of `[Phi Psi]` that move together.
const WIDTH: usize = 16;

/// `[Phi Psi]`: how the leading states at the end of an interval depend on all states at its beginning.
///
/// Between two updates sensors deliver many samples. Each is [`absorb`](Self::absorb)ed: the Jacobians of the parameter
/// blocks, turned into the leading states, times the sampling interval, are summed (`∫ B J dt`). Every few samples
/// [`advance`](Self::advance) moves the rows through the leading dynamics, to second order in the step.
pub struct Transition<F: Filter, T: Real> {
    rows: CoreRows<F, T>,
    drive: CoreRows<F, T>,
    elapsed: T,
}

impl<F: Filter, T: Real> Default for Transition<F, T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<F: Filter, T: Real> Transition<F, T> {
    /// The identity: no time has passed.
    pub fn new() -> Self {
        let mut new = Self {
            rows: F::Shape::core_rows(T::zero()),
            drive: F::Shape::core_rows(T::zero()),
            elapsed: T::zero(),
        };
        new.reset();
        new
    }

    /// Starts a new interval.
    pub fn reset(&mut self) {
        self.rows = F::Shape::core_rows(T::zero());
        for i in 0..F::Shape::CORE {
            self.rows[i][i] = T::one();
        }
        self.drive = F::Shape::core_rows(T::zero());
        self.elapsed = T::zero();
    }

    /// Adds one sample of `dt` seconds: `drive += B J dt`.
    #[inline]
    pub fn absorb(
        &mut self,
        at: &<F::Dynamics as Dynamics>::Point<T>,
        signals: &<F::Dynamics as Dynamics>::Signals<T>,
        dt: T,
    ) {
        let drive = &mut self.drive;
        F::input_jacobian(signals, &mut |input, state, value| {
            F::Dynamics::inject(at, input, value * dt, &mut |row, part| drive[row][state] += part);
        });
    }

    /// Moves through `dt` seconds of the leading dynamics at `at`, and takes in what was absorbed in them.
    ///
    /// `rows += dt A (rows + (dt A rows + drive) / 2) + drive`: exact to second order in `dt`.
    pub fn advance(&mut self, at: &<F::Dynamics as Dynamics>::Point<T>, dt: T) {
        let mut a = F::Shape::core_matrix(T::zero());
        F::Dynamics::core_jacobian(at, &mut |i, j, value| a[i][j] += value * dt);
        on_this_machine!(machine => advance::<F::Shape, T, _>(machine, &a, &mut self.rows, &mut self.drive));
        self.elapsed += dt;
    }

    /// The C x N rows `[Phi Psi]`.
    pub fn rows(&self) -> &CoreRows<F, T> {
        &self.rows
    }

    /// Length of the interval so far, s.
    pub fn elapsed(&self) -> T {
        self.elapsed
    }

    /// Covariance that white noise of the given densities D on the leading states adds over the interval T:
    /// Simpson's rule on `Phi D Phi'` with `(I + Phi) / 2` in the middle, exact for a chain of two integrators. Multiplied out,
    /// `T/6 (2 D + 2 Phi D Phi' + Phi D + D Phi')`.
    pub fn noise(&self, density: &CoreVector<F, T>) -> <F::Shape as Shape>::CoreMatrix<T> {
        let (sixth, two) = (self.elapsed / T::of(6.0), T::of(2.0));
        let mut q = F::Shape::core_matrix(T::zero());
        for i in 0..F::Shape::CORE {
            for l in 0..=i {
                let mut sum = if i == l { density[i] } else { T::zero() };
                for k in 0..F::Shape::CORE {
                    sum += self.rows[i][k] * density[k] * self.rows[l][k];
                }
                q[i][l] = sixth * (two * sum + self.rows[i][l] * density[l] + density[i] * self.rows[l][i]);
                q[l][i] = q[i][l];
            }
        }
        q
    }
}

/// The entries of each row of A that are not zero, a third of them for a strapdown system, with their columns.
struct Sparse<S: Shape, T: Real> {
    entries: S::CoreVector<S::CoreVector<(usize, T)>>,
    counts: S::CoreVector<usize>,
}

impl<S: Shape, T: Real> Sparse<S, T> {
    #[inline(always)]
    fn of(a: &S::CoreMatrix<T>) -> Self {
        let none = S::core_vector((0, T::zero()));
        let mut sparse = Self { entries: Array::from_fn(|| none.clone()), counts: S::core_vector(0) };
        for i in 0..S::CORE {
            let entries = &mut sparse.entries[i];
            let mut count = 0;
            for k in 0..S::CORE {
                entries[count] = (k, a[i][k]);
                count += usize::from(a[i][k] != T::zero());
            }
            sparse.counts[i] = count;
        }
        sparse
    }

    /// Row `i` of A times some columns of what has the given rows.
    #[inline(always)]
    fn row_times<'a, M: Machine, const W: usize>(
        &self,
        i: usize,
        row: impl Fn(usize) -> Option<&'a [T; W]>,
    ) -> [T; W] {
        let mut sums = [T::zero(); W];
        for &(k, a) in &self.entries[i].as_slice()[..self.counts[i]] {
            if let Some(row) = row(k) {
                for c in 0..W {
                    sums[c] = M::add_product(sums[c], a, row[c]);
                }
            }
        }
        sums
    }
}

/// `rows + drive + A (rows + (A rows + drive) / 2)`, and no drive any more. Columns move on their own: some at a time, so
/// that what is in between stays small.
#[inline(always)]
fn advance<S: Shape, T: Real, M: Machine>(
    machine: M,
    a: &S::CoreMatrix<T>,
    rows: &mut S::CoreRows<T>,
    drive: &mut S::CoreRows<T>,
) {
    let a = &Sparse::<S, T>::of(a);
    let mut done = 0;
    while done < S::STATES {
        if S::STATES >= WIDTH {
            // the last ones begin earlier, with columns that have moved already
            let first = done.min(S::STATES - WIDTH);
            advance_columns::<S, T, M, WIDTH>(machine, a, rows, drive, (first, done - first));
            done = first + WIDTH;
        } else {
            advance_columns::<S, T, M, 1>(machine, a, rows, drive, (done, 0));
            done += 1;
        }
    }
}

/// [`advance`] for `W` columns from `first` on, of which so many have moved already.
#[inline(always)]
fn advance_columns<S: Shape, T: Real, M: Machine, const W: usize>(
    _: M,
    a: &Sparse<S, T>,
    rows: &mut S::CoreRows<T>,
    drive: &mut S::CoreRows<T>,
    (first, moved): (usize, usize),
) {
    let half = T::of(0.5);
    let mut middle: S::CoreVector<[T; W]> = Array::from_fn(|| [T::zero(); W]);
    for i in 0..S::CORE {
        let mut sums = a.row_times::<M, W>(i, |k| rows[k].as_slice()[first..].first_chunk());
        let (row, driven) = (&rows[i].as_slice()[first..], &drive[i].as_slice()[first..]);
        if let (Some(row), Some(driven)) = (row.first_chunk::<W>(), driven.first_chunk::<W>()) {
            for c in 0..W {
                sums[c] = row[c] + half * (sums[c] + driven[c]);
            }
        }
        middle[i] = sums;
    }
    for i in 0..S::CORE {
        let mut sums = a.row_times::<M, W>(i, |k| Some(&middle[k]));
        if let Some(driven) = drive[i].as_mut_slice()[first..].first_chunk_mut() {
            let before: [T; W] = core::mem::replace(driven, [T::zero(); W]);
            for c in 0..W {
                sums[c] += before[c];
            }
        }
        // nothing is added once more to what has moved
        for c in 0..moved {
            in_turn();
            sums[c] = T::zero();
        }
        if let Some(row) = rows[i].as_mut_slice()[first..].first_chunk_mut::<W>() {
            for c in 0..W {
                row[c] += sums[c];
            }
        }
    }
}
