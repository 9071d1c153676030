//! What can be named.

use std::sync::Arc;

use calib_core::{Filter, Sizes};
use sinscal::{
    AnyEffect, CATALOGUE, Effect, FILTERS, Fault, FilterInfo, FilterVisitor, Law, Strapdown, probe,
    visit_filter,
};

use crate::Error;
use crate::compose::Composition;
use crate::filter::{AnyFilter, Declared};

/// Passes of a filter that somebody declared elsewhere, unless told: errors of 1e-2 need as many, and fewer do no harm.
const PASSES: u32 = 3;

/// What can be named: the filters and effects of the library, and those that a program adds.
#[derive(Clone)]
#[must_use]
pub struct Vocabulary {
    filters: Vec<Arc<dyn AnyFilter>>,
    effects: Vec<&'static dyn AnyEffect>,
    /// What is wrong with a filter that was added.
    faults: Vec<Fault>,
}

impl Vocabulary {
    /// Nothing.
    pub const fn empty() -> Self {
        Self { filters: Vec::new(), effects: Vec::new(), faults: Vec::new() }
    }

    /// The filters and effects of the library.
    pub fn standard() -> Self {
        struct Register(Vocabulary, &'static FilterInfo);
        impl FilterVisitor for Register {
            type Output = Vocabulary;

            fn visit<F: Filter<Dynamics = Strapdown, Shape: Sizes>>(self) -> Vocabulary {
                self.0.declared::<F>(self.1.passes, self.1.about)
            }
        }
        let register = |all: Self, info: &'static FilterInfo| {
            visit_filter(info.name, Register(all.clone(), info)).unwrap_or(all)
        };
        let effects = CATALOGUE.to_vec();
        FILTERS.iter().fold(Self { effects, ..Self::empty() }, register)
    }

    /// And filter `F`, for units whose class needs so many passes, with what it holds in a few words. It replaces one of the same
    /// name.
    pub fn declared<F: Filter<Dynamics = Strapdown, Shape: Sizes>>(
        mut self,
        passes: u32,
        about: &'static str,
    ) -> Self {
        self.faults.extend(probe::<F>().err());
        self.filters.retain(|filter| filter.name() != F::NAME);
        self.filters.push(Arc::new(Declared::<F>::new(passes, about)));
        self
    }

    /// And filter `F`.
    pub fn with_filter<F: Filter<Dynamics = Strapdown, Shape: Sizes>>(self) -> Self {
        self.declared::<F>(PASSES, "declared by this program")
    }

    /// Blocks of added filters that contradict themselves: such a filter cannot be run.
    pub fn faults(&self) -> &[Fault] {
        &self.faults
    }

    /// Every filter, in the order in which they were added.
    pub fn filters(&self) -> impl Iterator<Item = &Arc<dyn AnyFilter>> + Clone {
        self.filters.iter()
    }

    /// The filter called `name`, in capitals or not.
    ///
    /// # Errors
    /// When there is none.
    pub fn filter(&self, name: &str) -> Result<Arc<dyn AnyFilter>, Error> {
        let found = self.filters.iter().find(|filter| filter.name().eq_ignore_ascii_case(name));
        found.cloned().ok_or_else(|| Error::NoFilter { name: name.to_owned() })
    }

    /// And effect `E`. It replaces one of the same name.
    pub fn with_effect<E: Effect>(mut self) -> Self {
        let effect = <dyn AnyEffect>::of::<E>();
        self.effects.retain(|other| other.name() != effect.name());
        self.effects.push(effect);
        self
    }

    /// Every effect, in the order in which they were added.
    pub fn effects(&self) -> &[&'static dyn AnyEffect] {
        &self.effects
    }

    /// The effects that were added to those of the library.
    pub fn own_effects(&self) -> Vec<&'static dyn AnyEffect> {
        self.effects.iter().copied().filter(|effect| sinscal::any_effect(effect.name()).is_none()).collect()
    }

    /// The effect called `name`, or the [`Law`] that has this name.
    ///
    /// # Errors
    /// When there is none.
    pub fn effect(&self, name: &str) -> Result<&'static dyn AnyEffect, Error> {
        let found = self.effects.iter().copied().find(|effect| effect.name() == name);
        let law = || Law::named(name).map(|law| law.effect());
        found.or_else(law).ok_or_else(|| Error::NoEffect { name: name.to_owned() })
    }

    /// The filter called `base` with the effects called `with`, without the blocks called `without`.
    ///
    /// # Errors
    /// When one of them is not there, or they do not go together.
    pub fn composed(&self, base: &str, with: &[&str], without: &[&str]) -> Result<Arc<dyn AnyFilter>, Error> {
        let base = self.filter(base)?;
        if with.is_empty() && without.is_empty() {
            return Ok(base);
        }
        let effects = with.iter().map(|name| self.effect(name)).collect::<Result<Vec<_>, _>>()?;
        Ok(Arc::new(Composition::of(&*base, &effects, without)?))
    }
}
