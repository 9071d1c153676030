//! Filters composed at run time: a filter and effects that it lacks, or without blocks that it has.

use std::any::TypeId;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use calib_core::Dynamics;
use sinscal::{
    AnyBlock, AnyEffect, Attitude, BiasWander, Dither, DitherSizeEffect, InnerLeverArm, OpenBlocks,
    OpenError, Position, Setup, StateInfo, Strapdown, Velocity, any_effect,
};

use crate::compiled::{Compiled, Selection};
use crate::filter::{AnyFilter, Leaf, Pool};

/// A filter with effects added to it.
///
/// It runs on a filter that holds everything that can be estimated, with priors of zero for what takes no part: that costs time, not
/// correctness.
pub struct Composition {
    name: &'static str,
    path: &'static str,
    about: String,
    passes: u32,
    measures: Vec<&'static str>,
    own_columns: Vec<&'static str>,
    with: Vec<&'static str>,
    without: Vec<&'static str>,
    considered: Vec<&'static str>,
    /// The filter without what is considered, when nothing but that was added to it.
    exact: Option<Arc<dyn AnyFilter>>,
    states: Vec<StateInfo>,
    blocks: Vec<Leaf>,
    pool: &'static Pool,
    selection: Selection,
    /// Blocks of the pool that take no part.
    absent: Vec<&'static str>,
}

/// Why a filter cannot be composed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ComposeError {
    /// The filter has the effect.
    #[error("{filter} has `{effect}` already")]
    Declared {
        /// Name of the filter.
        filter: String,
        /// Name of the effect.
        effect: &'static str,
    },
    /// The filter does not have the effect.
    #[error("{filter} has no `{effect}` that could be left out")]
    Undeclared {
        /// Name of the filter.
        filter: String,
        /// Name of the effect.
        effect: String,
    },
    /// A block does not fit.
    #[error(transparent)]
    Open(#[from] OpenError),
}

