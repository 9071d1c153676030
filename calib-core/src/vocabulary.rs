//! Which blocks a declaration is made of: by name at compile time, by type at run time.

use core::any::TypeId;

use crate::declare::Part;
use crate::{Block, Dynamics, Real, Relaxation};

/// What is done with every block of a declaration that is written by hand; see [`Block::blocks`].
pub trait BlockVisitor<D: Dynamics> {
    /// Called with block `B`, whose first state is `first`.
    fn visit<B: Block<Dynamics = D>>(&mut self, first: usize);
}

/// A block that is written by hand, within a declaration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Leaf {
    /// Its type.
    pub id: TypeId,
    /// [`Block::NAME`].
    pub name: &'static str,
    /// Its first state within the declaration.
    pub first: usize,
    /// Number of its states.
    pub states: usize,
}

impl Leaf {
    /// Whether it is block `B`.
    pub fn is<B: Block>(&self) -> bool {
        self.id == TypeId::of::<B>()
    }
}

/// Whether declaration `F` has block `B`. Evaluated at compile time it costs nothing; it goes by name there, which tells
/// the blocks of one declaration apart.
pub const fn declares<F: Block, B: Block>() -> bool {
    Part::of::<F>().has(B::NAME)
}

/// Visits the blocks that declaration `F` is made of, in the order of their states.
///
/// A block that only switches a coupling on is visited too. A filter extended by a block that it has already
/// ([`Extended`](crate::Extended)) shows it twice.
pub fn leaves<F: Block>(visit: impl FnMut(Leaf)) {
    F::blocks(0, &mut Leaves(visit));
}

struct Leaves<V>(V);

impl<D: Dynamics, V: FnMut(Leaf)> BlockVisitor<D> for Leaves<V> {
    fn visit<B: Block<Dynamics = D>>(&mut self, first: usize) {
        (self.0)(Leaf { id: TypeId::of::<B>(), name: B::NAME, first, states: B::DIM });
    }
}

/// The first state of block `B` within declaration `F`; `None` when it is not there.
pub fn first_state<F: Block, B: Block>() -> Option<usize> {
    let mut found = None;
    leaves::<F>(|leaf| {
        if leaf.is::<B>() {
            found = found.or(Some(leaf.first));
        }
    });
    found
}

/// Whether some state of declaration `F` forgets. Evaluated at compile time it costs nothing.
pub const fn relaxes<F: Block>() -> bool {
    Part::of::<F>().relaxes()
}

/// Visits the states of declaration `F` that are considered: those of the fields marked `#[consider]`.
pub fn considered_in<F: Block>(mut visit: impl FnMut(usize)) {
    Part::of::<F>().each_considered(0, &mut visit);
}

/// The states of declaration `F` that are not constant: `put(state, relaxation)`.
#[inline]
pub fn relaxations<F: Block, T: Real>(mut put: impl FnMut(usize, Relaxation<T>)) {
    if const { relaxes::<F>() } {
        visit_relaxing::<F, T>(&mut put);
    }
}

/// Compiled once, whatever is done with the states.
fn visit_relaxing<F: Block, T: Real>(put: &mut dyn FnMut(usize, Relaxation<T>)) {
    F::blocks(0, &mut Relaxations(put));
}

struct Relaxations<'a, T>(&'a mut dyn FnMut(usize, Relaxation<T>));

impl<D: Dynamics, T: Real> BlockVisitor<D> for Relaxations<'_, T> {
    #[inline(always)]
    fn visit<B: Block<Dynamics = D>>(&mut self, first: usize) {
        for (state, Relaxation { rate, density }) in B::RELAXATIONS {
            (self.0)(first + state, Relaxation { rate: T::of(*rate), density: T::of(*density) });
        }
    }
}
