//! The non-trivial rows of a filter's transition matrix, accumulated over an interval.

use crate::machine::{Machine, on_this_machine};
use crate::tile::product;
use crate::{Array, Block, BlockSet, CoreRows, CoreVector, Dynamics, Filter, Real, Shape};

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
        on_this_machine!(machine => advance::<F::Shape, T>(machine, &a, &mut self.rows, &self.drive));
        self.drive = F::Shape::core_rows(T::zero());
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

/// `rows + drive + A (rows + (A rows + drive) / 2)`, with A times the step in `a`.
#[inline(always)]
fn advance<S: Shape, T: Real>(
    machine: impl Machine,
    a: &S::CoreMatrix<T>,
    rows: &mut S::CoreRows<T>,
    drive: &S::CoreRows<T>,
) {
    let half = T::of(0.5);
    let mut middle = times::<S, T>(machine, a, rows);
    for i in 0..S::CORE {
        for j in 0..S::STATES {
            middle[i][j] = rows[i][j] + half * (middle[i][j] + drive[i][j]);
        }
    }
    let end = times::<S, T>(machine, a, &middle);
    for i in 0..S::CORE {
        for j in 0..S::STATES {
            rows[i][j] += drive[i][j] + end[i][j];
        }
    }
}

/// `A rows`.
#[inline(always)]
fn times<S: Shape, T: Real>(
    machine: impl Machine,
    a: &S::CoreMatrix<T>,
    rows: &S::CoreRows<T>,
) -> S::CoreRows<T> {
    let mut product_rows = S::core_rows(T::zero());
    let size = (S::CORE, S::STATES);
    product::<_, _, _, false>(
        machine,
        size,
        |i, k| a[i][k],
        rows.as_slice(),
        0..S::CORE,
        |i, first, values| {
            product_rows[i].as_mut_slice()[first..first + values.len()].copy_from_slice(values);
        },
    );
    product_rows
}

/// Removes from `signals` what filter `F` does not model.
#[inline(always)]
pub fn restrict<F: Filter, T: Real>(signals: &mut <F::Dynamics as Dynamics>::Signals<T>) {
    let blocks: BlockSet = <F as Block>::SET;
    F::Dynamics::restrict(signals, blocks);
}
