//! How the sensors err.
//!
//! The simulator knows effects as objects: the error of a reading is the sum of [`AnyEffect::error`] over the effects that the unit
//! has, at the true signals of one instant. That a mistake in their Jacobians shows is for `tests/effects_jacobians` of the library,
//! which compares each with a model written by hand. What is not small, or where the place counts, stands here and in
//! [`Simulation`](crate::Simulation) in its true form: see [`IN_TRUE_FORM`].

use nalgebra::{Matrix3, Vector3};
use sinscal::{AnyEffect, Kind, Point, Signals};

use crate::truth::Truth;

type V = Vector3<f64>;

/// Effects that are simulated as they are, not as their Jacobian times their size: a delay shows the motion of another instant, a
/// lever arm the force at another place, which the errors of its accelerometer then act on, the reference its own frame, and what is
/// wrong with site, clock, thermometers and pick-offs is wrong there.
pub(crate) const IN_TRUE_FORM: [&str; 16] = [
    "accel-delay",
    "inner-lever-arm",
    "inner-lever-arm-tangential",
    "dither-size-effect",
    "outer-lever-arm",
    "reference-delay",
    "reference-misalignment",
    "reference-tilt",
    "clock-scale",
    "site-latitude",
    "site-height",
    "site-gravity",
    "thermometer-lag",
    "thermometer-scale",
    "thermometer-offset",
    "dither-scale",
];

/// An effect and its size.
#[derive(Clone, Debug)]
struct Acting {
    effect: &'static dyn AnyEffect,
    values: Vec<f64>,
}

/// The sensors of one unit and its reference.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sensors {
    gyros: Vec<Acting>,
    accelerometers: Vec<Acting>,
    reference: Vec<Acting>,
    /// Row i: where accelerometer i sits, from the unit's sensitive centre.
    arms: Matrix3<f64>,
    has_arms: bool,
}

impl Sensors {
    /// Those of a unit with the parameters `truth`, of `effects`.
    pub(crate) fn new(truth: &Truth, effects: impl Iterator<Item = &'static dyn AnyEffect>) -> Self {
        let r = |i| truth.value("inner-lever-arm", i);
        let t = |i| truth.value("inner-lever-arm-tangential", i);
        let arms = Matrix3::new(r(0), t(0), t(1), t(2), r(1), t(3), t(4), t(5), r(2));
        let mut sensors = Self { arms, has_arms: arms != Matrix3::zeros(), ..Self::default() };
        for effect in effects.filter(|effect| !IN_TRUE_FORM.contains(&effect.name())) {
            let values: Vec<f64> = (0..effect.dim()).map(|i| truth.value(effect.name(), i)).collect();
            if values.iter().all(|value| *value == 0.0) {
                continue;
            }
            let kind = effect.info().kind();
            let acting = Acting { effect, values };
            if kind.of_gyros() {
                sensors.gyros.push(acting.clone());
            }
            if kind.of_accelerometers() {
                sensors.accelerometers.push(acting.clone());
            }
            if kind == Kind::Measurement {
                sensors.reference.push(acting);
            }
        }
        sensors
    }

    /// Where the accelerometers sit: row i is the position of accelerometer i, m.
    pub(crate) fn arms(&self) -> &Matrix3<f64> {
        &self.arms
    }

    /// What the gyros read, rad/s.
    #[inline]
    pub(crate) fn gyros(&self, s: &Signals<f64>) -> V {
        let mut error = [0.0; 6];
        for Acting { effect, values } in &self.gyros {
            effect.error(s, values, &mut error);
        }
        s.rate + V::new(error[0], error[1], error[2])
    }

    /// What the accelerometers read, m/s^2, of the signals at the instant that they feel. Each one reads the specific force at
    /// its own place.
    #[inline]
    pub(crate) fn accelerometers(&self, mut s: Signals<f64>) -> V {
        if self.has_arms {
            s.force +=
                size_effect(&self.arms, &s.rate, &s.angular_acceleration) + self.dither(&s.coupled_dither);
        }
        let mut error = [0.0; 6];
        for Acting { effect, values } in &self.accelerometers {
            effect.error(&s, values, &mut error);
        }
        s.force + V::new(error[3], error[4], error[5])
    }