impl Composition {
    /// `base` with effects added. Where the base has inner lever arms, the dither's size effect needs no states: the dither acts
    /// through them.
    ///
    /// # Errors
    /// When the base has one of them, or there is no room.
    pub fn new(base: &dyn AnyFilter, effects: &[&'static dyn AnyEffect]) -> Result<Self, ComposeError> {
        Self::of(base, effects, &[])
    }

    /// `base` with effects added, each with states of its own, also the dither's size effect where there are inner lever arms: for
    /// what is told apart.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn with_states_for(
        base: &dyn AnyFilter,
        effects: &[&'static dyn AnyEffect],
    ) -> Result<Self, ComposeError> {
        let added = effects.iter().map(|effect| leaf(*effect)).collect();
        Self::assembled(base, base.pool(), base.blocks(), added, base.needs_dither(), effects)
    }

    /// `base` with effects added and blocks left out, by name.
    ///
    /// # Errors
    /// As [`new`](Self::new), and when a block that is left out is not there.
    pub fn of(
        base: &dyn AnyFilter,
        effects: &[&'static dyn AnyEffect],
        without: &[&str],
    ) -> Result<Self, ComposeError> {
        let pool = base.pool();
        let mut own = base.blocks();
        let mut left_out = base.without();
        for name in without {
            let named = |leaf: &Leaf| leaf.name == *name && !is_core(leaf);
            let Some(at) = own.iter().position(named) else {
                return Err(ComposeError::Undeclared { filter: base.title(), effect: (*name).to_owned() });
            };
            left_out.push(own.remove(at).name);
        }
        let mut added = Vec::new();
        for effect in effects {
            if own.iter().chain(&added).any(|leaf| leaf.name == effect.name()) {
                return Err(ComposeError::Declared { filter: base.title(), effect: effect.name() });
            }
            added.push(leaf(*effect));
        }
        let arms = own.iter().chain(&added).any(|leaf| leaf.is::<InnerLeverArm>());
        let of_base = base.needs_dither() && !base.blocks().iter().any(Leaf::is::<Dither>);
        let mut couples = of_base || own.iter().any(Leaf::is::<Dither>);
        if arms {
            let before = added.len();
            added.retain(|leaf| !leaf.is::<DitherSizeEffect>());
            couples |= added.len() < before;
        }
        let mut composed = Self::assembled(base, pool, own, added, couples, effects)?;
        composed.without = left_out;
        Ok(composed)
    }

    fn assembled(
        base: &dyn AnyFilter,
        pool: &'static Pool,
        own: Vec<Leaf>,
        added: Vec<Leaf>,
        couples: bool,
        effects: &[&'static dyn AnyEffect],
    ) -> Result<Self, ComposeError> {
        let there = (pool.blocks)();
        let mut open: Vec<Leaf> = Vec::new();
        let mut in_open = 0;
        let mut places = Vec::new();
        let (mut states, mut blocks) = (Vec::new(), Vec::new());
        let mut present = Vec::new();
        for leaf in own.into_iter().chain(added) {
            let first = states.len();
            leaf.block.states(&mut |info| states.push(info));
            let dim = states.len() - first;
            blocks.push(Leaf { first, ..leaf });
            let start = match there.iter().find(|known| known.identity() == leaf.identity()) {
                Some(known) => {
                    present.push(known.identity());
                    known.first
                }
                None => {
                    open.push(leaf);
                    in_open += dim;
                    there.iter().find(|known| known.is::<sinscal::Open>()).map_or(0, |open| open.first)
                        + in_open
                        - dim
                }
            };
            places.extend((start..start + dim).filter(|state| *state >= CORE));
        }
        let absent = |leaf: &&Leaf| {
            !is_core(leaf) && !present.contains(&leaf.identity()) && !leaf.is::<sinscal::Open>()
        };
        let absent = there.iter().filter(absent).map(|leaf| leaf.name).collect();
        let mut joined = OpenBlocks::new(kept(&open))?;
        if !couples {
            joined = joined.without_dither();
        }
        Ok(Self {
            name: base.name(),
            path: base.path(),
            about: base.about(),
            passes: base.passes(),
            measures: base.measures(),
            own_columns: base.own_columns(),
            with: base.with().into_iter().chain(effects.iter().map(|effect| effect.name())).collect(),
            without: Vec::new(),
            considered: base.considers(),
            exact: None,
            states,
            blocks,
            pool,
            selection: Selection { states: places, open: joined },
            absent,
        })
    }
}

/// `filter` with the wander of the biases that is known and that it does not have yet.
///
/// # Errors
/// When there is no room.
pub fn wandering(
    filter: &Arc<dyn AnyFilter>,
    wander: &BiasWander,
) -> Result<Arc<dyn AnyFilter>, ComposeError> {
    let blocks = filter.blocks();
    let lacks = |name: &&str| blocks.iter().all(|leaf| leaf.name != *name);
    let added: Vec<_> = wander.effects().filter(lacks).filter_map(any_effect).collect();
    if added.is_empty() {
        return Ok(filter.clone());
    }
    Ok(Arc::new(Composition::new(&**filter, &added)?))
}

/// `filter` that considers `effects`, those that it lacks as well as its own: their states keep their priors, and what these make
/// uncertain is in the covariance of the others.
///
/// # Errors
/// When there is no room.
pub fn considering(
    filter: &Arc<dyn AnyFilter>,
    effects: &[&'static dyn AnyEffect],
) -> Result<Arc<dyn AnyFilter>, ComposeError> {
    if effects.is_empty() {
        return Ok(filter.clone());
    }
    let blocks = filter.blocks();
    let lacks = |effect: &&&'static dyn AnyEffect| blocks.iter().all(|leaf| leaf.name != effect.name());
    let added: Vec<_> = effects.iter().filter(lacks).copied().collect();
    let mut composed = Composition::new(&**filter, &added)?;
    for effect in effects {
        if !composed.considered.contains(&effect.name()) {
            composed.considered.push(effect.name());
        }
    }
    // the dither's size effect needs no states beside inner lever arms, and is estimated with them
    if composed.needs_dither() == filter.needs_dither() {
        composed.exact = Some(filter.clone());
    }
    Ok(Arc::new(composed))
}

/// An effect as a block; where it begins is not known yet.
fn leaf(effect: &'static dyn AnyEffect) -> Leaf {
    Leaf { id: effect.id(), name: effect.name(), first: 0, block: effect.block() }
}

/// Whether a block moves by the dynamics.
fn is_core(leaf: &Leaf) -> bool {
    leaf.is::<Attitude>() || leaf.is::<Velocity>() || leaf.is::<Position>()
}

/// Leading states.
const CORE: usize = <Strapdown as Dynamics>::CORE;

/// A list of blocks that lives as long as the program: one for each set of blocks, however often it is asked for.
fn kept(blocks: &[Leaf]) -> &'static [&'static dyn AnyBlock] {
    type List = &'static [&'static dyn AnyBlock];
    static KEPT: Mutex<BTreeMap<Vec<(TypeId, &str)>, List>> = Mutex::new(BTreeMap::new());
    if blocks.is_empty() {
        return &[];
    }
    // not by their addresses: objects without size may all have the same
    let key = blocks.iter().map(Leaf::identity).collect();
    let mut all = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    all.entry(key).or_insert_with(|| blocks.iter().map(|leaf| leaf.block).collect::<Vec<_>>().leak())
}

impl AnyFilter for Composition {
    fn name(&self) -> &'static str {
        self.name
    }

    fn path(&self) -> &'static str {
        self.path
    }

    fn about(&self) -> String {
        self.about.clone()
    }

    fn passes(&self) -> u32 {
        self.passes
    }

    fn measures(&self) -> Vec<&'static str> {
        self.measures.clone()
    }

    fn own_columns(&self) -> Vec<&'static str> {
        self.own_columns.clone()
    }

    fn states(&self) -> Vec<StateInfo> {
        self.states.clone()
    }

    fn blocks(&self) -> Vec<Leaf> {
        self.blocks.clone()
    }

    fn compiled(&self) -> (&'static dyn Compiled, &Selection) {
        (self.pool.code, &self.selection)
    }

    fn pool(&self) -> &'static Pool {
        self.pool
    }

    fn prepare<'a>(&'a self, setup: &Setup<'a>, priors: &'a mut Vec<(&'a str, f64)>) -> Setup<'a> {
        priors.extend(self.absent.iter().map(|name| (*name, 0.0)));
        priors.extend(setup.priors.iter().filter(|(name, _)| !self.absent.contains(name)));
        let considered = if self.considered.is_empty() { setup.considered } else { &self.considered };
        Setup { priors, considered, ..*setup }
    }

    fn with(&self) -> Vec<&'static str> {
        self.with.clone()
    }

    fn without(&self) -> Vec<&'static str> {
        self.without.clone()
    }

    fn considers(&self) -> Vec<&'static str> {
        self.considered.clone()
    }

    fn exact(&self) -> Option<&dyn AnyFilter> {
        self.exact.as_deref()
    }

    fn needs_dither(&self) -> bool {
        self.selection.open.couples_dither()
    }
}
