//! The nonlinear runs: the declared filter with chosen candidates, closed loop, relinearised, recorded.

use nalgebra::DVector;
use runs::{About, AnyFilter, ComposeError, Composition, Options};
use sinscal::navigation::Pilot;
use sinscal::{AnyEffect, DitherSizeEffect, Effect, EffectInfo, Gate, Setup, StateInfo, any_effect};

use crate::candidates::prior_factor;
use crate::chain::is_left_out;
use crate::decide::with;
use crate::declaration::BaseFilter;
use crate::error::SceneError;
use crate::linear::{Found, Noise};
use crate::log::Log;
use crate::name::MARGIN;
use crate::noise::price;
use crate::prices::Prices;
use crate::recording::{CORE, Column, Recorder, Recording, Start};
use runs::products::dot;

/// Estimates have settled that are within so many standard deviations of where the pass was linearised.
const SETTLED: f64 = 1.0;
/// What a move leaves is second order. In the first recorded pass it is small when the largest angle that all moves make is less
/// than this, rad...
const SMALL: f64 = 2e-3;
/// ...and, times the largest move in standard deviations, less than this.
const SECOND_ORDER: f64 = 0.1;
/// No more candidates than this come first...
const FOREMOST: usize = 6;
/// ...and each adds this part of what those before it gain.
const GOOD_PART: f64 = 0.2;
/// No more recorded passes than this.
const PASSES: usize = 4;
/// The effect that a delay of the reference is.
pub(crate) const DELAY: &str = "reference-delay";
/// Size of a specific force, m/s^2.
const GRAVITY: f64 = 9.8;

/// A filter was really run.
#[derive(Clone, Debug)]
pub(crate) struct Ran {
    pub(crate) recording: Recording,
    /// Log-likelihood of the base filter, and the prices of the candidates that took part.
    pub(crate) log_likelihood: f64,
    pub(crate) prices: Prices,
    /// Estimate of every parameter under base and all candidates, truth.
    pub(crate) estimate: Vec<f64>,
}

impl Ran {
    /// The same as it looks from stamps from which no delay of the reference was taken out: the pass was linearised about the whole
    /// of it, and what it says of the delay is about the whole too.
    pub(crate) fn with_delay(mut self, seconds: f64) -> Self {
        let Recording { columns, starts, .. } = &mut self.recording;
        for (i, column) in columns.iter_mut().enumerate().filter(|(_, column)| column.info.block == DELAY) {
            starts.iter_mut().for_each(|start| start.about[i] += seconds);
            self.estimate[i] += seconds;
            if column.base {
                column.prior = column.prior.max(seconds.abs());
            }
        }
        self
    }

    /// Runs over several logs as one: what base estimates begins anew with each log, and in the end has the values of the last one.
    /// Nothing where an innovation covariance is not positive definite.
    pub(crate) fn joined(mut runs: Vec<Self>, noise: &Noise) -> Option<Self> {
        if runs.len() == 1 {
            return runs.pop();
        }
        let recording = Recording::joined(runs.into_iter().map(|ran| ran.recording).collect())?;
        let (found, prices) = price(&recording, noise)?;
        let values = estimates(&recording, &found, &prices, &prices.all())?;
        let estimate = values.into_iter().map(|(value, _)| value).collect();
        Some(Self { recording, log_likelihood: found.log_likelihood, prices, estimate })
    }
}

/// How many times larger than expected a block is taken to be; a candidate of size zero takes no part.
pub(crate) type Size<'a> = dyn Fn(&str) -> f64 + Sync + 'a;

/// What a diagnosis must be able to do with a declared filter, whatever its sizes.
pub(crate) trait Machine: Sync {
    /// What its declaration says.
    fn base(&self) -> BaseFilter;
    /// Whether the declared filter has a block.
    fn has(&self, block: &str) -> bool;
    /// What is said of an effect that is priced.
    fn entry(&self, effect: &str) -> Option<&'static EffectInfo>;
    /// Runs the filter and records a pass with all candidates' columns.
    fn run(&self, log: &Log, noise: &Noise, size: &Size) -> Result<Ran, SceneError>;
    /// The same, but it is the filter with `laws` and the candidates that have a size that is run closed loop, and there are no others.
    fn rerun(
        &self,
        log: &Log,
        noise: &Noise,
        laws: &[&'static dyn AnyEffect],
        size: &Size,
    ) -> Result<Ran, SceneError>;
    /// Navigates with what a run found.
    fn pilot(&self, setup: &Setup, ran: &Ran) -> Box<dyn Pilot>;
}

/// A filter and the effects that are priced against it.
pub(crate) struct Runs<'a> {
    base: &'a dyn AnyFilter,
    effects: Vec<&'static dyn AnyEffect>,
    /// The filter with all of them.
    all: Composition,
}

