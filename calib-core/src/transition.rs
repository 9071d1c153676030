//! The non-trivial rows of a filter's transition matrix, accumulated over an interval.

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
        let half = T::of(0.5);
        let mut middle = self.rows.clone();
        for i in 0..F::Shape::CORE {
            add_scaled::<F::Shape, T>(&mut middle[i], &self.drive[i], half);
        }
        let mut end = self.rows.clone();
        for i in 0..F::Shape::CORE {
            add_scaled::<F::Shape, T>(&mut end[i], &self.drive[i], T::one());
        }
        let rows = &self.rows;
        F::Dynamics::core_jacobian(at, &mut |i, j, a| {
            add_scaled::<F::Shape, T>(&mut middle[i], &rows[j], a * dt * half);
        });
        F::Dynamics::core_jacobian(at, &mut |i, j, a| {
            add_scaled::<F::Shape, T>(&mut end[i], &middle[j], a * dt);
        });
        self.rows = end;
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

    /// Covariance that white noise of the given densities on the leading states adds over the interval:
    /// Simpson's rule on `Phi Q Phi'`, exact for a chain of two integrators.
    pub fn noise(&self, density: &CoreVector<F, T>) -> <F::Shape as Shape>::CoreMatrix<T> {
        let half = T::of(0.5);
        let (sixth, four_sixths) = (self.elapsed / T::of(6.0), self.elapsed * T::of(4.0 / 6.0));
        let mut q = F::Shape::core_matrix(T::zero());
        for k in 0..F::Shape::CORE {
            let d = density[k];
            if d == T::zero() {
                continue;
            }
            q[k][k] += d * sixth;
            for i in 0..F::Shape::CORE {
                let unit_i = if i == k { T::one() } else { T::zero() };
                let (end_i, mid_i) = (self.rows[i][k], half * (unit_i + self.rows[i][k]));
                for l in 0..F::Shape::CORE {
                    let unit_l = if l == k { T::one() } else { T::zero() };
                    let (end_l, mid_l) = (self.rows[l][k], half * (unit_l + self.rows[l][k]));
                    q[i][l] += d * (sixth * (end_i * end_l) + four_sixths * (mid_i * mid_l));
                }
            }
        }
        q
    }
}

/// `y += a x`. Kept out of line: a rolled loop vectorises, forty inlined copies do not.
#[inline(never)]
fn add_scaled<S: Shape, T: Real>(y: &mut S::Vector<T>, x: &S::Vector<T>, a: T) {
    for (y, x) in y.as_mut_slice().iter_mut().zip(x.as_slice()) {
        *y += a * *x;
    }
}

/// Removes from `signals` what filter `F` does not model.
#[inline(always)]
pub fn restrict<F: Filter, T: Real>(signals: &mut <F::Dynamics as Dynamics>::Signals<T>) {
    let blocks: BlockSet = <F as Block>::SET;
    F::Dynamics::restrict(signals, blocks);
}
