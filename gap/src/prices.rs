//! What any set of candidates is worth, from one pass.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use crate::chi2::ln_survival;
use crate::recording::Column;

/// A direction of an effect in which its prior size would not even show as one standard deviation is left out of tests.
pub(crate) const SEEN: f64 = 1.0;

/// Estimates beyond so many standard deviations of their prior show that it was too narrow.
pub(crate) const BEYOND: f64 = 2.0;

/// Inverse variance of a wide prior, in units of a block's.
const WIDE: f64 = 1e-2;

/// A candidate effect: columns that come and go together.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Group {
    pub(crate) name: String,
    /// Priced columns, in the order of its components.
    pub(crate) members: Vec<usize>,
}

/// Score `b` and information `Lambda` of all priced columns about "nothing is missing", both scaled by the priors.
#[derive(Clone, Debug)]
pub(crate) struct Prices {
    pub(crate) b: DVector<f64>,
    pub(crate) lambda: DMatrix<f64>,
    pub(crate) sigma: Vec<f64>,
    pub(crate) groups: Vec<Group>,
}

/// What a group shows on top of others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Score {
    /// Natural logarithm of the p-value.
    pub(crate) ln_p: f64,
    pub(crate) directions: usize,
}

impl Prices {
    /// From the Gram matrix of a linear run; `sigma` holds the priors of the priced columns.
    pub(crate) fn new(gram: &[f64], sigma: Vec<f64>, groups: Vec<Group>) -> Self {
        let n = sigma.len();
        let b = DVector::from_fn(n, |i, _| gram[i + 1] * sigma[i]);
        let lambda = DMatrix::from_fn(n, n, |i, j| gram[(i + 1) * (n + 1) + j + 1] * sigma[i] * sigma[j]);
        Self { b, lambda, sigma, groups }
    }

    /// Of all of several parts of a log.
    pub(crate) fn sum(parts: &[Self]) -> Option<Self> {
        let (first, rest) = parts.split_first()?;
        let mut sum = first.clone();
        for part in rest {
            sum.b += &part.b;
            sum.lambda += &part.lambda;
        }
        Some(sum)
    }

    /// Prices of sums of columns, each of columns with equal priors, in `groups` of them.
    pub(crate) fn summed(&self, sums: &[Vec<usize>], groups: Vec<Group>) -> Self {
        let n = sums.len();
        let b = DVector::from_fn(n, |i, _| sums[i].iter().map(|m| self.b[*m]).sum());
        let lambda = DMatrix::from_fn(n, n, |i, j| {
            let of = |m: &usize| sums[j].iter().map(|k| self.lambda[(*m, *k)]).sum::<f64>();
            sums[i].iter().map(of).sum()
        });
        let sigma = sums.iter().map(|s| self.sigma[s[0]]).collect();
        Self { b, lambda, sigma, groups }
    }

    /// Prices of some groups, without the others.
    pub(crate) fn only(&self, groups: &[usize]) -> Self {
        let columns: Vec<Vec<usize>> = self.members(groups).into_iter().map(|m| vec![m]).collect();
        let mut at = 0;
        let renumbered = |g: &usize| {
            let Group { name, members } = &self.groups[*g];
            at += members.len();
            Group { name: name.clone(), members: (at - members.len()..at).collect() }
        };
        self.summed(&columns, groups.iter().map(renumbered).collect())
    }

    /// Columns of some groups.
    pub(crate) fn members(&self, groups: &[usize]) -> Vec<usize> {
        groups.iter().flat_map(|g| self.groups[*g].members.iter().copied()).collect()
    }

    pub(crate) fn all(&self) -> Vec<usize> {
        (0..self.groups.len()).collect()
    }

    pub(crate) fn find(&self, name: &str) -> Option<usize> {
        self.groups.iter().position(|g| g.name == name)
    }

    /// `Lambda + prior` of the columns of some groups, factored; `prior` is the inverse variance of each group, 1 for that
    /// of its block.
    fn posterior_factor(&self, groups: &[usize], prior: impl Fn(usize) -> f64) -> Option<Cholesky<f64, Dyn>> {
        let members = self.members(groups);
        let mut m = self.lambda.select_rows(&members).select_columns(&members);
        let mut at = 0;
        for (i, g) in groups.iter().enumerate() {
            for _ in &self.groups[*g].members {
                m[(at, at)] += prior(i);
                at += 1;
            }
        }
        Cholesky::new(m)
    }

