//! How far sigmas may be relied on: whether the scores of a log's stretches scatter as the model says, and where not, by how much more.
//!
//! The influence of stretch b on the estimates is u_b = P s_b with its score s_b at the estimate; by the model cov(u_a, u_b) =
//! P (delta_ab I_a - I_a P I_b) P. Where the scatter of all that was estimated stays within what that allows, the formal sigmas stand.
//! Where it does not, errors are correlated for long or larger than stated, and the part of each sigma that comes from the data grows by the
//! scatter of its own parameter, in as long stretches as show it, shrunk towards that of its block (a sandwich, White, *Econometrica*
//! 50(1), 1982, of too few stretches is far too small on its own). What a further pass would still move is in the sigma too: where
//! linearisation bears that is nothing.

use nalgebra::{DMatrix, DVector};

use crate::outcome::Outcome;
use crate::posterior::Posterior;

/// Into how many stretches a log is divided, from the shortest to the longest.
const LEVELS: [usize; 3] = [32, 8, 2];
/// Scatter beyond what chance does in 1.5 % of sound logs at each level is none: standard normal quantile.
const SURE: f64 = 2.17;
/// A parameter's own scatter is shrunk towards that of its block as if that had so many degrees of freedom.
pub(crate) const SHRUNK: f64 = 4.0;
/// Where the prior supplies more than this part of the information in a half, halves are not compared.
pub(crate) const PRIOR: f64 = 0.1;
/// Estimated are constants that the data know better than the prior: variance below this part of the prior's.
pub(crate) const ESTIMATED: f64 = 0.5;

/// How far the sigmas of an outcome repeat within its log; by parameter, in the order of the outcome.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Repeat {
    /// The stated standard deviation over the formal one.
    pub factors: Vec<f64>,
    /// By how many formal standard deviations a further pass would move each; it is in the stated ones.
    pub moves: Vec<f64>,
    /// Degrees of freedom behind the scatter that made a sigma grow; infinite where none did.
    pub freedom: Vec<f64>,
    /// Difference between the estimates of the two halves of the log over the root of their variances, as the stated sigmas have them;
    /// nothing where the prior supplies more than a tenth of the information in a half.
    pub halves: Vec<Option<f64>>,
    /// Mean scatter of what was estimated over what the model allows, for each number of stretches, and whether that is more than
    /// chance.
    pub scatter: Vec<Scatter>,
}

/// How the scores of so many stretches scatter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scatter {
    /// Number of stretches.
    pub stretches: usize,
    /// Mean of squares over what the model allows; 1 is expected.
    pub ratio: f64,
    /// What chance does not exceed.
    pub limit: f64,
}

impl Scatter {
    /// Whether it is more than chance does.
    pub fn is_more(&self) -> bool {
        self.ratio > self.limit
    }
}

/// Ratios of the unknowns that were estimated, with the degrees of freedom behind each.
struct Level {
    scatter: Scatter,
    ratios: Vec<Option<(f64, f64)>>,
}

impl Repeat {
    /// Of scores and information of 32 stretches of equal length, about parameters that are all zero and in units of their priors;
    /// `blocks` names that of each parameter.
    pub fn of_parts(parts: Vec<(DVector<f64>, DMatrix<f64>)>, blocks: &[&str]) -> Option<Self> {
        Self::of(&Posterior::of_parts(parts, blocks.len()), blocks, &DVector::zeros(blocks.len()))
    }

    /// Of what the stretches of a log say about the estimates; `blocks` names that of each parameter, `moves` has by how many sigmas a
    /// further pass would move each unknown.
    pub(crate) fn of(posterior: &Posterior, blocks: &[&str], moves: &DVector<f64>) -> Option<Self> {
        let (step, p) = posterior.step()?;
        let is_estimated: Vec<bool> = p.diagonal().iter().map(|variance| *variance < ESTIMATED).collect();
        let all: Vec<Level> =
            LEVELS.iter().map(|stretches| level(posterior, &step, &p, &is_estimated, *stretches)).collect();
        let mut halves = halves(posterior);
        let block = |i: usize| posterior.parameter(i).map(|parameter| blocks[parameter]);
        // where halves can be compared they are their own longest stretches
        let mut growth = vec![(1.0_f64, f64::INFINITY); p.nrows()];
        for (level, stretches) in all.iter().zip(LEVELS) {
            if !level.scatter.is_more() {
                continue;
            }
            let own: Vec<Option<(f64, f64)>> = if stretches == 2 {
                halves.iter().map(|half| half.map(|half| (half * half, 1.0))).collect()
            } else {
                level.ratios.clone()
            };
            let mean = |of: &dyn Fn(usize) -> bool| {
                let ratios: Vec<f64> =
                    (0..own.len()).filter(|i| of(*i)).filter_map(|i| own[i]).map(|own| own.0).collect();
                (!ratios.is_empty()).then(|| ratios.iter().sum::<f64>() / ratios.len() as f64)
            };
            for i in 0..own.len() {
                let usual = mean(&|k| block(k) == block(i)).unwrap_or(level.scatter.ratio);
                let (ratio, freedom) = own[i].unwrap_or((0.0, 0.0));
                let grown = (SHRUNK * usual + freedom * ratio) / (SHRUNK + freedom);
                if grown > growth[i].0 {
                    growth[i] = (grown, SHRUNK + freedom);
                }
            }
        }
        let by_prior = (&p * &p).diagonal();
        let mut repeat = Self {
            factors: vec![1.0; blocks.len()],
            moves: vec![0.0; blocks.len()],
            freedom: vec![f64::INFINITY; blocks.len()],
            halves: vec![None; blocks.len()],
            scatter: all.iter().map(|level| level.scatter).collect(),
        };
        for i in 0..growth.len() {
            let Some(parameter) = posterior.parameter(i) else { continue };
            let (formal, prior) = (p[(i, i)], by_prior[i].min(p[(i, i)]));
            let repeats = (prior + (formal - prior) * growth[i].0) / formal;
            let factor = (repeats + moves[i].powi(2)).sqrt();
            repeat.factors[parameter] = factor;
            repeat.moves[parameter] = moves[i];
            repeat.freedom[parameter] = growth[i].1;
            repeat.halves[parameter] = halves[i].take().map(|half| half / factor);
        }
        Some(repeat)
    }

