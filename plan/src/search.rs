//! Looking for the best path: annealing in several chains, then polishing of rests and rates.

use rayon::prelude::*;
use rig::motion::{RoundedTrapezoid, Turn};
use rig::random::Stream;

use crate::criterion::Criterion;
use crate::draft::{Draft, Limits};
use crate::evaluate::{Evaluator, Trouble};
use crate::known::known_paths;
use crate::table::Table;

/// Chains: their number does not depend on that of threads, so that neither does the result.
const CHAINS: usize = 4;
/// Steps of each chain before somebody is told.
const ROUND: usize = 25;
/// Every so many rounds the worst chain goes on from where the best one is.
const EXCHANGE: usize = 32;
/// Random paths of which a chain takes the best to begin with.
const DRAWN: usize = 12;
/// Differences of the logarithm of the criterion that are put up with at the beginning and at the end.
const HOT: f64 = 0.02;
const COLD: f64 = 2e-4;
/// The power of the mean that is made small: until this part of the annealing every effect counts, then hardly any but the worst.
const SOFT: f64 = 24.0;
const SHARP: f64 = 120.0;
const SOFT_UNTIL: f64 = 0.6;
/// The last part of the evaluations goes to polishing.
const POLISH: f64 = 0.15;
/// Rests are tried longer and shorter by this factor at first, and no finer than by that.
const COARSE: f64 = 1.3;
const FINE: f64 = 1.01;
/// Relative width of the durations between which the shortest is told.
const CLOSE: f64 = 0.02;

/// How long to look.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Number of paths that are evaluated, about.
    pub evaluations: usize,
    /// Of the random draws.
    pub seed: u64,
}

impl Effort {
    /// Evaluations of paths of `duration` seconds in a minute or two on two cores: long paths take longer. It depends on no clock.
    pub fn usual(duration: f64) -> usize {
        (20_000.0 * (3600.0 / duration).sqrt()).clamp(5_000.0, 60_000.0) as usize
    }
}

/// A path: the rest before the first turn, s, and the turns.
pub type Way = (f64, Vec<Turn>);

/// A path on trial.
#[derive(Clone)]
struct Tried {
    draft: Draft,
    /// What is made small.
    value: f64,
    /// Its worst ratio.
    worst: f64,
}

/// A chain of annealing.
struct Chain {
    random: Stream,
    now: Tried,
    /// The one with the least worst ratio.
    best: Tried,
}

/// What paths are tried against.
struct Trial<'a> {
    evaluator: &'a Evaluator,
    criterion: &'a Criterion,
    limits: Limits,
}

impl Trial<'_> {
    /// Evaluates a path; one that does not fit or cannot be evaluated is infinitely bad.
    fn of(&self, draft: Draft, power: f64) -> Tried {
        let expected =
            self.limits.path(&draft).and_then(|(still, turns)| self.evaluator.turns(&turns, still).ok());
        let (value, worst) = expected.map_or((f64::NAN, f64::NAN), |expected| {
            (self.criterion.smooth(&expected, power), self.criterion.of(&expected))
        });
        let bad = !(value.is_finite() && worst.is_finite());
        Tried {
            draft,
            value: if bad { f64::INFINITY } else { value },
            worst: if bad { f64::INFINITY } else { worst },
        }
    }
}

/// Looks for the path of `duration` seconds with the smallest criterion. `best` is told now and then how many paths were tried and the
/// best criterion so far; where it returns `false` the search ends with what it has.
///
/// # Errors
/// When no path fits into the time, or none can be evaluated.
pub fn design(
    evaluator: &Evaluator,
    table: Table,
    duration: f64,
    criterion: &Criterion,
    effort: &Effort,
    best: &mut dyn FnMut(usize, f64) -> bool,
) -> Result<Way, Trouble> {
    let motion = &evaluator.scenario().motion;
    let limits = Limits::new(table, motion.max_rate, motion.acceleration, duration);
    let trial = Trial { evaluator, criterion, limits };
    let known: Vec<Way> = known_paths(evaluator, table, duration).into_iter().map(|(_, way)| way).collect();
    let mut chains: Vec<Chain> = (0..CHAINS)
        .into_par_iter()
        .filter_map(|place| Chain::new(place, &trial, &known, effort.seed))
        .collect();
    let mut tried = CHAINS * DRAWN + known.len();
    let annealing = (effort.evaluations as f64 * (1.0 - POLISH)) as usize;
    let rounds = annealing.saturating_sub(tried) / (CHAINS * ROUND);
    let mut goes_on = !chains.is_empty();
    for round in 0..rounds {
        if !goes_on {
            break;
        }
        let part = round as f64 / rounds as f64;
        let heat = HOT * (COLD / HOT).powf(part);
        let power = if part < SOFT_UNTIL { SOFT } else { SHARP };
        chains.par_iter_mut().for_each(|chain| chain.round(&trial, heat, power));
        if round % EXCHANGE == EXCHANGE - 1 {
            exchange(&mut chains);
        }
        tried += chains.len() * (ROUND + 1);
        let least = chains.iter().map(|chain| chain.best.worst).fold(f64::INFINITY, f64::min);
        goes_on = best(tried, least);
    }
    let first = chains.into_iter().map(|chain| chain.best).min_by(|a, b| a.worst.total_cmp(&b.worst));
    let Some(first) = first else {
        return Err(Trouble::Impossible(format!(
            "no path of a {} table that the filter can use fits into {duration} s",
            table.name()
        )));
    };
    let mut found = trial.of(first.draft, SHARP);
    if goes_on {
        polish(&mut found, &trial, effort.evaluations.saturating_sub(tried), &mut |more, worst| {
            best(tried + more, worst)
        });
    }
    let mut ways = known;
    ways.extend(trial.limits.path(&found.draft));
    worst_least(evaluator, criterion, ways)
}

