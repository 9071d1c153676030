//! Several logs of one unit: what each says beyond its prior is added up, and where they contradict each other the sigmas grow.
//!
//! With estimate x_k, covariance P_k and prior (m_k, D_k) of log k the data alone say the information P_k^-1 - D_k^-1 about the common
//! parameters; their sum with the first log's prior is the estimate of all. What wanders has its own value in each log, and is left
//! out: P_k without its rows is what remains when nothing is known of it. Logs of other days differ by more than their sigmas where the
//! unit does not repeat: then each sigma grows by the scatter of its parameter from log to log, drawn towards that of its block (the
//! ratio of Birge, *Physical Review* 40(2), 1932).

use nalgebra::{Cholesky, DMatrix, DVector};
use sinscal::Parameter;

use crate::repeat::{ESTIMATED, PRIOR, SHRUNK, Scatter, limit};
use crate::{AnyFilter, Outcome};

/// What several logs of one unit say together.
#[derive(Clone, Debug)]
pub struct Together {
    /// The common parameters, SI, in the order of the outcomes.
    pub parameters: Vec<Parameter>,
    /// Where each stands among the parameters of an outcome.
    pub places: Vec<usize>,
    /// Their covariance, SI.
    pub covariance: Vec<Vec<f64>>,
    /// How the logs scatter; nothing where no parameter is known in two of them.
    pub scatter: Option<Scatter>,
    /// The stated standard deviation over what the sum alone would give.
    pub factors: Vec<f64>,
}

impl Together {
    /// Of runs of a filter over several logs. Nothing where there is none, or their information cannot be added up. The logs are taken
    /// to be independent: nothing may be considered that is common to them.
    pub fn of(filter: &dyn AnyFilter, outcomes: &[&Outcome]) -> Option<Self> {
        let first = outcomes.first()?;
        let places: Vec<usize> = (0..first.parameters.len())
            .filter(|i| !filter.changes(first.parameters[*i].info.block))
            .collect();
        // in units of the first log's priors, of those that take part
        let takes_part = |i: &usize| outcomes.iter().all(|outcome| outcome.parameters[*i].prior_sigma > 0.0);
        let taken: Vec<usize> = places.iter().copied().filter(takes_part).collect();
        let unit: Vec<f64> = taken.iter().map(|i| first.parameters[*i].prior_sigma).collect();
        let count = taken.len();
        let centre = DVector::from_fn(count, |i, _| first.prior_mean(taken[i]));
        let mut information = DMatrix::identity(count, count);
        let mut score = DVector::zeros(count);
        for outcome in outcomes {
            let covariance = DMatrix::from_fn(count, count, |i, j| {
                outcome.covariance[taken[i]][taken[j]] / (unit[i] * unit[j])
            });
            let posterior = Cholesky::new(covariance)?.inverse();
            let of = |value: &dyn Fn(usize) -> f64| {
                DVector::from_fn(count, |i, _| (value(taken[i]) - centre[i]) / unit[i])
            };
            let found = of(&|i| outcome.parameters[i].value);
            let believed = of(&|i| outcome.prior_mean(i));
            let prior =
                DVector::from_fn(count, |i, _| (unit[i] / outcome.parameters[taken[i]].prior_sigma).powi(2));
            score += &posterior * found - prior.component_mul(&believed);
            information += posterior - DMatrix::from_diagonal(&prior);
        }
        let factor = Cholesky::new(information)?;
        let (joint, covariance) = (factor.solve(&score), factor.inverse());
        let (scatter, growth) = contradictions(outcomes, &places);
        let mut together = Self {
            parameters: places.iter().map(|place| first.parameters[*place]).collect(),
            covariance: vec![vec![0.0; places.len()]; places.len()],
            scatter,
            factors: vec![1.0; places.len()],
            places,
        };
        let own: Vec<usize> =
            (0..together.places.len()).filter(|k| taken.contains(&together.places[*k])).collect();
        for (i, k) in own.iter().enumerate() {
            let variance = covariance[(i, i)];
            // what the prior supplies does not scatter
            together.factors[*k] = (variance + (1.0 - variance).max(0.0) * growth[*k]).sqrt().max(1.0);
        }
        for (i, a) in own.iter().enumerate() {
            for (j, b) in own.iter().enumerate() {
                together.covariance[*a][*b] =
                    covariance[(i, j)] * unit[i] * unit[j] * together.factors[*a] * together.factors[*b];
            }
            let parameter = &mut together.parameters[*a];
            parameter.value = centre[i] + joint[i] * unit[i];
            parameter.sigma = together.covariance[*a][*a].sqrt();
            parameter.estimated = parameter.sigma.powi(2) < ESTIMATED * parameter.prior_sigma.powi(2);
        }
        Some(together)
    }

    /// Whether the logs contradict each other by more than their sigmas allow.
    pub fn contradict(&self) -> bool {
        self.scatter.is_some_and(|scatter| scatter.is_more())
    }
}

/// How estimates scatter from log to log, and by how much that makes each variance grow.
fn contradictions(outcomes: &[&Outcome], places: &[usize]) -> (Option<Scatter>, Vec<f64>) {
    let n = places.len();
    // sum of squares over the variances about the weighted mean, and its degrees of freedom
    let own: Vec<Option<(f64, f64)>> = (0..n)
        .map(|i| {
            let known = |p: &&Parameter| p.sigma > 0.0 && p.sigma.powi(2) < PRIOR * p.prior_sigma.powi(2);
            let known: Vec<&Parameter> =
                outcomes.iter().map(|o| &o.parameters[places[i]]).filter(known).collect();
            let weight: f64 = known.iter().map(|p| p.sigma.powi(-2)).sum();
            let mean = known.iter().map(|p| p.value / p.sigma.powi(2)).sum::<f64>() / weight;
            let squares = known.iter().map(|p| ((p.value - mean) / p.sigma).powi(2)).sum();
            (known.len() > 1).then_some((squares, known.len() as f64 - 1.0))
        })
        .collect();
    let (squares, freedom) = own.iter().flatten().fold((0.0, 0.0), |sum, own| (sum.0 + own.0, sum.1 + own.1));
    if freedom == 0.0 {
        return (None, vec![1.0; n]);
    }
    // parameters of one log are correlated: taken as half as many
    let scatter = Scatter {
        stretches: outcomes.len(),
        ratio: squares / freedom,
        limit: limit((0.5 * freedom).max(1.0)),
    };
    if !scatter.is_more() {
        return (Some(scatter), vec![1.0; n]);
    }
    let block = |i: usize| outcomes[0].parameters[places[i]].info.block;
    let growth = (0..n).map(|i| {
        let kind = (0..n).filter(|k| block(*k) == block(i)).filter_map(|k| own[k]);
        let (squares, freedom) = kind.fold((0.0, 0.0), |sum, own| (sum.0 + own.0, sum.1 + own.1));
        let usual = if freedom > 0.0 { squares / freedom } else { scatter.ratio };
        let (squares, freedom) = own[i].unwrap_or_default();
        ((SHRUNK * usual + squares) / (SHRUNK + freedom)).max(1.0)
    });
    (Some(scatter), growth.collect())
}
