//! Generic code that adds a block to a declared filter.
//!
//! A declaration is concrete and its sizes are literals. Code that is generic over the declaration cannot add to a
//! literal, so the sizes of an [`Extended`] filter are added as types.

use core::fmt::Debug;
use core::marker::PhantomData;
use core::ops::Add;

use hybrid_array::typenum::{Sum, Unsigned};
use hybrid_array::{ArraySize, AssocArraySize};

use crate::{
    Array, Block, BlockSet, Dim, Dynamics, Entries, Estimate, Filter, Need, Real, Relaxation, Shape,
    StateInfo, View,
};

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

/// A filter of `F`'s states followed by those of block `B`, whose number of states is `K` (a `typenum` number).
///
/// What `#[base]` does in a declaration, for code that is generic over the base. The block's needs are checked against
/// the base when the filter is used.
#[derive(Debug)]
pub struct Extended<F, B, K>(PhantomData<(F, B, K)>);

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

impl<F, B, K> Block for Extended<F, B, K>
where
    F: Filter,
    B: Block<Dynamics = F::Dynamics>,
    K: Unsigned + 'static,
{
    type Dynamics = F::Dynamics;
    type View<'a, T: Real> = ExtendedView<'a, F, B, T>;

    const DIM: usize = {
        assert!(K::USIZE == B::DIM, "`K` of `Extended<F, B, K>` must be the number of states of `B`");
        let needs: &[Need] = B::NEEDS;
        let mut i = 0;
        while i < needs.len() {
            if !needs[i].any_of.intersects(F::SET.union(B::SET)) {
                panic!("{}", needs[i].message);
            }
            i += 1;
        }
        F::DIM + B::DIM
    };
    const SET: BlockSet = F::SET.union(B::SET);
    const RELAXES: bool = F::RELAXES || B::RELAXES;

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
    fn relaxation<T: Real>(put: &mut impl FnMut(usize, Relaxation<T>)) {
        F::relaxation(put);
        B::relaxation(&mut |state, relaxation| put(state + F::DIM, relaxation));
    }
}

impl<F, B, K, const N: usize, const C: usize, const M: usize> Filter for Extended<F, B, K>
where
    F: Filter<Shape = Dim<N, C, M>>,
    B: Block<Dynamics = F::Dynamics>,
    K: Unsigned + 'static,
    [(); N]: AssocArraySize,
    [(); C]: AssocArraySize,
    [(); M]: AssocArraySize,
    <[(); C] as AssocArraySize>::Size: ArraySize,
    <[(); M] as AssocArraySize>::Size: ArraySize,
    <[(); N] as AssocArraySize>::Size: Add<K>,
    Sum<<[(); N] as AssocArraySize>::Size, K>: ArraySize,
{
    const NAME: &'static str = F::NAME;
    type Shape = Grown<
        Sum<<[(); N] as AssocArraySize>::Size, K>,
        <[(); C] as AssocArraySize>::Size,
        <[(); M] as AssocArraySize>::Size,
    >;
    const MEASURES: &'static [usize] = F::MEASURES;
}
