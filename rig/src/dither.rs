//! Dither of the gyros at its own rate, felt by the accelerometers.
//!
//! The sensor block turns about each axis with rate `a sin(phi)`, phi growing at the dither's frequency. Amplitude and frequency
//! are drawn anew at the beginning of each cycle, where the rate is zero: the rate stays continuous, and within a cycle rate and
//! angular acceleration are exact derivatives of each other. The gyros' output is free of dither (they take it out
//! themselves); the accelerometers' is averaged over the sampling interval and twice more over the same length (a
//! third-order comb filter, centred, without delay) before it is decimated.

use std::f64::consts::TAU;

use nalgebra::{Matrix3, Vector3};

use crate::environment::Amplitudes;
use crate::random::Stream;
use crate::scenario::DitherPlan;
use crate::sensors::size_effect;

/// One gyro's dither.
#[derive(Clone, Debug)]
struct Oscillator {
    phase: f64,
    frequency: f64,
    factor: f64,
    random: Stream,
}

/// The sensor block's motion by dither of three gyros.
#[derive(Clone, Debug)]
pub struct DitherMotion {
    axes: [Oscillator; 3],
    mean_frequency: Vector3<f64>,
    frequency_noise: f64,
    modulation: f64,
    /// Makes the mean square of the modulated amplitude that of the unmodulated one.
    normal: f64,
    dt: f64,
}

impl DitherMotion {
    /// The dither of unit `seed`, in steps of `dt` seconds.
    pub fn new(plan: &DitherPlan, seed: u64, dt: f64) -> Self {
        let normal = 1.0 / (1.0 + plan.modulation * plan.modulation).sqrt();
        let axes = ["x", "y", "z"].map(|axis| {
            let mut random = Stream::new(seed, &format!("dither/cycles-{axis}"));
            Oscillator { phase: TAU * random.uniform(), frequency: 0.0, factor: normal, random }
        });
        let mut motion = Self {
            axes,
            mean_frequency: plan.frequency,
            frequency_noise: plan.frequency_noise,
            modulation: plan.modulation,
            normal,
            dt,
        };
        for i in 0..3 {
            motion.axes[i].frequency = motion.mean_frequency[i];
        }
        motion
    }

    /// Sets the phases, rad.
    pub fn with_phases(mut self, phases: &Vector3<f64>) -> Self {
        for (axis, phase) in self.axes.iter_mut().zip(phases.iter()) {
            axis.phase = *phase;
        }
        self
    }

    /// Rate (rad/s) and angular acceleration (rad/s^2) now, with `amplitudes` in rad/s; moves on by one step.
    #[inline]
    pub fn step(&mut self, amplitudes: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
        let (mut rate, mut acceleration) = (Vector3::zeros(), Vector3::zeros());
        for i in 0..3 {
            let axis = &mut self.axes[i];
            let (s, c) = axis.phase.sin_cos();
            let amplitude = amplitudes[i] * axis.factor;
            let w = TAU * axis.frequency;
            rate[i] = amplitude * s;
            acceleration[i] = amplitude * w * c;
            axis.phase += w * self.dt;
            if axis.phase >= TAU {
                axis.phase -= TAU;
                if self.modulation > 0.0 {
                    axis.factor = self.normal * (1.0 + self.modulation * axis.random.normal());
                }
                if self.frequency_noise > 0.0 {
                    // a bounded draw keeps the frequency positive
                    let noise = self.frequency_noise * axis.random.normal().clamp(-5.0, 5.0);
                    axis.frequency = self.mean_frequency[i] + noise;
                }
            }
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
        seed: u64,
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
    pub(crate) fn increment(&mut self, k: u64, base: impl Fn(f64) -> (Vector3<f64>, Vector3<f64>)) -> Vector3<f64> {
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
