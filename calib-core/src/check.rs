//! For the tests and benchmarks of whoever writes a block or declares a filter.
//!
//! - [`block`] and [`filter`]: what can be checked without knowing what is modelled.
//! - [`inputs`] and [`channels`]: the Jacobians of a block against a nonlinear model.
//! - [`bench`]: one cycle of a filter, timed against dense matrices once the covariances are equal.
//! - What these are made of: numerical differences, dual numbers, comparison.
//!
//! ```
//! use calib_core::Real;
//! use calib_core::check::{Model, central_jacobian, compare, dual_jacobian};
//!
//! struct Pendulum;
//! impl Model<2, 2> for Pendulum {
//!     fn value<T: Real>(&self, x: &[T; 2]) -> [T; 2] {
//!         [x[1], -x[0].sin()]
//!     }
//! }
//!
//! let x = [0.3_f64, -0.2];
//! let by_hand = [[0.0, 1.0], [-x[0].cos(), 0.0]];
//! compare(&by_hand, &dual_jacobian(&Pendulum, &x), 1e-14)?;
//! compare(&by_hand, &central_jacobian(|x| Pendulum.value(x), &x, &[1e-3; 2]), 1e-9)?;
//! # Ok::<(), calib_core::check::Mismatch>(())
//! ```

mod blocks;
mod cycle;

use num_dual::Dual64;

pub use blocks::{Faults, Report, block, channels, filter, inputs};
pub use cycle::bench;

use crate::Real;

/// A function of N numbers with M results, written once for every scalar.
pub trait Model<const N: usize, const M: usize> {
    /// The results at `x`.
    fn value<T: Real>(&self, x: &[T; N]) -> [T; M];
}

/// The Jacobian by dual numbers, exact to rounding: entry `[i][j]` is the derivative of result i by number j.
pub fn dual_jacobian<const N: usize, const M: usize>(
    model: &impl Model<N, M>,
    x: &[f64; N],
) -> [[f64; N]; M] {
    let mut jacobian = [[0.0; N]; M];
    for j in 0..N {
        let seeded: [Dual64; N] = core::array::from_fn(|k| Dual64::new(x[k], if k == j { 1.0 } else { 0.0 }));
        for (row, value) in jacobian.iter_mut().zip(model.value(&seeded)) {
            row[j] = value.eps;
        }
    }
    jacobian
}

/// The Jacobian by central differences with `steps`, taken at one and at half a step and extrapolated: the error is of
/// fourth order in the step.
pub fn central_jacobian<const N: usize, const M: usize>(
    f: impl Fn(&[f64; N]) -> [f64; M],
    x: &[f64; N],
    steps: &[f64; N],
) -> [[f64; N]; M] {
    let mut jacobian = [[0.0; N]; M];
    for j in 0..N {
        let slope = |step: f64| {
            let (mut up, mut down) = (*x, *x);
            up[j] += step;
            down[j] -= step;
            let (high, low) = (f(&up), f(&down));
            core::array::from_fn::<f64, M, _>(|i| (high[i] - low[i]) / (up[j] - down[j]))
        };
        let (coarse, fine) = (slope(steps[j]), slope(steps[j] * 0.5));
        for i in 0..M {
            jacobian[i][j] = fine[i] + (fine[i] - coarse[i]) / 3.0;
        }
    }
    jacobian
}

/// An entry that differs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mismatch {
    /// Row of the entry.
    pub row: usize,
    /// Column of the entry.
    pub column: usize,
    /// What was to be checked.
    pub found: f64,
    /// What it should be.
    pub expected: f64,
    /// Difference by the largest expected entry of the column.
    pub relative: f64,
}

impl core::fmt::Display for Mismatch {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(
            f,
            "Jacobian entry ({}, {}) is {:e}, expected {:e}: relative difference {:e}",
            self.row, self.column, self.found, self.expected, self.relative
        )
    }
}

impl core::error::Error for Mismatch {}

/// Compares two Jacobians entry by entry, relative to the largest expected entry of the same column: the scale on which
/// that number acts.
///
/// # Errors
/// The first entry that differs by more than `tolerance`, or is not finite.
pub fn compare<const N: usize, const M: usize>(
    found: &[[f64; N]; M],
    expected: &[[f64; N]; M],
    tolerance: f64,
) -> Result<(), Mismatch> {
    for column in 0..N {
        let scale = (0..M).fold(0.0_f64, |scale, row| scale.max(expected[row][column].abs()));
        for row in 0..M {
            let (a, b) = (found[row][column], expected[row][column]);
            let relative = if a == b { 0.0 } else { (a - b).abs() / scale.max(f64::MIN_POSITIVE) };
            if !(relative <= tolerance) {
                return Err(Mismatch { row, column, found: a, expected: b, relative });
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Cubic;
    impl Model<1, 2> for Cubic {
        fn value<T: Real>(&self, x: &[T; 1]) -> [T; 2] {
            [x[0] * x[0] * x[0], x[0].exp()]
        }
    }

    #[test]
    fn both_ways_agree_with_calculus() {
        let want = [[3.0 * 0.49], [0.7_f64.exp()]];
        compare(&dual_jacobian(&Cubic, &[0.7]), &want, 1e-15).unwrap();
        compare(&central_jacobian(|x| Cubic.value(x), &[0.7], &[1e-2]), &want, 1e-9).unwrap();
    }

    #[test]
    fn a_wrong_entry_is_named() {
        let wrong = compare(&[[1.0, 2.0], [3.0, 4.1]], &[[1.0, 2.0], [3.0, 4.0]], 1e-6).unwrap_err();
        assert_eq!((wrong.row, wrong.column), (1, 1));
        assert!(compare(&[[f64::NAN]], &[[1.0]], 1e-6).is_err());
    }
}
