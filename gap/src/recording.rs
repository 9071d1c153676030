//! What a pass of the filter did, kept so that every other filter about the same trajectory is a linear run.

use calib_core::StateInfo;
use runs::{Measured, Moved, Trace};
use sinscal::Motion;

use runs::products::{dot, multiply};

/// Leading states of a strapdown filter: attitude, velocity, position.
pub(crate) const CORE: usize = 9;
const SQUARE: usize = CORE * CORE;
/// Time between two logs that are taken as one, s.
const BETWEEN: f64 = 1.0;

/// A parameter of the recorded filter, base or candidate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Column {
    /// Name, component and unit.
    pub(crate) info: StateInfo,
    /// Prior standard deviation; zero when the column takes no part.
    pub(crate) prior: f64,
    /// Whether it belongs to the declared base filter.
    pub(crate) base: bool,
}

/// Where a log begins.
#[derive(Clone, Debug)]
pub(crate) struct Start {
    /// Its first step.
    pub(crate) step: usize,
    /// Prior standard deviations of the leading states.
    pub(crate) core: [f64; CORE],
    /// Values of the parameters about which its pass was linearised.
    pub(crate) about: Vec<f64>,
}

/// From one measurement to the next: how the leading states moved, and what was measured at the end.
#[derive(Clone, Debug)]
pub(crate) struct Step {
    pub(crate) time: f64,
    pub(crate) elapsed: f64,
    /// 9 x (9 + parameters + 1): `[Phi Psi known]`; the known input is what was fed back.
    pub(crate) rows: Vec<f64>,
    pub(crate) gyro_noise: [f64; SQUARE],
    pub(crate) accel_noise: [f64; SQUARE],
    /// One row of 9 + parameters for each scalar measurement present.
    pub(crate) h: Vec<f64>,
    pub(crate) z: Vec<f64>,
    pub(crate) r: Vec<f64>,
    /// What each measurement is of, by [`Channels`].
    pub(crate) channel: Vec<usize>,
    /// What the unit did at its end.
    pub(crate) motion: Motion,
}

/// A pass over a log, linearised about one trajectory, with all candidates' columns; or passes over several logs, one after the other.
#[derive(Clone, Debug)]
pub(crate) struct Recording {
    pub(crate) columns: Vec<Column>,
    /// The logs: what the filter estimates begins anew with each.
    pub(crate) starts: Vec<Start>,
    pub(crate) steps: Vec<Step>,
    /// Parameters that are not constant: column, inverse correlation time, noise density.
    pub(crate) relaxing: Vec<(usize, f64, f64)>,
    /// Names of what [`Step::channel`] counts, for instance `vel_n`; empty where nothing is measured.
    pub(crate) channels: Vec<String>,
}

impl Recording {
    /// The parameters, in the order of the declaration, the candidates after those of the base filter.
    pub(crate) fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// Several logs as one: what is priced is the same in all of them. Times of later logs follow on those of the first.
    pub(crate) fn joined(logs: Vec<Self>) -> Option<Self> {
        let mut logs = logs.into_iter();
        let mut all = logs.next()?;
        for log in logs {
            let (first, by) = (all.steps.len(), all.span().1 + BETWEEN - log.span().0);
            let later = log.starts.into_iter().map(|start| Start { step: first + start.step, ..start });
            all.starts.extend(later);
            all.steps.extend(log.steps.into_iter().map(|step| Step { time: step.time + by, ..step }));
            for (column, other) in all.columns.iter_mut().zip(&log.columns) {
                column.prior = column.prior.max(other.prior);
            }
        }
        Some(all)
    }

    /// Values about which the pass over the last log was linearised.
    pub(crate) fn about(&self) -> &[f64] {
        self.starts.last().map_or(&[], |start| &start.about)
    }

    /// The steps of each log.
    pub(crate) fn logs(&self) -> impl Iterator<Item = &[Step]> {
        let ends = self.starts.iter().skip(1).map(|start| start.step).chain([self.steps.len()]);
        self.starts.iter().zip(ends).map(|(start, end)| &self.steps[start.step..end])
    }

    /// Number of measurement updates.
    pub(crate) fn updates(&self) -> usize {
        self.steps.len()
    }

    /// Time of the first and of the last update, s.
    pub(crate) fn span(&self) -> (f64, f64) {
        match (self.steps.first(), self.steps.last()) {
            (Some(first), Some(last)) => (first.time, last.time),
            _ => (0.0, 0.0),
        }
    }

    /// Columns of the base filter that take part.
    pub(crate) fn base(&self) -> Vec<usize> {
        (0..self.columns.len()).filter(|&i| self.columns[i].base && self.columns[i].prior > 0.0).collect()
    }

    /// Candidate columns that take part.
    pub(crate) fn candidates(&self) -> Vec<usize> {
        (0..self.columns.len()).filter(|&i| !self.columns[i].base && self.columns[i].prior > 0.0).collect()
    }

