//! Passes that only improve: where linearisation bears, a further pass is a Gauss-Newton step of the posterior and the last one moves
//! nothing; where it does not, the step is shortened until the posterior is better, or it is said that passes do not agree.

use nalgebra::{DMatrix, DVector};
use sinscal::{Gate, Setup, Statistics};

use crate::Error;
use crate::compiled::About;
use crate::driver::{Watch, feed, no_update};
use crate::filter::AnyFilter;
use crate::outcome::{Outcome, Pass};
use crate::posterior::Posterior;
use crate::repeat::Repeat;
use crate::running::{Options, Running};
use crate::samples::Samples;
use crate::scores::{Question, START, Scored, Scores};
use crate::start::Start;

/// A pass whose result the next one would move by no more than this, in standard deviations, is the last.
const SETTLED: f64 = 0.5;
/// Steps that were shortened move until they move less than this...
const CLOSE: f64 = 0.1;
/// ...but not more often than this.
const STEPS: usize = 12;
/// A step is shortened by half, at most so many times.
const HALVED: i32 = 6;
/// The posterior of a linear model is better by half the square of the step in standard deviations: what is worse by less than this is
/// rounding and second order.
const SLACK: f64 = 0.5;
/// A reading that was left out counts as three components so many standard deviations off.
const LEFT_OUT: f64 = 5.0;

/// Where a pass is linearised about.
#[derive(Clone, Debug)]
struct Guess {
    /// Values of the parameters.
    values: Vec<f64>,
    /// Attitude and velocity at the first sample, where these are sought too.
    start: Option<Start>,
}

/// What is said of a guess.
struct Judged {
    guess: Guess,
    posterior: Posterior,
    log_posterior: f64,
    /// Where the posterior is best, as far as linearisation bears, from the guess, in units of the priors.
    step: DVector<f64>,
    covariance: DMatrix<f64>,
    /// Number of columns of the scores.
    columns: usize,
    constants: Vec<usize>,
}

impl Judged {
    /// What a further pass would move, in standard deviations.
    fn moves(&self) -> DVector<f64> {
        self.step.component_div(&self.covariance.diagonal().map(f64::sqrt))
    }

    /// The largest component of that.
    fn moved(&self) -> f64 {
        self.moves().amax()
    }

    /// The guess moved by a part of the step.
    fn along(&self, part: f64) -> Guess {
        let step = self.posterior.placed(&(&self.step * part), self.columns);
        let mut there = self.guess.clone();
        for (by, place) in step.iter().zip(&self.constants) {
            there.values[*place] += by;
        }
        if let Some(start) = &mut there.start {
            let sigmas = self.posterior.placed(&self.covariance.diagonal().map(f64::sqrt), self.columns);
            let first = self.constants.len();
            let of = |all: &[f64]| core::array::from_fn(|i| all[first + i]);
            start.correct(&of(&step), &of(&sigmas));
        }
        there
    }
}

struct Judge<'a> {
    filter: &'a dyn AnyFilter,
    samples: &'a dyn Samples,
    setup: Setup<'a>,
    priors: Vec<f64>,
    span: (f64, f64),
    gate: Gate,
}

impl Judge<'_> {
    /// Judges a guess in a pass with the parameters taken as known; nothing where it is beyond what a filter bears.
    fn at(&self, guess: Guess) -> Result<Option<Judged>, Error> {
        let mut scores = Scores::new(Question {
            about: guess.values.clone(),
            priors: self.priors.clone(),
            start: guess.start.is_some(),
            span: self.span,
        });
        let setup = guess.start.as_ref().map_or(self.setup, |start| start.within(&self.setup));
        let about = About { values: &guess.values, gate: self.gate };
        let statistics = match self.filter.trace(self.samples, &setup, &about, &mut scores) {
            Ok(traced) => traced.statistics,
            Err(Error::Diverged { .. }) => return Ok(None),
            Err(error) => return Err(error),
        };
        Ok(scores.finish().and_then(|scored| self.judged(guess, &scored, &statistics)))
    }

    fn judged(&self, guess: Guess, scored: &Scored, statistics: &Statistics) -> Option<Judged> {
        let start = guess.start.as_ref().map(|start| start.to_prior(&self.setup));
        let posterior = about(scored, &guess.values, &self.priors, start.as_ref());
        let (step, covariance) = posterior.step()?;
        Some(Judged {
            log_posterior: posterior.log_posterior - left_out(statistics),
            columns: scored.constants.len() + if guess.start.is_some() { START } else { 0 },
            constants: scored.constants.clone(),
            posterior,
            step,
            covariance,
            guess,
        })
    }
}

