//! From prices to a verdict.

use sinscal::{DitherScale, Effect as _};

use crate::error::SceneError;
use crate::name::{MARGIN, Search, Tried, search};
use crate::noise::TRUSTED;
use crate::open::Open;
use crate::partial::{absurd, dominant, remainder};
use crate::prices::Prices;
use crate::report::{Remainder, Verdict};
use crate::run::DELAY;
use crate::scene::Scene;
use crate::verify::{CONFIRMED, Verification, held_out, verify};

/// Where something remains unexplained, a named effect must outweigh it by this factor.
const OUTWEIGHS: f64 = 5.0;
/// ...and must carry this part of what the whole set gains.
const SHARE: f64 = 0.01;
/// What carries less than this part of the gain is never named beside the rest: a large effect that the inputs show to a hundredth,
/// say by a temperature that is read late, leaves as much behind.
const TRACE: f64 = 1e-4;

/// Scales of the dither's amplitudes beyond this are beyond linearisation, 1.
const GROSS: f64 = 0.1;
/// Nearly all of a gain.
const MOSTLY: f64 = 0.95;

/// What passes its threshold by less than three decades may be chance; where the second log is silent, it is.
const WEAK: f64 = 6.907_755_278_982_137;

/// What was decided, in numbers of groups of the first scene.
#[derive(Debug)]
pub(crate) struct Decision {
    pub(crate) verdict: Verdict,
    /// The set that explains best; named when the verdict is that effects were found.
    pub(crate) best: Tried,
    pub(crate) verification: Option<Verification>,
    /// Log of the e-value of each member on data that was not used for its estimate.
    pub(crate) each: Vec<f64>,
    /// Sets that explain as well.
    pub(crate) rivals: Vec<Vec<usize>>,
    /// Families of the dictionary that go with what is left, the most significant first.
    pub(crate) correlates: Vec<usize>,
    /// What remains on top of the set, where something does.
    pub(crate) remains: Option<String>,
    /// The same by its size, where effects are named all the same.
    pub(crate) remainder: Option<Remainder>,
    /// Why it was not confirmed.
    pub(crate) reason: Option<String>,
    /// Why the set that explains best of all is nothing to be named, and the members that are to blame.
    pub(crate) degenerate: Option<(String, Vec<usize>)>,
    /// Effects that were taken out again because the other data did not speak for them.
    pub(crate) stripped: Vec<usize>,
}

/// How well a set stands: from the first log, and from the second given the first.
#[derive(Clone, Copy, Debug)]
struct Standing {
    /// With the sizes that its effects were expected to have.
    evidence: f64,
    /// Without.
    likelihood: f64,
}

impl Standing {
    fn of(first: &Scene, second: Option<&Scene>, groups: &[usize], gain: f64, threshold: f64) -> Self {
        let more = second.and_then(|s| verify(first, s, groups, threshold)).map_or(0.0, |v| v.ln_e);
        let likelihood = first.prices.likelihood(groups, first.ran.recording.updates());
        Self { evidence: gain + more, likelihood: likelihood + more }
    }

    /// Whether a set that stands so cannot be told from the `best`. A name must not rest on how large effects were expected
    /// to be, nor on that alone be refused.
    fn rivals(self, best: Self) -> bool {
        self.evidence > best.evidence - MARGIN || self.likelihood > best.likelihood - MARGIN
    }
}

/// Sets that differ from `best` in one effect and explain the data as well.
fn exchanged(
    first: &Scene,
    second: Option<&Scene>,
    best: &Tried,
    among: &[usize],
    threshold: f64,
) -> Vec<Vec<usize>> {
    let standing = Standing::of(first, second, &best.groups, best.gain, threshold);
    let mut rivals = Vec::new();
    for (i, h) in (0..best.groups.len()).flat_map(|i| among.iter().map(move |h| (i, *h))) {
        if best.groups.contains(&h) {
            continue;
        }
        let mut groups = best.groups.clone();
        groups[i] = h;
        let other = Tried::new(&first.prices, groups, among);
        let rival = Standing::of(first, second, &other.groups, other.gain, threshold).rivals(standing);
        if rival && other.is_adequate(threshold - MARGIN) || is_mistold(&first.prices, &other, h, best) {
            rivals.push(other.groups);
        }
    }
    rivals
}

