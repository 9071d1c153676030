//! What might be missing that is in no library: families of products of what was measured.

use crate::linear::Priced;
use crate::prices::Group;
use crate::recording::{CORE, Motion, Recording, Step};

/// Faster than this the unit turns, rad/s.
pub(crate) const TURNING: f64 = 0.01;
/// Size of a family's effect before it is seen, as a fraction of the prior of the bias it changes.
const SIZE: f64 = 0.05;
/// Name of the family of all steps.
pub(crate) const RANDOM_WALK: &str = "random walk of the bias";
/// The log is cut into so many stretches, each with a bias of its own.
const STRETCHES: usize = 8;

/// What a family multiplies: the motion, the time and the time since the last rotation.
struct Moment<'a> {
    motion: &'a Motion,
    time: f64,
    fraction: f64,
    since_rotation: Option<f64>,
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
    ("(T - T_ref)^2", "K^2", |m, i, _, _| m.motion.temperature[i].powi(2)),
    ("(T - T_ref) f_j", "K m/s^2", |m, i, j, _| m.motion.temperature[i] * m.motion.force[j]),
    ("(T - T_ref) f_k", "K m/s^2", |m, i, _, k| m.motion.temperature[i] * m.motion.force[k]),
    ("(T - T_ref) omega_i", "K rad/s", |m, i, _, _| m.motion.temperature[i] * m.motion.rate[i]),
    ("dT/dt f_i", "K m/s^3", |m, i, _, _| m.motion.temperature_rate[i] * m.motion.force[i]),
    ("difference of temperatures", "K", |m, _, j, k| m.motion.temperature[j] - m.motion.temperature[k]),
    ("A_i^2", "(rad/s)^2", |m, i, _, _| 2.0 * m.motion.dither[i]),
    ("A_i^2 f_i", "(rad/s)^2 m/s^2", |m, i, _, _| 2.0 * m.motion.dither[i] * m.motion.force[i]),
    ("t^2", "s^2", |m, _, _, _| m.time * m.time),
    ("t f_i", "m/s", |m, i, _, _| m.time * m.motion.force[i]),
    ("t omega_i", "rad", |m, i, _, _| m.time * m.motion.rate[i]),
    ("warm-up within 300 s", "1", |m, _, _, _| (-m.time / 300.0).exp()),
    ("warm-up within 1000 s", "1", |m, _, _, _| (-m.time / 1000.0).exp()),
    ("exp-like transient after rotation, 10 s", "1", |m, _, _, _| transient(m, 10.0)),
    ("exp-like transient after rotation, 30 s", "1", |m, _, _, _| transient(m, 30.0)),
    ("exp-like transient after rotation, 100 s", "1", |m, _, _, _| transient(m, 100.0)),
    ("exp-like transient after rotation, 300 s", "1", |m, _, _, _| transient(m, 300.0)),
    ("transient of the scale factor after rotation, 100 s", "m/s^2", |m, i, _, _| {
        transient(m, 100.0) * m.motion.force[i]
    }),
    ("step after 1/8 of the run", "1", |m, _, _, _| step(m, 1)),
    ("step after 2/8 of the run", "1", |m, _, _, _| step(m, 2)),
    ("step after 3/8 of the run", "1", |m, _, _, _| step(m, 3)),
    ("step after 4/8 of the run", "1", |m, _, _, _| step(m, 4)),
    ("step after 5/8 of the run", "1", |m, _, _, _| step(m, 5)),
    ("step after 6/8 of the run", "1", |m, _, _, _| step(m, 6)),
    ("step after 7/8 of the run", "1", |m, _, _, _| step(m, 7)),
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

fn step(m: &Moment, of_eight: usize) -> f64 {
    if m.fraction >= of_eight as f64 / STRETCHES as f64 { 1.0 } else { 0.0 }
}

struct Entry {
    column: usize,
    value: Vec<f64>,
}

/// The columns of all families, as biases that change with what was measured.
pub(crate) struct Dictionary<'a> {
    entries: Vec<Entry>,
    pub(crate) groups: Vec<Group>,
    pub(crate) sigma: Vec<f64>,
    /// Unit of each group's values.
    pub(crate) units: Vec<String>,
    /// Root mean square of each column's feature, by which it is divided.
    pub(crate) rms: Vec<f64>,
    /// Recorded columns priced after the families.
    library: &'a [usize],
}

impl<'a> Dictionary<'a> {
    /// Families for a recording, and the recorded columns `library` after them.
    pub(crate) fn new(recording: &Recording, library: &'a [usize]) -> Self {
        let mut new = Self {
            entries: Vec::new(),
            groups: Vec::new(),
            sigma: Vec::new(),
            units: Vec::new(),
            rms: Vec::new(),
            library,
        };
        for (triad, bias, families) in [("accelerometer", "accel-bias", ACCEL), ("gyro", "gyro-bias", GYRO)] {
            let columns: Vec<usize> = (0..recording.columns.len())
                .filter(|c| recording.columns[*c].info.block == bias && recording.columns[*c].prior > 0.0)
                .collect();
            if columns.len() != 3 {
                continue;
            }
            for (name, unit, feature) in BOTH.iter().chain(families) {
                new.add(recording, triad, &columns, name, unit, *feature);
            }
            new.add_random_walk(triad);
        }
        new
    }

    fn add(
        &mut self,
        recording: &Recording,
        triad: &str,
        columns: &[usize],
        name: &str,
        unit: &str,
        feature: Feature,
    ) {
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
        let mut members = Vec::new();
        for ((value, rms), &column) in axes.into_iter().zip(columns) {
            members.push(self.entries.len());
            self.entries.push(Entry { column, value });
            self.sigma.push(SIZE * recording.columns[column].prior);
            self.rms.push(rms);
        }
        self.groups.push(Group { name: format!("{name} in the {triad}s"), members });
        self.units.push(format!("({})/({unit})", recording.columns[columns[0]].info.unit));
    }

    /// A walk is a sum of steps: one family of them all.
    fn add_random_walk(&mut self, triad: &str) {
        let steps = self
            .groups
            .iter()
            .enumerate()
            .filter(|(_, g)| g.name.starts_with("step") && g.name.ends_with(&format!("{triad}s")));
        let (members, units): (Vec<_>, Vec<_>) =
            steps.map(|(i, g)| (g.members.clone(), self.units[i].clone())).unzip();
        if let Some(unit) = units.into_iter().next() {
            self.groups
                .push(Group { name: format!("{RANDOM_WALK} in the {triad}s"), members: members.concat() });
            self.units.push(unit);
        }
    }

    /// Number of family columns; the library's come after them.
    pub(crate) fn own(&self) -> usize {
        self.entries.len()
    }
}

/// A feature over the steps of a recording: the mean of both ends of each.
fn along(recording: &Recording, feature: impl Fn(&Moment) -> f64) -> Vec<f64> {
    let (start, end) = recording.span();
    let length = (end - start).max(1e-9);
    let mut ended = None;
    let mut before = None;
    recording
        .steps
        .iter()
        .map(|s| {
            if s.motion.rate.norm() > TURNING {
                ended = Some(s.time);
            }
            let since_rotation = ended.map(|e| s.time - e).filter(|d| *d > 0.0);
            let time = s.time - start;
            let now = feature(&Moment { motion: &s.motion, time, fraction: time / length, since_rotation });
            let mean = 0.5 * (now + before.unwrap_or(now));
            before = Some(now);
            mean
        })
        .collect()
}

impl Priced for Dictionary<'_> {
    fn count(&self) -> usize {
        self.entries.len() + self.library.len()
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