    /// Whether the reference has errors that are not in [`IN_TRUE_FORM`].
    pub(crate) fn reference_errs(&self) -> bool {
        !self.reference.is_empty()
    }

    /// Errors of the reference's velocity, position and attitude where the motion is `at`.
    pub(crate) fn reference(&self, at: &Point<f64>) -> [V; 3] {
        let mut error = [0.0; 9];
        for Acting { effect, values } in &self.reference {
            effect.reference_error(at, values, &mut error);
        }
        [0, 3, 6].map(|first| V::new(error[first], error[first + 1], error[first + 2]))
    }

    /// Mean size effect of dither with mean squares `dither` of the rate about each axis, (rad/s)^2.
    #[inline]
    fn dither(&self, dither: &V) -> V {
        let sum = dither.sum();
        V::from_fn(|i, _| -(sum - dither[i]) * self.arms[(i, i)])
    }
}

/// What accelerometers at `arms` (row i: the position of accelerometer i, m) feel beyond the specific force at the centre, by
/// rate and angular acceleration: `u_i . (omega x (omega x r_i) + omega' x r_i)`.
#[inline]
pub fn size_effect(arms: &Matrix3<f64>, rate: &V, angular_acceleration: &V) -> V {
    V::from_fn(|i, _| {
        let r = arms.row(i).transpose();
        (rate.cross(&rate.cross(&r)) + angular_acceleration.cross(&r))[i]
    })
}

#[cfg(test)]
mod tests {
    use sinscal::CATALOGUE;

    use super::*;
    use crate::random::Stream;

    fn signals(random: &mut Stream) -> Signals<f64> {
        let dither = random.normals().abs() * 0.01;
        Signals {
            rate: random.normals(),
            angular_acceleration: random.normals(),
            force: random.normals() * 5.0,
            temperature: random.normals() * 10.0,
            temperature_rate: random.normals() * 0.01,
            gyro_temperature: random.normals() * 10.0,
            dither,
            coupled_dither: dither,
            time: 1000.0 * random.uniform(),
            ..Signals::default()
        }
    }

    /// Every error of the sensors is there, to first order what filters model; the delay is tested where motion is.
    #[test]
    fn readings_err_by_the_jacobian() {
        let of_sensors = |effect: &&&'static dyn AnyEffect| {
            effect.info().kind() != Kind::Measurement
                && !sinscal::INFLUENCES.contains(&effect.name())
                && !["accel-delay", "dither-size-effect"].contains(&effect.name())
        };
        for effect in CATALOGUE.iter().filter(of_sensors) {
            let mut random = Stream::new(1, effect.name());
            for _ in 0..50 {
                let at = signals(&mut random);
                let small = 1e-7;
                let values: Vec<f64> = (0..effect.dim()).map(|_| small * random.normal()).collect();
                let mut expected = [0.0; 6];
                effect.input_jacobian(&at, &mut |input, i, value| expected[input] += value * values[i]);
                let mut truth = Truth::default();
                truth.insert(effect.info(), values);
                let sensors = Sensors::new(&truth, [*effect].into_iter());
                let gyros = sensors.gyros(&at) - at.rate;
                let accelerometers = sensors.accelerometers(at) - at.force;
                assert!(expected.iter().any(|e| *e != 0.0));
                for i in 0..3 {
                    let scale = 1e-7 * small.max(expected[i].abs()).max(expected[3 + i].abs()) + 1e-14;
                    assert!(
                        (gyros[i] - expected[i]).abs() < scale,
                        "{effect:?}: {} {}",
                        gyros[i],
                        expected[i]
                    );
                    assert!((accelerometers[i] - expected[3 + i]).abs() < scale, "{effect:?}");
                }
            }
        }
    }
}
