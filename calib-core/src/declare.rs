//! What `#[derive(StateBlocks)]` calls at compile time: layout of the fields, and the rules across them.
//!
//! Not a public interface. A macro sees names, not types; what depends on types is a const function here, and
//! the derive evaluates it in a constant with the span of the field it judges.

use core::marker::PhantomData;

use crate::measurement::first_row;
use crate::{
    Block, BlockVisitor, Dynamics, Filter, Measurement, MeasurementInfo, Need, Real, Relaxation, StateInfo,
};

mod rules;
mod text;

pub use rules::{belongs, filter, filter_field, group_field, measurement};
use text::equal;
pub use text::{Text, distance};

/// A block as the rules see it, within a declaration: what it is, and the parts that it is made of.
#[derive(Clone, Copy)]
pub struct Part {
    /// Name of the field, empty outside of a declaration.
    name: &'static str,
    /// Name of the block.
    block: &'static str,
    dim: usize,
    needs: &'static [Need],
    relaxations: &'static [(usize, Relaxation<f64>)],
    /// None for a block that is written by hand.
    parts: &'static [Part],
    known: bool,
    repeated: bool,
    considered: bool,
    role: Role,
}

#[derive(Clone, Copy)]
enum Role {
    Block,
    Base { declared: bool },
}

impl Part {
    const UNKNOWN: Self = Self {
        name: "",
        block: "",
        dim: 0,
        needs: &[],
        relaxations: &[],
        parts: &[],
        known: false,
        repeated: false,
        considered: false,
        role: Role::Block,
    };

    /// What the rules must know of `B`.
    pub const fn of<B: Block>() -> Self {
        Self {
            block: B::NAME,
            dim: B::DIM,
            needs: B::NEEDS,
            relaxations: B::RELAXATIONS,
            parts: B::PARTS,
            known: true,
            ..Self::UNKNOWN
        }
    }

    /// The part as the field `name`.
    pub const fn named(mut self, name: &'static str) -> Self {
        self.name = name;
        self
    }

    /// The part as a base, which must have been a filter and have had `measures`.
    pub const fn base(mut self, measures: Option<&'static [MeasurementInfo]>) -> Self {
        self.role = Role::Base { declared: measures.is_some() };
        self
    }

    /// The part as one of which the macro itself has said that it stands there twice.
    pub const fn repeated(mut self) -> Self {
        self.repeated = true;
        self
    }

    /// The part as one whose states are considered.
    pub const fn considered(mut self) -> Self {
        self.considered = true;
        self
    }

    /// Visits the states that are considered; those of the part begin at `first`.
    pub(crate) fn each_considered(&self, first: usize, visit: &mut impl FnMut(usize)) {
        if self.considered {
            (first..first + self.dim).for_each(visit);
            return;
        }
        let mut at = first;
        for part in self.parts {
            part.each_considered(at, visit);
            at += part.dim;
        }
    }

    /// Whether the block called `name` is in it.
    pub(crate) const fn has(&self, name: &str) -> bool {
        if self.parts.is_empty() { self.known && equal(self.block, name) } else { has(self.parts, name) }
    }

    /// Whether some state of it forgets.
    pub(crate) const fn relaxes(&self) -> bool {
        let mut i = 0;
        while i < self.parts.len() {
            if self.parts[i].relaxes() {
                return true;
            }
            i += 1;
        }
        !self.relaxations.is_empty()
    }

    const fn is_base(&self) -> bool {
        matches!(self.role, Role::Base { .. })
    }
}

/// The block `B` as a field of a declaration with dynamics `D`.
///
/// Where `B` is a block of these dynamics the items are inherent; where it is not they come from [`Misfit`] and do
/// nothing. So the one line that demands a block of the right dynamics, [`belongs`], is the only one to fail,
/// and the rules still judge the other fields.
pub struct Field<B, D>(PhantomData<(B, D)>);

impl<B: Block<Dynamics = D>, D: Dynamics> Field<B, D> {
    /// What the rules must know of `B`.
    pub const PART: Part = Part::of::<B>();

    /// [`Block::states`].
    pub fn states(visit: &mut dyn FnMut(StateInfo)) {
        B::states(visit);
    }

    /// [`Block::input_jacobian`], with states counted from `offset`.
    #[inline(always)]
    pub fn input_jacobian<T: Real>(
        offset: usize,
        signals: &D::Signals<T>,
        put: &mut impl FnMut(usize, usize, T),
    ) {
        B::input_jacobian(signals, &mut |input, state, value| put(input, offset + state, value));
    }

