//! What dominates a log that nothing explains in full: measured logs always leave something.

use nalgebra::{DMatrix, DVector};
use runs::Repeat;

use crate::decide::with;
use crate::name::{EXHAUSTIVE, MARGIN, grown};
use crate::open::Open;
use crate::prices::Prices;
use crate::report::Remainder;
use crate::scene::Scene;
use crate::verify::same_values;

/// What is named must gain so many times what anything else gains on top of it.
const DOMINATES: f64 = 5.0;
/// Two effects whose values are correlated beyond this explain little but each other.
const CANCELS: f64 = 0.98;
/// What was stated of an effect is not meant for values of so many of its standard deviations.
const STATED: f64 = 5.0;
/// Families that go with what remains, at most.
const FAMILIES: usize = 3;

/// The largest set of which each member dominates what remains, that has no rival, and that is nothing absurd.
pub(crate) fn dominant(
    first: &Scene,
    second: Option<&Scene>,
    open: Option<&Open>,
    among: &[usize],
    stated: &dyn Fn(&str) -> Option<f64>,
) -> Option<Vec<usize>> {
    let prices = &first.prices;
    let mut front: Vec<(f64, Vec<usize>)> = vec![(0.0, Vec::new())];
    let mut found = None;
    for _ in 0..EXHAUSTIVE.min(among.len()) {
        front = grown(prices, &front, among);
        front.sort_by(|a, b| b.0.total_cmp(&a.0));
        let (gain, groups) = front.first()?;
        let remains = largest(first, open, groups, among).0;
        let is_rival = |other: &&(f64, Vec<usize>)| gain - other.0 < remains.max(MARGIN);
        let sound = least(prices, groups) > DOMINATES * remains
            && front.iter().skip(1).find(is_rival).is_none()
            && absurd(prices, groups, stated).is_none()
            && second.is_none_or(|second| is_repeated(first, second, groups));
        if sound {
            found = Some(groups.clone());
        }
    }
    found
}

/// What remains on top of a set: the most that any other effect or family gains, and what it goes with.
pub(crate) fn remainder(first: &Scene, open: Option<&Open>, named: &[usize], among: &[usize]) -> Remainder {
    let (most, mut all) = largest(first, open, named, among);
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    all.truncate(FAMILIES);
    let explained = first.prices.gain(named);
    Remainder {
        share: most / (most + explained),
        log_likelihood: most,
        families: all.into_iter().filter(|a| 2.0 * a.0 > most).map(|a| a.1).collect(),
    }
}

fn largest(
    first: &Scene,
    open: Option<&Open>,
    named: &[usize],
    among: &[usize],
) -> (f64, Vec<(f64, String)>) {
    let prices = &first.prices;
    let gain = prices.gain(named);
    let library = among
        .iter()
        .filter(|g| !named.contains(g))
        .map(|g| (prices.gain(&with(named, *g)) - gain, prices.groups[*g].name.clone()));
    let families = open.into_iter().flat_map(|open| {
        (0..open.families).map(|g| (open.gain_on(g, named), open.prices.groups[g].name.clone()))
    });
    let all: Vec<(f64, String)> = library.chain(families).filter(|a| a.0 > 0.0).collect();
    (all.iter().map(|a| a.0).fold(0.0, f64::max), all)
}

/// What the member that adds least adds to the others.
fn least(prices: &Prices, groups: &[usize]) -> f64 {
    let gain = prices.gain(groups);
    let without = |g: &usize| groups.iter().copied().filter(|o| o != g).collect::<Vec<_>>();
    groups.iter().map(|g| gain - prices.gain(&without(g))).fold(f64::INFINITY, f64::min)
}

