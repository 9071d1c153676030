//! The open stage: is something there that no effect of the library explains?

use crate::dictionary::{Dictionary, RANDOM_WALK};
use crate::linear::run;
use crate::name::MARGIN;
use crate::prices::{Prices, Score, groups_of};
use crate::scene::Scene;
use crate::threshold;
use crate::verify::WIDENED;

/// Families and library priced together.
pub(crate) struct Open {
    pub(crate) prices: Prices,
    /// Groups of families come first; there are this many.
    pub(crate) families: usize,
    pub(crate) units: Vec<String>,
    /// What a family must fall below on its own.
    pub(crate) threshold: f64,
    rms: Vec<f64>,
    updates: usize,
}

impl Open {
    /// With the threshold that is exceeded with probability `rate` when nothing is missing.
    pub(crate) fn new(scene: &Scene, rate: f64, seed: u64) -> Option<Self> {
        let mut new = Self::prices(scene)?;
        let own: Vec<usize> = (0..new.families).collect();
        new.threshold = threshold::simulate(&new.prices, &own, rate, seed, "dictionary");
        Some(new)
    }

    /// Without a threshold.
    pub(crate) fn prices(scene: &Scene) -> Option<Self> {
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
        Some(Self {
            prices,
            families,
            units: dictionary.units,
            threshold: f64::NEG_INFINITY,
            rms: dictionary.rms,
            updates: recording.updates(),
        })
    }

    /// Groups of the library by the numbers they have in the scene.
    fn mapped(&self, named: &[usize]) -> Vec<usize> {
        named.iter().map(|g| g + self.families).collect()
    }

    /// The families that are significant on top of `named`, the most significant first. On top of effects that are there,
    /// two decades of slack: tests at the 1 % level reject true models.
    pub(crate) fn loud(&self, named: &[usize]) -> Vec<(usize, Score)> {
        let threshold = if named.is_empty() { self.threshold } else { self.threshold - MARGIN };
        let Some(rest) = self.prices.given(&self.mapped(named)) else { return Vec::new() };
        let mut loud: Vec<(usize, Score)> =
            (0..self.families).map(|g| (g, rest.score(g))).filter(|(_, s)| s.ln_p < threshold).collect();
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

    /// Families that explain what `named` explains: within 10 of its BIC, and leaving nothing for it to add; each with how far
    /// its evidence is ahead. With another log, what that says counts too: `ln_e` is what it says of `named`.
    pub(crate) fn rivals(&self, named: &[usize], other: Option<(&Self, f64)>) -> Vec<(usize, f64)> {
        if named.is_empty() {
            return Vec::new();
        }
        let mapped = self.mapped(named);
        let theirs = self.prices.likelihood(&mapped, self.updates);
        let mut rivals: Vec<(usize, f64)> = (0..self.families)
            .filter_map(|g| {
                let mut ahead = self.prices.likelihood(&[g], self.updates) - theirs;
                if ahead < -5.0 {
                    return None;
                }
                if let Some((other, ln_e)) = other {
                    ahead += self.carried(g, other) - ln_e;
                    if ahead < -MARGIN {
                        return None;
                    }
                }
                let rest = self.prices.given(&[g])?;
                mapped.iter().all(|n| rest.score(*n).ln_p > self.threshold).then_some((g, ahead))
            })
            .collect();
        rivals.sort_by(|a, b| b.1.total_cmp(&a.1));
        rivals.truncate(5);
        rivals
    }

    /// Log of the e-value of family `g` on another log. What happens at its time has another value there, if it happens again:
    /// then what the other log says by itself counts.
    fn carried(&self, g: usize, other: &Self) -> f64 {
        let group = &self.prices.groups[g];
        let Some(there) = other.prices.groups[..other.families].iter().position(|o| o.name == group.name)
        else {
            return 0.0;
        };
        if group.name.starts_with("step") || group.name.starts_with(RANDOM_WALK) {
            return other.prices.likelihood(&[there], other.updates).max(0.0);
        }
        let Some((mut mean, mut covariance)) = self.prices.posterior(&[g]) else { return 0.0 };
        let scale: Vec<f64> = group
            .members
            .iter()
            .zip(&other.prices.groups[there].members)
            .map(|(a, b)| other.rms[*b] / self.rms[*a])
            .collect();
        for i in 0..scale.len() {
            mean[i] *= scale[i];
            for j in 0..scale.len() {
                covariance[(i, j)] *= WIDENED * scale[i] * scale[j];
            }
        }
        other.prices.ln_e(&[there], &mean, &covariance).unwrap_or(0.0)
    }
}
