//! Filters that consider: what the log says is settled without what is considered, by the filter that does not have it where there is
//! one, and one pass more carries what that makes uncertain.
//!
//! The posterior by which passes are compared knows no considered states: their priors are zero there. The pass that follows is the filter
//! of Schmidt (1966) about what was settled, which weighs readings by what they are worth with that uncertainty.

use std::sync::Arc;

use calib_core::Block;
use sinscal::{AccelBiasWander, GyroBiasWander, INFLUENCES, Setup, TableOrthogonality, any_effect};

use crate::budget::{Budget, budget};
use crate::compose::{Composition, considering};
use crate::driver::{Watch, feed};
use crate::filter::AnyFilter;
use crate::outcome::Outcome;
use crate::repeat::ESTIMATED;
use crate::running::Options;
use crate::samples::Samples;
use crate::{Error, settle};

/// The wander of the biases, as effects.
const WANDER: [&str; 2] = [GyroBiasWander::NAME, AccelBiasWander::NAME];

/// The influences of the chain of measurement that `filter` lacks and that stand behind every log. That a table tells the attitudes is known
/// only where somebody says how far from square it is.
pub fn influences(filter: &dyn AnyFilter) -> Vec<&'static str> {
    let own = filter.blocks();
    let lacks = |name: &&str| own.iter().all(|leaf| leaf.name != *name);
    INFLUENCES.iter().copied().filter(lacks).filter(|name| *name != TableOrthogonality::NAME).collect()
}

/// Names of the blocks of a filter by which its biases wander.
fn wander(filter: &dyn AnyFilter) -> Vec<&'static str> {
    let wanders = |name: &&str| any_effect(name).is_some_and(|effect| effect.is_wander());
    filter.blocks().iter().map(|leaf| leaf.name).filter(wanders).collect()
}

/// Settles a filter without what it considers, then runs it about that.
pub(crate) fn calibrate(
    filter: &dyn AnyFilter,
    samples: &dyn Samples,
    setup: &Setup,
    options: &Options,
    watch: &mut dyn Watch,
) -> Result<Outcome, Error> {
    let considered = filter.considers();
    let own = setup.priors.iter().copied().filter(|(name, _)| !considered.contains(name));
    let priors: Vec<_> = considered.iter().map(|name| (*name, 0.0)).chain(own).collect();
    let exact = Setup { priors: &priors, ..*setup };
    let quick = Options { smooth: false, residuals: false, ..options.clone() };
    let estimating = filter.exact().unwrap_or(filter);
    let mut found = settle::calibrate(estimating, samples, &exact, &quick, watch)?;
    let mut outcome = about(filter, samples, setup, options, &found)?;
    let noise = without_wander(estimating, samples, &exact, &quick, &found)?;
    outcome.budget = budget(&outcome, &considered);
    let mut formal_of = vec![0.0; outcome.parameters.len()];
    for part in &mut outcome.budget {
        let i = part.parameter;
        let formal = found.covariance[i][i].sqrt() / found.repeat.as_ref().map_or(1.0, |r| r.factors[i]);
        formal_of[i] = formal;
        part.blame(formal);
        if let Some(noise) = noise.as_ref().and_then(|noise| noise[i]) {
            part.wander = (formal * formal - noise * noise).max(0.0).sqrt().min(part.noise);
            part.noise = (part.noise.powi(2) - part.wander.powi(2)).max(0.0).sqrt();
        }
        if let Some(repeat) = &found.repeat {
            part.linearisation = formal * repeat.moves[i].abs();
            let more = repeat.factors[i].powi(2) - 1.0 - repeat.moves[i].powi(2);
            part.scatter(formal * formal * more, repeat.freedom[i]);
        }
    }
    let mut factors = vec![1.0; outcome.parameters.len()];
    for part in &outcome.budget {
        let parameter = &mut outcome.parameters[part.parameter];
        if parameter.sigma > 0.0 {
            factors[part.parameter] = part.combined() / parameter.sigma;
        }
        parameter.sigma *= factors[part.parameter];
        parameter.estimated &= parameter.sigma.powi(2) < ESTIMATED * parameter.prior_sigma.powi(2);
    }
    for (row, by) in outcome.covariance.iter_mut().zip(&factors) {
        row.iter_mut().zip(&factors).for_each(|(entry, factor)| *entry *= by * factor);
    }
    if let Some(repeat) = &mut found.repeat {
        repeat.extend_to(outcome.parameters.len());
        for (i, parameter) in outcome.parameters.iter().enumerate().filter(|(i, _)| formal_of[*i] > 0.0) {
            repeat.factors[i] = parameter.sigma / formal_of[i];
        }
    }
    (outcome.passes, outcome.moved, outcome.repeat) = (found.passes, found.moved, found.repeat);
    (outcome.site, outcome.site_fault, outcome.look) = (found.site, found.site_fault, found.look);
    Ok(outcome)
}