    /// The recording with every `keep`-th update only: for what need not use all of them.
    pub(crate) fn decimated(&self, keep: usize) -> Self {
        let mut steps = Vec::with_capacity(self.steps.len() / keep + 1);
        let mut starts = Vec::with_capacity(self.starts.len());
        for (start, log) in self.starts.iter().zip(self.logs()) {
            starts.push(Start { step: steps.len(), ..start.clone() });
            let mut open = Interval::new(self.columns.len());
            for (i, step) in log.iter().enumerate() {
                open.append(step.rows.clone(), &step.gyro_noise, &step.accel_noise, step.elapsed);
                if i % keep == 0 {
                    let mut kept =
                        Step { h: step.h.clone(), z: step.z.clone(), r: step.r.clone(), ..step.clone() };
                    (kept.rows, kept.gyro_noise, kept.accel_noise, kept.elapsed) = open.take();
                    steps.push(kept);
                }
            }
        }
        Self {
            starts,
            steps,
            columns: self.columns.clone(),
            relaxing: self.relaxing.clone(),
            channels: self.channels.clone(),
        }
    }
}

/// Steps of the leading states joined into one.
struct Interval {
    width: usize,
    /// Empty before the first step.
    rows: Vec<f64>,
    /// What was fed back before the first step.
    known: [f64; CORE],
    gyro_noise: [f64; SQUARE],
    accel_noise: [f64; SQUARE],
    elapsed: f64,
}

impl Interval {
    fn new(parameters: usize) -> Self {
        Self {
            width: CORE + parameters + 1,
            rows: Vec::new(),
            known: [0.0; CORE],
            gyro_noise: [0.0; SQUARE],
            accel_noise: [0.0; SQUARE],
            elapsed: 0.0,
        }
    }

    /// What has been joined; the interval starts anew.
    fn take(&mut self) -> (Vec<f64>, [f64; SQUARE], [f64; SQUARE], f64) {
        let w = self.width;
        let new = Self::new(w - CORE - 1);
        let Self { mut rows, known, gyro_noise, accel_noise, elapsed, .. } = core::mem::replace(self, new);
        if rows.is_empty() {
            rows.resize(CORE * w, 0.0);
            for i in 0..CORE {
                rows[i * w + i] = 1.0;
                rows[i * w + w - 1] = known[i];
            }
        }
        (rows, gyro_noise, accel_noise, elapsed)
    }

    fn append(&mut self, mut rows: Vec<f64>, gyro: &[f64; SQUARE], accel: &[f64; SQUARE], elapsed: f64) {
        let w = self.width;
        self.gyro_noise = moved_noise(&rows, w, &self.gyro_noise, gyro);
        self.accel_noise = moved_noise(&rows, w, &self.accel_noise, accel);
        self.elapsed += elapsed;
        for row in rows.chunks_exact_mut(w) {
            let (phi, rest) = row.split_at_mut(CORE);
            if self.rows.is_empty() {
                rest[w - CORE - 1] += dot(phi, &self.known);
                continue;
            }
            let phi: [f64; CORE] = core::array::from_fn(|k| core::mem::take(&mut phi[k]));
            multiply::<false>(&phi, &self.rows, 1, CORE, w, row);
        }
        self.rows = rows;
    }

    fn feed_back(&mut self, correction: &[f64]) {
        for i in 0..CORE {
            match self.rows.get_mut((i + 1) * self.width - 1) {
                Some(known) => *known -= correction[i],
                None => self.known[i] -= correction[i],
            }
        }
    }
}

/// `Phi Q Phi' + added`.
fn moved_noise(rows: &[f64], w: usize, q: &[f64; SQUARE], added: &[f64; SQUARE]) -> [f64; SQUARE] {
    if q.iter().all(|v| *v == 0.0) {
        return *added;
    }
    let mut half = [0.0; SQUARE];
    for i in 0..CORE {
        for k in 0..CORE {
            let a = rows[i * w + k];
            for j in 0..CORE {
                half[i * CORE + j] += a * q[k * CORE + j];
            }
        }
    }
    let mut out = *added;
    for i in 0..CORE {
        for j in 0..CORE {
            for k in 0..CORE {
                out[i * CORE + j] += half[i * CORE + k] * rows[j * w + k];
            }
        }
    }
    out
}

/// Records a pass whose parameters are held.
pub(crate) struct Recorder {
    open: Interval,
    pub(crate) steps: Vec<Step>,
}

impl Recorder {
    /// Of a pass with so many parameters.
    pub(crate) fn new(parameters: usize) -> Self {
        Self { open: Interval::new(parameters), steps: Vec::new() }
    }
}

impl Trace for Recorder {
    fn moved(&mut self, step: &Moved) {
        let w = self.open.width;
        let mut rows = Vec::with_capacity(CORE * w);
        for row in step.rows.chunks_exact(w - 1) {
            rows.extend_from_slice(row);
            rows.push(0.0);
        }
        self.open.append(rows, &step.gyro_noise, &step.accel_noise, step.elapsed);
    }

    fn widened(&mut self, variances: &[f64; CORE]) {
        for i in 0..CORE {
            self.open.accel_noise[i * CORE + i] += variances[i];
        }
    }

    fn measured(&mut self, measured: &Measured) {
        let (rows, gyro_noise, accel_noise, elapsed) = self.open.take();
        let signals = measured.signals;
        let mut step = Step {
            time: measured.time,
            elapsed,
            rows,
            gyro_noise,
            accel_noise,
            h: Vec::with_capacity(measured.rows.len() * self.open.width),
            z: Vec::new(),
            r: Vec::new(),
            channel: Vec::new(),
            motion: Motion::from(signals),
        };
        for row in measured.rows {
            step.h.extend_from_slice(&row.h);
            step.z.push(row.z);
            step.r.push(row.r);
            step.channel.push(row.channel);
        }
        self.steps.push(step);
    }

    fn fed_back(&mut self, correction: &[f64; CORE]) {
        self.open.feed_back(correction);
    }
}
