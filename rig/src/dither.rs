//! Dither of the gyros at its own rate, felt by the accelerometers.
//!
//! The sensor block turns about each axis with rate `a sin(phi)`, phi growing at the dither's frequency. Amplitude and frequency
//! are drawn anew at the beginning of each cycle, at the very instant where the rate is zero: the rate stays continuous. A step
//! gives the rate in its middle and the exact mean of the angular acceleration, the change of the rate over the step; so the
//! angular acceleration has no mean that the rate does not have.
//! The gyros' output is free of dither (they take it out themselves); the accelerometers' is averaged over the sampling interval
//! and twice more over the same length (a third-order comb filter, centred, without delay) before it is decimated.

use std::f64::consts::TAU;

use nalgebra::{Matrix3, Vector3};

use crate::environment::Amplitudes;
use crate::random::{Seed, Stream};
use crate::scenario::DitherPlan;
use crate::sensors::size_effect;

/// One gyro's dither.
#[derive(Clone, Debug)]
struct Oscillator {
    phase: f64,
    frequency: f64,
    factor: f64,
    /// Rate now as a share of the amplitude.
    rate: f64,
    random: Stream,
}

/// What changes from cycle to cycle.
#[derive(Clone, Copy, Debug)]
struct Cycles {
    frequency: Vector3<f64>,
    frequency_noise: f64,
    modulation: f64,
    /// Makes the mean square of the modulated amplitude that of the unmodulated one.
    normal: f64,
}

impl Oscillator {
    /// Moves on by `dt`; returns the rate there.
    #[inline]
    fn advance(&mut self, axis: usize, dt: f64, cycles: &Cycles) -> f64 {
        self.phase += TAU * self.frequency * dt;
        if self.phase >= TAU {
            let since = (self.phase - TAU) / (TAU * self.frequency);
            if cycles.modulation > 0.0 {
                self.factor = cycles.normal * (1.0 + cycles.modulation * self.random.normal());
            }
            if cycles.frequency_noise > 0.0 {
                // a bounded draw keeps the frequency positive
                let noise = cycles.frequency_noise * self.random.normal().clamp(-5.0, 5.0);
                self.frequency = cycles.frequency[axis] + noise;
            }
            self.phase = TAU * self.frequency * since;
        }
        self.rate = self.factor * self.phase.sin();
        self.rate
    }
}

/// The sensor block's motion by dither of three gyros.
#[derive(Clone, Debug)]
pub struct DitherMotion {
    axes: [Oscillator; 3],
    cycles: Cycles,
    dt: f64,
}

impl DitherMotion {
    /// The dither in a run of a unit, in steps of `dt` seconds.
    pub fn new(plan: &DitherPlan, seed: Seed, dt: f64) -> Self {
        let normal = 1.0 / (1.0 + plan.modulation * plan.modulation).sqrt();
        let axes = [0, 1, 2].map(|i| {
            let mut random =
                Stream::in_run(seed, ["dither/cycles-x", "dither/cycles-y", "dither/cycles-z"][i]);
            let phase = TAU * random.uniform();
            Oscillator {
                phase,
                frequency: plan.frequency[i],
                factor: normal,
                rate: normal * phase.sin(),
                random,
            }
        });
        let cycles = Cycles {
            frequency: plan.frequency,
            frequency_noise: plan.frequency_noise,
            modulation: plan.modulation,
            normal,
        };
        Self { axes, cycles, dt }
    }

    /// Sets the phases, rad.
    pub fn with_phases(mut self, phases: &Vector3<f64>) -> Self {
        for (axis, phase) in self.axes.iter_mut().zip(phases.iter()) {
            axis.phase = *phase;
            axis.rate = axis.factor * phase.sin();
        }
        self
    }

    /// One step with `amplitudes` in rad/s: the rate in its middle (rad/s) and the mean of the angular acceleration (rad/s^2).
    #[inline]
    pub fn step(&mut self, amplitudes: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        let (mut rate, mut acceleration) = (Vector3::zeros(), Vector3::zeros());
        for (i, axis) in self.axes.iter_mut().enumerate() {
            let before = axis.rate;
            rate[i] = amplitudes[i] * axis.advance(i, 0.5 * self.dt, &self.cycles);
            let after = axis.advance(i, 0.5 * self.dt, &self.cycles);
            acceleration[i] = amplitudes[i] * (after - before) / self.dt;
        }
        (rate, acceleration)
    }
}

/// Dither as a stream of velocity increments, one per sample.
#[derive(Clone, Debug)]
pub(crate) struct FullDither {
    motion: DitherMotion,
    amplitudes: Amplitudes,
    arms: Matrix3<f64>,
    /// Steps per sample.
    steps: usize,
    dt: f64,
    /// Index of the next interval to be simulated.
    next: i64,
    /// Filtered sums of the interval before `next - 1`, of that one, and of `next`.
    sums: [Vector3<f64>; 3],
}

impl FullDither {
    pub(crate) fn new(
        plan: &DitherPlan,
        amplitudes: &Amplitudes,
        arms: &Matrix3<f64>,
        steps: usize,
        seed: Seed,
        dt: f64,
    ) -> Self {
        Self {
            motion: DitherMotion::new(plan, seed, dt / steps as f64),
            amplitudes: *amplitudes,
            arms: *arms,
            steps,
            dt,
            next: -1,
            sums: [Vector3::zeros(); 3],
        }
    }

    /// Velocity increment of interval `k` that dither adds, asked for in order. `base` says rate and angular acceleration of
    /// the block without dither at a time.
    pub(crate) fn increment(
        &mut self,
        k: u64,
        base: impl Fn(f64) -> (Vector3<f64>, Vector3<f64>),
    ) -> Vector3<f64> {
        // the filter reaches one interval to either side
        while self.next <= k as i64 + 1 {
            self.simulate(&base);
        }
        self.sums[0] * (self.dt / self.steps as f64)
    }

    fn simulate(&mut self, base: &impl Fn(f64) -> (Vector3<f64>, Vector3<f64>)) {
        let start = self.next as f64 * self.dt;
        let amplitudes = self.amplitudes.at(start + 0.5 * self.dt);
        let (before, after) = (base(start), base(start + self.dt));
        // the sums move on by one interval
        self.sums = [self.sums[1], self.sums[2], Vector3::zeros()];
        for step in 0..self.steps {
            let u = (step as f64 + 0.5) / self.steps as f64;
            let rate = before.0.lerp(&after.0, u);
            let acceleration = before.1.lerp(&after.1, u);
            let (dither, dither_dot) = self.motion.step(&amplitudes);
            let with = size_effect(&self.arms, &(rate + dither), &(acceleration + dither_dot));
            let felt = with - size_effect(&self.arms, &rate, &acceleration);
            // quadratic B-spline about the middle of each of the three intervals
            self.sums[0] += felt * (0.5 * (1.0 - u) * (1.0 - u));
            self.sums[1] += felt * (0.75 - (u - 0.5) * (u - 0.5));
            self.sums[2] += felt * (0.5 * u * u);
        }
        self.next += 1;
    }
}