/// Whether a set explains nearly all that the best does by amplitudes of the dither that are told wrongly by more than linearisation
/// bears: what it leaves may be its second order.
fn is_mistold(prices: &Prices, set: &Tried, member: usize, best: &Tried) -> bool {
    prices.groups[member].name == DitherScale::EFFECT.name()
        && set.gain > MOSTLY * best.gain
        && prices.posterior(&[member]).is_some_and(|(scales, _)| scales.amax() > GROSS)
}

/// Judges what the first log shows, with the second where there is one.
///
/// # Errors
/// When the families of the second log cannot be priced.
pub(crate) fn decide(
    first: &Scene,
    second: Option<&Scene>,
    open: Option<&Open>,
    threshold: f64,
    stated: &dyn Fn(&str) -> Option<f64>,
) -> Result<Decision, SceneError> {
    let among = first.excited();
    if is_chance(first, second, open, &among, threshold)? {
        let none = Tried::new(&first.prices, Vec::new(), &among);
        return Ok(nothing_named(first, Search { sets: vec![none], adequate: true }, Vec::new()));
    }
    let mut found = search(&first.prices, &among, threshold);
    let mut loud = open.map_or(Vec::new(), |o| o.loud(&found.sets[0].groups));
    if found.sets[0].groups.is_empty() && !loud.is_empty() {
        // one effect that is not quite significant itself may silence what the families say
        let quiet = among
            .iter()
            .map(|g| Tried::new(&first.prices, vec![*g], &among))
            .filter(|s| s.gain > MARGIN && s.is_adequate(threshold))
            .filter(|s| open.is_some_and(|o| o.loud(&s.groups).is_empty()))
            .max_by(|a, b| a.gain.total_cmp(&b.gain));
        if let Some(quiet) = quiet {
            found = Search { sets: vec![quiet], adequate: true };
            loud.clear();
        }
    }
    if found.sets[0].groups.is_empty() {
        return Ok(nothing_named(first, found, loud));
    }
    let mut sets: Vec<(Standing, Tried)> = found
        .sets
        .into_iter()
        .map(|s| (Standing::of(first, second, &s.groups, s.gain, threshold), s))
        .collect();
    sets.sort_by(|a, b| b.0.evidence.total_cmp(&a.0.evidence));
    let (most, mut best) = sets.remove(0);
    let is_other = |best: &Tried, groups: &[usize]| !best.groups.iter().all(|g| groups.contains(g));
    let mut rivals: Vec<Vec<usize>> = sets
        .into_iter()
        .filter(|(standing, s)| standing.rivals(most) && is_other(&best, &s.groups))
        .map(|(_, s)| s.groups)
        .collect();
    let stripped = strip(first, second, &mut best, &among, threshold, found.adequate);
    for groups in exchanged(first, second, &best, &among, threshold) {
        if !rivals.contains(&groups) {
            rivals.push(groups);
        }
    }
    rivals.truncate(5);
    let loud = open.map_or(Vec::new(), |o| o.loud(&best.groups));
    let correlates: Vec<usize> = loud.iter().map(|l| l.0).take(5).collect();
    let verification = second.and_then(|s| verify(first, s, &best.groups, threshold));
    let each = match &verification {
        Some(v) => v.each.clone(),
        None => held_out(first, &best.groups).1,
    };
    let clean = best.is_adequate(threshold - MARGIN)
        && correlates.is_empty()
        && verification.as_ref().is_none_or(|v| !v.something_left);
    let remains = named_remainder(first, open, &best, &correlates, clean);
    let mut decision = Decision {
        verdict: Verdict::EffectsFound,
        best,
        verification,
        each,
        rivals,
        correlates,
        remains,
        remainder: None,
        reason: None,
        degenerate: None,
        stripped,
    };
    let is_strong = |decision: &Decision| {
        outweighs(first, second, open, decision)
            && absurd(&first.prices, &decision.best.groups, stated).is_none()
    };
    let mut strong = clean || is_strong(&decision);
    if !strong {
        decision.degenerate = absurd(&first.prices, &decision.best.groups, stated);
        settle_for_part(first, second, open, &mut decision, &among, threshold, stated);
        strong = is_strong(&decision);
    }
    judge(first, second, open, &mut decision, clean, strong)?;
    if !clean && decision.verdict == Verdict::EffectsFound {
        decision.remainder = Some(remainder(first, open, &decision.best.groups, &among));
    }
    Ok(decision)
}

