//! What must be exceeded for something to count: simulated, never guessed.

use nalgebra::{DMatrix, DVector};

use crate::prices::Prices;
use crate::random::Stream;

/// Draws of "nothing is missing".
const DRAWS: usize = 20_000;

/// The logarithm of the p-value that the most significant of `groups` falls below with probability `rate` when nothing
/// is missing: b is then normal with mean zero and covariance Lambda.
pub(crate) fn simulate(prices: &Prices, groups: &[usize], rate: f64, seed: u64, purpose: &str) -> f64 {
    let members = prices.members(groups);
    let n = members.len();
    if n == 0 {
        return f64::NEG_INFINITY;
    }
    // unit diagonal before the eigenvalues, or those of weak columns are lost in the rounding of strong ones
    let lambda = prices.lambda.select_rows(&members).select_columns(&members);
    let scale = DVector::from_fn(n, |i, _| lambda[(i, i)].max(0.0).sqrt());
    let inverse = scale.map(|s| if s > 0.0 { 1.0 / s } else { 0.0 });
    let unit = DMatrix::from_fn(n, n, |i, j| lambda[(i, j)] * inverse[i] * inverse[j]);
    let eigen = unit.symmetric_eigen();
    let root = DMatrix::from_fn(n, n, |i, k| {
        scale[i] * eigen.eigenvectors[(i, k)] * eigen.eigenvalues[k].max(0.0).sqrt()
    });
    let mut stream = Stream::new(seed, purpose);
    // in batches, so that the product is one of matrices
    let batch = 500;
    let mut smallest = Vec::with_capacity(DRAWS);
    let mut local = Prices {
        b: DVector::zeros(n),
        lambda,
        sigma: members.iter().map(|m| prices.sigma[*m]).collect(),
        groups: Vec::new(),
    };
    let mut at = 0;
    for g in groups {
        let mut group = prices.groups[*g].clone();
        for m in &mut group.members {
            *m = at;
            at += 1;
        }
        local.groups.push(group);
    }
    let tests: Vec<_> = (0..local.groups.len()).filter_map(|g| local.test(g)).collect();
    for _ in 0..DRAWS / batch {
        let normal = DMatrix::from_fn(n, batch, |_, _| stream.normal());
        let draws = &root * normal;
        for column in draws.column_iter() {
            let least = tests.iter().map(|test| test.ln_p(column.as_slice())).fold(0.0, f64::min);
            smallest.push(least);
        }
    }
    smallest.sort_unstable_by(f64::total_cmp);
    smallest[((DRAWS as f64 * rate) as usize).min(DRAWS - 1)]
}
