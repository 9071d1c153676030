//! Blocks and effects known at run time only.

use core::any::TypeId;
use core::fmt::{Debug, Formatter, Result};
use core::marker::PhantomData;

use calib_core::{Block, Relaxation, StateInfo, relaxations};

use super::{Effect, EffectInfo};
use crate::{Point, Signals, Strapdown};

/// A block of parameters as an object: what [`Block`] says, in `f64`.
pub trait AnyBlock: Send + Sync {
    /// Number of its states.
    fn dim(&self) -> usize;
    /// [`Block::states`].
    fn states(&self, visit: &mut dyn FnMut(StateInfo));
    /// [`Block::input_jacobian`].
    fn input_jacobian(&self, signals: &Signals<f64>, put: &mut dyn FnMut(usize, usize, f64));
    /// [`Block::measurement_jacobian`].
    fn measurement_jacobian(&self, at: &Point<f64>, put: &mut dyn FnMut(usize, usize, f64));
    /// The states that are not constant: [`Block::RELAXATIONS`].
    fn relaxation(&self, put: &mut dyn FnMut(usize, Relaxation<f64>));
}

/// An effect as an object: what [`Effect`] says, in `f64`.
///
/// ```
/// use sinscal::{AccelDelay, AnyEffect};
///
/// let delay = <dyn AnyEffect>::of::<AccelDelay>();
/// assert_eq!((delay.info().name(), delay.dim()), ("accel-delay", 1));
/// ```
pub trait AnyEffect: AnyBlock {
    /// Its entry.
    fn info(&self) -> &'static EffectInfo;
    /// Its type; of one type and one name there is one effect.
    fn id(&self) -> TypeId;
    /// It as a block.
    fn block(&'static self) -> &'static dyn AnyBlock;
    /// [`Effect::error`].
    fn error(&self, signals: &Signals<f64>, values: &[f64], error: &mut [f64; 6]);
    /// [`Effect::reference_error`].
    fn reference_error(&self, at: &Point<f64>, values: &[f64], error: &mut [f64; 9]);
}

/// The object of a type.
struct Erased<B>(PhantomData<fn() -> B>);

impl dyn AnyBlock {
    /// Block `B` as an object: any block, also a group of several.
    pub const fn of<B: Block<Dynamics = Strapdown>>() -> &'static dyn AnyBlock {
        const { &Erased::<B>(PhantomData) }
    }
}

impl dyn AnyEffect {
    /// Effect `E` as an object.
    pub const fn of<E: Effect>() -> &'static dyn AnyEffect {
        const { &Erased::<E>(PhantomData) }
    }

    /// Its name.
    pub fn name(&self) -> &'static str {
        self.info().name()
    }

    /// Whether some of its states are not constant.
    pub fn is_wander(&self) -> bool {
        let mut wanders = false;
        self.relaxation(&mut |_, _| wanders = true);
        wanders
    }
}

impl<B: Block<Dynamics = Strapdown>> AnyBlock for Erased<B> {
    fn dim(&self) -> usize {
        B::DIM
    }

    fn states(&self, visit: &mut dyn FnMut(StateInfo)) {
        B::states(visit);
    }

    fn input_jacobian(&self, signals: &Signals<f64>, put: &mut dyn FnMut(usize, usize, f64)) {
        B::input_jacobian(signals, &mut |input, state, value| put(input, state, value));
    }

    fn measurement_jacobian(&self, at: &Point<f64>, put: &mut dyn FnMut(usize, usize, f64)) {
        B::measurement_jacobian(at, &mut |channel, state, value| put(channel, state, value));
    }

    fn relaxation(&self, put: &mut dyn FnMut(usize, Relaxation<f64>)) {
        relaxations::<B, f64>(put);
    }
}

impl<E: Effect> AnyEffect for Erased<E> {
    fn info(&self) -> &'static EffectInfo {
        const { &E::EFFECT }
    }

    fn id(&self) -> TypeId {
        TypeId::of::<E>()
    }

    fn block(&'static self) -> &'static dyn AnyBlock {
        <dyn AnyBlock>::of::<E>()
    }

    fn error(&self, signals: &Signals<f64>, values: &[f64], error: &mut [f64; 6]) {
        E::error(signals, values, error);
    }

    fn reference_error(&self, at: &Point<f64>, values: &[f64], error: &mut [f64; 9]) {
        E::reference_error(at, values, error);
    }
}

impl Debug for dyn AnyEffect {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        f.write_str(self.name())
    }
}

/// Effects are known by their names.
impl PartialEq for dyn AnyEffect {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl Debug for dyn AnyBlock {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let mut last = "";
        let mut list = f.debug_list();
        self.states(&mut |info| {
            if info.block != last {
                list.entry(&info.block);
                last = info.block;
            }
        });
        list.finish()
    }
}
