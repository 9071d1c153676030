//! What might be missing that is in no library: families of products of what was measured.

use sinscal::Motion;

use crate::linear::Priced;
use crate::prices::Group;
use crate::recording::{CORE, Recording, Step};

/// Faster than this the unit turns, rad/s.
pub(crate) const TURNING: f64 = 0.01;
/// Size of a family's effect before it is seen, as a fraction of the prior of the bias it changes.
pub(crate) const SIZE: f64 = 0.05;
/// The same of a bias that is there for a stretch: what lasts a minute must be larger to show.
const SIZE_OF_STRETCH: f64 = 0.5;

/// What a family multiplies: the motion and the time since the last rotation.
pub(crate) struct Moment<'a> {
    pub(crate) motion: &'a Motion,
    pub(crate) since_rotation: Option<f64>,
}

type Feature = fn(&Moment, usize, usize, usize) -> f64;

/// Families of both triads; i is the sensor's own axis, j and k the next two.
const BOTH: &[(&str, &str, Feature)] = &[
    ("omega^2", "(rad/s)^2", |m, _, _, _| m.motion.rate.norm_squared()),
    ("|omega|", "rad/s", |m, _, _, _| m.motion.rate.norm()),
    ("omega_j omega_k", "(rad/s)^2", |m, _, j, k| m.motion.rate[j] * m.motion.rate[k]),
    ("omega_i omega_j", "(rad/s)^2", |m, i, j, _| m.motion.rate[i] * m.motion.rate[j]),
    ("omega_i omega_k", "(rad/s)^2", |m, i, _, k| m.motion.rate[i] * m.motion.rate[k]),
    ("f_i f_j", "(m/s^2)^2", |m, i, j, _| m.motion.force[i] * m.motion.force[j]),
    ("f_i f_k", "(m/s^2)^2", |m, i, _, k| m.motion.force[i] * m.motion.force[k]),
    ("f_j^2", "(m/s^2)^2", |m, _, j, _| m.motion.force[j].powi(2)),
    ("omega_i f_i", "rad m/s^3", |m, i, _, _| m.motion.rate[i] * m.motion.force[i]),
    ("omega_i f_j", "rad m/s^3", |m, i, j, _| m.motion.rate[i] * m.motion.force[j]),
    ("omega_i f_k", "rad m/s^3", |m, i, _, k| m.motion.rate[i] * m.motion.force[k]),
    ("|omega| f_i", "rad m/s^3", |m, i, _, _| m.motion.rate.norm() * m.motion.force[i]),
    ("(T - T_ref) f_i^2", "K (m/s^2)^2", |m, i, _, _| m.motion.temperature[i] * m.motion.force[i].powi(2)),
    ("(dT/dt)^2", "(K/s)^2", |m, i, _, _| m.motion.temperature_rate[i].powi(2)),
    ("(T - T_ref)^3", "K^3", |m, i, _, _| m.motion.temperature[i].powi(3)),
    ("(T - T_ref)^2", "K^2", |m, i, _, _| m.motion.temperature[i].powi(2)),
    ("(T - T_ref) f_j", "K m/s^2", |m, i, j, _| m.motion.temperature[i] * m.motion.force[j]),
    ("(T - T_ref) f_k", "K m/s^2", |m, i, _, k| m.motion.temperature[i] * m.motion.force[k]),
    ("(T - T_ref) omega_i", "K rad/s", |m, i, _, _| m.motion.temperature[i] * m.motion.rate[i]),
    ("dT/dt f_i", "K m/s^3", |m, i, _, _| m.motion.temperature_rate[i] * m.motion.force[i]),
    ("difference of temperatures", "K", |m, _, j, k| m.motion.temperature[j] - m.motion.temperature[k]),
    ("A_i^2", "(rad/s)^2", |m, i, _, _| 2.0 * m.motion.dither[i]),
    ("A_i^2 f_i", "(rad/s)^2 m/s^2", |m, i, _, _| 2.0 * m.motion.dither[i] * m.motion.force[i]),
    ("t^2", "s^2", |m, _, _, _| m.motion.time * m.motion.time),
    ("t f_i", "m/s", |m, i, _, _| m.motion.time * m.motion.force[i]),
    ("t omega_i", "rad", |m, i, _, _| m.motion.time * m.motion.rate[i]),
    ("warm-up within 300 s", "1", |m, _, _, _| (-m.motion.time / 300.0).exp()),
    ("warm-up within 1000 s", "1", |m, _, _, _| (-m.motion.time / 1000.0).exp()),
    ("exp-like transient after rotation, 10 s", "1", |m, _, _, _| transient(m, 10.0)),
    ("exp-like transient after rotation, 30 s", "1", |m, _, _, _| transient(m, 30.0)),
    ("exp-like transient after rotation, 100 s", "1", |m, _, _, _| transient(m, 100.0)),
    ("exp-like transient after rotation, 300 s", "1", |m, _, _, _| transient(m, 300.0)),
    ("transient of the scale factor after rotation, 100 s", "m/s^2", |m, i, _, _| {
        transient(m, 100.0) * m.motion.force[i]
    }),
];

