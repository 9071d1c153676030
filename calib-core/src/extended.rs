//! Generic code that adds a block to a declared filter.
//!
//! A declaration is concrete and its sizes are literals. Code that is generic over the declaration cannot add to a
//! literal, so the sizes of an [`Extended`] filter are added as types.

use core::fmt::Debug;
use core::marker::PhantomData;
use core::ops::Add;

use hybrid_array::typenum::Sum;
use hybrid_array::{ArraySize, AssocArraySize};

use crate::declare::{Part, unmet};
use crate::{
    Array, Block, BlockVisitor, Dim, Dynamics, Entries, Estimate, Filter, MeasurementInfo, Real, Shape,
    StateInfo, View,
};

/// A block whose number of states is a type too. `#[derive(StateBlocks)]` makes a group one; a block that is written by hand
/// becomes one in a group of its own:
///
/// ```text
/// #[derive(StateBlocks)]
/// #[group]
/// struct Mine {
///     spin: Spin,
/// }
/// ```
#[diagnostic::on_unimplemented(
    message = "the number of states of `{Self}` is no type",
    label = "no group of blocks",
    note = "put it into a group: `#[derive(StateBlocks)] #[group] struct Mine {{ own: {Self} }}`"
)]
pub trait Counted: Block {
    /// Number of states, [`Block::DIM`].
    type States: ArraySize;
}

/// A [`Shape`] whose sizes are types too: every [`Dim`] of up to 512 states, and [`Grown`].
pub trait Sizes: Shape {
    /// Number of states N.
    type States: ArraySize;
    /// Number of leading states C.
    type Core: ArraySize;
    /// Number of measurement rows M.
    type Rows: ArraySize;
}

impl<const N: usize, const C: usize, const M: usize> Sizes for Dim<N, C, M>
where
    [(); N]: AssocArraySize<Size: ArraySize>,
    [(); C]: AssocArraySize<Size: ArraySize>,
    [(); M]: AssocArraySize<Size: ArraySize>,
{
    type States = <[(); N] as AssocArraySize>::Size;
    type Core = <[(); C] as AssocArraySize>::Size;
    type Rows = <[(); M] as AssocArraySize>::Size;
}

impl<N: ArraySize, C: ArraySize, M: ArraySize> Sizes for Grown<N, C, M> {
    type States = N;
    type Core = C;
    type Rows = M;
}

/// Sizes given as types: `N` states of which the first `C` move, measured in `M` rows.
#[derive(Debug)]
pub struct Grown<N, C, M>(PhantomData<(N, C, M)>);

impl<N: ArraySize, C: ArraySize, M: ArraySize> Shape for Grown<N, C, M> {
    const STATES: usize = N::USIZE;
    const CORE: usize = C::USIZE;
    const ROWS: usize = M::USIZE;
    type Vector<E: Clone + Debug + Send + Sync> = hybrid_array::Array<E, N>;
    type Matrix<T: Real> = hybrid_array::Array<Self::Vector<T>, N>;
    type CoreRows<T: Real> = hybrid_array::Array<Self::Vector<T>, C>;
    type CoreMatrix<T: Real> = hybrid_array::Array<Self::CoreVector<T>, C>;
    type CoreVector<E: Clone + Debug + Send + Sync> = hybrid_array::Array<E, C>;
    type MeasurementRows<T: Real> = hybrid_array::Array<Self::Vector<T>, M>;
    type MeasurementMatrix<T: Real> = hybrid_array::Array<Self::Measurement<T>, M>;
    type Measurement<E: Clone + Debug + Send + Sync> = hybrid_array::Array<E, M>;
}

