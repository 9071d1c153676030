//! Which processes a channel's Allan variances are the sum of, and how large they are.

use nalgebra::{DMatrix, DVector};

use crate::allan::Scale;
use crate::model::{Kind, Process, composite};

/// Correlation times that a search starts from, as powers of the ratio of the longest averaging time to the shortest.
const STARTS: [f64; 7] = [0.15, 0.27, 0.39, 0.51, 0.63, 0.75, 0.87];
/// A search ends after so many steps, or where a step gains less than this part of a standard deviation squared.
const STEPS: usize = 100;
const GAIN: f64 = 1e-9;
/// The logarithm of a parameter moves by no more than this in a step.
const STRIDE: f64 = 2.0;

/// A sum of processes fitted to Allan variances.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The processes, by kind, those of Gauss and Markov by their times.
    pub processes: Vec<Process>,
    /// How far the variances are from those of the sum: twice the logarithm of the likelihood that is lost against a sum that
    /// meets every one of them.
    pub deviance: f64,
}

/// Chooses the processes whose sum explains the Allan variances of `readings` readings.
///
/// Each sum of quantisation, white noise, random walk, ramp and up to two Gauss-Markov processes is fitted: the weighted squares of what it
/// leaves of the moments are least, weights being those that it has itself (degrees of freedom over the square of the variance), so that the
/// few terms of long averaging times do not pull it down. That is the maximum of the likelihood of chi-squared variances. Chosen is
/// the sum whose deviance plus the number of its parameters times the logarithm of the number of readings is least (Schwarz's criterion).
pub fn identify(scales: &[Scale], readings: u64) -> Fit {
    let scales: Vec<Scale> = scales.iter().copied().filter(|scale| scale.variance > 0.0).collect();
    let (Some(first), Some(last)) = (scales.first(), scales.last()) else {
        return Fit { processes: Vec::new(), deviance: 0.0 };
    };
    let price = (readings.max(2) as f64).ln();
    let span = last.tau / first.tau;
    let times: Vec<f64> = STARTS.iter().map(|power| first.tau * span.powf(*power)).collect();
    let mut best: Option<(f64, Fit)> = None;
    for kinds in sums(&times) {
        if parameters(&kinds) > scales.len() {
            continue;
        }
        let fit = fit(&scales, start(&scales, &kinds));
        let cost = fit.deviance + price * parameters(&kinds) as f64;
        if best.as_ref().is_none_or(|(least, _)| cost < *least) {
            best = Some((cost, fit));
        }
    }
    best.map_or(Fit { processes: Vec::new(), deviance: 0.0 }, |(_, fit)| fit)
}

/// Fits processes of the kinds of `start` anew, from its sizes and times.
pub(crate) fn refit(scales: &[Scale], start: &[Process]) -> Fit {
    let scales: Vec<Scale> = scales.iter().copied().filter(|scale| scale.variance > 0.0).collect();
    fit(&scales, start.to_vec())
}

fn parameters(kinds: &[Kind]) -> usize {
    kinds.iter().map(|kind| if matches!(kind, Kind::GaussMarkov { .. }) { 2 } else { 1 }).sum()
}

/// Every sum that is tried, from every start.
fn sums(times: &[f64]) -> Vec<Vec<Kind>> {
    let plain = [Kind::Quantisation, Kind::White, Kind::RandomWalk, Kind::Ramp];
    let markov = |time: &f64| Kind::GaussMarkov { time: *time };
    let mut of_markov: Vec<Vec<Kind>> = vec![Vec::new()];
    of_markov.extend(times.iter().map(|time| vec![markov(time)]));
    for (at, time) in times.iter().enumerate() {
        of_markov.extend(times[at + 1..].iter().map(|longer| vec![markov(time), markov(longer)]));
    }
    let mut sums = Vec::new();
    for chosen in 0..1_usize << plain.len() {
        let of_plain = |range: std::ops::Range<usize>| {
            range.filter(move |at| chosen & (1 << at) != 0).map(|at| plain[at])
        };
        for markovs in &of_markov {
            let sum: Vec<Kind> =
                of_plain(0..2).chain(markovs.iter().copied()).chain(of_plain(2..4)).collect();
            if !sum.is_empty() {
                sums.push(sum);
            }
        }
    }
    sums
}

