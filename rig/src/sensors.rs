//! How the sensors err.
//!
//! Every effect is written out by hand as the error of the reading at one instant, from the true signals at that instant, and
//! not taken from the tables that the filters are generated from: a simulation that shared them could not show a
//! mistake in them. The delay has no formula here at all, the accelerometers are given the motion of an earlier instant.

use nalgebra::{Matrix3, Vector3};

use crate::mechanics::Felt;
use crate::truth::Truth;

type V = Vector3<f64>;

/// Motion and surroundings at one instant, as the sensors meet them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Conditions {
    /// What an ideal unit feels.
    pub(crate) felt: Felt,
    /// Of each accelerometer above the reference temperature, K.
    pub(crate) temperature: V,
    /// Its derivative, K/s.
    pub(crate) temperature_rate: V,
    /// Of each gyro above the reference temperature, K.
    pub(crate) gyro_temperature: V,
    /// Half the squares of the dither's amplitudes, (rad/s)^2, where its mean is what counts.
    pub(crate) dither: V,
    /// Time since the first sample, s.
    pub(crate) time: f64,
}

/// The errors of one unit, named as in the catalogue of effects.
#[derive(Clone, Debug, Default)]
pub(crate) struct Errors {
    gyro_matrix: Matrix3<f64>,
    gyro_bias: V,
    gyro_bias_drift: V,
    gyro_temperature_bias: V,
    gyro_g_sensitivity: V,
    gyro_scale_asymmetry: V,
    gyro_rate_nonlinearity: V,
    accel_matrix: Matrix3<f64>,
    accel_bias: V,
    accel_bias_drift: V,
    accel_quadratic: V,
    accel_cubic: V,
    accel_scale_asymmetry: V,
    accel_cross_coupling: V,
    accel_temperature_scale: V,
    accel_temperature_bias: V,
    accel_temperature_rate: V,
    /// Row i: where accelerometer i sits, from the unit's sensitive centre.
    arms: Matrix3<f64>,
    has_arms: bool,
}

impl Errors {
    /// The errors of a unit with the parameters `truth`.
    pub(crate) fn new(truth: &Truth) -> Self {
        let three = |name: &str| truth.vector(name);
        let of = |name: &str, i: usize| truth.value(name, i);
        let scale = Matrix3::from_diagonal(&three("gyro-scale"));
        let m = |i| of("gyro-misalignment", i);
        let gyro_matrix = scale + Matrix3::new(0.0, 0.0, 0.0, m(0), 0.0, 0.0, m(1), m(2), 0.0);
        let scale = Matrix3::from_diagonal(&three("accel-scale"));
        let m = |i| of("accel-misalignment", i);
        let accel_matrix = scale + Matrix3::new(0.0, m(0), m(1), m(2), 0.0, m(3), m(4), m(5), 0.0);
        let r = |i| of("inner-lever-arm", i);
        let t = |i| of("inner-lever-arm-tangential", i);
        let arms = Matrix3::new(r(0), t(0), t(1), t(2), r(1), t(3), t(4), t(5), r(2));
        Self {
            gyro_matrix,
            gyro_bias: three("gyro-bias"),
            gyro_bias_drift: three("gyro-bias-drift"),
            gyro_temperature_bias: three("gyro-temperature-bias"),
            gyro_g_sensitivity: three("gyro-g-sensitivity"),
            gyro_scale_asymmetry: three("gyro-scale-asymmetry"),
            gyro_rate_nonlinearity: three("gyro-rate-nonlinearity"),
            accel_matrix,
            accel_bias: three("accel-bias"),
            accel_bias_drift: three("accel-bias-drift"),
            accel_quadratic: three("accel-quadratic"),
            accel_cubic: three("accel-cubic"),
            accel_scale_asymmetry: three("accel-scale-asymmetry"),
            accel_cross_coupling: three("accel-cross-coupling"),
            accel_temperature_scale: three("accel-temperature-scale"),
            accel_temperature_bias: three("accel-temperature-bias"),
            accel_temperature_rate: three("accel-temperature-rate"),
            arms,
            has_arms: arms != Matrix3::zeros(),
        }
    }

    /// Where the accelerometers sit: row i is the position of accelerometer i, m.
    pub(crate) fn arms(&self) -> &Matrix3<f64> {
        &self.arms
    }

    /// What the gyros read, rad/s.
    #[inline]
    pub(crate) fn gyros(&self, s: &Conditions) -> V {
        let w = &s.felt.rate;
        let size = w.abs();
        w + self.gyro_matrix * w
            + self.gyro_bias
            + self.gyro_bias_drift * s.time
            + self.gyro_temperature_bias.component_mul(&s.gyro_temperature)
            + self.gyro_g_sensitivity.component_mul(&s.felt.force)
            + self.gyro_scale_asymmetry.component_mul(&size)
            + self.gyro_rate_nonlinearity.component_mul(&w.component_mul(&size))
    }

