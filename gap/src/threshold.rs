//! What must be exceeded for something to count: simulated, never guessed.

use nalgebra::{DMatrix, DVector};

use crate::prices::Prices;
use crate::random::Stream;

/// Draws of "nothing is missing".
const DRAWS: usize = 20_000;

/// The logarithm of the p-value that the most significant of `groups` falls below with probability `rate` when nothing
/// is missing.
pub(crate) fn simulate(prices: &Prices, groups: &[usize], rate: f64, seed: u64, purpose: &str) -> f64 {
    let local = prices.only(groups);
    let tests: Vec<_> = (0..local.groups.len()).filter_map(|g| local.test(g)).collect();
    least(&local.lambda, rate, seed, purpose, &|b| tests.iter().map(|test| test.ln_p(b)).fold(0.0, f64::min))
}

/// What `statistic` of the score b falls below with probability `rate` when nothing is missing: b is then normal with mean
/// zero and covariance Lambda.
pub(crate) fn least(
    lambda: &DMatrix<f64>,
    rate: f64,
    seed: u64,
    purpose: &str,
    statistic: &dyn Fn(&[f64]) -> f64,
) -> f64 {
    let n = lambda.nrows();
    if n == 0 {
        return f64::NEG_INFINITY;
    }
    // unit diagonal before the eigenvalues, or those of weak columns are lost in the rounding of strong ones
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
    for _ in 0..DRAWS / batch {
        let normal = DMatrix::from_fn(n, batch, |_, _| stream.normal());
        let draws = &root * normal;
        smallest.extend(draws.column_iter().map(|column| statistic(column.as_slice())));
    }
    smallest.sort_unstable_by(f64::total_cmp);
    smallest[((DRAWS as f64 * rate) as usize).min(DRAWS - 1)]
}
