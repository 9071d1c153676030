//! State blocks: named groups of states, and what a declaration must know about them.

use crate::{Dynamics, Real};

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

/// A set of blocks known to a family of dynamics, as bits.
///
/// Declarations are checked with it at compile time: which blocks are there, which are missing, which
/// stand there twice. Each family of dynamics numbers its blocks; a block that nobody asks for needs no number. For
/// strapdown systems 31 to 63 are free for blocks of other crates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlockSet(u64);

impl BlockSet {
    /// No block.
    pub const EMPTY: Self = Self(0);

    /// The set of the one block numbered `index` (below 64).
    pub const fn only(index: u32) -> Self {
        Self(1 << index)
    }

    /// Blocks in either set.
    pub const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Whether the sets share a block.
    pub const fn intersects(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// Whether every block of `other` is in this set.
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }
}

/// A rule of a block or of a family of dynamics: at least one block of a set must be declared.
#[derive(Clone, Copy, Debug)]
pub struct Need {
    /// One of these must be in the declaration.
    pub any_of: BlockSet,
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
pub trait Block: 'static {
    /// The family of dynamics this block belongs to.
    type Dynamics: Dynamics;

    /// Named access to the states of this block within a filter.
    type View<'a, T: Real>: crate::View<'a, T>;

    /// Number of states; zero for a block that only switches a coupling on.
    const DIM: usize;

    /// What the block provides, for the rules of other blocks.
    const SET: BlockSet = BlockSet::EMPTY;

    /// What must be declared beside it.
    const NEEDS: &'static [Need] = &[];

    /// Whether some state of the block has a [`relaxation`](Self::relaxation).
    const RELAXES: bool = false;

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

    /// States that are not constant: `put(state, relaxation)`.
    #[inline(always)]
    fn relaxation<T: Real>(put: &mut impl FnMut(usize, Relaxation<T>)) {
        let _ = put;
    }
}
