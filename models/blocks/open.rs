//! Blocks that join a filter at run time.

use core::fmt::{Debug, Display, Formatter};

use calib_core::{Block, BlockView, Dynamics, Real, Relaxation, StateInfo};
use nalgebra::convert_unchecked;

use crate::{AnyBlock, Point, Signals, Strapdown};

/// Room for blocks that are chosen at run time: [`CAPACITY`](Self::CAPACITY) states whose Jacobians are those of the
/// [`OpenBlocks`] that the signals and the point carry.
///
/// - Where: in a filter that is compiled before it is known what it has to model. The states of the first block come first; what
///   is left over has no Jacobian and a prior of zero, and takes no part.
/// - What joins is given to the run: [`Setup::open`](crate::Setup::open).
/// - A filter says nothing of what joins: names, units and priors of the states come with
///   [`Calibration::parameters`](crate::Calibration::parameters).
#[derive(Clone, Copy, Debug)]
pub struct Open;

impl Open {
    /// Number of its states.
    pub const CAPACITY: usize = 32;
}

/// Names of the states that are not taken.
const PLACES: [&str; Open::CAPACITY] = [
    "0", "1", "2", "3", "4", "5", "6", "7", "8", "9", "10", "11", "12", "13", "14", "15", "16", "17", "18",
    "19", "20", "21", "22", "23", "24", "25", "26", "27", "28", "29", "30", "31",
];

/// The places as states that relax, with nothing to forget.
const CONSTANT: [(usize, Relaxation<f64>); Open::CAPACITY] = {
    let mut all = [(0, Relaxation { rate: 0.0, density: 0.0 }); Open::CAPACITY];
    let mut at = 0;
    while at < all.len() {
        all[at].0 = at;
        at += 1;
    }
    all
};

const fn place(at: usize) -> StateInfo {
    StateInfo {
        block: Open::NAME,
        component: PLACES[at],
        unit: "1",
        prior_sigma: 0.0,
        sheet_unit: "1",
        sheet_scale: 1.0,
    }
}

impl Block for Open {
    type Dynamics = Strapdown;
    type View<'a, T: Real> = BlockView<'a, Self, T>;

    /// States that are taken carry the names of their own blocks.
    const NAME: &'static str = "open";
    const DIM: usize = Self::CAPACITY;
    /// Any place may be taken by a state that forgets; until one does, all are constant.
    const RELAXATIONS: &'static [(usize, Relaxation<f64>)] = &CONSTANT;

    fn states(visit: &mut dyn FnMut(StateInfo)) {
        for at in 0..Self::CAPACITY {
            visit(place(at));
        }
    }

    #[inline]
    fn input_jacobian<T: Real>(signals: &Signals<T>, put: &mut impl FnMut(usize, usize, T)) {
        if signals.open.is_empty() {
            return;
        }
        let at = signals.map(convert_unchecked::<T, f64>);
        signals.open.each(|offset, block| {
            block.input_jacobian(&at, &mut |input, state, value| put(input, offset + state, T::of(value)));
        });
    }

    #[inline]
    fn measurement_jacobian<T: Real>(at: &Point<T>, put: &mut impl FnMut(usize, usize, T)) {
        if at.open.is_empty() {
            return;
        }
        let of = at.map(convert_unchecked::<T, f64>);
        at.open.each(|offset, block| {
            block.measurement_jacobian(&of, &mut |channel, state, value| {
                put(channel, offset + state, T::of(value));
            });
        });
    }
}

/// The blocks that take part in a filter with [`Open`]; none by default.
///
/// It also says whether the dither acts through the inner lever arm of a filter that declares [`Dither`](crate::Dither), as it does
/// by default.
#[derive(Clone, Copy, Default)]
pub struct OpenBlocks {
    blocks: &'static [&'static dyn AnyBlock],
    uncoupled: bool,
}

impl OpenBlocks {
    /// None.
    pub const NONE: Self = Self { blocks: &[], uncoupled: false };

