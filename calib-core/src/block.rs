//! State blocks: named groups of states, and what a declaration must know about them.

use crate::declare::Part;
use crate::{BlockVisitor, Dynamics, Real};

/// What people call one state, and what it is worth before any measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateInfo {
    /// Name of the block in reports, for instance `gyro-scale`.
    pub block: &'static str,
    /// Component within the block, for instance `x`, `yx` or `tau`.
    pub component: &'static str,
    /// SI unit of the state, `1` when it has none.
    pub unit: &'static str,
    /// Default prior standard deviation, in [`unit`](Self::unit).
    pub prior_sigma: f64,
    /// Unit that data sheets use for this state, for instance `ppm`.
    pub sheet_unit: &'static str,
    /// Size of one [`sheet_unit`](Self::sheet_unit) in [`unit`](Self::unit).
    pub sheet_scale: f64,
}

/// A rule of a block or of a family of dynamics: at least one block of some names must be declared.
#[derive(Clone, Copy, Debug)]
pub struct Need {
    /// [`Block::NAME`] of the blocks, one of which must be in the declaration.
    pub any_of: &'static [&'static str],
    /// What the compiler says when none is.
    pub message: &'static str,
}

/// A state that forgets: first-order Gauss-Markov, `x' = -x / tau + w`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relaxation<T> {
    /// Inverse correlation time 1/tau, 1/s; zero for a random walk.
    pub rate: T,
    /// One-sided noise density q of `w`, (unit of the state)^2/s.
    pub density: T,
}

/// A group of states with its effect on the system.
///
/// A parameter state is the error still to be removed, `truth - estimate`; a core state (one of the first
/// [`Dynamics::CORE`]) is the error of what was computed, `computed - truth`. The Jacobians are handed over entry by entry:
/// an entry that is never put is a structural zero, and since implementations are straight-line code with
/// constant indices the compiler sees the sparsity too.
///
/// A struct of blocks is a block again: `#[derive(StateBlocks)]` writes the implementation.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a state block",
    label = "no state block",
    note = "use a block of the prelude, derive `StateBlocks` for a group of blocks, or implement `Block`"
)]
pub trait Block: Sized + 'static {
    /// The family of dynamics this block belongs to.
    type Dynamics: Dynamics;

    /// Named access to the states of this block within a filter.
    type View<'a, T: Real>: crate::View<'a, T>;

    /// Name in reports, on the command line and in the rules of other blocks, for instance `gyro-scale`. No two blocks of
    /// a declaration have the same.
    const NAME: &'static str;

    /// Number of states; zero for a block that only switches a coupling on.
    const DIM: usize;

    /// What must be declared beside it.
    const NEEDS: &'static [Need] = &[];

    /// The states that are not constant, each with how it forgets; for those of a declaration see
    /// [`relaxations`](crate::relaxations).
    const RELAXATIONS: &'static [(usize, Relaxation<f64>)] = &[];

    /// The blocks it is made of; none for a block that is written by hand. Written by `#[derive(StateBlocks)]`.
    #[doc(hidden)]
    const PARTS: &'static [Part] = &[];

    /// Describes the states in order.
    fn states(visit: &mut dyn FnMut(StateInfo));

    /// Derivative of the sensor-input errors with respect to the states: `put(input, state, value)`.
    #[inline(always)]
    fn input_jacobian<T: Real>(
        signals: &<Self::Dynamics as Dynamics>::Signals<T>,
        put: &mut impl FnMut(usize, usize, T),
    ) {
        let _ = (signals, put);
    }

    /// Direct effect of the states on the measurement residuals: `put(channel, state, value)`.
    #[inline(always)]
    fn measurement_jacobian<T: Real>(
        at: &<Self::Dynamics as Dynamics>::Point<T>,
        put: &mut impl FnMut(usize, usize, T),
    ) {
        let _ = (at, put);
    }

    /// Visits the blocks that it is made of, itself when it is written by hand, each with its first state, counted from
    /// `first`. Written by `#[derive(StateBlocks)]`.
    #[inline(always)]
    fn blocks(first: usize, visitor: &mut impl BlockVisitor<Self::Dynamics>) {
        visitor.visit::<Self>(first);
    }
}