/// Families of the accelerometers alone.
const ACCEL: &[(&str, &str, Feature)] = &[
    ("omega_j f_k", "rad m/s^3", |m, _, j, k| m.motion.rate[j] * m.motion.force[k]),
    ("omega_k f_j", "rad m/s^3", |m, _, j, k| m.motion.rate[k] * m.motion.force[j]),
    ("omega_i", "rad/s", |m, i, _, _| m.motion.rate[i]),
    ("omega_i^2", "(rad/s)^2", |m, i, _, _| m.motion.rate[i].powi(2)),
    ("f_i^4", "(m/s^2)^4", |m, i, _, _| m.motion.force[i].powi(4)),
];

/// Families of the gyros alone.
const GYRO: &[(&str, &str, Feature)] = &[
    ("f_j", "m/s^2", |m, _, j, _| m.motion.force[j]),
    ("f_k", "m/s^2", |m, _, _, k| m.motion.force[k]),
    ("f_i^2", "(m/s^2)^2", |m, i, _, _| m.motion.force[i].powi(2)),
    ("f_j f_k", "(m/s^2)^2", |m, _, j, k| m.motion.force[j] * m.motion.force[k]),
    ("omega_i^3", "(rad/s)^3", |m, i, _, _| m.motion.rate[i].powi(3)),
    ("omega_i^2", "(rad/s)^2", |m, i, _, _| m.motion.rate[i].powi(2)),
    ("dT/dt", "K/s", |m, i, _, _| m.motion.temperature_rate[i]),
];

fn transient(m: &Moment, tau: f64) -> f64 {
    m.since_rotation.map_or(0.0, |s| (-s / tau).exp())
}

struct Entry {
    column: usize,
    value: Vec<f64>,
}

/// The sensors whose biases change.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triad {
    pub(crate) name: &'static str,
    /// Columns of its biases in the recording.
    pub(crate) columns: [usize; 3],
    families: &'static [(&'static str, &'static str, Feature)],
}

impl Triad {
    /// Those whose biases the filter estimates.
    pub(crate) fn all(recording: &Recording) -> Vec<Self> {
        [("accelerometer", "accel-bias", ACCEL), ("gyro", "gyro-bias", GYRO)]
            .into_iter()
            .filter_map(|(name, bias, families)| {
                let is =
                    |c: &usize| recording.columns[*c].info.block == bias && recording.columns[*c].prior > 0.0;
                let columns: Vec<usize> = (0..recording.columns.len()).filter(is).collect();
                Some(Self { name, columns: columns.try_into().ok()?, families })
            })
            .collect()
    }
}

/// Columns that are biases which change: with what was measured, or from one cell of time to the next.
pub(crate) struct Dictionary<'a> {
    entries: Vec<Entry>,
    /// The families, by columns.
    pub(crate) groups: Vec<Group>,
    pub(crate) sigma: Vec<f64>,
    /// Unit of each group's values.
    pub(crate) units: Vec<String>,
    /// Root mean square of each column's feature, by which it is divided.
    pub(crate) rms: Vec<f64>,
    /// Recorded columns priced after all others.
    library: &'a [usize],
    /// Whether the products of all columns are summed.
    pub(crate) is_summed: bool,
}

impl<'a> Dictionary<'a> {
    /// Nothing but the recorded columns `library`.
    pub(crate) fn new(library: &'a [usize]) -> Self {
        Self {
            entries: Vec::new(),
            groups: Vec::new(),
            sigma: Vec::new(),
            units: Vec::new(),
            rms: Vec::new(),
            library,
            is_summed: true,
        }
    }