/// Whether what is significant is so by little, and nothing is in the second log.
fn is_chance(
    first: &Scene,
    second: Option<&Scene>,
    open: Option<&Open>,
    among: &[usize],
    threshold: f64,
) -> Result<bool, SceneError> {
    let library = first.prices.worst(among.iter().copied()).map_or(0.0, |(_, score)| score.ln_p - threshold);
    let loudest = open.and_then(|o| o.loud(&[]).iter().map(|loud| o.beyond(loud)).min_by(f64::total_cmp));
    let most = loudest.map_or(library, |families| families.min(library));
    match second {
        Some(second) if most < 0.0 && most > -WEAK => is_silent(second, open, threshold),
        _ => Ok(false),
    }
}

/// Whether nothing is significant in the second log, on top of the base filter, by the thresholds of the first.
fn is_silent(second: &Scene, open: Option<&Open>, threshold: f64) -> Result<bool, SceneError> {
    let library = second.prices.worst(second.excited().into_iter()).is_none_or(|(_, s)| s.ln_p > threshold);
    let there = Open::prices(second)?;
    let families = there.zip(open).is_none_or(|(mut there, open)| {
        there.threshold = open.threshold;
        there.threshold_of_bursts = open.threshold_of_bursts;
        there.loud(&[]).is_empty()
    });
    Ok(library && families)
}

/// No effect of the library is significant.
fn nothing_named(first: &Scene, mut found: Search, loud: Vec<(usize, crate::prices::Score)>) -> Decision {
    let (verdict, reason) = if !loud.is_empty() {
        (Verdict::OutsideLibrary, None)
    } else if first.noise_hides {
        (
            Verdict::NotConfirmed,
            Some(format!("the noise is more than {TRUSTED} times what is stated, and may hide anything")),
        )
    } else {
        (Verdict::NothingMissing, None)
    };
    Decision {
        verdict,
        best: found.sets.remove(0),
        verification: None,
        each: Vec::new(),
        rivals: Vec::new(),
        correlates: loud.iter().map(|l| l.0).take(5).collect(),
        remains: None,
        remainder: None,
        reason,
        degenerate: None,
        stripped: Vec::new(),
    }
}

/// Nothing is named, whatever was found, for a reason that stands in the samples themselves.
pub(crate) fn withheld(first: &Scene, reason: String) -> Decision {
    let none = Tried::new(&first.prices, Vec::new(), &first.excited());
    let search = Search { sets: vec![none], adequate: false };
    Decision {
        verdict: Verdict::NotConfirmed,
        reason: Some(reason),
        ..nothing_named(first, search, Vec::new())
    }
}

