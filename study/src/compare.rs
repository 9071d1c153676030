//! Calibrations of one unit, or of several, against each other.

use statrs::distribution::{ContinuousCDF, Normal};

use crate::statistics::rms;

/// How often a comparison of calibrations that agree is called a difference.
const FALSE_ALARM: f64 = 0.01;

/// An estimate with its standard deviation, both in the same unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Its standard deviation, above zero.
    pub sigma: f64,
}

impl Estimate {
    /// By how many standard deviations of the difference it lies above `first`. The two are taken as independent: their noise is
    /// that of different logs.
    pub fn beyond(&self, first: &Self) -> f64 {
        (self.value - first.value) / self.sigma.hypot(first.sigma)
    }
}

/// What the differences of two calibrations say together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Agreement {
    /// Parameters that both estimate.
    pub compared: usize,
    /// Place of the largest difference among them.
    pub at: usize,
    /// That difference, sigmas, with its sign.
    pub largest: f64,
    /// Root of the mean square of all differences; about 1 where only noise makes them.
    pub rms: f64,
    /// So many sigmas are reached by the largest of so many differences in one of a hundred comparisons of calibrations that agree
    /// (Sidak's bound, whatever their correlation).
    pub limit: f64,
    /// Differences beyond that.
    pub beyond: usize,
}

impl Agreement {
    /// Of differences in sigmas; nothing of none.
    pub fn of(differences: &[f64]) -> Option<Self> {
        let sizes = differences.iter().enumerate();
        let (at, largest) = sizes.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        let alone = -((-FALSE_ALARM).ln_1p() / differences.len() as f64).exp_m1();
        let limit = Normal::standard().inverse_cdf(1.0 - 0.5 * alone);
        Some(Self {
            compared: differences.len(),
            at,
            largest: *largest,
            rms: rms(differences),
            limit,
            beyond: differences.iter().filter(|difference| difference.abs() > limit).count(),
        })
    }

    /// Whether chance explains the differences.
    pub fn agrees(&self) -> bool {
        self.beyond == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_in_sigmas_of_the_difference() {
        let (a, b) = (Estimate { value: 10.0, sigma: 3.0 }, Estimate { value: 20.0, sigma: 4.0 });
        assert_eq!(b.beyond(&a), 2.0);
        assert_eq!(a.beyond(&b), -2.0);
    }

    #[test]
    fn the_limit_is_that_of_so_many_differences() {
        // two-sided quantiles of the normal distribution: 99 %, and 0.99 to the power of 1/34
        for (n, limit) in [(1, 2.575_829), (34, 3.619_166)] {
            let agreement = Agreement::of(&vec![0.5; n]).expect("differences");
            assert!((agreement.limit - limit).abs() < 1e-5, "{}", agreement.limit);
            assert!(agreement.agrees() && agreement.rms == 0.5);
        }
    }

    #[test]
    fn what_differs_is_named() {
        // of three, 2.93 is reached once in a hundred comparisons
        let agreement = Agreement::of(&[0.1, -7.0, 2.9]).expect("differences");
        assert_eq!((agreement.at, agreement.largest, agreement.beyond), (1, -7.0, 1));
        assert!(!agreement.agrees());
        assert!(Agreement::of(&[]).is_none());
    }
}
