//! What a log says of the constants of a filter, stretch of time by stretch of time, about one trajectory.
//!
//! With the leading states x of a pass whose parameters are held at a point, the state given an error p of the constants is
//! x(p) = m + M p, both carried through the filter of the leading states alone (Friedland, *IEEE Transactions on Automatic Control*
//! 14(4), 1969): the innovations are e - A p, whitened, and the log-likelihood is quadratic in p with the score A'e and the information
//! A'A. These are sums over the updates, kept apart by stretches: a sum over all is one Gauss-Newton step of the posterior (Bell,
//! *SIAM Journal on Optimization* 4(3), 1994), and how the stretches scatter is how far the sigmas may be relied on.

use calib_core::{Fade, Relaxation};

use crate::products::{add_products, dot, multiply, subtract_outer, whiten};
use crate::trace::{CORE, Measured, Moved, Trace, Traced};

/// So many whitened rows are kept before their products are summed.
const AT_ONCE: usize = 48;
/// The span is divided into so many stretches of equal length.
pub(crate) const STRETCHES: usize = 32;
/// Leading states whose value at the first sample may be asked for: the attitude error.
pub(crate) const START: usize = 3;

/// What the scores of a pass are about.
#[derive(Clone, Debug)]
pub(crate) struct Question {
    /// Values of the parameters that take part, in the order of the selection.
    pub(crate) about: Vec<f64>,
    /// Their prior standard deviations.
    pub(crate) priors: Vec<f64>,
    /// Whether the attitude at the first sample is asked for like a constant.
    pub(crate) start: bool,
    /// First and last time, s.
    pub(crate) span: (f64, f64),
}

/// Score and information of the updates of a stretch, or of several together.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stretch {
    /// A'e, one for each constant.
    pub(crate) score: Vec<f64>,
    /// A'A, row after row.
    pub(crate) information: Vec<f64>,
}

/// What the scores of a pass came to.
#[derive(Clone, Debug)]
pub struct Scored {
    /// In order of time.
    pub(crate) stretches: Vec<Stretch>,
    /// Constants, as places in the selection; after them in the scores comes the attitude error at the first sample, if it was asked for.
    pub(crate) constants: Vec<usize>,
    /// Log-likelihood at the point itself, what relaxes left open.
    pub(crate) log_likelihood: f64,
}

/// Adds them up on the way.
pub(crate) struct Scores {
    question: Question,
    constants: Vec<usize>,
    /// Parameters that relax, as places in the selection: they follow the leading states.
    relaxing: Vec<(usize, Relaxation<f64>)>,
    /// Covariance of leading and relaxing states, were the constants known.
    p: Vec<f64>,
    /// m, and M.
    w: Vec<f64>,
    rows: Vec<f64>,
    at: usize,
    grams: Vec<Vec<f64>>,
    log_likelihood: f64,
    /// No sum means anything any more.
    broken: bool,
}

impl Scores {
    pub(crate) fn new(question: Question) -> Self {
        let grams = vec![Vec::new(); STRETCHES];
        Self {
            question,
            constants: Vec::new(),
            relaxing: Vec::new(),
            p: Vec::new(),
            w: Vec::new(),
            rows: Vec::new(),
            at: 0,
            grams,
            log_likelihood: 0.0,
            broken: false,
        }
    }

    /// States that are carried.
    fn states(&self) -> usize {
        CORE + self.relaxing.len()
    }

    /// Columns of m and M.
    fn columns(&self) -> usize {
        1 + self.constants.len() + if self.question.start { START } else { 0 }
    }

    fn flush(&mut self) {
        let columns = self.columns();
        let gram = &mut self.grams[self.at];
        gram.resize(columns * columns, 0.0);
        add_products::<false>(&self.rows, columns, gram);
        self.rows.clear();
    }

    /// What it came to; nothing where it is no number.
    pub(crate) fn finish(mut self) -> Option<Scored> {
        self.flush();
        let columns = self.columns();
        let log_likelihood = self.log_likelihood;
        if self.broken || !log_likelihood.is_finite() {
            return None;
        }
        let stretches: Vec<Stretch> = self
            .grams
            .iter_mut()
            .map(|gram| {
                gram.resize(columns * columns, 0.0);
                // the row of m holds -e
                let score = gram[1..columns].iter().map(|product| -product).collect();
                let entry = |i: usize, j: usize| gram[(1 + i.min(j)) * columns + 1 + i.max(j)];
                let n = columns - 1;
                let information = (0..n * n).map(|k| entry(k / n, k % n)).collect();
                Stretch { score, information }
            })
            .collect();
        let numbers = stretches.iter().flat_map(|stretch| stretch.score.iter().chain(&stretch.information));
        if numbers.copied().any(|number| !number.is_finite()) {
            return None;
        }
        Some(Scored { stretches, constants: self.constants, log_likelihood })
    }
}