/// Takes out members that data not used for their estimate do not speak for, while what is left stays adequate; where no
/// set is adequate, also members that carry next to nothing; and traces always.
fn strip(
    first: &Scene,
    second: Option<&Scene>,
    best: &mut Tried,
    among: &[usize],
    threshold: f64,
    adequate: bool,
) -> Vec<usize> {
    let mut stripped = Vec::new();
    while best.groups.len() > 1 {
        let checked = second.and_then(|s| verify(first, s, &best.groups, threshold));
        let each = match &checked {
            Some(v) => v.each.clone(),
            None => held_out(first, &best.groups).1,
        };
        let gains: Vec<f64> = best
            .groups
            .iter()
            .map(|g| {
                let others: Vec<usize> = best.groups.iter().copied().filter(|o| o != g).collect();
                best.gain - first.prices.gain(&others)
            })
            .collect();
        // what is said of a delay that was taken out beforehand is no measure for the rest
        let late = first.surveys.iter().any(|survey| survey.late.0 != 0);
        let out = |i: &usize| late && first.prices.groups[best.groups[*i]].name == DELAY;
        let beforehand: f64 = (0..gains.len()).filter(out).map(|i| gains[i]).sum();
        let is_trace = |i: usize| gains[i] < TRACE * (best.gain - beforehand);
        let weak = (0..best.groups.len())
            .filter(|i| each[*i] < CONFIRMED || is_trace(*i) || !adequate && gains[*i] < SHARE * best.gain)
            .min_by(|a, b| gains[*a].total_cmp(&gains[*b]));
        let Some(weak) = weak else { break };
        let mut groups = best.groups.clone();
        let out = groups.remove(weak);
        let rest = Tried::new(&first.prices, groups, among);
        if adequate && !is_trace(weak) && !rest.is_adequate(threshold - MARGIN) {
            break;
        }
        stripped.push(out);
        *best = rest;
    }
    stripped
}

/// What is most significant on top of the set, by name.
fn named_remainder(
    first: &Scene,
    open: Option<&Open>,
    best: &Tried,
    correlates: &[usize],
    clean: bool,
) -> Option<String> {
    if clean {
        return None;
    }
    match (best.left, correlates.first(), open) {
        (Some((g, score)), Some(family), Some(open)) => {
            let gain = first.prices.gain(&with(&best.groups, g)) - best.gain;
            if gain >= open.gain_on(*family, &best.groups) || score.ln_p < -100.0 && gain > 0.0 {
                Some(first.prices.groups[g].name.clone())
            } else {
                Some(open.prices.groups[*family].name.clone())
            }
        }
        (Some((g, _)), _, _) => Some(first.prices.groups[g].name.clone()),
        (None, Some(family), Some(open)) => Some(open.prices.groups[*family].name.clone()),
        _ => None,
    }
}

/// Where no set explains all: takes what dominates instead, if there is such a thing.
fn settle_for_part(
    first: &Scene,
    second: Option<&Scene>,
    open: Option<&Open>,
    decision: &mut Decision,
    among: &[usize],
    threshold: f64,
    stated: &dyn Fn(&str) -> Option<f64>,
) {
    let Some(groups) = dominant(first, second, open, among, stated) else { return };
    let tried = Tried::new(&first.prices, groups, among);
    decision.stripped.extend(decision.best.groups.iter().copied().filter(|g| !tried.groups.contains(g)));
    decision.stripped.retain(|g| !tried.groups.contains(g));
    decision.verification = second.and_then(|s| verify(first, s, &tried.groups, threshold));
    decision.each = match &decision.verification {
        Some(v) => v.each.clone(),
        None => held_out(first, &tried.groups).1,
    };
    let loud = open.map_or(Vec::new(), |o| o.loud(&tried.groups));
    decision.correlates = loud.iter().map(|l| l.0).take(5).collect();
    decision.remains = named_remainder(first, open, &tried, &decision.correlates, false);
    // whatever explains as much was looked for among all sets of this size
    decision.rivals.clear();
    decision.best = tried;
}

pub(crate) fn with(groups: &[usize], g: usize) -> Vec<usize> {
    let mut all = groups.to_vec();
    all.push(g);
    all
}

