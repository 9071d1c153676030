//! Rows of the observability matrix of a declared filter, and a place to stack them.

mod triangle;

pub use triangle::{Decomposition, Triangle};

use crate::{
    CoreRows, Dynamics, Filter, MeasurementRows, Real, Relaxation, Shape, Vector, measurement_rows,
    relaxations, relaxing,
};

/// The C non-trivial rows `[A B]` of the continuous system matrix F; below them stand zeros, or the rates of
/// parameters that relax.
pub fn system_rows<F: Filter, T: Real>(
    at: &<F::Dynamics as Dynamics>::Point<T>,
    signals: &<F::Dynamics as Dynamics>::Signals<T>,
) -> CoreRows<F, T> {
    let mut rows = F::Shape::core_rows(T::zero());
    F::Dynamics::core_jacobian(at, &mut |i, j, a| rows[i][j] += a);
    F::input_jacobian(signals, &mut |input, state, value| {
        F::Dynamics::inject(at, input, value, &mut |row, part| rows[row][state] += part);
    });
    rows
}

/// The blocks `H, H F, H F^2, ...` of a segment with constant H and F (piecewise constant systems: Goshen-Meskin and
/// Bar-Itzhack, *IEEE Trans. AES* 28(4), 1992), one after the other.
///
/// Time is counted in units of `seconds`, so that the rows of high powers neither vanish nor explode; scale the columns
/// by the prior standard deviations of the states before judging a rank.
pub struct ObservabilityRows<F: Filter, T: Real> {
    system: CoreRows<F, T>,
    rows: MeasurementRows<F, T>,
    relaxing: Vector<F, Relaxation<T>>,
    seconds: T,
}

impl<F: Filter, T: Real> ObservabilityRows<F, T> {
    /// Begins with H at `at`; states that relax do so as they are declared to.
    pub fn new(
        at: &<F::Dynamics as Dynamics>::Point<T>,
        signals: &<F::Dynamics as Dynamics>::Signals<T>,
        seconds: T,
    ) -> Self {
        Self::with_relaxing(at, signals, relaxing::<F, T>(), seconds)
    }

    /// [`new`](Self::new) with `relaxing` by state in place of those that are declared.
    pub fn with_relaxing(
        at: &<F::Dynamics as Dynamics>::Point<T>,
        signals: &<F::Dynamics as Dynamics>::Signals<T>,
        relaxing: Vector<F, Relaxation<T>>,
        seconds: T,
    ) -> Self {
        Self {
            relaxing,
            system: system_rows::<F, T>(at, signals),
            rows: measurement_rows::<F, T>(at, signals),
            seconds,
        }
    }

    /// The current block, M x N.
    pub fn rows(&self) -> &MeasurementRows<F, T> {
        &self.rows
    }

    /// Goes on to the next power of F: `rows <- rows F`.
    pub fn advance(&mut self) {
        for m in 0..F::Shape::ROWS {
            let before = self.rows[m].clone();
            for j in 0..F::Shape::STATES {
                let mut sum = T::zero();
                for i in 0..F::Shape::CORE {
                    sum += before[i] * self.system[i][j];
                }
                self.rows[m][j] = sum * self.seconds;
            }
            let (row, relaxing, seconds) = (&mut self.rows[m], &self.relaxing, self.seconds);
            relaxations::<F, T>(|state, _| {
                row[state] -= before[state] * relaxing[state].rate * seconds;
            });
        }
    }
}
