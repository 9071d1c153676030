//! A known effect against its neighbours, and what no library holds as a law: an equation of what was measured, never a cause.

use sinscal::{Kind, Law};

use crate::decide::Decision;
use crate::name::{MARGIN, Tried};
use crate::neighbours::Neighbours;
use crate::open::Open;
use crate::prices::Prices;
use crate::report::{FoundLaw, Verdict};
use crate::scene::Scene;
use crate::verify::{CONFIRMED, WIDENED, same_values};

/// An effect is unseated by a neighbour on top of which it keeps less than this part of what it says by itself.
const KEPT: f64 = 0.1;
/// So many terms are looked at with every part of a set.
const SHORTLIST: usize = 12;
/// Rivals of similar form that are listed, at most.
const RIVALS: usize = 5;

/// A law that a second log bears out, and what stands beside it.
pub(crate) struct Proposed {
    pub(crate) law: Law,
    /// Groups of the first log that are named with it.
    pub(crate) beside: Vec<usize>,
    /// What law and those gain together on both logs.
    pub(crate) gains: [f64; 2],
    pub(crate) said: FoundLaw,
}

/// A term with a part of the set beside which it was priced.
struct Candidate {
    at: usize,
    groups: Vec<usize>,
    /// What both logs say for it, with what it pays for having been chosen.
    standing: f64,
}

/// A set of effects and all terms, on both logs.
struct Bench<'a> {
    first: &'a Scene,
    here: Neighbours,
    there: Option<Neighbours>,
    /// The set, as groups of the first log.
    set: &'a [usize],
    /// Number of effects of the set.
    size: usize,
}

impl<'a> Bench<'a> {
    fn new(first: &'a Scene, second: Option<&Scene>, set: &'a [usize], triads: &[&str]) -> Option<Self> {
        let here = Neighbours::of(first, set, triads)?;
        let there = match second {
            Some(second) => {
                let mapped: Option<Vec<usize>> =
                    set.iter().map(|g| second.prices.find(&first.prices.groups[*g].name)).collect();
                Some(here.again(second, &mapped?)?)
            }
            None => None,
        };
        (!here.all.is_empty()).then_some(Self { first, here, there, set, size: set.len() })
    }

    fn likelihood(&self, prices: &Prices, groups: &[usize]) -> f64 {
        prices.likelihood(groups, self.first.ran.recording.updates())
    }

    /// Log of the e-value of groups on the second log, given the first.
    fn ln_e(here: &Prices, there: Option<&Prices>, groups: &[usize]) -> f64 {
        let (Some(there), false) = (there, groups.is_empty()) else { return 0.0 };
        let found = here.posterior(groups);
        found.and_then(|(mean, c)| there.ln_e(groups, &mean, &(c * WIDENED))).unwrap_or(f64::NEG_INFINITY)
    }

    /// What both logs say for groups of one pair of prices.
    fn standing(&self, here: &Prices, there: Option<&Prices>, groups: &[usize]) -> f64 {
        self.likelihood(here, groups) + Self::ln_e(here, there, groups)
    }

    fn pair(&self, at: usize) -> (Prices, Option<Prices>) {
        (self.here.with(at), self.there.as_ref().map(|there| there.with(at)))
    }

    /// What a term pays for having been chosen.
    fn price(&self) -> f64 {
        (self.here.all.len() as f64).ln()
    }

    /// The neighbour that explains both logs better than the member `place` of the set, and leaves it nothing to explain.
    fn unseats(&self, place: usize, is_gyro: Option<bool>) -> Option<Candidate> {
        let whole: Vec<usize> = (0..self.size).collect();
        let others: Vec<usize> = whole.iter().copied().filter(|g| *g != place).collect();
        let mut best: Option<Candidate> = None;
        for at in 0..self.here.all.len() {
            if is_gyro.is_some_and(|is_gyro| is_gyro != self.here.all[at].is_gyro()) {
                continue;
            }
            let here = self.here.with(at);
            let exchanged: Vec<usize> = others.iter().copied().chain([self.size]).collect();
            let (without, alone) = (self.likelihood(&here, &others), self.likelihood(&here, &whole));
            // far behind on the first log alone: the second is not asked
            if self.likelihood(&here, &exchanged) < alone - 0.1 * (alone - without).abs() - MARGIN {
                continue;
            }
            let there = self.there.as_ref().map(|there| there.with(at));
            let ahead = self.standing(&here, there.as_ref(), &exchanged)
                - self.standing(&here, there.as_ref(), &whole)
                - self.price();
            let mut both = whole.clone();
            both.push(self.size);
            let kept = self.likelihood(&here, &both) - self.likelihood(&here, &exchanged);
            let is_ahead = ahead > MARGIN && kept < (KEPT * (alone - without)).max(MARGIN);
            if is_ahead && best.as_ref().is_none_or(|best| ahead > best.standing) {
                best = Some(Candidate { at, groups: exchanged, standing: ahead });
            }
        }
        best
    }