/// Sizes to begin with: no process can be larger than the variances allow.
fn start(scales: &[Scale], kinds: &[Kind]) -> Vec<Process> {
    let most = |kind: Kind| {
        let allowed = scales.iter().map(|scale| scale.variance / kind.unit_variance(scale.tau));
        allowed.fold(f64::INFINITY, f64::min)
    };
    let share = kinds.len() as f64;
    kinds.iter().map(|kind| Process { kind: *kind, size: (most(*kind) / share).sqrt() }).collect()
}

/// Twice the logarithm of the likelihood that is lost.
fn deviance(scales: &[Scale], processes: &[Process]) -> f64 {
    let lost = scales.iter().map(|scale| {
        let ratio = scale.variance / composite(processes, scale.tau);
        scale.edf * (ratio - 1.0 - ratio.ln())
    });
    lost.sum()
}

/// Damped scoring in the logarithms of sizes and times (Levenberg and Marquardt).
fn fit(scales: &[Scale], mut processes: Vec<Process>) -> Fit {
    let (Some(first), Some(last)) = (scales.first(), scales.last()) else {
        return Fit { processes, deviance: 0.0 };
    };
    // a shorter time is white noise, a longer one a random walk
    let times = (2.0 * first.tau, last.tau);
    let mut now = deviance(scales, &processes);
    let mut damping = 1e-2;
    for _ in 0..STEPS {
        let (gradient, information) = scoring(scales, &processes);
        let mut damped = information.clone();
        for at in 0..damped.nrows() {
            damped[(at, at)] += damping * (information[(at, at)] + 1e-9);
        }
        let Some(step) = damped.cholesky().map(|factor| factor.solve(&gradient)) else { break };
        let next = moved(&processes, &step, times);
        let then = deviance(scales, &next);
        if then < now {
            let gained = now - then;
            (processes, now) = (next, then);
            damping = (damping * 0.2).max(1e-9);
            if gained < GAIN {
                break;
            }
        } else {
            damping *= 5.0;
            if damping > 1e9 {
                break;
            }
        }
    }
    for pair in 1..processes.len() {
        let [before, after] = [pair - 1, pair].map(|at| processes[at].kind.time());
        if after.is_some() && before > after {
            processes.swap(pair - 1, pair);
        }
    }
    Fit { processes, deviance: now }
}

/// Gradient and Fisher information of the logarithm of the likelihood: of each process its variance, then its time where it has one.
fn scoring(scales: &[Scale], processes: &[Process]) -> (DVector<f64>, DMatrix<f64>) {
    let count = parameters(&processes.iter().map(|process| process.kind).collect::<Vec<_>>());
    let mut gradient = DVector::zeros(count);
    let mut information = DMatrix::zeros(count, count);
    let mut slopes = DVector::zeros(count);
    for scale in scales {
        let whole = composite(processes, scale.tau);
        let mut at = 0;
        for process in processes {
            let part = process.variance(scale.tau) / whole;
            slopes[at] = part;
            at += 1;
            if matches!(process.kind, Kind::GaussMarkov { .. }) {
                slopes[at] = part * process.kind.sensitivity(scale.tau);
                at += 1;
            }
        }
        let weight = 0.5 * scale.edf;
        gradient.axpy(weight * (scale.variance / whole - 1.0), &slopes, 1.0);
        information.ger(weight, &slopes, &slopes, 1.0);
    }
    (gradient, information)
}

fn moved(processes: &[Process], step: &DVector<f64>, times: (f64, f64)) -> Vec<Process> {
    let mut steps = step.iter().map(|step| step.clamp(-STRIDE, STRIDE));
    let mut next = || steps.next().unwrap_or(0.0);
    let moved = processes.iter().map(|process| {
        let size = process.size * (0.5 * next()).exp();
        let kind = match process.kind {
            Kind::GaussMarkov { time } => {
                Kind::GaussMarkov { time: (time * next().exp()).clamp(times.0, times.1.max(times.0)) }
            }
            kind => kind,
        };
        Process { kind, size }
    });
    moved.collect()
}
