//! Directions among the states, in words.

use std::fmt::{self, Write};
use std::string::String;
use std::vec::Vec;

use calib_core::{Decomposition, Filter, Shape};

use crate::{StateInfo, Strapdown};

/// Parts of a direction below this fraction of its largest are not named.
const NAMED: f64 = 0.05;
/// Coefficients this close to one are not written.
const ONE: f64 = 0.05;

/// A combination of states, each counted in its prior standard deviation; the largest coefficient is one.
#[derive(Clone, Debug, PartialEq)]
pub struct Direction {
    /// States and coefficients, in the order of the declaration.
    pub terms: Vec<(StateInfo, f64)>,
}

/// A basis of the space that the singular vectors `which` of a decomposition span, each of few states: singular
/// vectors of equal values are any basis of their space, this one is brought to echelon form with the largest pivots.
pub fn basis<F: Filter<Dynamics = Strapdown>>(
    found: &Decomposition<F::Shape, f64>,
    which: core::ops::Range<usize>,
) -> Vec<Direction> {
    let n = F::Shape::STATES;
    let mut vectors: Vec<Vec<f64>> = which.map(|i| (0..n).map(|j| found.direction(i)[j]).collect()).collect();
    let mut pivots: Vec<usize> = Vec::new();
    for k in 0..vectors.len() {
        let entries = (k..vectors.len()).flat_map(|v| (0..n).map(move |j| (v, j)));
        let free = entries.filter(|(_, j)| !pivots.contains(j));
        let Some((best, pivot)) =
            free.max_by(|a, b| vectors[a.0][a.1].abs().total_cmp(&vectors[b.0][b.1].abs()))
        else {
            break;
        };
        vectors.swap(k, best);
        pivots.push(pivot);
        let scale = vectors[k][pivot];
        vectors[k].iter_mut().for_each(|entry| *entry /= scale);
        let row = vectors[k].clone();
        for (other, vector) in vectors.iter_mut().enumerate() {
            let factor = vector[pivot];
            if other != k {
                vector.iter_mut().zip(&row).for_each(|(entry, part)| *entry -= factor * part);
            }
        }
    }
    let mut infos = Vec::with_capacity(n);
    F::states(&mut |info| infos.push(info));
    // in the order of the states whose part is largest
    let mut directions: Vec<(usize, Direction)> = vectors
        .iter()
        .map(|vector| {
            let (at, largest) = vector.iter().enumerate().fold((0, 0.0_f64), |best, (j, entry)| {
                if entry.abs() > 1.0000001 * best.1.abs() { (j, *entry) } else { best }
            });
            let terms = infos.iter().zip(vector).map(|(info, entry)| (*info, entry / largest));
            (at, Direction { terms: terms.filter(|(_, part)| part.abs() > NAMED).collect() })
        })
        .collect();
    directions.sort_by_key(|(at, _)| *at);
    directions.into_iter().map(|(_, direction)| direction).collect()
}

impl fmt::Display for Direction {
    /// Blocks joined by "with", components within a block by their signs: `accel-misalignment xy - yx with heading`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut blocks: Vec<(&str, Vec<(&str, f64)>)> = Vec::new();
        for (info, part) in &self.terms {
            let (block, component) = match (info.block, info.component) {
                ("attitude", "u") => ("heading", ""),
                ("attitude", component) => ("tilt", component),
                other => other,
            };
            match blocks.iter_mut().find(|(name, _)| *name == block) {
                Some((_, terms)) => terms.push((component, *part)),
                None => blocks.push((block, Vec::from([(component, *part)]))),
            }
        }
        let size = |terms: &[(&str, f64)]| terms.iter().map(|(_, part)| part.abs()).fold(0.0, f64::max);
        blocks.sort_by(|a, b| size(&b.1).total_cmp(&size(&a.1)));
        for (i, (block, terms)) in blocks.iter().enumerate() {
            f.write_str(if i == 0 { "" } else { " with " })?;
            f.write_str(block)?;
            f.write_str(&written(terms, size(terms)))?;
        }
        Ok(())
    }
}

/// Components with signs, the first one positive.
fn written(terms: &[(&str, f64)], largest: f64) -> String {
    let sign = terms.first().map_or(1.0, |(_, part)| part.signum());
    let mut text = String::new();
    for (i, (component, part)) in terms.iter().enumerate() {
        let part = sign * part / largest;
        if i > 0 {
            text.push_str(if part < 0.0 { " -" } else { " +" });
        }
        if (part.abs() - 1.0).abs() > ONE {
            // writing to a string does not fail
            let _ = write!(text, " {:.2}", part.abs());
        }
        if !component.is_empty() {
            text.push(' ');
            text.push_str(component);
        }
    }
    text
}