    /// The term that explains most, with those of the set that are still needed beside it.
    fn best(&self) -> Option<Candidate> {
        let whole: Vec<usize> = (0..self.size).collect();
        let mut front: Vec<(f64, usize)> = (0..self.here.all.len())
            .map(|at| {
                let here = self.here.with(at);
                let all: Vec<usize> = (0..=self.size).collect();
                (self.likelihood(&here, &[self.size]).max(self.likelihood(&here, &all)), at)
            })
            .collect();
        front.sort_by(|a, b| b.0.total_cmp(&a.0));
        front.truncate(SHORTLIST);
        let mut best: Option<Candidate> = None;
        for (_, at) in front {
            let (here, there) = self.pair(at);
            let mut groups: Vec<usize> = whole.iter().copied().chain([self.size]).collect();
            let mut standing = self.standing(&here, there.as_ref(), &groups);
            // what the term explains needs no known effect
            loop {
                let fewer = (0..groups.len() - 1).map(|out| {
                    let mut fewer = groups.clone();
                    fewer.remove(out);
                    (self.standing(&here, there.as_ref(), &fewer), fewer)
                });
                let Some(fewer) = fewer.max_by(|a, b| a.0.total_cmp(&b.0)) else { break };
                if fewer.0 < standing - MARGIN {
                    break;
                }
                (standing, groups) = fewer;
            }
            if best.as_ref().is_none_or(|best| standing > best.standing) {
                best = Some(Candidate { at, groups, standing });
            }
        }
        best
    }

    /// A candidate as a law, where the second log bears it out: an e-value above 20, the same value in both, and no other form that wins
    /// there.
    fn law(&self, candidate: &Candidate) -> Option<Proposed> {
        let Candidate { at, groups, .. } = candidate;
        let (here, there) = self.pair(*at);
        let there = there?;
        let term = self.size;
        let others: Vec<usize> = groups.iter().copied().filter(|g| *g != term).collect();
        let log_e_verify = Self::ln_e(&here, Some(&there), groups) - Self::ln_e(&here, Some(&there), &others);
        let (mean, covariance) = here.posterior(groups)?;
        let (again, again_covariance) = there.posterior(groups)?;
        let same = same_values(
            &here,
            groups,
            (mean.clone(), covariance.clone()),
            (again.clone(), again_covariance),
        )?;
        let own = self.likelihood(&there, groups);
        let standing = self.standing(&here, Some(&there), groups);
        let mut rivals: Vec<(f64, usize)> = Vec::new();
        let mut beaten = false;
        for other in (0..self.here.all.len()).filter(|other| other != at) {
            let (here, there) = self.pair(other);
            beaten |= there.as_ref().is_some_and(|there| self.likelihood(there, groups) > own + MARGIN);
            let behind = standing - self.standing(&here, there.as_ref(), groups);
            if behind < MARGIN {
                rivals.push((behind, other));
            }
        }
        if log_e_verify <= CONFIRMED || !*same.last()? || beaten {
            return None;
        }
        rivals.sort_by(|a, b| a.0.total_cmp(&b.0));
        rivals.truncate(RIVALS);
        let neighbour = &self.here.all[*at];
        let last = mean.len() - 3;
        let sigma: Vec<f64> = (last..last + 3).map(|i| covariance[(i, i)].sqrt()).collect();
        let beside: Vec<usize> = others.iter().map(|g| self.set[*g]).collect();
        let said = FoundLaw {
            name: neighbour.law.name(),
            equation: neighbour.law.equation(),
            beside: beside.iter().map(|g| self.first.prices.groups[*g].name.clone()).collect(),
            components: ["x", "y", "z"].map(String::from).to_vec(),
            estimate: neighbour.coefficients(&mean.as_slice()[last..]).collect(),
            sigma: neighbour.coefficients(&sigma).collect(),
            estimate_verify: neighbour.coefficients(&again.as_slice()[last..]).collect(),
            unit: neighbour.law.unit(),
            log_likelihood_gain: here.gain(groups) - here.gain(&others),
            log_e_verify,
            rivals: rivals.into_iter().map(|(_, other)| self.here.all[other].law.name()).collect(),
        };
        let gains = [here.gain(groups), there.gain(groups)];
        Some(Proposed { law: neighbour.law.clone(), beside, gains, said })
    }
}