    /// [`Block::measurement_jacobian`], with states counted from `offset`.
    #[inline(always)]
    pub fn measurement_jacobian<T: Real>(
        offset: usize,
        at: &D::Point<T>,
        put: &mut impl FnMut(usize, usize, T),
    ) {
        B::measurement_jacobian(at, &mut |channel, state, value| put(channel, offset + state, value));
    }

    /// [`Block::blocks`].
    #[inline(always)]
    pub fn blocks(first: usize, visitor: &mut impl BlockVisitor<D>) {
        B::blocks(first, visitor);
    }
}

/// A [`Field`] that is no block of the dynamics.
pub trait Misfit {
    /// Nothing is known.
    const PART: Part = Part::UNKNOWN;

    /// No states.
    fn states(visit: &mut dyn FnMut(StateInfo)) {
        let _ = visit;
    }

    /// No effect.
    fn input_jacobian<T: Real>(offset: usize, signals: &impl Sized, put: &mut impl FnMut(usize, usize, T)) {
        let _ = (offset, signals, put);
    }

    /// No effect.
    fn measurement_jacobian<T: Real>(offset: usize, at: &impl Sized, put: &mut impl FnMut(usize, usize, T)) {
        let _ = (offset, at, put);
    }

    /// None.
    fn blocks(first: usize, visitor: &mut impl Sized) {
        let _ = (first, visitor);
    }
}

impl<B, D> Misfit for Field<B, D> {}

/// The measurement `M` of a declaration with dynamics `D`; where it is none of these dynamics, [`Unmeasured`].
pub struct Measured<M, D>(PhantomData<(M, D)>);

impl<M: Measurement<Dynamics = D>, D: Dynamics> Measured<M, D> {
    /// [`Measurement::INFO`].
    pub const INFO: MeasurementInfo = M::INFO;

    /// [`Measurement::residual`].
    #[inline]
    pub fn residual<T: Real>(at: &D::Point<T>, reading: &[T], put: &mut impl FnMut(usize, T)) {
        M::residual(at, reading, put);
    }

    /// [`Measurement::jacobian`], with the rows of `measures` at place `measured`.
    #[inline(always)]
    pub fn jacobian<T: Real>(
        measures: &[MeasurementInfo],
        measured: usize,
        at: &D::Point<T>,
        put: &mut impl FnMut(usize, usize, T),
    ) {
        let first = first_row(measures, measured);
        M::jacobian(at, &mut |row, channel, value| put(first + row, channel, value));
    }
}

/// A [`Measured`] that is no measurement of the dynamics.
pub trait Unmeasured {
    /// No rows.
    const INFO: MeasurementInfo =
        MeasurementInfo { name: "", components: &[], unit: "", columns: &[], sigma: 0.0, channels: Some(0) };

    /// No residuals.
    fn residual<T: Real>(at: &impl Sized, reading: &[T], put: &mut impl FnMut(usize, T)) {
        let _ = (at, reading, put);
    }

    /// No rows.
    fn jacobian<T: Real>(
        measures: &[MeasurementInfo],
        measured: usize,
        at: &impl Sized,
        put: &mut impl FnMut(usize, usize, T),
    ) {
        let _ = (measures, measured, at, put);
    }
}

impl<M, D> Unmeasured for Measured<M, D> {}

/// The type of a base, which is a filter or else [`Baseless`].
pub struct Base<B>(PhantomData<B>);

impl<B: Filter> Base<B> {
    /// The measurements of the filter `B`.
    pub const MEASURES: Option<&'static [MeasurementInfo]> = Some(B::MEASURES);

    /// [`Filter::residual`].
    #[inline]
    pub fn residual<T: Real>(
        measured: usize,
        at: &<B::Dynamics as Dynamics>::Point<T>,
        reading: &[T],
        put: &mut impl FnMut(usize, T),
    ) {
        B::residual(measured, at, reading, put);
    }

    /// [`Filter::residual_jacobian`].
    #[inline(always)]
    pub fn residual_jacobian<T: Real>(
        at: &<B::Dynamics as Dynamics>::Point<T>,
        put: &mut impl FnMut(usize, usize, T),
    ) {
        B::residual_jacobian(at, put);
    }
}

/// A [`Base`] that is no filter.
pub trait Baseless {
    /// It measures nothing.
    const MEASURES: Option<&'static [MeasurementInfo]> = None;

    /// No residuals.
    fn residual<T: Real>(measured: usize, at: &impl Sized, reading: &[T], put: &mut impl FnMut(usize, T)) {
        let _ = (measured, at, reading, put);
    }