    /// `logL(base + groups) - logL(base)`; exact for a linear filter.
    pub(crate) fn gain(&self, groups: &[usize]) -> f64 {
        let members = self.members(groups);
        if members.is_empty() {
            return 0.0;
        }
        let Some(factor) = self.posterior_factor(groups, |_| 1.0) else { return f64::NAN };
        let b = self.b.select_rows(&members);
        0.5 * b.dot(&factor.solve(&b)) - factor.l_dirty().diagonal().iter().map(|d| d.ln()).sum::<f64>()
    }

    /// What the data alone say for some groups, however large they were expected to be: the log-likelihood that their best
    /// fit gains, less half the logarithm of the number of `updates` for each direction that is seen (BIC).
    pub(crate) fn likelihood(&self, groups: &[usize], updates: usize) -> f64 {
        let members = self.members(groups);
        if members.is_empty() {
            return 0.0;
        }
        let eigen = self.lambda.select_rows(&members).select_columns(&members).symmetric_eigen();
        let b = self.b.select_rows(&members);
        let cost = (updates as f64).ln();
        let seen = eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()).filter(|(v, _)| **v > SEEN);
        seen.map(|(value, direction)| 0.5 * (direction.dot(&b).powi(2) / value - cost)).sum()
    }

    /// How many times larger than expected each group's prior must be for what the data say of it: an effect that shows
    /// clearly beyond its prior must not be pulled back by it.
    pub(crate) fn sizes(&self, groups: &[usize]) -> Option<Vec<f64>> {
        let members = self.members(groups);
        let mean = self.posterior_factor(groups, |_| 1.0)?.solve(&self.b.select_rows(&members));
        let mut at = 0;
        let largest = groups.iter().map(|g| {
            let n = self.groups[*g].members.len();
            at += n;
            mean.rows(at - n, n).amax()
        });
        Some(largest.map(|size| if size > BEYOND { size } else { 1.0 }).collect())
    }

    /// Estimates of the columns of some groups and their covariance, both in physical units, with priors as wide as they must be.
    pub(crate) fn posterior(&self, groups: &[usize]) -> Option<(DVector<f64>, DMatrix<f64>)> {
        self.estimates(groups, &self.sizes(groups)?)
    }

    /// The same with the prior of each group so many times larger than expected.
    pub(crate) fn estimates(&self, groups: &[usize], sizes: &[f64]) -> Option<(DVector<f64>, DMatrix<f64>)> {
        let members = self.members(groups);
        let factor = self.posterior_factor(groups, |i| 1.0 / (sizes[i] * sizes[i]))?;
        let scale = DVector::from_iterator(members.len(), members.iter().map(|i| self.sigma[*i]));
        let mean = factor.solve(&self.b.select_rows(&members)).component_mul(&scale);
        let mut covariance = factor.inverse();
        for i in 0..members.len() {
            for j in 0..members.len() {
                covariance[(i, j)] *= scale[i] * scale[j];
            }
        }
        Some((mean, covariance))
    }

    /// Log of the e-value of some groups: how much better this log is predicted by what another said of them (mean and
    /// covariance, physical) than by their absence.
    pub(crate) fn ln_e(
        &self,
        groups: &[usize],
        mean: &DVector<f64>,
        covariance: &DMatrix<f64>,
    ) -> Option<f64> {
        let members = self.members(groups);
        let scale = DVector::from_iterator(members.len(), members.iter().map(|i| self.sigma[*i]));
        let mean = mean.component_div(&scale);
        let mut prior = covariance.clone();
        for i in 0..members.len() {
            for j in 0..members.len() {
                prior[(i, j)] /= scale[i] * scale[j];
            }
        }
        let inverse = Cholesky::new(prior.clone())?.inverse();
        let lambda = self.lambda.select_rows(&members).select_columns(&members);
        let b = self.b.select_rows(&members) + &inverse * &mean;
        let sum = Cholesky::new(&lambda + &inverse)?;
        // ln det(1 + C Lambda) = ln det(C^-1 + Lambda) + ln det C
        let ln_det =
            |c: &Cholesky<f64, Dyn>| 2.0 * c.l_dirty().diagonal().iter().map(|d| d.ln()).sum::<f64>();
        let det = ln_det(&sum) + ln_det(&Cholesky::new(prior)?);
        Some(0.5 * b.dot(&sum.solve(&b)) - 0.5 * mean.dot(&(&inverse * &mean)) - 0.5 * det)
    }

    /// Score and information of all columns once `groups` are in the filter, with wide priors: an effect larger than its prior
    /// must not leave something behind that looks like another.
    pub(crate) fn given(&self, groups: &[usize]) -> Option<Self> {
        let members = self.members(groups);
        if members.is_empty() {
            return Some(self.clone());
        }
        let factor = self.posterior_factor(groups, |_| WIDE)?;
        let cross = self.lambda.select_rows(&members);
        let gained = factor.solve(&cross);
        let b = &self.b - gained.transpose() * self.b.select_rows(&members);
        let lambda = &self.lambda - cross.transpose() * gained;
        Some(Self { b, lambda, sigma: self.sigma.clone(), groups: self.groups.clone() })
    }

    /// The test of a group: its directions that can be seen, each scaled to unit variance.
    pub(crate) fn test(&self, group: usize) -> Option<Test> {
        let members = &self.groups[group].members;
        let lambda = self.lambda.select_rows(members).select_columns(members);
        let eigen = lambda.symmetric_eigen();
        let mut directions = Vec::new();
        for (k, value) in eigen.eigenvalues.iter().enumerate() {
            if *value > SEEN {
                let root = value.sqrt();
                directions.push(eigen.eigenvectors.column(k).iter().map(|v| v / root).collect());
            }
        }
        (!directions.is_empty()).then(|| Test { members: members.clone(), directions })
    }

    /// What a group shows in this score.
    pub(crate) fn score(&self, group: usize) -> Score {
        match self.test(group) {
            Some(test) => Score { ln_p: test.ln_p(self.b.as_slice()), directions: test.directions.len() },
            None => Score { ln_p: 0.0, directions: 0 },
        }
    }

    /// Standard deviations of the prior that the best and the worst seen direction of a group would show.
    pub(crate) fn excitation(&self, group: usize) -> (f64, f64) {
        let members = &self.groups[group].members;
        let eigen = self.lambda.select_rows(members).select_columns(members).symmetric_eigenvalues();
        (eigen.max().max(0.0).sqrt(), eigen.min().max(0.0).sqrt())
    }

    /// Information about the components of a group, physical, row by row.
    pub(crate) fn information(&self, group: usize) -> Vec<f64> {
        let members = &self.groups[group].members;
        let of = |i: &usize, j: &usize| self.lambda[(*i, *j)] / (self.sigma[*i] * self.sigma[*j]);
        members.iter().flat_map(|i| members.iter().map(move |j| of(i, j))).collect()
    }

    /// The most significant of some groups.
    pub(crate) fn worst(&self, among: impl Iterator<Item = usize>) -> Option<(usize, Score)> {
        among.map(|g| (g, self.score(g))).min_by(|a, b| a.1.ln_p.total_cmp(&b.1.ln_p))
    }
}

/// How a group is tested against "nothing missing".
pub(crate) struct Test {
    members: Vec<usize>,
    directions: Vec<Vec<f64>>,
}

impl Test {
    /// Natural logarithm of the p-value under score `b` of all columns.
    pub(crate) fn ln_p(&self, b: &[f64]) -> f64 {
        let mut t = 0.0;
        for direction in &self.directions {
            let along: f64 = direction.iter().zip(&self.members).map(|(v, m)| v * b[*m]).sum();
            t += along * along;
        }
        ln_survival(t, self.directions.len())
    }
}

/// Groups the columns of effects, in the order of their first column; `priced` lists the priced ones.
pub(crate) fn groups_of(columns: &[Column], priced: &[usize]) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for (at, c) in priced.iter().enumerate() {
        let name = columns[*c].info.block;
        match groups.iter_mut().find(|g| g.name == name) {
            Some(group) => group.members.push(at),
            None => groups.push(Group { name: name.into(), members: vec![at] }),
        }
    }
    groups
}