impl<'a> Runs<'a> {
    /// `base` with those of `effects` that it lacks.
    pub(crate) fn new(
        base: &'a dyn AnyFilter,
        effects: &[&'static dyn AnyEffect],
    ) -> Result<Self, ComposeError> {
        let own = base.blocks();
        // a filter with the dither coupling knows the dither's size effect, without states for it
        let has = |effect: &'static dyn AnyEffect| {
            own.iter().any(|leaf| leaf.name == effect.name())
                || effect.name() == DitherSizeEffect::EFFECT.name() && base.needs_dither()
        };
        let declares = |name: &str| own.iter().any(|leaf| leaf.name == name);
        // the column of a candidate is that of a constant
        let outside = |effect: &'static dyn AnyEffect| {
            effect.is_wander() || is_left_out(effect.name(), &declares, base.needs_dither())
        };
        let priced = |effect: &&'static dyn AnyEffect| !has(*effect) && !outside(*effect);
        let effects: Vec<_> = effects.iter().copied().filter(priced).collect();
        let all = Composition::with_states_for(base, &effects)?;
        Ok(Self { base, effects, all })
    }

    /// The parameters, those of the base first, with what is believed of them before the run.
    fn columns(&self, log: &Log, size: &Size) -> Vec<Column> {
        let own = self.base.parameters().len();
        let parameters = self.all.parameters();
        let column = |(i, info): (usize, StateInfo)| {
            let sigma = log.setup.prior(info.block).unwrap_or(info.prior_sigma);
            let prior = if i < own {
                sigma
            } else {
                sigma * size(info.block) * prior_factor(log.setup, self.entry(info.block))
            };
            Column { info, prior, base: i < own }
        };
        parameters.into_iter().enumerate().map(column).collect()
    }

    /// The filter with all effects; where there are none the base, whose code is its own.
    fn everything(&self) -> &dyn AnyFilter {
        if self.effects.is_empty() { self.base } else { &self.all }
    }

    /// Runs the base, or the filter with all effects, closed loop on joined samples, then records passes with all effects about
    /// what was found, until it has settled.
    fn drive(&self, log: &Log, noise: &Noise, size: &Size, all: bool) -> Result<Ran, SceneError> {
        let columns = self.columns(log, size);
        let first = if all { self.everything() } else { self.base };
        let priors = columns[..first.parameters().len()].iter().map(|column| column.prior).collect();
        let mut run = first.start(log.setup, &Options { passes: 1, priors, ..Options::of(first) });
        run.begin_pass(false)?;
        log.try_each_joined(|sample| run.feed(core::slice::from_ref(sample)).map_err(SceneError::Diverged))?;
        let found = run.finish()?;
        let mut values: Vec<f64> = found.parameters.iter().map(|parameter| parameter.value).collect();
        values.resize(columns.len(), 0.0);
        self.everything().without_guess(log.setup, &mut values);
        let (mut about, mut gate) = (values, found.gate);
        // where the pass before was linearised about: its record is large, and made anew should it be wanted after all
        let mut before: Option<(Vec<f64>, Gate)> = None;
        let mut passes = 0;
        loop {
            let recorded = match self.record(log, noise, &columns, &About { values: &about, gate }, all) {
                // estimates that navigation does not survive are worse than those of the pass before
                Err(SceneError::Diverged(_) | SceneError::Indefinite) if before.is_some() => {
                    (about, gate) = before.take().unwrap_or((about, gate));
                    passes = PASSES - 1;
                    continue;
                }
                recorded => recorded?,
            };
            passes += 1;
            let moves: Vec<f64> =
                recorded.next.iter().zip(&about).map(|(next, about)| next - about).collect();
            let sigmas = moves.iter().zip(&recorded.sigmas).filter(|(_, sigma)| **sigma > 0.0);
            let moved = sigmas.map(|(by, sigma)| by.abs() / sigma).fold(0.0, f64::max);
            let is_small = || angle_of(&recorded.ran.recording, &moves) < SMALL.min(SECOND_ORDER / moved);
            if moved < SETTLED || passes == 1 && is_small() || passes == PASSES {
                return Ok(recorded.ran);
            }
            before = Some((about, gate));
            (about, gate) = (recorded.next, recorded.gate);
        }
    }

    /// Records a pass about given values and prices the candidates; the next one is about all of them, or about those that come first.
    fn record(
        &self,
        log: &Log,
        noise: &Noise,
        columns: &[Column],
        about: &About,
        all: bool,
    ) -> Result<Pass, SceneError> {
        let mut recorder = Recorder::new(columns.len());
        let traced = self.everything().trace(log.samples, log.setup, about, &mut recorder)?;
        let recording = Recording {
            columns: columns.to_vec(),
            starts: vec![Start { step: 0, core: traced.start, about: about.values.to_vec() }],
            steps: recorder.steps,
            relaxing: traced.relaxing.iter().map(|(column, r)| (*column, r.rate, r.density)).collect(),
            channels: traced.channels,
        };
        let (found, prices) = price(&recording, noise).ok_or(SceneError::Indefinite)?;
        let of = |groups: &[usize]| {
            let estimates = estimates(&recording, &found, &prices, groups).ok_or(SceneError::Indefinite)?;
            Ok::<(Vec<f64>, Vec<f64>), SceneError>(estimates.into_iter().unzip())
        };
        let (estimate, sigmas) = of(&prices.all())?;
        let (next, sigmas) = if all { (estimate.clone(), sigmas) } else { of(&foremost(&prices))? };
        let ran = Ran { recording, log_likelihood: found.log_likelihood, prices, estimate };
        Ok(Pass { ran, next, sigmas, gate: traced.gate })
    }
}