/// One pass about what another run found; what the filter has more is zero.
fn about(
    filter: &dyn AnyFilter,
    samples: &dyn Samples,
    setup: &Setup,
    options: &Options,
    found: &Outcome,
) -> Result<Outcome, Error> {
    let mut run = filter.start(setup, &Options { settle: false, ..options.clone() });
    let mut values = found.state_values.clone();
    values.resize(filter.parameters().len(), 0.0);
    run.restart(&found.begun);
    run.judge_as(found.gate);
    run.begin_pass_about(&values, true)?;
    feed(&[filter], core::slice::from_mut(&mut run), samples)?;
    Ok(run.finish()?)
}

/// The standard deviations of a filter's parameters were there no wander of the biases; nothing where it has none.
fn without_wander(
    filter: &dyn AnyFilter,
    samples: &dyn Samples,
    setup: &Setup,
    options: &Options,
    found: &Outcome,
) -> Result<Option<Vec<Option<f64>>>, Error> {
    let names = wander(filter);
    if names.is_empty() {
        return Ok(None);
    }
    let Ok(steady) = Composition::of(filter, &[], &names) else { return Ok(None) };
    let stays = |i: &usize| !names.contains(&found.parameters[*i].info.block);
    let places: Vec<usize> = (0..found.parameters.len()).filter(stays).collect();
    let own =
        Outcome { state_values: places.iter().map(|i| found.state_values[*i]).collect(), ..found.clone() };
    let outcome = about(&steady, samples, setup, options, &own)?;
    let mut sigmas = vec![None; found.parameters.len()];
    for (place, parameter) in places.iter().zip(&outcome.parameters) {
        sigmas[*place] = Some(parameter.sigma);
    }
    Ok(Some(sigmas))
}

/// What a run took as exact, and what it would matter.
#[derive(Clone, Debug)]
pub struct Exact {
    /// What each influence of the chain of measurement, and the wander of the biases, would add to each parameter, SI.
    pub budget: Vec<Budget>,
    /// Standard deviations that this was reckoned with, SI, by name of the effect.
    pub sigmas: Vec<(&'static str, f64)>,
}

impl Exact {
    /// What adds most to a parameter beside its sigma: the influence, the parameter's place, and by how much, SI.
    pub fn largest(&self, found: &Outcome) -> Option<(&'static str, usize, f64)> {
        let all = self.budget.iter().filter(|part| found.parameters[part.parameter].estimated);
        let all = all.flat_map(|part| {
            let of_the_chain = part.influences.iter().filter(|(name, _)| !WANDER.contains(name));
            of_the_chain.map(|(name, by)| (*name, part.parameter, *by))
        });
        all.max_by(|a, b| {
            let over = |(_, place, by): &(&str, usize, f64)| by / found.parameters[*place].sigma;
            over(a).total_cmp(&over(b))
        })
    }

    /// The standard deviations of the gyro and accelerometer biases' wander that would each double the sigma of a parameter, SI; nothing where
    /// the filter has wander, or it does not matter.
    pub fn doubled_by(&self, found: &Outcome, parameter: usize) -> [Option<f64>; 2] {
        let part = self.budget.iter().find(|part| part.parameter == parameter);
        WANDER.map(|name| {
            let added = part?.influences.iter().find(|(influence, _)| *influence == name)?.1;
            let (_, sigma) = self.sigmas.iter().find(|(known, _)| *known == name)?;
            let doubles = 3.0_f64.sqrt() * found.parameters[parameter].sigma / added;
            doubles.is_finite().then(|| sigma * doubles)
        })
    }
}

/// In one pass more, what was taken as exact would add to what a run found. Nothing where the filter has no room for it, or does not
/// survive it.
///
/// # Errors
/// When the log cannot be read.
pub fn exact(
    filter: &Arc<dyn AnyFilter>,
    samples: &dyn Samples,
    setup: &Setup,
    options: &Options,
    found: &Outcome,
) -> Result<Option<Exact>, Error> {
    let steady = wander(&**filter).is_empty();
    let wander = WANDER.iter().copied().filter(|_| steady);
    let names: Vec<&str> = influences(&**filter).into_iter().chain(wander).collect();
    let effects: Vec<_> = names.iter().filter_map(|name| any_effect(name)).collect();
    let Ok(doubting) = considering(filter, &effects) else { return Ok(None) };
    let quick = Options { smooth: false, residuals: false, ..options.clone() };
    let outcome = match about(&*doubting, samples, setup, &quick, found) {
        // nothing is lost with it but what it would have said
        Err(Error::Diverged { .. }) => return Ok(None),
        outcome => outcome?,
    };
    let mut sigmas: Vec<(&'static str, f64)> = Vec::new();
    for parameter in outcome.parameters.iter().filter(|parameter| names.contains(&parameter.info.block)) {
        if sigmas.last().is_none_or(|(name, _)| *name != parameter.info.block) {
            sigmas.push((parameter.info.block, parameter.prior_sigma));
        }
    }
    Ok(Some(Exact { budget: budget(&outcome, &names), sigmas }))
}
