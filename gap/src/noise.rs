//! The noise first: wrong noise raises false alarms that no other test repairs.

use nalgebra::{Matrix3, Vector3};

use crate::linear::{Found, Noise, Recorded, run};
use crate::parallel::both;
use crate::prices::{Prices, groups_of};
use crate::recording::Recording;

/// Scales are sought between 2/7 of what is stated and 3.5 times that.
const CAP: f64 = 3.5;
/// Noise that is certainly more than this may hide anything.
pub(crate) const TRUSTED: f64 = 3.0;
/// "Certainly": the objective is so much worse at the other scale.
const CERTAIN: f64 = 2.0;
/// Less noise than stated makes chance significant: it takes more than that to be believed.
const MORE_CERTAIN: f64 = 8.0;
/// Steps the fit looks at, about.
const STEPS: usize = 900;
/// Steps of the fit longer than this are long.
const FAR: f64 = 0.3;
const PAIRS: [(usize, usize); 3] = [(0, 1), (0, 2), (1, 2)];
/// Standard deviation of the logarithm of a scale before the fit.
const PRIOR: f64 = 1.0;

/// What the base filter finds in a recording under `noise`, and the prices of all candidates.
pub(crate) fn price(recording: &Recording, noise: &Noise) -> Option<(Found, Prices)> {
    let priced = recording.candidates();
    let found = run(recording, &recording.base(), &Recorded(&priced), noise, &mut |_| {})?;
    let sigma = priced.iter().map(|c| recording.columns[*c].prior).collect();
    let prices = Prices::new(&found.gram, sigma, groups_of(&recording.columns, &priced));
    Some((found, prices))
}

fn noise_of(x: &Vector3<f64>) -> Noise {
    Noise { gyro: x[0].exp(), accel: x[1].exp(), reference: x[2].exp() }
}

/// Log-likelihood of the filter with every candidate, and a weak preference for what is stated.
fn objective(recording: &Recording, x: &Vector3<f64>) -> f64 {
    match price(recording, &noise_of(x)) {
        Some((found, prices)) => {
            found.log_likelihood + prices.gain(&prices.all()) - 0.5 * x.norm_squared() / (PRIOR * PRIOR)
        }
        None => f64::NEG_INFINITY,
    }
}

/// Objective at several places, on two threads.
fn objectives(recording: &Recording, places: &[Vector3<f64>]) -> Vec<f64> {
    let (left, right) = places.split_at(places.len() / 2);
    let of = |places: &[Vector3<f64>]| places.iter().map(|x| objective(recording, x)).collect::<Vec<f64>>();
    let (mut all, mine) = both(|| of(left), || of(right));
    all.extend(mine);
    all
}

/// Fits the noise scales under base and all candidates by Newton's method in their logarithms; also whether one of them is
/// certainly beyond what may be trusted.
pub(crate) fn fit(recording: &Recording) -> (Noise, bool) {
    let keep = (recording.updates() / STEPS).max(1);
    let short;
    let recording = if keep > 1 {
        short = recording.decimated(keep);
        &short
    } else {
        recording
    };
    let limit = CAP.ln();
    let unit = |i: usize| Vector3::ith(i, 1.0);
    let h = 0.12;
    let mut x = Vector3::zeros();
    let mut mixed = [0.0; 3];
    // how far the last step went: the mixed derivatives, in units of the others, are looked at anew after a long one
    let mut moved = f64::INFINITY;
    for _ in 0..15 {
        let mut places = vec![x];
        for i in 0..3 {
            places.push(x + unit(i) * h);
            places.push(x - unit(i) * h);
        }
        if moved > FAR {
            places.extend(PAIRS.map(|(i, j)| x + (unit(i) + unit(j)) * h));
        }
        let f = objectives(recording, &places);
        let mut gradient = Vector3::zeros();
        let mut curvature = Matrix3::zeros();
        for i in 0..3 {
            let (up, down) = (f[1 + 2 * i], f[2 + 2 * i]);
            gradient[i] = (up - down) / (2.0 * h);
            // where the objective is not concave: a step along the gradient
            let bent = (2.0 * f[0] - up - down) / (h * h);
            curvature[(i, i)] = bent.max(gradient[i].abs()).max(1.0);
        }
        for (k, (i, j)) in PAIRS.into_iter().enumerate() {
            let scale = f64::sqrt(curvature[(i, i)] * curvature[(j, j)]);
            if moved > FAR {
                let cross = -(f[7 + k] - f[1 + 2 * i] - f[1 + 2 * j] + f[0]) / (h * h);
                mixed[k] = (cross / scale).clamp(-0.9, 0.9);
            }
            curvature[(i, j)] = mixed[k] * scale;
            curvature[(j, i)] = curvature[(i, j)];
        }
        // at a bound that the gradient pushes against, the others move on their own
        for i in 0..3 {
            if x[i].abs() < limit || x[i] * gradient[i] <= 0.0 {
                continue;
            }
            gradient[i] = 0.0;
            for j in (0..3).filter(|j| *j != i) {
                curvature[(i, j)] = 0.0;
                curvature[(j, i)] = 0.0;
            }
        }
        let step = curvature.cholesky().map_or(gradient * 0.01, |c| c.solve(&gradient));
        let step = step.map(|s| s.clamp(-0.7, 0.7));
        let tries = |parts: [f64; 2]| parts.map(|s| (x + step * s).map(|v| v.clamp(-limit, limit)));
        let better = |tries: [Vector3<f64>; 2]| {
            let values = objectives(recording, &tries);
            let best = if values[1] > values[0] { 1 } else { 0 };
            (values[best] > f[0]).then_some(tries[best])
        };
        let Some(next) = better(tries([1.0, 0.5])).or_else(|| better(tries([0.2, 0.05]))) else { break };
        moved = (next - x).amax();
        x = next;
        if moved < 0.02 {
            break;
        }
    }
    for i in (0..3).filter(|i| x[*i] < 0.0).collect::<Vec<_>>() {
        let mut stated = x;
        stated[i] = 0.0;
        if let &[fitted, other] = objectives(recording, &[x, stated]).as_slice()
            && other > fitted - MORE_CERTAIN
        {
            x = stated;
        }
    }
    let beyond: Vec<Vector3<f64>> = (0..3)
        .filter(|i| x[*i] > TRUSTED.ln())
        .map(|i| {
            let mut trusted = x;
            trusted[i] = TRUSTED.ln();
            trusted
        })
        .collect();
    let hides = !beyond.is_empty() && {
        let best = objective(recording, &x);
        objectives(recording, &beyond).into_iter().any(|trusted| trusted < best - CERTAIN)
    };
    (noise_of(&x), hides)
}
