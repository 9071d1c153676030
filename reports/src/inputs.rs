//! What a unit was put through: turns, forces, temperatures, dither, in memory that does not grow with the log.

use nalgebra::Vector3;
use sinscal::Sample;

use super::Section;
use crate::draw::{Curve, Figure, Style};

/// More stretches are joined in pairs.
const CAPACITY: usize = 2048;
const AXES: [&str; 3] = ["x", "y", "z"];

/// Means of the signals over even stretches of a log.
pub struct Inputs {
    /// Samples in a stretch.
    length: u32,
    stretches: Vec<Stretch>,
    open: Stretch,
    time: f64,
}

/// Sums over the samples of a stretch, and the last readings in it.
#[derive(Clone, Copy)]
struct Stretch {
    samples: u32,
    end: f64,
    duration: f64,
    dtheta: Vector3<f64>,
    dvel: Vector3<f64>,
    temperature: Vector3<f64>,
    gyro_temperature: Vector3<f64>,
    dither: Vector3<f64>,
}

impl Stretch {
    fn empty() -> Self {
        let (none, zero) = (Vector3::repeat(f64::NAN), Vector3::zeros());
        Self {
            samples: 0,
            end: f64::NAN,
            duration: 0.0,
            dtheta: zero,
            dvel: zero,
            temperature: none,
            gyro_temperature: none,
            dither: none,
        }
    }

    fn join(&mut self, later: &Self) {
        self.samples += later.samples;
        self.end = later.end;
        self.duration += later.duration;
        self.dtheta += later.dtheta;
        self.dvel += later.dvel;
        let last = |now: &mut Vector3<f64>, later: &Vector3<f64>| {
            *now = now.zip_map(later, |now, later| if later.is_nan() { now } else { later });
        };
        last(&mut self.temperature, &later.temperature);
        last(&mut self.gyro_temperature, &later.gyro_temperature);
        last(&mut self.dither, &later.dither);
    }
}

impl Default for Inputs {
    fn default() -> Self {
        Self::new()
    }
}

impl Inputs {
    /// Of no sample yet.
    pub fn new() -> Self {
        Self { length: 1, stretches: Vec::new(), open: Stretch::empty(), time: f64::NAN }
    }

    /// Takes in the next sample.
    pub fn push(&mut self, sample: &Sample) {
        let elapsed = sample.time - self.time;
        self.time = sample.time;
        // how long the first interval was is not known yet
        if elapsed.is_nan() {
            return;
        }
        self.open.join(&Stretch {
            samples: 1,
            end: sample.time,
            duration: elapsed,
            dtheta: sample.dtheta,
            dvel: sample.dvel,
            temperature: sample.temperature,
            gyro_temperature: sample.gyro_temperature,
            dither: sample.dither,
        });
        if self.open.samples < self.length {
            return;
        }
        self.stretches.push(std::mem::replace(&mut self.open, Stretch::empty()));
        if self.stretches.len() == CAPACITY {
            self.length *= 2;
            let pairs = self.stretches.chunks(2).map(|pair| {
                let mut joined = pair[0];
                pair.iter().skip(1).for_each(|later| joined.join(later));
                joined
            });
            self.stretches = pairs.collect();
        }
    }

    /// The motion and the surroundings as curves.
    pub fn section(&self) -> Section {
        let mut items = vec![
            figure(
                "rate",
                "Angular rate: the path of the turntable",
                "rate, deg/s",
                vec![self.curves("", |s| (s.dtheta / s.duration).map(f64::to_degrees))],
            ),
            figure(
                "force",
                "Specific force: which way the axes point",
                "force, m/s^2",
                vec![self.curves("", |s| s.dvel / s.duration)],
            ),
            figure(
                "temperature",
                "Temperatures",
                "temperature, degC",
                vec![
                    self.curves("accelerometer ", |s| s.temperature),
                    self.curves("gyro ", |s| s.gyro_temperature),
                ],
            ),
            figure("dither", "Amplitude of the dither", "rate, rad/s", vec![self.curves("", |s| s.dither)]),
        ];
        items.retain(|figure| !figure.curves.is_empty());
        Section::new("What the unit was put through", items.into_iter().map(Into::into).collect()).folded()
    }

    /// One curve for each axis that was read.
    fn curves(&self, name: &str, of: impl Fn(&Stretch) -> Vector3<f64>) -> Vec<Curve> {
        let values: Vec<(f64, Vector3<f64>)> = self.stretches.iter().map(|s| (s.end, of(s))).collect();
        let axis = |i: usize| {
            let points = values.iter().map(|(time, value)| (*time, value[i])).filter(|(_, y)| y.is_finite());
            Curve::new(format!("{name}{}", AXES[i]), Style::Full, points.collect())
        };
        (0..3).map(axis).filter(|curve| !curve.is_empty()).collect()
    }
}

fn figure(file: &'static str, title: &str, axis: &'static str, curves: Vec<Vec<Curve>>) -> Figure {
    let curves = curves.into_iter().flatten().collect();
    Figure { file: file.into(), title: title.into(), axes: ["time, s", axis], curves }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_are_kept_in_bounded_memory() {
        let mut inputs = Inputs::new();
        for k in 0..100_000_u32 {
            inputs.push(&Sample {
                time: f64::from(k) * 0.01,
                dtheta: Vector3::new(0.02, 0.0, 0.0),
                dvel: Vector3::zeros(),
                temperature: Vector3::repeat(if k % 100 == 0 { 30.0 } else { f64::NAN }),
                gyro_temperature: Vector3::repeat(f64::NAN),
                dither: Vector3::repeat(f64::NAN),
                reference: sinscal::Reference::default(),
            });
        }
        assert!((CAPACITY / 2 - 1..CAPACITY).contains(&inputs.stretches.len()), "{}", inputs.stretches.len());
        assert!(inputs.stretches.iter().all(|s| (s.dtheta.x / s.duration - 2.0).abs() < 1e-9));
        // rates, forces, temperatures of the accelerometers: nothing else was read
        assert_eq!(inputs.section().items.len(), 3);
    }
}
