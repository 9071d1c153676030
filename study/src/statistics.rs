//! Statistics of samples.

use rig::random::Stream;
use statrs::distribution::{Binomial, ChiSquared, ContinuousCDF, DiscreteCDF};

/// Resamplings of a bootstrap.
const RESAMPLINGS: usize = 2000;

/// Mean; NaN of nothing.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Root of the mean square; NaN of nothing.
pub fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
}

/// The largest; zero of nothing, NaN where one is no number.
pub fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |most, value| if value > most || value.is_nan() { value } else { most })
}

/// The value below which the part `p` of the values lies, linear between neighbours; NaN of nothing, and where one is no
/// number.
pub fn percentile(values: &[f64], p: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    if values.iter().any(|value| value.is_nan()) {
        return f64::NAN;
    }
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let at = p.clamp(0.0, 1.0) * last as f64;
    let below = at.floor() as usize;
    let above = (below + 1).min(last);
    sorted[below] + (at - below as f64) * (sorted[above] - sorted[below])
}

/// Middle value; NaN of nothing.
pub fn median(values: &[f64]) -> f64 {
    percentile(values, 0.5)
}

/// Between which values the median of the population lies with at least 95 % probability, by order statistics, whatever the
/// distribution. `None` of fewer than six values.
pub fn median_interval_95(values: &[f64]) -> Option<[f64; 2]> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let below = Binomial::new(0.5, sorted.len() as u64).ok()?;
    // the k-th value lies above the median when fewer than k do not
    let k = (1..=sorted.len() / 2).rev().find(|k| below.cdf(*k as u64 - 1) <= 0.025)?;
    Some([sorted[k - 1], sorted[sorted.len() - k]])
}

/// Part of the values whose size is at most `limit`.
pub fn coverage(values: &[f64], limit: f64) -> f64 {
    values.iter().filter(|value| value.abs() <= limit).count() as f64 / values.len() as f64
}

/// Between which numbers the mean of a sum of `degrees_of_freedom` squares of standard normal numbers, divided by their
/// number, lies with probability `probability`. `None` when there are none.
pub fn chi_square_band(degrees_of_freedom: usize, probability: f64) -> Option<(f64, f64)> {
    let n = degrees_of_freedom as f64;
    let distribution = ChiSquared::new(n).ok()?;
    let tail = 0.5 * (1.0 - probability);
    Some((distribution.inverse_cdf(tail) / n, distribution.inverse_cdf(1.0 - tail) / n))
}

/// Ratio of the medians of paired values with its 95 % confidence interval (bootstrap over the pairs, percentiles). The same
/// values give the same numbers.
pub fn ratio_of_medians(above: &[f64], below: &[f64]) -> (f64, [f64; 2]) {
    let n = above.len().min(below.len());
    let ratio = median(above) / median(below);
    if n == 0 {
        return (ratio, [f64::NAN; 2]);
    }
    let mut stream = Stream::new(n as u64, "statistics/bootstrap");
    let mut ratios = Vec::with_capacity(RESAMPLINGS);
    let (mut a, mut b) = (vec![0.0; n], vec![0.0; n]);
    for _ in 0..RESAMPLINGS {
        for i in 0..n {
            let drawn = ((stream.uniform() * n as f64) as usize).min(n - 1);
            a[i] = above[drawn];
            b[i] = below[drawn];
        }
        ratios.push(median(&a) / median(&b));
    }
    (ratio, [percentile(&ratios, 0.025), percentile(&ratios, 0.975)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles() {
        let values = [4.0, 1.0, 3.0, 2.0];
        assert_eq!(median(&values), 2.5);
        assert_eq!(percentile(&values, 0.0), 1.0);
        assert_eq!(percentile(&values, 1.0), 4.0);
        assert!(median(&[]).is_nan());
        assert_eq!(coverage(&[-1.0, 0.5, 2.0, -3.0], 2.0), 0.75);
        assert!((rms(&[3.0, 4.0]) - 12.5_f64.sqrt()).abs() < 1e-15);
        assert_eq!(percentile(&[10.0, 0.0, 20.0], 0.75), 15.0);
        assert_eq!(mean(&[1.0, 2.0, 6.0]), 3.0);
    }

    #[test]
    fn the_interval_of_a_ratio_holds_it_and_is_as_wide_as_the_median_is_uncertain() {
        let above: Vec<f64> = (1..=9).map(f64::from).collect();
        let (ratio, [low, high]) = ratio_of_medians(&above, &[0.5; 9]);
        assert_eq!(ratio, 10.0);
        // of nine numbers the second to fourth and the sixth to eighth bound the median in 95 cases of 100
        assert!((4.0..=8.0).contains(&low) && (12.0..=16.0).contains(&high), "{low} {high}");
    }

    #[test]
    fn what_is_no_number_is_not_passed_over() {
        for nan in [f64::NAN, -f64::NAN] {
            assert!(largest([1.0, nan, 2.0]).is_nan());
            assert!(median(&[1.0, nan, 2.0]).is_nan() && percentile(&[nan, 1.0, 2.0], 0.95).is_nan());
        }
        assert_eq!((largest([1.0, 3.0, 2.0]), largest([])), (3.0, 0.0));
    }

    #[test]
    fn the_interval_of_a_median_is_that_of_the_tables() {
        // of 20 values the 6th and the 15th, of 6 the first and the last
        let values: Vec<f64> = (1..=20).map(f64::from).collect();
        assert_eq!(median_interval_95(&values), Some([6.0, 15.0]));
        assert_eq!(median_interval_95(&values[..6]), Some([1.0, 6.0]));
        assert_eq!(median_interval_95(&values[..5]), None);
    }

    #[test]
    fn bands_are_those_of_the_tables() {
        // chi-square of 10 degrees of freedom: 2.156 and 25.188 at 0.5 % and 99.5 %
        let (low, high) = chi_square_band(10, 0.99).unwrap_or_default();
        assert!((low - 0.21559).abs() < 1e-4 && (high - 2.51882).abs() < 1e-4, "{low} {high}");
        assert!(chi_square_band(0, 0.99).is_none());
    }

    #[test]
    fn a_ratio_lies_in_its_interval() {
        let below: Vec<f64> = (1..=60).map(f64::from).collect();
        let above: Vec<f64> = below.iter().map(|value| 0.5 * value).collect();
        let (ratio, [low, high]) = ratio_of_medians(&above, &below);
        assert_eq!(ratio, 0.5);
        assert!((low - 0.5).abs() < 1e-12 && (high - 0.5).abs() < 1e-12);
    }
}
