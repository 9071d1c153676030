//! A declared filter: its sizes, and the matrices it is assembled into.

use core::fmt::Debug;
use core::ops::IndexMut;

use crate::measurement::first_row;
use crate::{Block, Dynamics, Entries, Estimate, MeasurementInfo, Real, View};

/// Sizes of a filter as types: the arrays it needs.
///
/// A declaration names its [`Dim`]; generic code that extends a filter by a block gets its sizes from
/// [`Grown`](crate::Grown). The kernels are written once over this trait: lengths are constants after
/// monomorphisation, whichever of the two they come from.
pub trait Shape: Sized + 'static {
    /// Number of states N.
    const STATES: usize;
    /// Number of leading states C.
    const CORE: usize;
    /// Number of measurement rows M.
    const ROWS: usize;
    /// N of anything.
    type Vector<E: Clone + Debug + Send + Sync>: Array<E>;
    /// N x N numbers, row after row.
    type Matrix<T: Real>: Array<Self::Vector<T>> + Entries<T>;
    /// C x N numbers: the non-trivial rows of the transition matrix.
    type CoreRows<T: Real>: Array<Self::Vector<T>>;
    /// C x C numbers.
    type CoreMatrix<T: Real>: Array<Self::CoreVector<T>>;
    /// C of anything.
    type CoreVector<E: Clone + Debug + Send + Sync>: Array<E>;
    /// M x N numbers: the measurement matrix.
    type MeasurementRows<T: Real>: Array<Self::Vector<T>>;
    /// M x M numbers.
    type MeasurementMatrix<T: Real>: Array<Self::Measurement<T>>;
    /// M of anything.
    type Measurement<E: Clone + Debug + Send + Sync>: Array<E>;

    /// N times the same.
    #[inline(always)]
    fn vector<E: Copy + Debug + Send + Sync>(value: E) -> Self::Vector<E> {
        Array::from_fn(|| value)
    }
    /// N x N equal numbers.
    #[inline(always)]
    fn matrix<T: Real>(value: T) -> Self::Matrix<T> {
        Array::from_fn(|| Self::vector(value))
    }
    /// C x N equal numbers.
    #[inline(always)]
    fn core_rows<T: Real>(value: T) -> Self::CoreRows<T> {
        Array::from_fn(|| Self::vector(value))
    }
    /// C x C equal numbers.
    #[inline(always)]
    fn core_matrix<T: Real>(value: T) -> Self::CoreMatrix<T> {
        Array::from_fn(|| Self::core_vector(value))
    }
    /// C equal numbers.
    #[inline(always)]
    fn core_vector<T: Copy + Debug + Send + Sync>(value: T) -> Self::CoreVector<T> {
        Array::from_fn(|| value)
    }
    /// M x N equal numbers.
    #[inline(always)]
    fn measurement_rows<T: Real>(value: T) -> Self::MeasurementRows<T> {
        Array::from_fn(|| Self::vector(value))
    }
    /// M x M equal numbers.
    #[inline(always)]
    fn measurement_matrix<T: Real>(value: T) -> Self::MeasurementMatrix<T> {
        Array::from_fn(|| Self::measurement(value))
    }
    /// M equal numbers.
    #[inline(always)]
    fn measurement<T: Real>(value: T) -> Self::Measurement<T> {
        Array::from_fn(|| value)
    }
}

/// An array whose length is part of its type.
pub trait Array<E: Clone>: Clone + Debug + Send + Sync + IndexMut<usize, Output = E> {
    /// An array of elements made one by one.
    fn from_fn(element: impl FnMut() -> E) -> Self;
    /// The elements as a slice.
    fn as_slice(&self) -> &[E];
    /// The elements as a mutable slice.
    fn as_mut_slice(&mut self) -> &mut [E];
}

impl<E: Clone + Debug + Send + Sync, const N: usize> Array<E> for [E; N] {
    #[inline(always)]
    fn from_fn(mut element: impl FnMut() -> E) -> Self {
        core::array::from_fn(|_| element())
    }
    #[inline(always)]
    fn as_slice(&self) -> &[E] {
        self
    }
    #[inline(always)]
    fn as_mut_slice(&mut self) -> &mut [E] {
        self
    }
}