impl<E: Clone + Debug + Send + Sync, N: ArraySize> Array<E> for hybrid_array::Array<E, N> {
    #[inline(always)]
    fn from_fn(mut element: impl FnMut() -> E) -> Self {
        hybrid_array::Array::from_fn(|_| element())
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

impl<T: Copy, N: ArraySize> Entries<T> for hybrid_array::Array<hybrid_array::Array<T, N>, N> {
    fn entry(&self, i: usize, j: usize) -> T {
        self[i][j]
    }
}

/// A filter of `F`'s states followed by those of block `B`.
///
/// What `#[base]` does in a declaration, for code that is generic over the base. The block's needs are checked against
/// the base when the filter is used; unlike a declaration it may add a block that the base has already.
///
/// It is a filter for every declared `F`, for another extended one, and for every `B` that is [`Counted`]: a group, or an effect
/// of the catalogue. Nobody counts states for it. Generic code asks for `Extended<F, B>: Filter<Dynamics = ...>`.
#[derive(Debug)]
pub struct Extended<F, B>(PhantomData<(F, B)>);

/// Views of the base and of the added block.
pub struct ExtendedView<'a, F: Block, B: Block, T: Real> {
    /// The base filter's states.
    pub base: F::View<'a, T>,
    /// The added states.
    pub added: B::View<'a, T>,
}

impl<'a, F: Block, B: Block, T: Real> View<'a, T> for ExtendedView<'a, F, B, T> {
    fn at(estimate: Estimate<'a, T>, offset: usize) -> Self {
        Self { base: F::View::at(estimate, offset), added: B::View::at(estimate, offset + F::DIM) }
    }
}

impl<F: Filter, B: Block<Dynamics = F::Dynamics>> Block for Extended<F, B> {
    type Dynamics = F::Dynamics;
    type View<'a, T: Real> = ExtendedView<'a, F, B, T>;

    const NAME: &'static str = F::NAME;
    const DIM: usize = {
        let message = unmet(B::NEEDS, Self::PARTS);
        if !message.is_empty() {
            panic!("{}", message);
        }
        F::DIM + B::DIM
    };
    const PARTS: &'static [Part] = &[Part::of::<F>(), Part::of::<B>()];

    fn states(visit: &mut dyn FnMut(StateInfo)) {
        F::states(visit);
        B::states(visit);
    }

    #[inline(always)]
    fn input_jacobian<T: Real>(
        signals: &<Self::Dynamics as Dynamics>::Signals<T>,
        put: &mut impl FnMut(usize, usize, T),
    ) {
        F::input_jacobian(signals, put);
        B::input_jacobian(signals, &mut |input, state, value| put(input, state + F::DIM, value));
    }

    #[inline(always)]
    fn measurement_jacobian<T: Real>(
        at: &<Self::Dynamics as Dynamics>::Point<T>,
        put: &mut impl FnMut(usize, usize, T),
    ) {
        F::measurement_jacobian(at, put);
        B::measurement_jacobian(at, &mut |channel, state, value| put(channel, state + F::DIM, value));
    }

    #[inline(always)]
    fn blocks(first: usize, visitor: &mut impl BlockVisitor<Self::Dynamics>) {
        F::blocks(first, visitor);
        B::blocks(first + F::DIM, visitor);
    }
}

impl<F, B> Filter for Extended<F, B>
where
    F: Filter<Shape: Sizes<States: Add<B::States>>>,
    B: Counted<Dynamics = F::Dynamics>,
    Sum<<F::Shape as Sizes>::States, B::States>: ArraySize,
{
    type Shape = Grown<
        Sum<<F::Shape as Sizes>::States, B::States>,
        <F::Shape as Sizes>::Core,
        <F::Shape as Sizes>::Rows,
    >;
    const MEASURES: &'static [MeasurementInfo] = F::MEASURES;

    #[inline]
    fn residual<T: Real>(
        measured: usize,
        at: &<Self::Dynamics as Dynamics>::Point<T>,
        reading: &[T],
        put: &mut impl FnMut(usize, T),
    ) {
        F::residual(measured, at, reading, put);
    }

    #[inline(always)]
    fn residual_jacobian<T: Real>(
        at: &<Self::Dynamics as Dynamics>::Point<T>,
        put: &mut impl FnMut(usize, usize, T),
    ) {
        F::residual_jacobian(at, put);
    }
}
