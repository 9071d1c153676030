//! The filters that others are composed of at run time: navigation with the measurements of a filter, and everything that can be
//! estimated.

use core::marker::PhantomData;

use calib_core::declare::Part;
use calib_core::{Extended, Grown, MeasurementInfo, Sizes};
use hybrid_array::typenum::U9;
use sinscal::literature::Systematic30;
use sinscal::prelude::*;
use sinscal::{BlockVisitor, Catalogue, Mems30, Open, Point, Sins36P, StateInfo, Tracked35};

use crate::filter::Pool;

/// The leading states.
#[derive(StateBlocks)]
#[group]
pub(crate) struct Navigation {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
}

/// All that can be estimated, and room for what is added at run time.
#[derive(StateBlocks)]
#[group]
pub(crate) struct Everything {
    known: Catalogue,
    dither: Dither,
    open: Open,
}

/// Navigation alone, measured as filter `F` measures.
pub(crate) struct Navigating<F>(PhantomData<fn() -> F>);

impl<F: Filter<Dynamics = Strapdown>> Block for Navigating<F> {
    type Dynamics = Strapdown;
    type View<'a, T: Real> = <Navigation as Block>::View<'a, T>;
    const NAME: &'static str = "pool";
    const DIM: usize = Navigation::DIM;
    const PARTS: &'static [Part] = Navigation::PARTS;

    fn states(visit: &mut dyn FnMut(StateInfo)) {
        Navigation::states(visit);
    }

    #[inline(always)]
    fn blocks(first: usize, visitor: &mut impl BlockVisitor<Strapdown>) {
        Navigation::blocks(first, visitor);
    }
}

impl<F: Filter<Dynamics = Strapdown, Shape: Sizes>> Filter for Navigating<F> {
    type Shape = Grown<U9, U9, <F::Shape as Sizes>::Rows>;
    const MEASURES: &'static [MeasurementInfo] = F::MEASURES;

    #[inline]
    fn residual<T: Real>(measured: usize, at: &Point<T>, reading: &[T], put: &mut impl FnMut(usize, T)) {
        F::residual(measured, at, reading, put);
    }

    #[inline(always)]
    fn residual_jacobian<T: Real>(at: &Point<T>, put: &mut impl FnMut(usize, usize, T)) {
        F::residual_jacobian(at, put);
    }
}

/// What a filter measures, where filters of the library do so too: they share one pool, which is compiled once.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Like {
    Table,
    Velocity,
    Carried,
    Tracked,
    Other,
}

// Not in a generic function, which would be compiled in every crate that declares a filter.
static TABLE: &Pool = Pool::of::<Extended<Navigating<Sins36P>, Everything>>();
static VELOCITY: &Pool = Pool::of::<Extended<Navigating<Systematic30>, Everything>>();
static CARRIED: &Pool = Pool::of::<Extended<Navigating<Mems30>, Everything>>();
static TRACKED: &Pool = Pool::of::<Extended<Navigating<Tracked35>, Everything>>();

/// The pool for filters that measure what `F` does.
pub(crate) fn pool<F: Filter<Dynamics = Strapdown, Shape: Sizes>>() -> &'static Pool {
    // known at compile time: a pool of its own is not compiled for every `F`
    if const { matches!(like(F::MEASURES), Like::Table) } {
        TABLE
    } else if const { matches!(like(F::MEASURES), Like::Velocity) } {
        VELOCITY
    } else if const { matches!(like(F::MEASURES), Like::Carried) } {
        CARRIED
    } else if const { matches!(like(F::MEASURES), Like::Tracked) } {
        TRACKED
    } else {
        Pool::of::<Extended<Navigating<F>, Everything>>()
    }
}

const fn like(measures: &[MeasurementInfo]) -> Like {
    match measures {
        [first, second] if is(first, "velocity") && is(second, "position") => Like::Table,
        [only] if is(only, "velocity") => Like::Velocity,
        [first, second] if is(first, "velocity") && is(second, "rate") => Like::Carried,
        [first, second] if is(first, "position") && is(second, "attitude") => Like::Tracked,
        _ => Like::Other,
    }
}

const fn is(measured: &MeasurementInfo, name: &str) -> bool {
    let (a, b) = (measured.name.as_bytes(), name.as_bytes());
    let mut same = a.len() == b.len() && measured.channels.is_some();
    let mut i = 0;
    while same && i < a.len() {
        same = a[i] == b[i];
        i += 1;
    }
    same
}
