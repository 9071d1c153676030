//! Surroundings: temperature and the slow change of the dither's amplitude.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use crate::random::{Seed, Stream};

/// Temperature around the sensors over time.
#[derive(Clone, Debug, PartialEq)]
pub enum TemperatureProfile {
    /// Always the same, degC.
    Constant(f64),
    /// `start + rise (1 - exp(-t / time_constant))`.
    WarmUp {
        /// degC.
        start: f64,
        /// K.
        rise: f64,
        /// s.
        time_constant: f64,
    },
    /// Linear between points of time (s) and temperature (degC), constant outside.
    Ramps(Vec<(f64, f64)>),
}

impl TemperatureProfile {
    /// Temperature at time `t`, degC.
    pub fn at(&self, t: f64) -> f64 {
        match self {
            Self::Constant(temperature) => *temperature,
            Self::WarmUp { start, rise, time_constant } => {
                start - rise * (-t.max(0.0) / time_constant).exp_m1()
            }
            Self::Ramps(points) => {
                let i = points.partition_point(|(time, _)| *time <= t);
                match (i.checked_sub(1).and_then(|i| points.get(i)), points.get(i)) {
                    (Some((t0, a)), Some((t1, b))) => a + (b - a) * (t - t0) / (t1 - t0),
                    (Some((_, only)), None) | (None, Some((_, only))) => *only,
                    (None, None) => 0.0,
                }
            }
        }
    }
}

/// Temperatures of the sensors and what the thermometers make of them.
#[derive(Clone, Debug, PartialEq)]
pub struct TemperaturePlan {
    /// Where temperature effects vanish, degC.
    pub reference: f64,
    /// Temperature around the sensors.
    pub profile: TemperatureProfile,
    /// Of each accelerometer from the profile, K.
    pub accelerometer_offset: Vector3<f64>,
    /// Of each gyro from the profile, K.
    pub gyro_offset: Vector3<f64>,
    /// First-order lag of the sensors behind the profile, s.
    pub sensor_lag: f64,
    /// First-order lag of the thermometers behind the sensors, s.
    pub thermometer_lag: f64,
    /// Standard deviation of one reading, K.
    pub thermometer_noise: f64,
    /// Rate of the readings, Hz.
    pub rate: f64,
}

/// Follows the temperatures sample by sample.
#[derive(Clone, Debug)]
pub(crate) struct Temperatures {
    plan: TemperaturePlan,
    /// Of the thermometers at the accelerometers, and of those at the gyros.
    errors: [ThermometerErrors; 2],
    around: f64,
    /// At the beginning of the interval and at its end, without the offsets.
    before: f64,
    now: f64,
    thermometer: f64,
    noise: Stream,
    dt: f64,
}

/// Follows `from -> to` over `dt` with first-order lag `lag`; exact for a linear input.
fn follow(value: f64, from: f64, to: f64, lag: f64, dt: f64) -> f64 {
    if lag <= 0.0 {
        return to;
    }
    let slope = (to - from) / dt;
    to - slope * lag + (value - from + slope * lag) * (-dt / lag).exp()
}

/// What is wrong with the thermometers of a triad, as the effects of these names have it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ThermometerErrors {
    /// s.
    pub(crate) lag: f64,
    pub(crate) scale: f64,
    /// K.
    pub(crate) offset: f64,
}

impl Temperatures {
    pub(crate) fn new(plan: &TemperaturePlan, errors: [ThermometerErrors; 2], seed: Seed, dt: f64) -> Self {
        let start = plan.profile.at(0.0);
        let noise = Stream::in_run(seed, "noise/thermometers");
        Self {
            plan: plan.clone(),
            errors,
            around: start,
            before: start,
            now: start,
            thermometer: start,
            noise,
            dt,
        }
    }

    /// Moves on to the interval that ends at `time`.
    pub(crate) fn advance(&mut self, time: f64) {
        self.advance_over(time, self.dt);
    }

    /// Moves on to the interval of `dt` seconds that ends at `time`.
    pub(crate) fn advance_over(&mut self, time: f64, dt: f64) {
        let around = self.plan.profile.at(time);
        self.before = self.now;
        self.now = follow(self.before, self.around, around, self.plan.sensor_lag, dt);
        self.thermometer = follow(self.thermometer, self.before, self.now, self.plan.thermometer_lag, dt);
        self.around = around;
        self.dt = dt;
    }