    /// These blocks, in this order.
    ///
    /// # Errors
    /// When they have more states than [`Open`] has room for, and when one describes another number of states than it has or puts an
    /// entry outside of them.
    pub fn new(blocks: &'static [&'static dyn AnyBlock]) -> Result<Self, OpenError> {
        let mut states = 0;
        for block in blocks {
            states += block.dim();
            let name = name(*block);
            if !sound(*block) {
                return Err(OpenError { name, fault: Fault::Unsound });
            }
            if states > Open::CAPACITY {
                return Err(OpenError { name, fault: Fault::Full });
            }
        }
        Ok(Self { blocks, uncoupled: false })
    }

    /// The same where the dither does not act through the inner lever arm, whatever is declared.
    #[must_use]
    pub const fn without_dither(self) -> Self {
        Self { uncoupled: true, ..self }
    }

    /// Whether the dither may act through the inner lever arm.
    #[inline(always)]
    pub const fn couples_dither(self) -> bool {
        !self.uncoupled
    }

    /// Whether there is none.
    #[inline(always)]
    pub const fn is_empty(self) -> bool {
        self.blocks.is_empty()
    }

    /// The blocks in order.
    pub const fn blocks(self) -> &'static [&'static dyn AnyBlock] {
        self.blocks
    }

    /// Describes the states of filter `F` in order: those of its [`Open`] block as what takes them.
    pub fn states_of<F: Block>(self, visit: &mut dyn FnMut(StateInfo)) {
        F::states(&mut |info| {
            if info.block != Open::NAME {
                visit(info);
            } else if info.component == PLACES[0] {
                self.states(visit);
            }
        });
    }

    /// Describes the states of [`Open`].
    fn states(self, visit: &mut dyn FnMut(StateInfo)) {
        let mut taken = 0;
        for block in self.blocks {
            block.states(&mut |info| {
                taken += 1;
                visit(info);
            });
        }
        for at in taken..Open::CAPACITY {
            visit(place(at));
        }
    }

    /// The states that forget, by their place in [`Open`].
    pub(crate) fn relaxations(self, mut visit: impl FnMut(usize, Relaxation<f64>)) {
        self.each(|offset, block| {
            block.relaxation(&mut |state, relaxation| visit(offset + state, relaxation));
        });
    }

    #[inline]
    fn each(self, mut visit: impl FnMut(usize, &'static dyn AnyBlock)) {
        let mut offset = 0;
        for block in self.blocks {
            visit(offset, *block);
            offset += block.dim();
        }
    }
}

/// Whether a block describes as many states as it has, and puts entries of these and of existing inputs and channels only.
fn sound(block: &dyn AnyBlock) -> bool {
    let dim = block.dim();
    let (mut described, mut sound) = (0, true);
    block.states(&mut |_| described += 1);
    block.input_jacobian(&Signals::default(), &mut |input, state, _| {
        sound &= input < Strapdown::INPUTS && state < dim
    });
    block.measurement_jacobian(&Point::default(), &mut |channel, state, _| {
        sound &= channel < Strapdown::CHANNELS && state < dim
    });
    sound && described == dim
}

/// The first name that a block's states have.
fn name(block: &dyn AnyBlock) -> &'static str {
    let mut name = None;
    block.states(&mut |info| {
        name.get_or_insert(info.block);
    });
    name.unwrap_or("a block without states")
}

/// The same blocks at the same place in memory.
impl PartialEq for OpenBlocks {
    fn eq(&self, other: &Self) -> bool {
        core::ptr::eq(self.blocks, other.blocks) && self.uncoupled == other.uncoupled
    }
}

impl Debug for OpenBlocks {
    fn fmt(&self, f: &mut Formatter<'_>) -> core::fmt::Result {
        f.debug_list().entries(self.blocks).finish()
    }
}

/// Why a block cannot join a filter at run time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OpenError {
    /// Name of the block.
    pub name: &'static str,
    fault: Fault,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fault {
    Full,
    Unsound,
}

impl Display for OpenError {
    fn fmt(&self, f: &mut Formatter<'_>) -> core::fmt::Result {
        let Self { name, fault } = self;
        match fault {
            Fault::Full => {
                write!(
                    f,
                    "no room for `{name}`: blocks that join at run time have up to {} states",
                    Open::CAPACITY
                )
            }
            Fault::Unsound => write!(
                f,
                "`{name}` describes another number of states than its `DIM`, or puts an entry outside of its states, \
                 of the {} inputs or of the {} channels",
                Strapdown::INPUTS,
                Strapdown::CHANNELS
            ),
        }
    }
}

impl core::error::Error for OpenError {}