    /// What the accelerometers read, m/s^2, of the signals at the instant that they feel. Each one reads the specific force at
    /// its own place.
    #[inline]
    pub(crate) fn accelerometers(&self, s: &Conditions) -> V {
        let f = if self.has_arms {
            let Felt { rate, angular_acceleration, force } = &s.felt;
            force + size_effect(&self.arms, rate, angular_acceleration) + self.dither(&s.dither)
        } else {
            s.felt.force
        };
        let square = f.component_mul(&f);
        let cross = V::new(f.y * f.z, f.x * f.z, f.x * f.y);
        f + self.accel_matrix * f
            + self.accel_bias
            + self.accel_bias_drift * s.time
            + self.accel_quadratic.component_mul(&square)
            + self.accel_cubic.component_mul(&square.component_mul(&f))
            + self.accel_scale_asymmetry.component_mul(&f.abs())
            + self.accel_cross_coupling.component_mul(&cross)
            + self.accel_temperature_scale.component_mul(&s.temperature.component_mul(&f))
            + self.accel_temperature_bias.component_mul(&s.temperature)
            + self.accel_temperature_rate.component_mul(&s.temperature_rate)
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
    use sinscal::calib_core::{Block, Dynamics};
    use sinscal::*;

    use super::*;
    use crate::random::Stream;

    fn conditions(random: &mut Stream) -> Conditions {
        let felt = Felt {
            rate: random.normals(),
            angular_acceleration: random.normals(),
            force: random.normals() * 5.0,
        };
        Conditions {
            felt,
            temperature: random.normals() * 10.0,
            temperature_rate: random.normals() * 0.01,
            gyro_temperature: random.normals() * 10.0,
            dither: random.normals().abs() * 0.01,
            time: 1000.0 * random.uniform(),
        }
    }

    fn signals(at: &Conditions) -> Signals<f64> {
        Signals {
            rate: at.felt.rate,
            angular_acceleration: at.felt.angular_acceleration,
            force: at.felt.force,
            temperature: at.temperature,
            temperature_rate: at.temperature_rate,
            gyro_temperature: at.gyro_temperature,
            dither: at.dither,
            coupled_dither: at.dither,
            time: at.time,
            ..Signals::default()
        }
    }

    /// Compares the hand-written error of one effect with the Jacobian that filters use.
    fn compare<B: Block<Dynamics = Strapdown>>(effect: &str) {
        let info = sinscal::effect(effect).unwrap();
        let mut random = Stream::new(1, effect);
        for _ in 0..50 {
            let at = conditions(&mut random);
            let small = 1e-7;
            let values: Vec<f64> = info.components().iter().map(|_| small * random.normal()).collect();
            let mut expected = [0.0; 6];
            B::input_jacobian(&signals(&at), &mut |input, i, value: f64| {
                expected[input] += value * values[i]
            });
            let mut truth = Truth::default();
            truth.insert(info, values);
            let errors = Errors::new(&truth);
            let gyros = errors.gyros(&at) - at.felt.rate;
            let accelerometers = errors.accelerometers(&at) - at.felt.force;
            for i in 0..3 {
                let scale = 1e-7 * small.max(expected[i].abs()).max(expected[3 + i].abs()) + 1e-14;
                assert!((gyros[i] - expected[i]).abs() < scale, "{effect}: {} {}", gyros[i], expected[i]);
                assert!((accelerometers[i] - expected[3 + i]).abs() < scale, "{effect}");
            }
        }
    }

    #[test]
    fn effects_are_those_that_filters_model() {
        macro_rules! each {
            ($($block:ident),+) => { $(compare::<$block>(<$block as Effect>::EFFECT.name());)+ };
        }
        each!(
            GyroScale,
            GyroMisalignment,
            GyroBias,
            GyroBiasDrift,
            GyroTemperatureBias,
            GyroGSensitivity,
            GyroScaleAsymmetry,
            GyroRateNonlinearity,
            AccelScale,
            AccelMisalignment,
            AccelBias,
            AccelBiasDrift,
            AccelQuadratic,
            AccelCubic,
            AccelScaleAsymmetry,
            AccelCrossCoupling,
            AccelTemperatureScale,
            AccelTemperatureBias,
            AccelTemperatureRate,
            InnerLeverArm,
            InnerLeverArmTangential
        );
        assert_eq!(Strapdown::INPUTS, 6);
    }
}