/// `STATES` states of which the first `CORE` move, measured in `ROWS` rows.
#[derive(Debug)]
pub struct Dim<const STATES: usize, const CORE: usize, const ROWS: usize>;

impl<const N: usize, const C: usize, const M: usize> Shape for Dim<N, C, M> {
    const STATES: usize = N;
    const CORE: usize = C;
    const ROWS: usize = M;
    type Vector<E: Clone + Debug + Send + Sync> = [E; N];
    type Matrix<T: Real> = [[T; N]; N];
    type CoreRows<T: Real> = [[T; N]; C];
    type CoreMatrix<T: Real> = [[T; C]; C];
    type CoreVector<E: Clone + Debug + Send + Sync> = [E; C];
    type MeasurementRows<T: Real> = [[T; N]; M];
    type MeasurementMatrix<T: Real> = [[T; M]; M];
    type Measurement<E: Clone + Debug + Send + Sync> = [E; M];

    // in place: `from_fn` makes an array of arrays elsewhere and copies it
    #[inline(always)]
    fn vector<E: Copy + Debug + Send + Sync>(value: E) -> [E; N] {
        [value; N]
    }
}

/// A declared filter: a [`Block`] that begins with the leading states of its dynamics, and a choice of
/// measurements. Written by `#[derive(StateBlocks)]`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a declared filter",
    label = "no declared filter",
    note = "a filter is a struct with `#[derive(StateBlocks)]` and `#[filter(measures(...))]`; one with `#[group]` is a part of filters"
)]
pub trait Filter: Block {
    /// The sizes of the filter.
    type Shape: Shape;
    /// The measurements, in the order of their rows.
    const MEASURES: &'static [MeasurementInfo];

    /// [`Measurement::residual`](crate::Measurement::residual) of the measurement at place `measured` of
    /// [`MEASURES`](Self::MEASURES), its rows counted from 0.
    fn residual<T: Real>(
        measured: usize,
        at: &<Self::Dynamics as Dynamics>::Point<T>,
        reading: &[T],
        put: &mut impl FnMut(usize, T),
    );

    /// [`Measurement::jacobian`](crate::Measurement::jacobian) of all measurements: `put(row, channel, value)`, with the
    /// rows of the filter.
    fn residual_jacobian<T: Real>(
        at: &<Self::Dynamics as Dynamics>::Point<T>,
        put: &mut impl FnMut(usize, usize, T),
    );

    /// Named access to a state vector and its covariance: `F::view(&x, &p).inner_lever().sigma(0)`.
    fn view<'a, T: Real>(x: &'a Vector<Self, T>, p: &'a Matrix<Self, T>) -> Self::View<'a, T> {
        Self::View::at(Estimate { x: x.as_slice(), p }, 0)
    }

    /// Rows of the measurement at place `measured` of [`MEASURES`](Self::MEASURES).
    #[inline]
    fn rows(measured: usize) -> core::ops::Range<usize> {
        let first = first_row(Self::MEASURES, measured);
        first..first + Self::MEASURES[measured].components.len()
    }
}

/// Shorthand for the arrays of a filter.
pub type Vector<F, T> = <<F as Filter>::Shape as Shape>::Vector<T>;
/// Shorthand for the covariance of a filter.
pub type Matrix<F, T> = <<F as Filter>::Shape as Shape>::Matrix<T>;
/// Shorthand for the non-trivial rows of a filter's transition matrix.
pub type CoreRows<F, T> = <<F as Filter>::Shape as Shape>::CoreRows<T>;
/// Shorthand for the measurement matrix of a filter.
pub type MeasurementRows<F, T> = <<F as Filter>::Shape as Shape>::MeasurementRows<T>;
/// Shorthand for numbers by measurement row.
pub type MeasurementVector<F, T> = <<F as Filter>::Shape as Shape>::Measurement<T>;
/// Shorthand for numbers by pairs of measurement rows.
pub type MeasurementMatrix<F, T> = <<F as Filter>::Shape as Shape>::MeasurementMatrix<T>;
/// Shorthand for numbers by leading state.
pub type CoreVector<F, T> = <<F as Filter>::Shape as Shape>::CoreVector<T>;