/// Puts what was decided to the neighbours: a known effect that one of them unseats is no longer named, and what is in no library is
/// proposed as a law where a second log bears it out.
pub(crate) fn review(
    first: &Scene,
    second: Option<&Scene>,
    open: Option<&Open>,
    decision: &mut Decision,
    kind: &dyn Fn(&str) -> Option<Kind>,
) -> Option<Proposed> {
    let set = decision.best.groups.clone();
    let kinds: Vec<Option<Kind>> = set.iter().map(|g| kind(&first.prices.groups[*g].name)).collect();
    let is_outside = decision.verdict == Verdict::OutsideLibrary;
    let is_named = matches!(decision.verdict, Verdict::EffectsFound | Verdict::Ambiguous) && !set.is_empty();
    let goes_with = |triad: &str| {
        let of_kind = kinds.iter().flatten().any(|kind| match triad {
            "gyro" => kind.of_gyros(),
            _ => kind.of_accelerometers(),
        });
        let end = format!("in the {triad}s");
        let of_family = |g: &usize| open.is_some_and(|o| o.prices.groups[*g].name.ends_with(&end));
        of_kind || is_outside && decision.correlates.iter().any(of_family)
    };
    let triads: Vec<&str> = ["accelerometer", "gyro"].into_iter().filter(|triad| goes_with(triad)).collect();
    let is_asked = is_named || is_outside && second.is_some();
    if triads.is_empty() || !is_asked {
        return None;
    }
    let bench = Bench::new(first, second, &set, &triads)?;
    if is_outside {
        return bench.law(&bench.best().filter(|best| !is_stretch(open, decision, &bench, best))?);
    }
    let unseated = (0..set.len()).filter_map(|place| {
        let is_gyro = match kinds[place]? {
            Kind::Rate => Some(true),
            Kind::Force => Some(false),
            Kind::Sensors => None,
            Kind::Measurement => return None,
        };
        Some((place, bench.unseats(place, is_gyro)?))
    });
    let (place, by) = unseated.max_by(|a, b| a.1.standing.total_cmp(&b.1.standing))?;
    let name = &first.prices.groups[set[place]].name;
    let equation = bench.here.all[by.at].law.equation();
    decision.verdict = Verdict::OutsideLibrary;
    decision.reason = Some(format!("{name} comes near it, but {equation} explains it better"));
    decision.remainder = None;
    let rest = set.iter().copied().filter(|g| *g != set[place]).collect();
    decision.best = Tried::new(&first.prices, rest, &first.excited());
    decision.each.clear();
    decision.verification = None;
    bench.law(&by)
}

/// Whether something that is there for a stretch of the log, or after rotations, explains more than a term.
fn is_stretch(open: Option<&Open>, decision: &Decision, bench: &Bench, best: &Candidate) -> bool {
    let (Some(open), Some(family)) = (open, decision.correlates.first()) else { return false };
    let set: Vec<usize> =
        best.groups.iter().filter(|g| **g < bench.size).map(|g| decision.best.groups[*g]).collect();
    let theirs = open.likelihood_with(*family, &set);
    let own = bench.likelihood(&bench.here.with(best.at), &best.groups);
    let name = &open.prices.groups[*family].name;
    let lasts = ["burst", "step", "walk", "transient", "warm-up"].iter().any(|word| name.contains(word));
    lasts && theirs > own
}