    /// Adds the families of a triad.
    pub(crate) fn add_families(&mut self, recording: &Recording, triad: &Triad) {
        for (name, unit, feature) in BOTH.iter().chain(triad.families) {
            self.add(recording, triad, name, unit, *feature);
        }
    }

    /// Adds a bias of its own in each cell of time between two `bounds`: cell by cell, axis by axis.
    pub(crate) fn add_cells(&mut self, recording: &Recording, triad: &Triad, bounds: &[f64]) {
        for cell in bounds.windows(2) {
            let inside = |step: &Step| {
                let both = step.time.min(cell[1]) - (step.time - step.elapsed).max(cell[0]);
                if step.elapsed > 0.0 { (both / step.elapsed).clamp(0.0, 1.0) } else { 0.0 }
            };
            let value: Vec<f64> = recording.steps.iter().map(inside).collect();
            for column in triad.columns {
                self.push(column, value.clone(), SIZE_OF_STRETCH * recording.columns[column].prior, 1.0);
            }
        }
    }

    pub(crate) fn push(&mut self, column: usize, value: Vec<f64>, sigma: f64, rms: f64) {
        self.entries.push(Entry { column, value });
        self.sigma.push(sigma);
        self.rms.push(rms);
    }

    fn add(&mut self, recording: &Recording, triad: &Triad, name: &str, unit: &str, feature: Feature) {
        let mut axes = Vec::new();
        for i in 0..3 {
            let mut value = along(recording, |m| feature(m, i, (i + 1) % 3, (i + 2) % 3));
            let rms = (value.iter().map(|v| v * v).sum::<f64>() / value.len().max(1) as f64).sqrt();
            if rms.is_nan() || rms < 1e-12 {
                return;
            }
            for v in &mut value {
                *v /= rms;
            }
            axes.push((value, rms));
        }
        let first = self.entries.len();
        for ((value, rms), column) in axes.into_iter().zip(triad.columns) {
            self.push(column, value, SIZE * recording.columns[column].prior, rms);
        }
        self.groups.push(Group {
            name: format!("{name} in the {}s", triad.name),
            members: (first..self.entries.len()).collect(),
        });
        self.units.push(format!("({})/({unit})", recording.columns[triad.columns[0]].info.unit));
    }

    /// Number of columns of its own; the library's come after them.
    pub(crate) fn own(&self) -> usize {
        self.entries.len()
    }
}

/// A feature over the steps of a recording: the mean of both ends of each.
pub(crate) fn along(recording: &Recording, feature: impl Fn(&Moment) -> f64) -> Vec<f64> {
    let of_log = |steps: &[Step]| {
        let mut ended = None;
        let mut before = None;
        let each = steps.iter().map(|s| {
            if s.motion.rate.norm() > TURNING {
                ended = Some(s.time);
            }
            let since_rotation = ended.map(|e| s.time - e).filter(|d| *d > 0.0);
            let now = feature(&Moment { motion: &s.motion, since_rotation });
            let mean = 0.5 * (now + before.unwrap_or(now));
            before = Some(now);
            mean
        });
        each.collect::<Vec<f64>>()
    };
    recording.logs().flat_map(of_log).collect()
}

impl Priced for Dictionary<'_> {
    fn count(&self) -> usize {
        self.entries.len() + self.library.len()
    }

    fn is_summed(&self) -> bool {
        self.is_summed
    }

    fn fill(&self, at: usize, step: &Step, width: usize, gamma: &mut [f64], direct: &mut [f64]) {
        let nc = self.count() + 1;
        let own = self.entries.len();
        for (matrix, source, stride, rows) in
            [(gamma, &step.rows, width, CORE), (direct, &step.h, width - 1, step.z.len())]
        {
            for i in 0..rows {
                let row = &source[i * stride + CORE..];
                let out = &mut matrix[i * nc + 1..(i + 1) * nc];
                for (o, e) in out.iter_mut().zip(&self.entries) {
                    *o = row[e.column] * e.value[at];
                }
                for (o, c) in out[own..].iter_mut().zip(self.library) {
                    *o = row[*c];
                }
            }
        }
    }
}