/// What readings that were left out take from a log-likelihood, so that leaving them out makes no guess better.
pub(crate) fn left_out(statistics: &Statistics) -> f64 {
    0.5 * 3.0 * LEFT_OUT * LEFT_OUT * statistics.rejected as f64
}

/// The posterior about values of the parameters and, if asked, the state at the first sample (to the prior's mean, and sigma).
fn about(
    scored: &Scored,
    values: &[f64],
    priors: &[f64],
    start: Option<&([f64; START], [f64; START])>,
) -> Posterior {
    let mut sigmas: Vec<f64> = scored.constants.iter().map(|place| priors[*place]).collect();
    let mut to_mean: Vec<f64> = scored.constants.iter().map(|place| -values[*place]).collect();
    if let Some((to_start, sigma)) = start {
        to_mean.extend(to_start);
        sigmas.extend(sigma);
    }
    Posterior::new(scored, &sigmas, &to_mean)
}

/// Moves uphill from a guess until a step moves nothing, or no part of a step is better.
fn climb(judge: &Judge, mut here: Judged, told: &mut Vec<Pass>) -> Result<Judged, Error> {
    for _ in 0..STEPS {
        if here.moved() < CLOSE {
            break;
        }
        let mut better = None;
        for halved in 0..=HALVED {
            let there = judge.at(here.along(0.5_f64.powi(halved)))?;
            let log_posterior = there.as_ref().map(|there| there.log_posterior);
            better = there.filter(|there| there.log_posterior > here.log_posterior);
            told.push(Pass { log_posterior, kept: better.is_some() });
            if better.is_some() {
                break;
            }
        }
        match better {
            Some(there) => here = there,
            None => break,
        }
    }
    Ok(here)
}

/// What a pass found.
struct Tried {
    values: Vec<f64>,
    /// How the readings were spread in it, and so which of them the next pass believes.
    gate: Gate,
    /// Logarithm of the posterior of the values, where the next pass has told it.
    log_posterior: Option<f64>,
}

impl Tried {
    fn worth(&self) -> f64 {
        self.log_posterior.unwrap_or(f64::NEG_INFINITY)
    }
}

/// The passes that were asked for, each about what the one before found; fewer if one after the first diverges.
fn passes(
    filter: &dyn AnyFilter,
    run: &mut Box<dyn Running>,
    samples: &dyn Samples,
    options: &Options,
    watch: &mut dyn Watch,
) -> Result<Vec<Tried>, Error> {
    let priors = run.priors();
    let mut tried: Vec<Tried> = Vec::new();
    for pass in 1..=options.passes {
        run.begin_pass(pass == options.passes)?;
        let fed = feed(&[filter], core::slice::from_mut(run), samples);
        if let (Some(last), Some(scored)) = (tried.last_mut(), run.scored()) {
            let posterior = about(&scored, &last.values, &priors, None).log_posterior;
            last.log_posterior = Some(posterior - left_out(run.statistics()));
        }
        match fed {
            // whoever survived one pass may be helped
            Err(Error::Diverged { .. }) if pass > 1 => break,
            fed => fed?,
        }
        if run.statistics().updates == 0 {
            return Err(no_update(filter));
        }
        watch.pass(&filter.title(), pass, options.passes, run.statistics());
        tried.push(Tried { values: run.values(), gate: run.gate(), log_posterior: None });
    }
    Ok(tried)
}

