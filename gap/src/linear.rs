//! Any filter about a recorded trajectory, and the price of every effect it lacks, in one linear run.

use crate::recording::{CORE, Column, Recording, Start, Step};
use runs::products::{add_products, dot, multiply, subtract_outer, whiten};

/// So many whitened rows are kept before their products are summed: the sums are many more than a cache holds.
const AT_ONCE: usize = 48;

/// Factors on the stated standard deviations of the noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// On the angle random walk.
    pub gyro: f64,
    /// On the velocity random walk.
    pub accel: f64,
    /// On the standard deviations of the reference.
    pub reference: f64,
}

impl Noise {
    /// As stated.
    pub const STATED: Self = Self { gyro: 1.0, accel: 1.0, reference: 1.0 };
}

/// A column priced beside the filter: how an unmodelled unit constant enters each step.
pub(crate) trait Priced {
    fn count(&self) -> usize;
    /// Whether the products of all columns are summed; where not, who watches sums those that matter.
    fn is_summed(&self) -> bool {
        true
    }
    /// Effect on the leading states over step `at` (9 rows), and on its measurements.
    fn fill(&self, at: usize, step: &Step, width: usize, gamma: &mut [f64], direct: &mut [f64]);
}

/// Columns of the recording itself.
pub(crate) struct Recorded<'a>(pub(crate) &'a [usize]);

impl Priced for Recorded<'_> {
    fn count(&self) -> usize {
        self.0.len()
    }

    fn fill(&self, _: usize, step: &Step, width: usize, gamma: &mut [f64], direct: &mut [f64]) {
        // both matrices have a first column of another meaning
        let nc = self.0.len() + 1;
        let copy = |from: &[f64], width: usize, to: &mut [f64], rows: usize| {
            let mut at = 1;
            for run in self.0.chunk_by(|a, b| *b == a + 1) {
                for i in 0..rows {
                    let first = i * width + CORE + run[0];
                    let to = &mut to[i * nc + at..i * nc + at + run.len()];
                    to.copy_from_slice(&from[first..first + run.len()]);
                }
                at += run.len();
            }
        };
        copy(&step.rows, width, gamma, CORE);
        copy(&step.h, width - 1, direct, step.z.len());
    }
}

/// What a linear run found. `gram` is `Y'Y` of the whitened innovations and sensitivities, (1 + priced)^2: entry (0, 0)
/// is the normalised innovation squared, the rest of row 0 the score b, the rest the information Lambda.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    pub(crate) log_likelihood: f64,
    pub(crate) degrees_of_freedom: usize,
    pub(crate) gram: Vec<f64>,
    /// Of each estimated column in the end, that of the last log: the negative of its estimate, and what a unit of each priced column adds to that.
    pub(crate) errors: Vec<f64>,
    /// And its variance, were nothing of what is priced there.
    pub(crate) variances: Vec<f64>,
}

/// The whitened rows of one update: `rows` x (1 + priced).
pub(crate) struct Whitened<'a> {
    pub(crate) step: &'a Step,
    pub(crate) rows: &'a [f64],
}

/// Predictions without updates, over a horizon, from the second half of a log.
#[derive(Clone, Debug, Default)]
pub(crate) struct FreeRun {
    pub(crate) horizon: f64,
    /// Predictions begin after this time, s.
    pub(crate) from: f64,
    state: Vec<f64>,
    since: Option<f64>,
    /// Sums of squares and counts of velocity and position.
    sums: [(f64, usize); 2],
}

impl FreeRun {
    pub(crate) fn new(horizon: f64, from: f64) -> Self {
        Self { horizon, from, ..Self::default() }
    }

    /// Root mean square of the error at the end of the horizon, of velocity where it is measured, else of position.
    pub(crate) fn rms(&self) -> (f64, &'static str) {
        let (which, of) = if self.sums[0].1 > 0 { (0, "velocity") } else { (1, "position") };
        let (sum, count) = self.sums[which];
        if count == 0 { (f64::NAN, of) } else { ((sum / count as f64).sqrt(), of) }
    }

    fn advance(&mut self, a: &[f64], input: impl Fn(usize) -> f64, n: usize, elapsed: f64) {
        let Some(since) = &mut self.since else { return };
        *since += elapsed;
        let moved: [f64; CORE] =
            core::array::from_fn(|i| input(i) + dot(&a[i * n..(i + 1) * n], &self.state));
        self.state[..CORE].copy_from_slice(&moved);
    }

    fn measure(&mut self, step: &Step, h: &[f64], z: impl Fn(usize) -> f64, n: usize) {
        if self.since.is_none_or(|since| since < self.horizon) {
            return;
        }
        self.since = None;
        for (m, channel) in step.channel.iter().enumerate().filter(|(_, c)| **c < 6) {
            let error = z(m) + dot(&h[m * n..(m + 1) * n], &self.state);
            let sum = &mut self.sums[channel / 3];
            *sum = (sum.0 + error * error, sum.1 + 1);
        }
    }