/// Why a set is nothing to be named, where it is so: members that cancel each other, or that are far larger than the description of the log
/// says that they may be; and the members that are to blame.
pub(crate) fn absurd(
    prices: &Prices,
    groups: &[usize],
    stated: &dyn Fn(&str) -> Option<f64>,
) -> Option<(String, Vec<usize>)> {
    let Some((mean, covariance)) = prices.posterior(groups) else {
        return Some(("its values are not determined".into(), groups.to_vec()));
    };
    let of: Vec<usize> =
        groups.iter().flat_map(|g| prices.groups[*g].members.iter().map(move |_| *g)).collect();
    let name = |i: usize| prices.groups[of[i]].name.as_str();
    let correlation =
        |i: usize, j: usize| covariance[(i, j)] / (covariance[(i, i)] * covariance[(j, j)]).sqrt();
    for i in 0..of.len() {
        if let Some(j) = (0..i).find(|j| of[*j] != of[i] && correlation(i, *j).abs() > CANCELS) {
            let why = format!(
                "this path shows {} and {} only together: their values are correlated by {:.3}",
                name(j),
                name(i),
                correlation(i, j)
            );
            return Some((why, vec![of[j], of[i]]));
        }
        if let Some(sigma) = stated(name(i)).filter(|sigma| mean[i].abs() > STATED * sigma) {
            let times = mean[i].abs() / sigma;
            let why = format!("{} would be {times:.0} times what [prior] states", name(i));
            return Some((why, vec![of[i]]));
        }
    }
    None
}

/// Whether a second log has the same values, within the errors that the stretches of both show.
fn is_repeated(first: &Scene, second: &Scene, groups: &[usize]) -> bool {
    let there: Option<Vec<usize>> =
        groups.iter().map(|g| second.prices.find(&first.prices.groups[*g].name)).collect();
    let same = there.and_then(|there| {
        same_values(&first.prices, groups, scattered(first, groups)?, scattered(second, &there)?)
    });
    same.is_some_and(|same| same.iter().all(|same| *same))
}

/// Values and their covariance, widened where the scores of base and groups together scatter from one stretch of the log to the next by
/// more than chance, as a calibration does it ([`Repeat`]).
pub(crate) fn scattered(scene: &Scene, groups: &[usize]) -> Option<(DVector<f64>, DMatrix<f64>)> {
    let (mean, mut covariance) = scene.prices.posterior(groups)?;
    let sizes = scene.prices.sizes(groups)?;
    if let Some(wider) = wider(scene, groups, &sizes) {
        for i in 0..wider.len() {
            for j in 0..wider.len() {
                covariance[(i, j)] *= wider[i] * wider[j];
            }
        }
    }
    Some((mean, covariance))
}

/// Factors on the standard deviations of the members of groups whose priors are so many times wider.
fn wider(scene: &Scene, groups: &[usize], sizes: &[f64]) -> Option<Vec<f64>> {
    let parts = scene.parts();
    let first = parts.first()?;
    let names: Vec<&str> = groups.iter().map(|g| scene.prices.groups[*g].name.as_str()).collect();
    let candidate = |name: &str| scene.prices.find(name).is_some();
    let mut chosen: Vec<usize> =
        (0..first.groups.len()).filter(|g| !candidate(&first.groups[*g].name)).collect();
    let own = first.members(&chosen).len();
    for name in &names {
        chosen.push(first.find(name)?);
    }
    let members = first.members(&chosen);
    let of = |g: usize| first.groups[g].members.iter().map(move |_| g);
    let of: Vec<usize> = chosen.iter().flat_map(|g| of(*g)).collect();
    let size = |g: usize| {
        let at = names.iter().position(|name| *name == first.groups[g].name);
        at.map_or(1.0, |at| sizes[at])
    };
    let scale = DVector::from_iterator(of.len(), of.iter().map(|g| size(*g)));
    let blocks: Vec<&str> = of.iter().map(|g| first.groups[*g].name.as_str()).collect();
    let scaled = |part: &Prices| {
        let lambda = part.lambda.select_rows(&members).select_columns(&members);
        let lambda = DMatrix::from_fn(of.len(), of.len(), |i, j| scale[i] * scale[j] * lambda[(i, j)]);
        (part.b.select_rows(&members).component_mul(&scale), lambda)
    };
    let repeat = Repeat::of_parts(parts.iter().map(scaled).collect(), &blocks)?;
    Some(repeat.factors[own..].to_vec())
}