/// Of some paths the one whose worst ratio is the least: a path that is known may beat what makes the mean of a power small.
fn worst_least(evaluator: &Evaluator, criterion: &Criterion, ways: Vec<Way>) -> Result<Way, Trouble> {
    let mut found: Option<(f64, Way)> = None;
    for (still, turns) in ways {
        let value = criterion.of(&evaluator.turns(&turns, still)?);
        // the designed one comes last, and is taken where it is as good
        if found.as_ref().is_none_or(|(least, _)| value <= *least) {
            found = Some((value, (still, turns)));
        }
    }
    found.map(|(_, way)| way).ok_or_else(|| Trouble::Impossible("there is no path to choose from".into()))
}

impl Chain {
    /// Begins at the best of its share of the paths that are known and some random ones.
    fn new(place: usize, trial: &Trial<'_>, known: &[Way], seed: u64) -> Option<Self> {
        let mut random = Stream::new(seed, &format!("plan/chain/{place}"));
        let known = known.iter().skip(place).step_by(CHAINS).map(|way| trial.limits.draft(way));
        let mut drafts: Vec<Draft> = known.collect();
        drafts.extend((0..DRAWN).map(|_| trial.limits.random(&mut random)));
        let tried = drafts.into_iter().map(|draft| trial.of(draft, SOFT));
        let now = tried.min_by(|a, b| a.value.total_cmp(&b.value)).filter(|now| now.value.is_finite())?;
        Some(Self { random, best: now.clone(), now })
    }

    /// Tries some changes; worse by about `heat` is put up with.
    fn round(&mut self, trial: &Trial<'_>, heat: f64, power: f64) {
        // what it is worth depends on the power
        self.now = trial.of(self.now.draft.clone(), power);
        for _ in 0..ROUND {
            let new = trial.of(trial.limits.change(&self.now.draft, &mut self.random), power);
            let chance = self.random.uniform();
            if new.value <= self.now.value || chance < ((self.now.value - new.value) / heat).exp() {
                self.now = new;
                if self.now.worst < self.best.worst {
                    self.best = self.now.clone();
                }
            }
        }
    }
}

/// The chain that is worst goes on from where the best one is.
fn exchange(chains: &mut [Chain]) {
    let place = |chains: &[Chain], worst: bool| {
        let by = |a: &usize, b: &usize| chains[*a].now.value.total_cmp(&chains[*b].now.value);
        if worst { (0..chains.len()).max_by(by) } else { (0..chains.len()).min_by(by) }
    };
    if let (Some(best), Some(worst)) = (place(chains, false), place(chains, true)) {
        chains[worst].now = chains[best].now.clone();
    }
}

/// Makes one rest after the other longer or shorter, and one turn after the other slower or faster, as long as that helps; steps become
/// smaller where none does.
fn polish(
    found: &mut Tried,
    trial: &Trial<'_>,
    evaluations: usize,
    told: &mut dyn FnMut(usize, f64) -> bool,
) {
    let (mut tried, mut factor) = (0, COARSE);
    while factor > FINE && tried < evaluations {
        let changes = trial.limits.changes(&found.draft, factor);
        let changed: Vec<Tried> = changes.into_par_iter().map(|draft| trial.of(draft, SHARP)).collect();
        tried += changed.len();
        // all that help on their own are made together, where that helps more than the best of them
        let helps: Vec<bool> = changed.iter().map(|changed| changed.value < found.value).collect();
        let together = trial.of(trial.limits.together(&found.draft, factor, &helps), SHARP);
        tried += 1;
        let best = changed.into_iter().chain([together]).min_by(|a, b| a.value.total_cmp(&b.value));
        match best {
            Some(better) if better.value < found.value => *found = better,
            _ => factor = factor.sqrt(),
        }
        if !told(tried, found.worst) {
            return;
        }
    }
}

/// Looks for the shortest path, from `least` to `most` seconds, whose criterion is at most 1.
///
/// # Errors
/// When there is none, or as [`design`].
pub fn shortest(
    evaluator: &Evaluator,
    table: Table,
    (least, most): (f64, f64),
    criterion: &Criterion,
    effort: &Effort,
    best: &mut dyn FnMut(usize, f64) -> bool,
) -> Result<Way, Trouble> {
    let mut goes_on = true;
    let mut attempt = |duration: f64, goes_on: &mut bool| -> Result<_, Trouble> {
        let mut told = |tried: usize, value: f64| {
            *goes_on &= best(tried, value);
            // what is asked for is reached
            *goes_on && value > 1.0
        };
        let found = design(evaluator, table, duration, criterion, effort, &mut told)?;
        let value = criterion.of(&evaluator.turns(&found.1, found.0)?);
        Ok((found, value))
    };
    let (mut found, value) = attempt(most, &mut goes_on)?;
    if !(value <= 1.0) {
        return Err(Trouble::Impossible(format!(
            "the sigmas are not reached in {most} s: the worst is {value:.2} times what is asked for"
        )));
    }
    let (mut short, mut long) = (least, most);
    while goes_on && long / short > 1.0 + CLOSE {
        let middle = (short * long).sqrt();
        match attempt(middle, &mut goes_on) {
            Ok((path, value)) if value <= 1.0 => (found, long) = (path, middle),
            Ok(_) | Err(Trouble::Impossible(_)) => short = middle,
            Err(error) => return Err(error),
        }
    }
    Ok(found)
}

/// How long a turn takes, s: a trapezoid of rate, or a triangle.
pub(crate) fn takes(turn: &Turn, acceleration: f64) -> f64 {
    RoundedTrapezoid::new(turn.angle, turn.rate, acceleration, 0.0).duration()
}
