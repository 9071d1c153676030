//! What a path can show and what it cannot tell apart.

use nalgebra::DMatrix;

use crate::linear::{Noise, Recorded, run};
use crate::prices::{Prices, groups_of};
use crate::recording::Recording;
use crate::scene::{EXCITED, Scene};

/// Two effects are the same to a path that leaves less than this part of what one says once the other is free, and too little
/// for an effect of its prior's size to show.
const LEFT: f64 = 0.05;

/// Two effects that a path cannot tell apart.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pair {
    pub(crate) effect: String,
    pub(crate) other: String,
}

/// Pairs of which the second hides the first: a candidate behind a block of the filter, or behind another candidate.
///
/// From one run in which base parameters are priced like candidates: the information of everything about everything.
pub(crate) fn indistinguishable(scene: &Scene) -> Vec<Pair> {
    let base = scene.ran.recording.base();
    let Some(everything) = Prices::sum(scene.parts()) else { return Vec::new() };
    let of_base = |g: usize| everything.groups[g].members.iter().all(|m| *m < base.len());
    let all = everything.all();
    let (own, candidates): (Vec<usize>, Vec<usize>) = all.into_iter().partition(|g| of_base(*g));
    let mut pairs = Vec::new();
    let mut judge = |with: &[usize], other: usize, before: &Prices| {
        let mut more = with.to_vec();
        more.push(other);
        let Some(after) = everything.given(&more) else { return };
        for g in candidates.iter().copied().filter(|g| *g != other) {
            if before.excitation(g).0 < EXCITED {
                continue;
            }
            // with much said to begin with, a twentieth of it may still be plenty
            if left(before, &after, g) < LEFT && after.excitation(g).1 < EXCITED {
                let name = |g: usize| everything.groups[g].name.clone();
                pairs.push(Pair { effect: name(g), other: name(other) });
            }
        }
    };
    for &h in &own {
        let others: Vec<usize> = own.iter().copied().filter(|o| *o != h).collect();
        if let Some(before) = everything.given(&others) {
            judge(&others, h, &before);
        }
    }
    if let Some(before) = everything.given(&own) {
        for &h in &candidates {
            judge(&own, h, &before);
        }
    }
    pairs
}

/// The same from each of so many stretches of equal length; nothing where the run breaks down.
pub(crate) fn parts(recording: &Recording, noise: &Noise, count: usize) -> Vec<Prices> {
    let mut priced = recording.base();
    priced.extend(recording.candidates());
    let nc = 1 + priced.len();
    let (start, end) = recording.span();
    let mut grams = vec![vec![0.0; nc * nc]; count];
    let found = run(recording, &[], &Recorded(&priced), noise, &mut |whitened| {
        let part = (whitened.step.time - start) / (end - start).max(f64::MIN_POSITIVE);
        let gram = &mut grams[((part * count as f64) as usize).min(count - 1)];
        for row in whitened.rows.chunks_exact(nc) {
            for i in 0..nc {
                for j in 0..nc {
                    gram[i * nc + j] += row[i] * row[j];
                }
            }
        }
    });
    if found.is_none() {
        return Vec::new();
    }
    let sigma: Vec<f64> = priced.iter().map(|c| recording.columns[*c].prior).collect();
    let groups = groups_of(&recording.columns, &priced);
    grams.iter().map(|gram| Prices::new(gram, sigma.clone(), groups.clone())).collect()
}

/// The part of a group's information that is left in its worst direction, of those that show at all.
fn left(before: &Prices, after: &Prices, g: usize) -> f64 {
    let members = &before.groups[g].members;
    let lambda = before.lambda.select_rows(members).select_columns(members);
    let rest = after.lambda.select_rows(members).select_columns(members);
    let eigen = lambda.symmetric_eigen();
    let shown: Vec<usize> =
        (0..members.len()).filter(|k| eigen.eigenvalues[*k] > EXCITED * EXCITED).collect();
    if shown.is_empty() {
        return 1.0;
    }
    let root = DMatrix::from_fn(members.len(), shown.len(), |i, k| {
        eigen.eigenvectors[(i, shown[k])] / eigen.eigenvalues[shown[k]].sqrt()
    });
    (root.transpose() * rest * root).symmetric_eigenvalues().min()
}