    fn restart(&mut self, time: f64, w: &[f64], n: usize, nc: usize) {
        if self.since.is_none() && time >= self.from {
            self.since = Some(0.0);
            self.state = (0..n).map(|i| w[i * nc]).collect();
        }
    }
}

/// Runs the filter with the columns `estimated` about the trajectory of `recording`, under `noise`, and prices `priced`
/// beside it. Columns in neither are zero in truth.
///
/// With F, H, K of the filter, `U = F V + Gamma`, `S = H U + D`, `V = U - K S` carry the sensitivity of the estimation
/// error to each unmodelled constant (Friedland's separate bias, exact); the estimate goes with them as one more column. Nothing
/// where an innovation covariance is not positive definite, or a number is none any more.
pub(crate) fn run(
    recording: &Recording,
    estimated: &[usize],
    priced: &dyn Priced,
    noise: &Noise,
    watch: &mut dyn FnMut(&Whitened),
) -> Option<Found> {
    run_free(recording, estimated, priced, noise, watch, &mut FreeRun::new(0.0, f64::INFINITY))
}

/// [`run`], with predictions on the way.
pub(crate) fn run_free(
    recording: &Recording,
    estimated: &[usize],
    priced: &dyn Priced,
    noise: &Noise,
    watch: &mut dyn FnMut(&Whitened),
    free: &mut FreeRun,
) -> Option<Found> {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = fearless_simd::Level::new().as_avx2() {
        return fearless_simd::Simd::vectorize(
            avx2,
            #[inline(always)]
            || filter::<true>(recording, estimated, priced, noise, watch, free),
        );
    }
    filter::<false>(recording, estimated, priced, noise, watch, free)
}

/// [`run_free`], compiled once with fused products for the processor that has them and once without.
#[inline(always)]
fn filter<const FUSED: bool>(
    recording: &Recording,
    estimated: &[usize],
    priced: &dyn Priced,
    noise: &Noise,
    watch: &mut dyn FnMut(&Whitened),
    free: &mut FreeRun,
) -> Option<Found> {
    let columns = &recording.columns;
    let np = columns.len();
    let width = CORE + np + 1;
    let n = CORE + estimated.len();
    let nc = 1 + priced.count();
    let is_summed = priced.is_summed();
    let mut is_estimated = vec![false; np];
    for &i in estimated {
        is_estimated[i] = true;
    }
    let mut starts = recording.starts.iter().peekable();
    let (mut about, mut known): (&[f64], Vec<usize>) = (&[], Vec::new());
    let mut p = vec![0.0; n * n];
    let mut w = vec![0.0; n * nc];
    let relaxing: Vec<(usize, f64, f64)> = recording
        .relaxing
        .iter()
        .filter_map(|r| estimated.iter().position(|i| *i == r.0).map(|k| (CORE + k, r.1, r.2)))
        .collect();
    let mut a = vec![0.0; CORE * n];
    let mut moved = vec![0.0; CORE * n];
    let mut gamma = vec![0.0; CORE * nc];
    let mut gram = vec![0.0; if is_summed { nc * nc } else { 0 }];
    let mut rows = Vec::new();
    let mut log_likelihood = 0.0;
    let mut degrees_of_freedom = 0;
    let (gyro, accel) = (noise.gyro * noise.gyro, noise.accel * noise.accel);
    let reference = noise.reference * noise.reference;
    let mut h = Vec::new();
    let mut direct = Vec::new();
    let mut y = Vec::new();
    let mut s = Vec::new();
    let mut yp = Vec::new();
    for (at, step) in recording.steps.iter().enumerate() {
        if let Some(start) = starts.next_if(|start| start.step == at) {
            begin(start, (at > 0).then_some(about), columns, estimated, (n, nc), (&mut p, &mut w));
            about = &start.about;
            // what is not estimated is zero in truth: its remaining error is minus the linearisation point
            known = (0..np).filter(|&i| !is_estimated[i] && about[i] != 0.0).collect();
            free.since = None;
        }
        let ms = step.z.len();
        gamma.fill(0.0);
        direct.clear();
        direct.resize(ms * nc, 0.0);
        priced.fill(at, step, width, &mut gamma, &mut direct);
        // time: F = [a; 0 I]
        for i in 0..CORE {
            let row = &step.rows[i * width..(i + 1) * width];
            a[i * n..i * n + CORE].copy_from_slice(&row[..CORE]);
            for (k, &c) in estimated.iter().enumerate() {
                a[i * n + CORE + k] = row[CORE + c];
            }
            let mut input = row[width - 1];
            for &c in &known {
                input -= row[CORE + c] * about[c];
            }
            gamma[i * nc] = -input;
        }
        free.advance(&a, |i| gamma[i * nc], n, step.elapsed);
        multiply::<FUSED>(&a, &w, CORE, n, nc, &mut gamma);
        w[..CORE * nc].copy_from_slice(&gamma);
        moved.fill(0.0);
        multiply::<FUSED>(&a, &p, CORE, n, n, &mut moved);
        for i in 0..CORE {
            for l in 0..=i {
                let q = gyro * step.gyro_noise[i * CORE + l] + accel * step.accel_noise[i * CORE + l];
                let value = q + dot(&moved[i * n..(i + 1) * n], &a[l * n..(l + 1) * n]);
                p[i * n + l] = value;
                p[l * n + i] = value;
            }
            for j in CORE..n {
                p[i * n + j] = moved[i * n + j];
                p[j * n + i] = moved[i * n + j];
            }
        }
        for &(state, rate, density) in &relaxing {
            relax(&mut p, &mut w, n, nc, state, rate, density, step.elapsed);
        }
        // measurement
        h.clear();
        h.resize(ms * n, 0.0);
        for m in 0..ms {
            let row = &step.h[m * (width - 1)..(m + 1) * (width - 1)];
            h[m * n..m * n + CORE].copy_from_slice(&row[..CORE]);
            for (k, &c) in estimated.iter().enumerate() {
                h[m * n + CORE + k] = row[CORE + c];
            }
            let mut z = step.z[m];
            for &c in &known {
                z += row[CORE + c] * about[c];
            }
            direct[m * nc] = z;
        }
        free.measure(step, &h, |m| direct[m * nc], n);
        y.clear();
        y.extend_from_slice(&direct);
        multiply::<FUSED>(&h, &w, ms, n, nc, &mut y);
        yp.clear();
        yp.resize(ms * n, 0.0);
        multiply::<FUSED>(&h, &p, ms, n, n, &mut yp);
        s.clear();
        s.resize(ms * ms, 0.0);
        for i in 0..ms {
            for j in 0..=i {
                s[i * ms + j] = dot(&yp[i * n..(i + 1) * n], &h[j * n..(j + 1) * n]);
            }
            s[i * ms + i] += step.r[i] * reference;
        }
        let log_det = whiten(&mut s, ms, &mut yp, n, &mut y, nc)?;
        let nis: f64 = (0..ms).map(|m| y[m * nc] * y[m * nc]).sum();
        if !nis.is_finite() {
            return None;
        }
        log_likelihood -= 0.5 * (nis + log_det + ms as f64 * core::f64::consts::TAU.ln());
        degrees_of_freedom += ms;
        subtract_outer::<FUSED>(&yp, &yp, ms, n, n, &mut p);
        subtract_outer::<FUSED>(&yp, &y, ms, n, nc, &mut w);
        if is_summed {
            rows.extend_from_slice(&y);
        }
        if rows.len() >= AT_ONCE * nc {
            add_products::<FUSED>(&rows, nc, &mut gram);
            rows.clear();
        }
        free.restart(step.time, &w, n, nc);
        watch(&Whitened { step, rows: &y });
    }
    if is_summed {
        add_products::<FUSED>(&rows, nc, &mut gram);
    }
    for i in 0..if is_summed { nc } else { 0 } {
        for j in 0..i {
            gram[i * nc + j] = gram[j * nc + i];
        }
    }
    // a sensitivity that is no number any more would pass for an effect that does not show
    if gram.iter().any(|product| !product.is_finite()) {
        return None;
    }
    let errors = w.split_off(CORE * nc);
    let variances = (CORE..n).map(|i| p[i * n + i]).collect();
    Some(Found { log_likelihood, degrees_of_freedom, gram, errors, variances })
}

