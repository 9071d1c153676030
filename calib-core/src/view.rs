//! Named access to a filter's estimate: no index is ever written by hand.

use core::marker::PhantomData;

use crate::{Block, Real};

/// A square matrix by its entries, whatever its size.
pub trait Entries<T> {
    /// The entry in row `i` and column `j`.
    fn entry(&self, i: usize, j: usize) -> T;
}

impl<T: Copy, const N: usize> Entries<T> for [[T; N]; N] {
    fn entry(&self, i: usize, j: usize) -> T {
        self[i][j]
    }
}

/// A state vector with its covariance, borrowed.
#[derive(Clone, Copy)]
pub struct Estimate<'a, T: Real> {
    /// The states, in the order of the declaration.
    pub x: &'a [T],
    /// The covariance; as many rows as states.
    pub p: &'a dyn Entries<T>,
}

/// A part of an [`Estimate`] that knows its block; the derive writes one for every struct of blocks.
pub trait View<'a, T: Real>: Sized {
    /// The view of the block that begins at state `offset`.
    fn at(estimate: Estimate<'a, T>, offset: usize) -> Self;
}

/// The states of one block within an estimate.
pub struct BlockView<'a, B, T: Real> {
    estimate: Estimate<'a, T>,
    offset: usize,
    block: PhantomData<B>,
}

impl<B, T: Real> Clone for BlockView<'_, B, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<B, T: Real> Copy for BlockView<'_, B, T> {}

impl<B: Block, T: Real> core::fmt::Debug for BlockView<'_, B, T> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_list().entries(self.values()).finish()
    }
}

impl<'a, B: Block, T: Real> View<'a, T> for BlockView<'a, B, T> {
    fn at(estimate: Estimate<'a, T>, offset: usize) -> Self {
        Self { estimate, offset, block: PhantomData }
    }
}

impl<'a, B: Block, T: Real> BlockView<'a, B, T> {
    /// The states, SI units, component order of the block.
    pub fn values(&self) -> &'a [T] {
        &self.estimate.x[self.offset..self.offset + B::DIM]
    }

    /// Covariance of components `i` and `j` of the block.
    ///
    /// # Panics
    /// When an index is not below the block's dimension.
    pub fn covariance(&self, i: usize, j: usize) -> T {
        assert!(i < B::DIM && j < B::DIM, "component outside the block");
        self.estimate.p.entry(self.offset + i, self.offset + j)
    }

    /// Standard deviation of component `i` of the block.
    ///
    /// # Panics
    /// When `i` is not below the block's dimension.
    pub fn sigma(&self, i: usize) -> T {
        self.covariance(i, i).sqrt()
    }
}