    /// Temperatures above the reference of accelerometers and gyros, `part` of the way through the interval, K.
    #[inline]
    pub(crate) fn at(&self, part: f64) -> (Vector3<f64>, Vector3<f64>) {
        let above = self.before + (self.now - self.before) * part - self.plan.reference;
        (self.plan.accelerometer_offset.add_scalar(above), self.plan.gyro_offset.add_scalar(above))
    }

    /// Rate of change, K/s.
    pub(crate) fn rate(&self) -> f64 {
        (self.now - self.before) / self.dt
    }

    /// Readings at the end of the interval: accelerometers and gyros, degC.
    pub(crate) fn read(&mut self) -> (Vector3<f64>, Vector3<f64>) {
        let rate = self.rate();
        let mut reading = |offset: &Vector3<f64>, errors: &ThermometerErrors| {
            let noise = if self.plan.thermometer_noise > 0.0 {
                self.noise.normals() * self.plan.thermometer_noise
            } else {
                Vector3::zeros()
            };
            let ThermometerErrors { lag, scale, offset: too_high } = *errors;
            let there = offset.add_scalar(self.thermometer);
            let read = there + there.add_scalar(-self.plan.reference) * scale;
            read.add_scalar(too_high - lag * rate) + noise
        };
        let [accelerometers, gyros] = &self.errors;
        (reading(&self.plan.accelerometer_offset, accelerometers), reading(&self.plan.gyro_offset, gyros))
    }
}

/// Slow change of the dither's amplitudes: `A (1 + change sin(2 pi t / period + phase))`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Amplitudes {
    /// Mean amplitudes about x, y, z, rad/s.
    pub mean: Vector3<f64>,
    /// Relative change.
    pub change: f64,
    /// s.
    pub period: f64,
    /// rad.
    pub phase: Vector3<f64>,
}

impl Amplitudes {
    /// The amplitudes at time `t`, rad/s.
    pub fn at(&self, t: f64) -> Vector3<f64> {
        Vector3::from_fn(|i, _| {
            self.mean[i] * (1.0 + self.change * (TAU * t / self.period + self.phase[i]).sin())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ramps_are_linear_between_points_and_constant_outside() {
        let ramps = TemperatureProfile::Ramps(vec![(10.0, 20.0), (20.0, 40.0), (30.0, 35.0)]);
        let at = [0.0, 10.0, 15.0, 20.0, 25.0, 99.0].map(|t| ramps.at(t));
        assert_eq!(at, [20.0, 20.0, 30.0, 40.0, 37.5, 35.0]);
    }

    #[test]
    fn warm_up_reaches_63_percent_after_its_time_constant() {
        let warm_up = TemperatureProfile::WarmUp { start: 20.0, rise: 10.0, time_constant: 100.0 };
        assert_eq!(warm_up.at(0.0), 20.0);
        assert!((warm_up.at(100.0) - (30.0 - 10.0 / std::f64::consts::E)).abs() < 1e-12);
    }

    #[test]
    fn a_lagging_sensor_follows_a_ramp_at_the_distance_of_its_lag() {
        let plan = TemperaturePlan {
            reference: 25.0,
            profile: TemperatureProfile::Ramps(vec![(0.0, 20.0), (10_000.0, 120.0)]),
            accelerometer_offset: Vector3::zeros(),
            gyro_offset: Vector3::zeros(),
            sensor_lag: 200.0,
            thermometer_lag: 50.0,
            thermometer_noise: 0.0,
            rate: 1.0,
        };
        let mut temperatures = Temperatures::new(&plan, Default::default(), Seed { unit: 1, run: 0 }, 0.1);
        for k in 1..=50_000 {
            temperatures.advance(f64::from(k) * 0.1);
        }
        let around = plan.profile.at(5000.0);
        let (sensor, _) = temperatures.at(1.0);
        assert!((sensor.x + 25.0 - (around - 2.0)).abs() < 1e-6);
        assert!((temperatures.read().0.x - (around - 2.5)).abs() < 1e-6);
        assert!((temperatures.rate() - 0.01).abs() < 1e-9);
    }
}