/// What a recorded pass gives.
struct Pass {
    ran: Ran,
    /// What the next pass is to be linearised about, and its standard deviations.
    next: Vec<f64>,
    sigmas: Vec<f64>,
    gate: Gate,
}

/// The candidates that explain most, one after the other, as long as each adds a good part of what is explained so far. What comes after
/// is small beside them, and on a measured log nothing to linearise about: many unknowns share out there what none of them is.
fn foremost(prices: &Prices) -> Vec<usize> {
    let (mut set, mut gain) = (Vec::new(), 0.0);
    for _ in 0..FOREMOST {
        let others = prices.all().into_iter().filter(|g| !set.contains(g));
        let more = others.map(|g| (prices.gain(&with(&set, g)), with(&set, g)));
        let Some((best, larger)) = more.max_by(|a, b| a.0.total_cmp(&b.0)) else { break };
        if best - gain < MARGIN.max(GOOD_PART * gain) {
            break;
        }
        (set, gain) = (larger, best);
    }
    set
}

impl Machine for Runs<'_> {
    fn base(&self) -> BaseFilter {
        BaseFilter::of(self.base)
    }

    fn has(&self, block: &str) -> bool {
        self.entry(block).is_none()
    }

    fn entry(&self, effect: &str) -> Option<&'static EffectInfo> {
        self.effects.iter().map(|effect| effect.info()).find(|info| info.name() == effect)
    }

    fn run(&self, log: &Log, noise: &Noise, size: &Size) -> Result<Ran, SceneError> {
        match self.drive(log, noise, size, false) {
            // it may well be what it lacks that it does not survive
            Err(SceneError::Diverged(_)) => self.rerun(log, noise, &[], size),
            done => done,
        }
    }

    fn rerun(
        &self,
        log: &Log,
        noise: &Noise,
        laws: &[&'static dyn AnyEffect],
        size: &Size,
    ) -> Result<Ran, SceneError> {
        let taken = self.effects.iter().chain(laws).copied().filter(|effect| size(effect.name()) > 0.0);
        let narrow = Runs::new(self.base, &taken.collect::<Vec<_>>());
        narrow.map_err(|error| SceneError::Unreadable(error.into()))?.drive(log, noise, size, true)
    }

    fn pilot(&self, setup: &Setup, ran: &Ran) -> Box<dyn Pilot> {
        let mut added: Vec<&'static dyn AnyEffect> = Vec::new();
        for column in ran.recording.columns.iter().filter(|column| !column.base) {
            let name = column.info.block;
            if added.last().is_none_or(|last| last.name() != name) {
                let known = self.effects.iter().copied().find(|effect| effect.name() == name);
                added.extend(known.or_else(|| any_effect(name)));
            }
        }
        match Composition::with_states_for(self.base, &added) {
            Ok(filter) if !added.is_empty() => (&filter as &dyn AnyFilter).pilot_with(setup, &ran.estimate),
            // what ran with them can be composed with them
            _ => self.base.pilot_with(setup, &ran.estimate),
        }
    }
}

/// The largest angle, rad, by which moves of all parameters turn the computed attitude, or the specific force.
fn angle_of(recording: &Recording, moves: &[f64]) -> f64 {
    let mut angle: f64 = 0.0;
    let mut turned = [0.0; 3];
    for step in &recording.steps {
        let mut rows = step.rows.chunks_exact(CORE + moves.len() + 1).map(|row| dot(&row[CORE..], moves));
        for (turned, by) in turned.iter_mut().zip(&mut rows) {
            *turned += by;
            angle = angle.max(turned.abs());
        }
        for by in rows.take(3).filter(|_| step.elapsed > 0.0) {
            angle = angle.max(by.abs() / (GRAVITY * step.elapsed));
        }
    }
    angle
}

/// Estimate and standard deviation of every column under base and some candidates, from the run of the base filter that found
/// the candidates' prices; zero for what takes no part.
fn estimates(
    recording: &Recording,
    found: &Found,
    prices: &Prices,
    groups: &[usize],
) -> Option<Vec<(f64, f64)>> {
    let priced = recording.candidates();
    let (mean, covariance) = prices.estimates(groups, &vec![1.0; groups.len()])?;
    let members = prices.members(groups);
    let mut estimates = vec![(0.0, 0.0); recording.columns.len()];
    for (k, member) in members.iter().enumerate() {
        estimates[priced[*member]] = (mean[k], covariance[(k, k)].sqrt());
    }
    let nc = 1 + priced.len();
    for (k, i) in recording.base().into_iter().enumerate() {
        let errors = &found.errors[k * nc..(k + 1) * nc];
        let shares = DVector::from_iterator(members.len(), members.iter().map(|m| errors[1 + m]));
        let value = recording.about()[i] - errors[0] + shares.dot(&mean);
        let variance = found.variances[k] + shares.dot(&(&covariance * &shares));
        estimates[i] = (value, variance.sqrt());
    }
    Some(estimates)
}
