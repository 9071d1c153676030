//! What a log can tell a filter, by its path alone.
//!
//! Two views. The structural one takes each still or turning stretch as a piece with constant H and F and stacks
//! `H, H F, H F^2, ...` of all pieces (Eq. 55-58 of the paper; Goshen-Meskin and Bar-Itzhack, *IEEE Trans. AES* 28(4), 1992):
//! its rank says what can be found at all. The other one is the information that the measurements of a run carry, with
//! the run's own transition matrices: it gives the standard deviation of each state before any data is taken.
//!
//! # Scales and tolerance
//! Columns are multiplied by the prior standard deviations of the states and rows divided by the standard deviations of
//! the measurements; the rows of the k-th power are those of the Taylor series over the piece, `H F^k d^k / k!` with d its
//! duration. A singular value is then the largest change of the reading, in its standard deviations, that one prior
//! standard deviation along the direction can cause, and the external observation itself has the singular value one, by
//! which Eq. 58 divides. Without the scales a rank means nothing: the columns differ by ten decades, the rows by twenty.
//!
//! A direction counts as observable above [`TOLERANCE`] standard deviations.

#[cfg(feature = "std")]
mod directions;
mod information;
mod segments;

use calib_core::{
    Array, Decomposition, Dynamics, Filter, MeasurementVector, ObservabilityRows, Shape, Triangle, Vector,
    relaxes,
};

use crate::calibration::Beginning;
use crate::{OpenBlocks, Point, Relaxation, Setup, Signals, Strapdown};

#[cfg(feature = "std")]
pub use directions::{Direction, basis};
pub use information::{Information, prior};
pub use segments::{Segment, Segmenter};

/// Singular values up to this one, in standard deviations of a reading, count as zero: one standard deviation of what was
/// believed before changes a reading by less than its noise. It is some eight decades above rounding, so the rank
/// does not depend on the arithmetic; and it is the size that data must have to say as much as the prior does.
pub const TOLERANCE: f64 = 1.0;

/// A state is excited well in a span where its degree of observability is above this, the paper's threshold for a singular
/// value that is not zero.
pub const EXCITED: f64 = 10.0;

/// Stacks the observability rows of segments.
pub struct Observability<F: Filter<Dynamics = Strapdown>> {
    prior: Vector<F, f64>,
    relaxing: Vector<F, Relaxation<f64>>,
    noise: MeasurementVector<F, f64>,
    open: OpenBlocks,
    triangle: Triangle<F::Shape, f64>,
}

impl<F: Filter<Dynamics = Strapdown>> Observability<F> {
    /// Nothing seen yet; priors, correlation times and measurement noise are those of the setup.
    pub fn new(setup: &Setup) -> Self {
        let mut noise = F::Shape::measurement(1.0);
        for (measured, info) in F::MEASURES.iter().enumerate() {
            for row in F::rows(measured) {
                noise[row] = setup.sigma(info);
            }
        }
        let Beginning { prior, relaxing, .. } = Beginning::<F>::new(setup, &mut |_, _, sigma| sigma);
        Self { prior, relaxing, noise, open: setup.open, triangle: Triangle::default() }
    }

    /// The same where measurement `measured`, by its place in [`Filter::MEASURES`], is never read.
    #[must_use]
    pub fn unread(mut self, measured: usize) -> Self {
        for row in F::rows(measured) {
            self.noise[row] = f64::INFINITY;
        }
        self
    }

    /// Appends the rows of a segment.
    ///
    /// The powers go to the number C of leading states: every higher one is a combination of these (Cayley and Hamilton; the
    /// parameters' part of F is zero). With parameters that relax all N are taken.
    pub fn add(&mut self, segment: &Segment) {
        let mut signals = Signals { open: self.open, ..segment.signals };
        if !self.open.couples_dither() {
            signals.coupled_dither.fill(0.0);
        }
        Strapdown::restrict::<F, f64>(&mut signals);
        let point = Point { open: self.open, ..segment.point };
        let relaxing = self.relaxing.clone();
        let mut rows =
            ObservabilityRows::<F, f64>::with_relaxing(&point, &signals, relaxing, segment.duration);
        let forgets = |state: &Relaxation<f64>| state.rate != 0.0;
        let relaxes = relaxes::<F>() && self.relaxing.as_slice().iter().any(forgets);
        let powers = if relaxes { F::Shape::STATES } else { F::Shape::CORE };
        let mut factorial = 1.0;
        for k in 0..=powers {
            if k > 0 {
                rows.advance();
                factorial *= k as f64;
            }
            for m in 0..F::Shape::ROWS {
                let mut row = rows.rows()[m].clone();
                for (entry, sigma) in row.as_mut_slice().iter_mut().zip(self.prior.as_slice()) {
                    *entry *= sigma / (self.noise[m] * factorial);
                }
                self.triangle.append(&row);
            }
        }
    }

    /// Takes a state for known: a row that it alone moves, by twice the tolerance. What is decomposed then has a singular value for it
    /// that says nothing of the data.
    pub fn know(&mut self, state: usize) {
        let mut row = F::Shape::vector(0.0);
        row[state] = 2.0 * TOLERANCE;
        self.triangle.append(&row);
    }

    /// Takes in what another one has stacked.
    pub fn join(&mut self, other: &Self) {
        self.triangle.join(&other.triangle);
    }

    /// Singular values and directions of what was stacked, in the scales of the [module](self).
    pub fn decompose(&self) -> Decomposition<F::Shape, f64> {
        self.triangle.decompose()
    }
}
