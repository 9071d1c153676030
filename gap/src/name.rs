//! Which effects are missing: the smallest set that leaves nothing to explain.

use crate::prices::{Prices, Score};

/// No more effects than this are named by trying all sets; beyond, sets grow one by one.
pub(crate) const EXHAUSTIVE: usize = 3;
/// Growing ends here.
const MOST: usize = 6;
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
        self.left.is_none_or(|(_, score)| score.ln_p > threshold)
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
    let mut best: Option<Tried> = None;
    let mut adequate: Vec<Tried> = Vec::new();
    for size in 1..=EXHAUSTIVE.min(among.len()) {
        let mut sets = Vec::new();
        combinations(among, size, &mut Vec::new(), 0, &mut |set| {
            // a set that gains nothing explains nothing
            if prices.gain(set) > 0.0 {
                sets.push(Tried::new(prices, set.to_vec(), among));
            }
        });
        sets.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        if let Some(first) = sets.first() {
            best = Some(first.clone());
        }
        sets.retain(|s| s.is_adequate(threshold));
        // a larger set must earn its place
        let least = adequate.first().map_or(f64::NEG_INFINITY, |s| s.gain + MARGIN);
        adequate.extend(sets.into_iter().filter(|s| s.gain > least));
    }
    if !adequate.is_empty() {
        adequate.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        return Search { sets: adequate, adequate: true };
    }
    let mut grown = best.unwrap_or(none);
    while grown.groups.len() < MOST && !grown.is_adequate(threshold) {
        let next = among
            .iter()
            .filter(|g| !grown.groups.contains(g))
            .map(|g| {
                let mut groups = grown.groups.clone();
                groups.push(*g);
                Tried::new(prices, groups, among)
            })
            .max_by(|a, b| a.gain.total_cmp(&b.gain));
        match next {
            Some(next) if next.gain > grown.gain + MARGIN => grown = next,
            _ => break,
        }
    }
    let adequate = grown.is_adequate(threshold);
    Search { sets: vec![grown], adequate }
}

fn combinations(
    among: &[usize],
    size: usize,
    chosen: &mut Vec<usize>,
    from: usize,
    visit: &mut dyn FnMut(&[usize]),
) {
    if chosen.len() == size {
        visit(chosen);
        return;
    }
    for i in from..among.len() {
        chosen.push(among[i]);
        combinations(among, size, chosen, i + 1, visit);
        chosen.pop();
    }
}
