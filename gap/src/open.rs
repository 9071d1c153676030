//! The open stage: is something there that no effect of the library explains?

use crate::dictionary::Dictionary;
use crate::linear::run;
use crate::prices::{Prices, Score, groups_of};
use crate::scene::Scene;
use crate::threshold;

/// Families and library priced together.
pub(crate) struct Open {
    pub(crate) prices: Prices,
    /// Groups of families come first; there are this many.
    pub(crate) families: usize,
    pub(crate) units: Vec<String>,
    /// What a family must fall below on its own.
    pub(crate) threshold: f64,
    updates: usize,
}

impl Open {
    pub(crate) fn new(scene: &Scene, rate: f64, seed: u64) -> Option<Self> {
        let recording = &scene.ran.recording;
        let library = recording.candidates();
        let dictionary = Dictionary::new(recording, &library);
        if dictionary.own() == 0 {
            return None;
        }
        let found = run(recording, &recording.base(), &dictionary, &scene.noise, &mut |_| {})?;
        let mut sigma = dictionary.sigma.clone();
        sigma.extend(library.iter().map(|c| recording.columns[*c].prior));
        let mut groups = dictionary.groups.clone();
        let families = groups.len();
        for mut group in groups_of(&recording.columns, &library) {
            for m in &mut group.members {
                *m += dictionary.own();
            }
            groups.push(group);
        }
        let prices = Prices::new(&found.gram, sigma, groups);
        let own: Vec<usize> = (0..families).collect();
        let threshold = threshold::simulate(&prices, &own, rate, seed, "dictionary");
        Some(Self { prices, families, units: dictionary.units, threshold, updates: recording.updates() })
    }

    /// Groups of the library by the numbers they have in the scene.
    fn mapped(&self, named: &[usize]) -> Vec<usize> {
        named.iter().map(|g| g + self.families).collect()
    }

    /// The families that are significant on top of `named`, the most significant first.
    pub(crate) fn loud(&self, named: &[usize]) -> Vec<(usize, Score)> {
        let Some(rest) = self.prices.given(&self.mapped(named)) else { return Vec::new() };
        let mut loud: Vec<(usize, Score)> =
            (0..self.families).map(|g| (g, rest.score(g))).filter(|(_, s)| s.ln_p < self.threshold).collect();
        loud.sort_by(|a, b| a.1.ln_p.total_cmp(&b.1.ln_p));
        loud
    }

    /// What family `g` gains on top of `named`.
    pub(crate) fn gain_on(&self, g: usize, named: &[usize]) -> f64 {
        let mapped = self.mapped(named);
        let mut with = mapped.clone();
        with.push(g);
        self.prices.gain(&with) - self.prices.gain(&mapped)
    }

    /// The part of each member's gain that it keeps when family `g` joins the set.
    pub(crate) fn kept(&self, g: usize, named: &[usize]) -> f64 {
        let mapped = self.mapped(named);
        let gain_of = |without: usize, with_family: bool| {
            let mut all = mapped.clone();
            if with_family {
                all.push(g);
            }
            let others: Vec<usize> = all.iter().copied().filter(|o| *o != without).collect();
            self.prices.gain(&all) - self.prices.gain(&others)
        };
        mapped.iter().map(|m| gain_of(*m, true) / gain_of(*m, false).max(1e-9)).fold(f64::INFINITY, f64::min)
    }

    /// Families that explain what `named` explains: within 10 of its BIC, and leaving nothing for it to add.
    pub(crate) fn rivals(&self, named: &[usize]) -> Vec<usize> {
        let mapped = self.mapped(named);
        let bic = |groups: &[usize]| {
            let parameters = self.prices.members(groups).len() as f64;
            self.fit(groups) - parameters * (self.updates as f64).ln()
        };
        if named.is_empty() {
            return Vec::new();
        }
        let theirs = bic(&mapped);
        (0..self.families)
            .filter(|&g| {
                if bic(&[g]) < theirs - 10.0 {
                    return false;
                }
                let Some(rest) = self.prices.given(&[g]) else { return false };
                mapped.iter().all(|n| rest.score(*n).ln_p > self.threshold)
            })
            .collect()
    }

    /// Twice the gain in likelihood of the best fit of some groups.
    fn fit(&self, groups: &[usize]) -> f64 {
        let members = self.prices.members(groups);
        let lambda = self.prices.lambda.select_rows(&members).select_columns(&members);
        let b = self.prices.b.select_rows(&members);
        let mut t = 0.0;
        if members.is_empty() {
            return t;
        }
        let eigen = lambda.symmetric_eigen();
        for (k, value) in eigen.eigenvalues.iter().enumerate() {
            if *value > 1.0 {
                t += eigen.eigenvectors.column(k).dot(&b).powi(2) / value;
            }
        }
        t
    }
}