impl Trace for Scores {
    fn begin(&mut self, begun: &Traced) {
        self.relaxing.clone_from(&begun.relaxing);
        let relaxes = |place: usize| begun.relaxing.iter().any(|(relaxing, _)| *relaxing == place);
        let Question { about, priors, start, .. } = &self.question;
        self.constants = (0..about.len()).filter(|place| !relaxes(*place)).collect();
        let (n, nc) = (self.states(), self.columns());
        self.p = vec![0.0; n * n];
        self.w = vec![0.0; n * nc];
        for i in 0..CORE {
            if *start && i < START {
                self.w[i * nc + 1 + self.constants.len() + i] = 1.0;
            } else {
                self.p[i * n + i] = begun.start[i] * begun.start[i];
            }
        }
        for (k, (place, _)) in begun.relaxing.iter().enumerate() {
            let i = CORE + k;
            self.p[i * n + i] = priors[*place] * priors[*place];
            self.w[i * nc] = -about[*place];
        }
    }

    fn moved(&mut self, step: &Moved) {
        let (n, nc) = (self.states(), self.columns());
        let width = step.rows.len() / CORE;
        let mut a = vec![0.0; CORE * n];
        let mut moved = vec![0.0; CORE * nc];
        for i in 0..CORE {
            let row = &step.rows[i * width..(i + 1) * width];
            a[i * n..i * n + CORE].copy_from_slice(&row[..CORE]);
            for (k, (place, _)) in self.relaxing.iter().enumerate() {
                a[i * n + CORE + k] = row[CORE + place];
            }
            for (k, place) in self.constants.iter().enumerate() {
                moved[i * nc + 1 + k] = row[CORE + place];
            }
        }
        multiply::<false>(&a, &self.w, CORE, n, nc, &mut moved);
        self.w[..CORE * nc].copy_from_slice(&moved);
        let p = &mut self.p;
        let mut half = vec![0.0; CORE * n];
        multiply::<false>(&a, p, CORE, n, n, &mut half);
        for i in 0..CORE {
            for l in 0..=i {
                let noise = step.gyro_noise[i * CORE + l] + step.accel_noise[i * CORE + l];
                let value = noise + dot(&half[i * n..(i + 1) * n], &a[l * n..(l + 1) * n]);
                p[i * n + l] = value;
                p[l * n + i] = value;
            }
            for j in CORE..n {
                p[i * n + j] = half[i * n + j];
                p[j * n + i] = half[i * n + j];
            }
        }
        for (k, (_, relaxation)) in self.relaxing.iter().enumerate() {
            let i = CORE + k;
            let fade = Fade::over(*relaxation, i, step.elapsed);
            for j in 0..n {
                p[i * n + j] *= fade.keep;
                p[j * n + i] *= fade.keep;
            }
            p[i * n + i] += fade.variance;
            self.w[i * nc..(i + 1) * nc].iter_mut().for_each(|value| *value *= fade.keep);
        }
    }

    fn widened(&mut self, variances: &[f64; CORE]) {
        let n = self.states();
        for i in 0..CORE {
            self.p[i * n + i] += variances[i];
        }
    }

    fn measured(&mut self, measured: &Measured) {
        let (n, nc) = (self.states(), self.columns());
        let ms = measured.rows.len();
        let mut h = vec![0.0; ms * n];
        // -e, and A
        let mut y = vec![0.0; ms * nc];
        for (m, row) in measured.rows.iter().enumerate() {
            h[m * n..m * n + CORE].copy_from_slice(&row.h[..CORE]);
            for (k, (place, _)) in self.relaxing.iter().enumerate() {
                h[m * n + CORE + k] = row.h[CORE + place];
            }
            y[m * nc] = -row.z;
            for (k, place) in self.constants.iter().enumerate() {
                y[m * nc + 1 + k] = row.h[CORE + place];
            }
        }
        multiply::<false>(&h, &self.w, ms, n, nc, &mut y);
        let mut yp = vec![0.0; ms * n];
        multiply::<false>(&h, &self.p, ms, n, n, &mut yp);
        let mut s = vec![0.0; ms * ms];
        for i in 0..ms {
            for j in 0..=i {
                s[i * ms + j] = dot(&yp[i * n..(i + 1) * n], &h[j * n..(j + 1) * n]);
            }
            s[i * ms + i] += measured.rows[i].r;
        }
        let Some(log_det) = whiten(&mut s, ms, &mut yp, n, &mut y, nc) else {
            self.broken = true;
            return;
        };
        let nis: f64 = (0..ms).map(|m| y[m * nc] * y[m * nc]).sum();
        self.log_likelihood -= 0.5 * (nis + log_det + ms as f64 * core::f64::consts::TAU.ln());
        subtract_outer::<false>(&yp, &yp, ms, n, n, &mut self.p);
        subtract_outer::<false>(&yp, &y, ms, n, nc, &mut self.w);
        let (first, last) = self.question.span;
        let part = (measured.time - first) / (last - first).max(f64::MIN_POSITIVE);
        let at = ((part * STRETCHES as f64).max(0.0) as usize).min(STRETCHES - 1);
        if at != self.at || self.rows.len() >= AT_ONCE * nc {
            self.flush();
            self.at = at;
        }
        self.rows.extend_from_slice(&y);
    }

    fn fed_back(&mut self, correction: &[f64; CORE]) {
        let nc = self.columns();
        for i in 0..CORE {
            self.w[i * nc] -= correction[i];
        }
    }
}