/// The verdict on a set of effects.
fn judge(
    first: &Scene,
    second: Option<&Scene>,
    open: Option<&Open>,
    decision: &mut Decision,
    clean: bool,
    strong: bool,
) -> Result<(), SceneError> {
    let best = &decision.best;
    if !strong {
        let inside = decision.correlates.is_empty();
        decision.verdict = if inside { Verdict::NotConfirmed } else { Verdict::OutsideLibrary };
        decision.reason =
            Some("something significant remains on top of every set of known effects that was tried".into());
        return Ok(());
    }
    let families = unresolved(second, open, decision)?;
    if let (Some(open), Some((family, ahead))) = (open, families.first()) {
        let name = &open.prices.groups[*family].name;
        decision.reason = Some(format!("{name}, which is no known effect, explains the data as well"));
        decision.correlates = families.iter().map(|f| f.0).collect();
        decision.verdict = match (*ahead > MARGIN, decision.rivals.is_empty()) {
            (true, _) => Verdict::OutsideLibrary,
            // one set is no choice between sets
            (false, true) => Verdict::NotConfirmed,
            (false, false) => Verdict::Ambiguous,
        };
        return Ok(());
    }
    if !decision.rivals.is_empty() {
        decision.verdict = Verdict::Ambiguous;
        return Ok(());
    }
    let name = |i: usize| first.prices.groups[best.groups[i]].name.as_str();
    if let Some(i) = (0..decision.each.len()).find(|i| decision.each[*i] < CONFIRMED) {
        let other = if second.is_some() { "the second log" } else { "the second half of the log" };
        decision.verdict = Verdict::NotConfirmed;
        decision.reason = Some(format!("{other} does not speak for {}", name(i)));
        return Ok(());
    }
    if second.is_some() && decision.verification.is_none() {
        decision.verdict = Verdict::NotConfirmed;
        decision.reason = Some("the second log cannot show it".into());
        return Ok(());
    }
    if let Some(v) = &decision.verification
        && let Some(i) = (0..v.same.len()).find(|i| !v.same[*i])
        && clean
    {
        decision.verdict = Verdict::NotConfirmed;
        decision.reason = Some(format!("{} has another value in the second log", name(i)));
    }
    Ok(())
}

/// Families of the dictionary that explain the data as well as the set, the second log included.
fn unresolved(
    second: Option<&Scene>,
    open: Option<&Open>,
    decision: &Decision,
) -> Result<Vec<(usize, f64)>, SceneError> {
    let Some(open) = open else { return Ok(Vec::new()) };
    let named = &decision.best.groups;
    let mut families = open.rivals(named, None);
    if !families.is_empty()
        && let (Some(second), Some(v)) = (second, &decision.verification)
        && let Some(there) = Open::prices(second)?
    {
        families = open.rivals(named, Some((&there, v.ln_e)));
    }
    Ok(families)
}

/// Whether every member of the set outweighs what remains, in both logs.
fn outweighs(first: &Scene, second: Option<&Scene>, open: Option<&Open>, decision: &Decision) -> bool {
    let best = &decision.best;
    let least = best
        .groups
        .iter()
        .map(|g| {
            let others: Vec<usize> = best.groups.iter().copied().filter(|o| o != g).collect();
            best.gain - first.prices.gain(&others)
        })
        .fold(f64::INFINITY, f64::min);
    let library = first
        .excited()
        .into_iter()
        .filter(|g| !best.groups.contains(g))
        .map(|g| first.prices.gain(&with(&best.groups, g)) - best.gain)
        .fold(0.0, f64::max);
    let families = open
        .map_or(0.0, |o| decision.correlates.iter().map(|g| o.gain_on(*g, &best.groups)).fold(0.0, f64::max));
    let stand = open.is_none_or(|o| decision.correlates.iter().all(|g| o.stand(*g, &best.groups)));
    let there = second.is_none() || decision.each.iter().all(|e| *e > 10.0 * CONFIRMED);
    least > OUTWEIGHS * library.max(families) && stand && there
}
