//! How good a path is.

use std::collections::BTreeMap;

use sinscal::StateInfo;

use crate::evaluate::Expected;

/// Of a path as long as the one to compare with this part of its sigmas is asked for.
const FLOOR: f64 = 0.566;
/// A shorter path is asked for more by this power of the duration.
const BY_TIME: f64 = 0.25;
/// For less than what noise leaves of an effect when all others are known nobody asks, but for this multiple of it...
const ABOVE_NOISE: f64 = 1.25;
/// ...and for a larger one the further noise alone is above what would be asked for, by this power for each e-folding that the path is
/// shorter: such an effect takes all the time that there is, and the others want theirs.
const BOUND: f64 = 0.072;

/// What is made small: the ratios of sigmas to those that are asked for, SI. Sigmas count by effect: that of its worst component.
/// Effects that are not named do not count.
#[derive(Clone, Debug, PartialEq)]
pub struct Criterion(pub BTreeMap<String, f64>);

/// An effect, and the sigma of its worst component, SI.
pub type Group = (String, f64);

/// Effects in the order of their states.
pub fn groups(expected: &Expected) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for (info, sigma) in &expected.sigma {
        match groups.last_mut().filter(|(name, _)| name == info.block) {
            Some((_, worst)) => *worst = worst.max(*sigma),
            None => groups.push((info.block.to_owned(), *sigma)),
        }
    }
    groups
}

impl Criterion {
    /// To be better than the path `reference` in `duration` seconds, as far as `noise` lets each effect be found.
    pub fn against(reference: &Expected, noise: &[Group], duration: f64) -> Self {
        let shorter = (reference.duration / duration).ln();
        let part = FLOOR * (BY_TIME * shorter).exp();
        let asked = |(name, sigma): Group| {
            let least = noise.iter().find(|(other, _)| *other == name).map_or(0.0, |(_, least)| *least);
            let wanted = part * sigma;
            (name, wanted.max(ABOVE_NOISE * least * (least / wanted).powf(BOUND * shorter)))
        };
        Self(groups(reference).into_iter().map(asked).collect())
    }

    /// To keep effects apart: each is to be shown, all the others in doubt.
    pub fn apart(parameters: &[StateInfo], effects: &[String]) -> Self {
        let wanted = parameters.iter().filter(|state| effects.iter().any(|name| name == state.block));
        Self(wanted.map(|state| (state.block.to_owned(), state.prior_sigma)).collect())
    }

    /// The ratio of each effect.
    pub fn ratios(&self, expected: &Expected) -> Vec<Group> {
        let ratio = |(name, sigma): Group| self.0.get(&name).map(|asked| (name, sigma / asked));
        groups(expected).into_iter().filter_map(ratio).collect()
    }

    /// The worst ratio of a path; less is better, and 1 is what is asked for.
    pub fn of(&self, expected: &Expected) -> f64 {
        self.ratios(expected).iter().fold(0.0, |worst, (_, ratio)| worst.max(*ratio))
    }

    /// What noise would leave of the criterion if for each effect all the others were known, on whichever path of `alone` is the best for
    /// it: no path is known to come below.
    pub fn bound(&self, alone: &[&[Group]]) -> f64 {
        let least = |wanted: &String| {
            let sigmas = alone.iter().flat_map(|path| path.iter());
            sigmas.filter(|(name, _)| name == wanted).map(|(_, sigma)| *sigma).fold(f64::INFINITY, f64::min)
        };
        self.0.iter().map(|(name, asked)| least(name) / asked).fold(0.0, f64::max)
    }

    /// What a search makes small: the logarithm of a mean of the ratios in this power. Where it is high only the worst counts, where it is
    /// low the others are made small as well.
    pub(crate) fn smooth(&self, expected: &Expected, power: f64) -> f64 {
        let ratios = self.ratios(expected);
        let sum: f64 = ratios.iter().map(|(_, ratio)| ratio.powf(power)).sum();
        (sum / ratios.len() as f64).ln() / power
    }
}