/// Covariance, and errors with sensitivities, at the beginning of a log. Of what was estimated in a log before it, about other values, the
/// candidates stay: they are the same in all logs.
fn begin(
    start: &Start,
    before: Option<&[f64]>,
    columns: &[Column],
    estimated: &[usize],
    (n, nc): (usize, usize),
    (p, w): (&mut [f64], &mut [f64]),
) {
    let stays = |at: usize| before.is_some() && at >= CORE && !columns[estimated[at - CORE]].base;
    for i in 0..n {
        for j in 0..n {
            if !(stays(i) && stays(j)) {
                p[i * n + j] = 0.0;
            }
        }
        if i < CORE {
            p[i * n + i] = start.core[i] * start.core[i];
        }
    }
    w[..CORE * nc].fill(0.0);
    for (k, &i) in estimated.iter().enumerate() {
        let at = CORE + k;
        if let (Some(before), true) = (before, stays(at)) {
            w[at * nc] += start.about[i] - before[i];
            continue;
        }
        p[at * n + at] = columns[i].prior * columns[i].prior;
        w[at * nc..(at + 1) * nc].fill(0.0);
        w[at * nc] = start.about[i];
    }
}

#[allow(clippy::too_many_arguments, reason = "one line of the loop, out of its way")]
fn relax(p: &mut [f64], w: &mut [f64], n: usize, nc: usize, i: usize, rate: f64, density: f64, dt: f64) {
    let fade = calib_core::Fade::over(calib_core::Relaxation { rate, density }, i, dt);
    for j in 0..n {
        p[i * n + j] *= fade.keep;
        p[j * n + i] *= fade.keep;
    }
    p[i * n + i] += fade.variance;
    for v in &mut w[i * nc..(i + 1) * nc] {
        *v *= fade.keep;
    }
}
