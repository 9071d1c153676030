//! The posterior of the constants about a point: scores and information of a log, and the prior.

use nalgebra::{Cholesky, DMatrix, DVector};

use crate::scores::{Scored, Stretch};

/// Score and information of a part of a log.
pub(crate) type Part = (DVector<f64>, DMatrix<f64>);

/// The normal equations about a point, in units of the priors; parameters whose prior is zero take no part.
#[derive(Clone, Debug)]
pub(crate) struct Posterior {
    /// Places of the unknowns in the scores.
    unknowns: Vec<usize>,
    /// Which parameters those places are, as far as they are parameters.
    constants: Vec<usize>,
    /// Prior standard deviations of the unknowns.
    priors: Vec<f64>,
    /// Where the prior's mean lies from the point, in units of the priors.
    prior_mean: DVector<f64>,
    /// Score and information of each stretch.
    stretches: Vec<Part>,
    /// Logarithm of the posterior at the point, but for a constant of the priors.
    pub(crate) log_posterior: f64,
}

impl Posterior {
    /// With prior standard deviations and the prior's mean less the point, both by place in the scores.
    pub(crate) fn new(scored: &Scored, priors: &[f64], to_mean: &[f64]) -> Self {
        let unknowns: Vec<usize> = (0..priors.len()).filter(|i| priors[*i] > 0.0).collect();
        let sigma: Vec<f64> = unknowns.iter().map(|i| priors[*i]).collect();
        let count = unknowns.len();
        let prior_mean = DVector::from_fn(count, |i, _| to_mean[unknowns[i]] / sigma[i]);
        let scaled = |Stretch { score, information }: &Stretch| {
            let all = score.len();
            (
                DVector::from_fn(count, |i, _| score[unknowns[i]] * sigma[i]),
                DMatrix::from_fn(count, count, |i, j| {
                    information[unknowns[i] * all + unknowns[j]] * sigma[i] * sigma[j]
                }),
            )
        };
        Self {
            stretches: scored.stretches.iter().map(scaled).collect(),
            log_posterior: scored.log_likelihood - 0.5 * prior_mean.norm_squared(),
            unknowns,
            constants: scored.constants.clone(),
            priors: sigma,
            prior_mean,
        }
    }

    /// Of `stretches` about `count` unknowns that are all zero, in units of their priors.
    pub(crate) fn of_parts(stretches: Vec<Part>, count: usize) -> Self {
        Self {
            stretches,
            log_posterior: 0.0,
            unknowns: (0..count).collect(),
            constants: (0..count).collect(),
            priors: vec![1.0; count],
            prior_mean: DVector::zeros(count),
        }
    }

    /// Score and information of so many stretches of equal length.
    pub(crate) fn merged(&self, count: usize) -> Vec<Part> {
        let sum = |parts: &[Part]| {
            let mut sum = (DVector::zeros(self.len()), DMatrix::zeros(self.len(), self.len()));
            for (score, information) in parts {
                sum.0 += score;
                sum.1 += information;
            }
            sum
        };
        self.stretches.chunks(self.stretches.len().div_ceil(count)).map(sum).collect()
    }

    /// Number of unknowns.
    pub(crate) fn len(&self) -> usize {
        self.unknowns.len()
    }

    /// Where the prior's mean lies from the point, in units of the priors.
    #[cfg(test)]
    pub(crate) fn to_mean(&self) -> &DVector<f64> {
        &self.prior_mean
    }

    /// Which parameter an unknown is.
    pub(crate) fn parameter(&self, i: usize) -> Option<usize> {
        self.constants.get(self.unknowns[i]).copied()
    }

    /// The Gauss-Newton step from the point to where the posterior is best, in units of the priors, and the posterior covariance.
    pub(crate) fn step(&self) -> Option<(DVector<f64>, DMatrix<f64>)> {
        self.step_of(self.merged(1).first()?)
    }

    /// The same by a part of the log alone.
    pub(crate) fn step_of(&self, (score, information): &Part) -> Option<(DVector<f64>, DMatrix<f64>)> {
        let factor = Cholesky::new(information + DMatrix::identity(self.len(), self.len()))?;
        Some((factor.solve(&(score + &self.prior_mean)), factor.inverse()))
    }

    /// A vector in units of the priors, by place in scores of so many columns.
    pub(crate) fn placed(&self, scaled: &DVector<f64>, columns: usize) -> Vec<f64> {
        let mut placed = vec![0.0; columns];
        for ((place, prior), value) in self.unknowns.iter().zip(&self.priors).zip(scaled.iter()) {
            placed[*place] = value * prior;
        }
        placed
    }
}
