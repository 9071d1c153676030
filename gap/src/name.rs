//! Which effects are missing: the smallest set that leaves nothing to explain.

use crate::prices::{Prices, Score};

/// Up to this size all sets are tried; larger ones grow from the best of the size before.
pub(crate) const EXHAUSTIVE: usize = 3;
/// Growing ends here.
const MOST: usize = 6;
/// So many sets of each size go on growing: a wrong member taken early must not be the only way on.
const BEAM: usize = 40;
/// Two sets whose evidence differs by less than this (ln 100) cannot be told apart.
pub(crate) const MARGIN: f64 = 4.605_170_185_988_091;

/// A set of effects that was tried.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tried {
    /// Groups, in the order of the catalogue.
    pub(crate) groups: Vec<usize>,
    /// What it gains in log-likelihood, its prior included: its log-evidence.
    pub(crate) gain: f64,
    /// What is most significant on top of it.
    pub(crate) left: Option<(usize, Score)>,
}

impl Tried {
    pub(crate) fn new(prices: &Prices, mut groups: Vec<usize>, among: &[usize]) -> Self {
        groups.sort_unstable();
        let left = prices
            .given(&groups)
            .and_then(|rest| rest.worst(among.iter().copied().filter(|g| !groups.contains(g))));
        Self { gain: prices.gain(&groups), groups, left }
    }

    /// Whether nothing on top of it is more significant than `threshold`.
    pub(crate) fn is_adequate(&self, threshold: f64) -> bool {
        // of a set that cannot be priced nothing is known
        self.gain.is_finite() && self.left.is_none_or(|(_, score)| score.ln_p > threshold)
    }
}

/// The sets worth considering, best evidence first.
#[derive(Clone, Debug)]
pub(crate) struct Search {
    /// Adequate sets, larger ones only where they gain clearly more; or the one set that growing ended with.
    pub(crate) sets: Vec<Tried>,
    /// Whether the first set leaves nothing significant.
    pub(crate) adequate: bool,
}

/// Looks for the smallest adequate set among groups.
pub(crate) fn search(prices: &Prices, among: &[usize], threshold: f64) -> Search {
    let none = Tried::new(prices, Vec::new(), among);
    if none.is_adequate(threshold) {
        return Search { sets: vec![none], adequate: true };
    }
    let mut best = none;
    let mut adequate: Vec<Tried> = Vec::new();
    let mut front: Vec<(f64, Vec<usize>)> = vec![(0.0, Vec::new())];
    for size in 1..=MOST.min(among.len()) {
        front = grown(prices, &front, among);
        front.sort_by(|a, b| b.0.total_cmp(&a.0));
        let Some((gain, largest)) = front.first() else { break };
        if *gain > best.gain + MARGIN {
            best = Tried::new(prices, largest.clone(), among);
        } else if size > EXHAUSTIVE {
            break;
        }
        // a larger set must earn its place
        let least = adequate.first().map_or(f64::NEG_INFINITY, |s| s.gain + MARGIN);
        // and a set that gains nothing explains nothing
        let least = least.max(0.0);
        let tried = front.iter().take_while(|s| s.0 > least).map(|s| Tried::new(prices, s.1.clone(), among));
        adequate.extend(tried.filter(|s| s.is_adequate(threshold)));
        if size >= EXHAUSTIVE {
            if !adequate.is_empty() {
                break;
            }
            front.truncate(BEAM);
        }
    }
    if adequate.is_empty() {
        let adequate = best.is_adequate(threshold);
        return Search { sets: vec![best], adequate };
    }
    adequate.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    Search { sets: adequate, adequate: true }
}

/// Every set of `from` with one more of `among`, each once, with its gain.
pub(crate) fn grown(prices: &Prices, from: &[(f64, Vec<usize>)], among: &[usize]) -> Vec<(f64, Vec<usize>)> {
    let mut sets: Vec<Vec<usize>> = Vec::new();
    for (_, set) in from {
        for g in among.iter().filter(|g| !set.contains(g)) {
            let mut more = set.clone();
            more.push(*g);
            more.sort_unstable();
            sets.push(more);
        }
    }
    sets.sort_unstable();
    sets.dedup();
    sets.into_iter().map(|s| (prices.gain(&s), s)).collect()
}