    /// The same with what stretches say nothing of: as many parameters as that.
    pub(crate) fn extend_to(&mut self, parameters: usize) {
        self.factors.resize(parameters, 1.0);
        self.moves.resize(parameters, 0.0);
        self.freedom.resize(parameters, f64::INFINITY);
        self.halves.resize(parameters, None);
    }

    /// Lets an outcome state the sigmas that repeat.
    pub(crate) fn apply(self, outcome: &mut Outcome) {
        for (parameter, factor) in outcome.parameters.iter_mut().zip(&self.factors) {
            parameter.sigma *= factor;
            parameter.estimated &=
                parameter.sigma * parameter.sigma < ESTIMATED * parameter.prior_sigma.powi(2);
        }
        for (row, by) in outcome.covariance.iter_mut().zip(&self.factors) {
            row.iter_mut().zip(&self.factors).for_each(|(entry, factor)| *entry *= by * factor);
        }
        outcome.repeat = Some(self);
    }
}

/// How `count` stretches scatter about the estimates.
fn level(
    posterior: &Posterior,
    step: &DVector<f64>,
    p: &DMatrix<f64>,
    is_estimated: &[bool],
    count: usize,
) -> Level {
    let n = p.nrows();
    let parts = posterior.merged(count);
    let root = p.clone().cholesky().map_or_else(|| DMatrix::zeros(n, n), |factor| factor.l());
    let influence: Vec<DVector<f64>> = parts.iter().map(|(score, i)| p * (score - i * step)).collect();
    // P I_a P and P I_a P^(1/2): the influence of stretches a and b has the covariance P (delta_ab I_a - I_a P I_b) P
    let own: Vec<DMatrix<f64>> = parts.iter().map(|(_, i)| p * i * p).collect();
    let half: Vec<DMatrix<f64>> = parts.iter().map(|(_, i)| p * i * &root).collect();
    let variance = |j: usize| -> f64 {
        own.iter().zip(&half).map(|(own, half)| own[(j, j)] - half.row(j).norm_squared()).sum()
    };
    let variances: Vec<f64> = (0..n).map(variance).collect();
    let taken: Vec<usize> = (0..n).filter(|j| is_estimated[*j] && variances[*j] > 0.0).collect();
    let scale = DVector::from_iterator(taken.len(), taken.iter().map(|j| 1.0 / variances[*j].sqrt()));
    let scaled = DMatrix::from_diagonal(&scale);
    let own: Vec<DMatrix<f64>> =
        own.iter().map(|own| &scaled * own.select_rows(&taken).select_columns(&taken) * &scaled).collect();
    let half: Vec<DMatrix<f64>> = half.iter().map(|half| &scaled * half.select_rows(&taken)).collect();
    let squares = |k: usize| influence.iter().map(|u| (u[taken[k]] * scale[k]).powi(2)).sum::<f64>();
    let mut spread = DVector::zeros(taken.len());
    let mut total = 0.0;
    for (a, first) in half.iter().enumerate() {
        for (b, second) in half.iter().enumerate() {
            let mut covariance = -(first * second.transpose());
            if a == b {
                covariance += &own[a];
            }
            total += covariance.norm_squared();
            spread += covariance.diagonal().map(|c| c * c);
        }
    }
    let mut ratios = vec![None; n];
    for (k, j) in taken.iter().enumerate() {
        ratios[*j] = Some((squares(k), 1.0 / spread[k]));
    }
    let size = taken.len() as f64;
    let ratio = (0..taken.len()).map(squares).sum::<f64>() / size;
    let limit = limit(size * size / total);
    Level { scatter: Scatter { stretches: count, ratio, limit }, ratios }
}

/// What a mean of squares with so many degrees of freedom does not exceed by chance (Wilson and Hilferty 1931).
pub(crate) fn limit(freedom: f64) -> f64 {
    let chance = 2.0 / (9.0 * freedom);
    (1.0 - chance + SURE * chance.sqrt()).powi(3)
}

/// Difference between the halves over the root of their formal variances, by unknown.
fn halves(posterior: &Posterior) -> Vec<Option<f64>> {
    let found: Option<Vec<_>> = posterior.merged(2).iter().map(|half| posterior.step_of(half)).collect();
    let Some([(first, p), (second, q)]) = found.as_deref() else { return vec![None; posterior.len()] };
    let compared = |i: usize| {
        let is_known = p[(i, i)] < PRIOR && q[(i, i)] < PRIOR;
        is_known.then(|| (first[i] - second[i]) / (p[(i, i)] + q[(i, i)]).sqrt())
    };
    (0..posterior.len()).map(compared).collect()
}