/// Runs a filter over a log until its passes agree.
pub(crate) fn calibrate(
    filter: &dyn AnyFilter,
    samples: &dyn Samples,
    setup: &Setup,
    options: &Options,
    watch: &mut dyn Watch,
) -> Result<Outcome, Error> {
    let found = Start::find(filter, samples, setup, options)?;
    let begun = found.as_ref().map_or(*setup, |start| start.within(setup));
    let mut run = filter.start(&begun, options);
    let mut tried = passes(filter, &mut run, samples, options, watch)?;
    let mut judge =
        Judge { filter, samples, setup: *setup, priors: run.priors(), span: run.span(), gate: run.gate() };
    let guess = |values: &[f64]| Guess { values: values.to_vec(), start: found };
    let best_before = tried.iter().map(Tried::worth).fold(f64::NEG_INFINITY, f64::max);
    let mut last = None;
    if tried.len() == options.passes as usize
        && let Some(tried) = tried.last_mut()
    {
        last = judge.at(guess(&tried.values))?;
        tried.log_posterior = last.as_ref().map(|here| here.log_posterior);
    }
    let settles =
        |here: &Judged| found.is_none() && here.log_posterior > best_before - SLACK && here.moved() < SETTLED;
    let told = |kept: &dyn Fn(usize) -> bool| {
        let pass = |(k, tried): (usize, &Tried)| Pass { log_posterior: tried.log_posterior, kept: kept(k) };
        tried.iter().enumerate().map(pass).collect::<Vec<_>>()
    };
    let (posterior, moves, told) = if let Some(here) = last.filter(settles) {
        (Some(here.posterior.clone()), here.moves(), told(&|_| true))
    } else {
        let best = (0..tried.len()).max_by(|a, b| tried[*a].worth().total_cmp(&tried[*b].worth()));
        let values = best.map(|best| tried[best].values.clone()).unwrap_or_default();
        if let Some(best) = best {
            // a pass that went astray believes whatever it saw: the readings are judged as those of the best were
            judge.gate = tried[best].gate;
        }
        let mut told = told(&|k| Some(k) == best);
        let mut from = judge.at(guess(&values))?;
        if from.is_none() {
            // nowhere near: begin with what was believed before
            from = judge.at(guess(&vec![0.0; judge.priors.len()]))?;
        }
        let Some(from) = from else { return Err(Error::NoGuess { filter: filter.title() }) };
        let best = climb(&judge, from, &mut told)?;
        if let Some(start) = &best.guess.start {
            run.restart(&start.within(setup).initial);
        }
        run.judge_as(judge.gate);
        run.begin_pass_about(&best.guess.values, true)?;
        feed(&[filter], core::slice::from_mut(&mut run), samples)?;
        let posterior = run.scored().map(|scored| about(&scored, &best.guess.values, &judge.priors, None));
        (posterior, best.moves(), told)
    };
    let mut outcome = run.finish()?;
    outcome.passes = told;
    outcome.moved = Some(moves.amax());
    if let Some(posterior) = posterior {
        let blocks: Vec<&str> = outcome.parameters.iter().map(|parameter| parameter.info.block).collect();
        if let Some(repeat) = Repeat::of(&posterior, &blocks, &moves) {
            repeat.apply(&mut outcome);
        }
    }
    Ok(outcome)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate as run;
    use crate::filter::Declared;
    use rig::{Scenario, Simulation};
    use sinscal::{Sample, Sins43B};

    const LOG: &str = "[imu]\nrate = \"20 Hz\"\n[motion]\nstill = \"60 s\"\ndwell = \"30 s\"";

    /// The next pass of the filter itself, and differences of the likelihood of whole passes, are the oracles.
    #[test]
    fn scores_are_the_gradient_of_the_likelihood_and_their_step_is_the_next_pass() {
        let simulation = Simulation::new(&Scenario::parse(LOG).expect("a scenario"), 3).expect("a unit");
        let setup = simulation.description().clone();
        let setup = setup.setup(&[]);
        let samples: Vec<Sample> = simulation.collect();
        // by its type: whatever else can be named would be compiled a second time for this test
        let filter = Declared::<Sins43B>::new(2, "");
        let after = |passes: u32| {
            let options = Options { passes, ..Options::of(&filter) };
            run(&filter, &samples, &setup, &options, &mut ()).expect("an outcome")
        };
        let (first, second) = (after(1), after(2));
        let of = |outcome: &Outcome| outcome.parameters.iter().map(|p| p.value).collect::<Vec<f64>>();
        let judge = Judge {
            filter: &filter,
            samples: &samples,
            setup,
            priors: first.parameters.iter().map(|p| p.prior_sigma).collect(),
            span: (first.start, first.start + first.duration),
            gate: second.gate,
        };
        let at = |values: Vec<f64>| judge.at(Guess { values, start: None }).expect("read").expect("bears");
        let here = at(of(&first));
        let there = here.along(1.0).values;
        let sigmas: Vec<f64> = second.parameters.iter().map(|p| p.sigma).collect();
        let mut moved = 0.0_f64;
        for (k, sigma) in sigmas.iter().enumerate() {
            let by = (second.parameters[k].value - first.parameters[k].value) / sigma;
            moved = moved.max(by.abs());
            let off = (there[k] - second.parameters[k].value) / sigma;
            assert!(off.abs() < 1e-3, "{k} is {off} sigma off");
            let stated = (here.covariance[(k, k)].sqrt() * judge.priors[k] / sigma - 1.0).abs();
            assert!(stated < 1e-3, "sigma of {k} by {stated}");
        }
        assert!(moved > 0.1, "nothing is tried: {moved}");
        let score = &here.posterior.merged(1)[0].0 + here.posterior.to_mean();
        for k in [0, 4, 7, 13, 20, first.parameters.len() - 1] {
            let aside = |part: f64| {
                let mut values = of(&first);
                values[k] += part * sigmas[k];
                at(values).log_posterior
            };
            let difference = (aside(0.5) - aside(-0.5)) / sigmas[k];
            let off = (difference - score[k] / judge.priors[k]) * sigmas[k];
            assert!(off.abs() < 0.03, "the slope of {k} is {off} a sigma off");
        }
    }
}
