//! Whether a second log bears out what the first one said.

use nalgebra::{Cholesky, DMatrix, DVector};

use crate::prices::{Prices, Score};
use crate::scene::Scene;

/// ln 20: an effect counts as confirmed when another stretch of data speaks for it by more than this.
pub(crate) const CONFIRMED: f64 = 2.995_732_273_553_991;
/// Covariances carried to another log are widened by this factor: a unit is not quite the same on another day.
pub(crate) const WIDENED: f64 = 9.0;
/// Estimates may differ by so many standard deviations per component...
const APART: f64 = 5.0;
/// ...or by this fraction of themselves.
const SAME: f64 = 0.1;
/// Decades of slack in what may be left: tests at the 1 % level reject true models.
const SLACK: f64 = 4.605_170_185_988_091;

/// What the second log says about a set of effects.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Verification {
    /// Log of the e-value of the whole set.
    pub(crate) ln_e: f64,
    /// Log of the e-value of each effect on top of the others.
    pub(crate) each: Vec<f64>,
    /// Whether each effect has the same value in both logs.
    pub(crate) same: Vec<bool>,
    /// What is most significant in the second log on top of the set.
    pub(crate) left: Option<(usize, Score)>,
    /// Whether that is too significant to be chance.
    pub(crate) something_left: bool,
}

/// Asks `second` about the groups `named` in `first`; nothing when it cannot say, for lack of excitation.
pub(crate) fn verify(first: &Scene, second: &Scene, named: &[usize], threshold: f64) -> Option<Verification> {
    let there = |groups: &[usize]| -> Option<Vec<usize>> {
        groups.iter().map(|g| second.prices.find(&first.prices.groups[*g].name)).collect()
    };
    let ln_e = |groups: &[usize]| -> Option<f64> {
        if groups.is_empty() {
            return Some(0.0);
        }
        let (mean, covariance) = first.prices.posterior(groups)?;
        second.prices.ln_e(&there(groups)?, &mean, &(covariance * WIDENED))
    };
    let all = ln_e(named)?;
    let mut each = Vec::new();
    for g in named {
        let others: Vec<usize> = named.iter().copied().filter(|o| o != g).collect();
        each.push(all - ln_e(&others)?);
    }
    let mapped = there(named)?;
    let same =
        same_values(&first.prices, named, first.prices.posterior(named)?, second.prices.posterior(&mapped)?)?;
    let excited = second.excited();
    let left = second
        .prices
        .given(&mapped)
        .and_then(|rest| rest.worst(excited.into_iter().filter(|g| !mapped.contains(g))));
    let something_left = left.is_some_and(|(_, score)| score.ln_p < threshold - SLACK);
    Some(Verification { ln_e: all, each, same, left, something_left })
}

/// Whether each of `groups` has the same value in both of two logs, within error: estimates and their covariances.
pub(crate) fn same_values(
    first: &Prices,
    groups: &[usize],
    (mean_a, covariance_a): (DVector<f64>, DMatrix<f64>),
    (mean_b, covariance_b): (DVector<f64>, DMatrix<f64>),
) -> Option<Vec<bool>> {
    let mut at = 0;
    let mut same = Vec::new();
    for g in groups {
        let n = first.groups[*g].members.len();
        let d = mean_a.rows(at, n) - mean_b.rows(at, n);
        let c = covariance_a.view((at, at), (n, n)) + covariance_b.view((at, at), (n, n));
        let distance = d.dot(&Cholesky::new(c)?.solve(&d));
        let size = mean_a.rows(at, n).norm();
        same.push(distance < APART * APART * n as f64 || d.norm() < SAME * size);
        at += n;
    }
    Some(same)
}

/// The same from the two halves of one log: how much better the second half is predicted with the groups than without,
/// both given the first half.
pub(crate) fn held_out(scene: &Scene, named: &[usize]) -> (f64, Vec<f64>) {
    let gain = |groups: &[usize]| scene.prices.gain(groups) - scene.half.gain(groups);
    let all = gain(named);
    let each = named
        .iter()
        .map(|g| {
            let others: Vec<usize> = named.iter().copied().filter(|o| o != g).collect();
            all - gain(&others)
        })
        .collect();
    (all, each)
}