    /// No rows.
    fn residual_jacobian<T: Real>(at: &impl Sized, put: &mut impl FnMut(usize, usize, T)) {
        let _ = (at, put);
    }
}

impl<B> Baseless for Base<B> {}

/// The dynamics of a declaration, which are dynamics or else [`Unrelated`].
pub struct Family<D>(PhantomData<D>);

impl<D: Dynamics> Family<D> {
    /// They are dynamics.
    pub const KNOWN: bool = true;
    /// [`Dynamics::CORE`].
    pub const CORE: usize = D::CORE;
    /// [`Dynamics::NEEDS`].
    pub const NEEDS: &'static [Need] = D::NEEDS;
}

/// A [`Family`] that is none: the one line that demands dynamics is the only one to fail.
pub trait Unrelated {
    /// They are none.
    const KNOWN: bool = false;
    /// No states.
    const CORE: usize = 0;
    /// No rules.
    const NEEDS: &'static [Need] = &[];
}

impl<D> Unrelated for Family<D> {}

/// The dynamics of a field beside those of the declaration: the same or else [`Other`].
pub struct Fit<A, B>(PhantomData<(A, B)>);

impl<D> Fit<D, D> {
    /// They are the same.
    pub const SAME: bool = true;
}

/// A [`Fit`] of two.
pub trait Other {
    /// They are not.
    const SAME: bool = false;
}

impl<A, B> Other for Fit<A, B> {}

/// Where each part begins.
pub const fn offsets<const N: usize>(parts: &[Part; N]) -> [usize; N] {
    let mut offsets = [0; N];
    let mut i = 1;
    while i < N {
        offsets[i] = offsets[i - 1] + parts[i - 1].dim;
        i += 1;
    }
    offsets
}

/// Whether the parts that begin at `offsets` follow each other without a gap and make `dim` states.
pub const fn contiguous<const N: usize>(parts: &[Part; N], offsets: &[usize; N], dim: usize) -> bool {
    let mut next = 0;
    let mut i = 0;
    while i < N {
        if offsets[i] != next {
            return false;
        }
        next += parts[i].dim;
        i += 1;
    }
    next == dim
}

/// States of all parts.
pub const fn dim(parts: &[Part]) -> usize {
    let mut sum = 0;
    let mut i = 0;
    while i < parts.len() {
        sum += parts[i].dim;
        i += 1;
    }
    sum
}

/// The number of states of a group as a type.
pub type Size<const N: usize> = <[(); N] as hybrid_array::AssocArraySize>::Size;

/// Whether the block called `name` is in some part.
const fn has(parts: &[Part], name: &str) -> bool {
    let mut i = 0;
    while i < parts.len() {
        if parts[i].has(name) {
            return true;
        }
        i += 1;
    }
    false
}

/// Whether some part has what a rule asks for.
const fn meets(parts: &[Part], need: &Need) -> bool {
    let mut k = 0;
    while k < need.any_of.len() {
        if has(parts, need.any_of[k]) {
            return true;
        }
        k += 1;
    }
    false
}

/// What the first of `needs` says that the parts do not meet; nothing when they meet all.
pub(crate) const fn unmet(needs: &'static [Need], parts: &[Part]) -> &'static str {
    let mut k = 0;
    while k < needs.len() {
        if !meets(parts, &needs[k]) {
            return needs[k].message;
        }
        k += 1;
    }
    ""
}

/// How many rules the parts have together.
pub const fn count_needs(parts: &[Part]) -> usize {
    let mut count = 0;
    let mut i = 0;
    while i < parts.len() {
        count += parts[i].needs.len();
        i += 1;
    }
    count
}

/// The rules of all parts: a group hands them on to the filter that declares it.
pub const fn needs<const K: usize>(parts: &[Part]) -> [Need; K] {
    let mut all = [Need { any_of: &[], message: "" }; K];
    let (mut i, mut k) = (0, 0);
    while i < parts.len() {
        let mut j = 0;
        while j < parts[i].needs.len() {
            all[k] = parts[i].needs[j];
            k += 1;
            j += 1;
        }
        i += 1;
    }
    all
}

/// Rows of the measurement matrix.
pub const fn rows(measures: &[MeasurementInfo]) -> usize {
    first_row(measures, measures.len())
}

/// The measurements of a base, none when it is no filter, which [`filter_field`] reports.
pub const fn inherited(measures: Option<&'static [MeasurementInfo]>) -> &'static [MeasurementInfo] {
    match measures {
        Some(measures) => measures,
        None => &[],
    }
}
