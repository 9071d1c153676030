//! Noise of a triad of sensors: random walks, bias instability, quantisation.

use nalgebra::Vector3;

use crate::random::{Seed, Stream};

/// Noise figures of a triad, the same on each axis, in the unit of the measured quantity (rad/s or m/s^2) and seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NoiseFigures {
    /// Angle or velocity random walk, unit sqrt(s): density of the white noise.
    pub white: f64,
    /// Standard deviation of the bias instability, modelled as a first-order Gauss-Markov process, unit.
    pub instability: f64,
    /// Its correlation time, s.
    pub correlation: f64,
    /// Random walk of the bias, unit / sqrt(s).
    pub walk: f64,
    /// Size of one count of the increments, unit s; zero for none.
    pub quantum: f64,
}

impl NoiseFigures {
    /// Standard deviation and correlation time of the wander, where there is any.
    pub(crate) fn wander(&self) -> Option<(f64, f64)> {
        (self.instability > 0.0 && self.correlation > 0.0).then_some((self.instability, self.correlation))
    }

    /// Random walk of the bias, where there is any.
    pub(crate) fn bias_walk(&self) -> Option<f64> {
        (self.walk > 0.0).then_some(self.walk)
    }
}

/// The noise of a triad as it comes along.
#[derive(Clone, Debug)]
pub(crate) struct Noise {
    figures: NoiseFigures,
    white: Stream,
    instability: Stream,
    walk: Stream,
    /// Present biases.
    correlated: Vector3<f64>,
    walked: Vector3<f64>,
    /// What has not filled a count yet.
    remainder: Vector3<f64>,
    dt: f64,
    white_step: f64,
    keep: f64,
    renew: f64,
    walk_step: f64,
}

impl Noise {
    /// The noise of triad `name` of unit `seed`, in steps of `dt` seconds.
    pub(crate) fn new(figures: &NoiseFigures, seed: Seed, name: &str, dt: f64) -> Self {
        let stream = |what: &str| Stream::in_run(seed, &format!("noise/{name}-{what}"));
        let mut instability = stream("instability");
        let correlated = if figures.instability > 0.0 {
            instability.normals() * figures.instability
        } else {
            Vector3::zeros()
        };
        let keep = if figures.correlation > 0.0 { (-dt / figures.correlation).exp() } else { 0.0 };
        Self {
            figures: *figures,
            white: stream("white"),
            instability,
            walk: stream("walk"),
            correlated,
            walked: Vector3::zeros(),
            remainder: Vector3::zeros(),
            dt,
            white_step: figures.white * dt.sqrt(),
            keep,
            renew: figures.instability * (1.0 - keep * keep).sqrt(),
            walk_step: figures.walk * dt.sqrt(),
        }
    }

    /// How far the biases have wandered by now, and how far they have walked.
    pub(crate) fn biases(&self) -> [Vector3<f64>; 2] {
        [self.correlated, self.walked]
    }

    /// Adds the noise of one step to the increments of that step.
    #[inline]
    pub(crate) fn add(&mut self, increments: &mut Vector3<f64>) {
        if self.white_step > 0.0 {
            *increments += self.white.normals() * self.white_step;
        }
        if self.renew > 0.0 {
            *increments += self.correlated * self.dt;
            self.correlated = self.correlated * self.keep + self.instability.normals() * self.renew;
        }
        if self.walk_step > 0.0 {
            *increments += self.walked * self.dt;
            self.walked += self.walk.normals() * self.walk_step;
        }
        if self.figures.quantum > 0.0 {
            let total = *increments + self.remainder;
            *increments = (total / self.figures.quantum).map(f64::round) * self.figures.quantum;
            self.remainder = total - *increments;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SEED: Seed = Seed { unit: 3, run: 0 };

    #[test]
    fn quantisation_loses_nothing() {
        let figures = NoiseFigures { quantum: 1e-3, ..NoiseFigures::default() };
        let mut noise = Noise::new(&figures, SEED, "test", 0.01);
        let (mut sum, mut true_sum) = (0.0, 0.0);
        for i in 0..1000 {
            let mut step = Vector3::repeat(1.234e-4 * f64::from(i % 7));
            true_sum += step.x;
            noise.add(&mut step);
            let counts = step.x / 1e-3;
            assert!((counts - counts.round()).abs() < 1e-9);
            sum += step.x;
            assert!((sum - true_sum).abs() <= 0.5001e-3);
        }
    }

    #[test]
    fn white_noise_has_its_density_and_instability_its_size_and_memory() {
        let n = 100_000;
        let dt = 0.02;
        let figures = NoiseFigures { white: 2.0, ..NoiseFigures::default() };
        let mut noise = Noise::new(&figures, SEED, "test", dt);
        let mut square = 0.0;
        for _ in 0..n {
            let mut step = Vector3::zeros();
            noise.add(&mut step);
            square += step.norm_squared() / 3.0;
        }
        assert!((square / f64::from(n) / (4.0 * dt) - 1.0).abs() < 0.02);

        let figures = NoiseFigures { instability: 0.5, correlation: 1.0, ..NoiseFigures::default() };
        let mut noise = Noise::new(&figures, SEED, "test", dt);
        let (mut square, mut lagged) = (0.0, 0.0);
        let mut history = std::collections::VecDeque::new();
        for _ in 0..n {
            let mut step = Vector3::zeros();
            noise.add(&mut step);
            let bias = step / dt;
            square += bias.norm_squared() / 3.0;
            history.push_back(bias);
            if history.len() > 50
                && let Some(old) = history.pop_front()
            {
                lagged += old.dot(&bias) / 3.0;
            }
        }
        let variance = square / f64::from(n);
        assert!((variance / 0.25 - 1.0).abs() < 0.1, "{variance}");
        assert!((lagged / f64::from(n) / variance - (-1.0_f64).exp()).abs() < 0.08);
    }
    /// The variance of a random walk grows by the square of its figure each second.
    #[test]
    fn a_bias_walks_as_far_as_stated() {
        let figures = NoiseFigures { walk: 0.3, ..NoiseFigures::default() };
        let (dt, steps, walks) = (0.25, 64, 3000);
        let (mut square, mut early) = (0.0, 0.0);
        for run in 0..walks {
            let mut noise = Noise::new(&figures, Seed { unit: 3, run }, "test", dt);
            for k in 0..=steps {
                let mut step = Vector3::zeros();
                noise.add(&mut step);
                let bias = (step / dt).norm_squared() / 3.0;
                square += if k == steps { bias } else { 0.0 };
                early += if k == steps / 4 { bias } else { 0.0 };
            }
        }
        // 9000 numbers tell a variance to 1.5 %
        let expected = 0.09 * dt * f64::from(steps);
        assert!((square / walks as f64 / expected - 1.0).abs() < 0.06, "{square}");
        assert!((early / walks as f64 / (0.25 * expected) - 1.0).abs() < 0.06, "{early}");
    }
}
