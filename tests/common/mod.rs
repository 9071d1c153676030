//! What several tests share: numbers, a moving unit.
#![allow(dead_code, reason = "not every test uses all of the shared helpers")]

use nalgebra::{Rotation3, UnitQuaternion, Vector3};
use sinscal::{InitialAttitude, Point, Reference, ReferenceSigma, Sample, SensorNoise, Setup, Signals, Site};

/// A small linear congruential generator, uniform in -1 to 1: the tests need numbers, not statistics.
pub(crate) struct Numbers(pub(crate) u64);

impl Numbers {
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    pub(crate) fn vector(&mut self, scale: f64) -> Vector3<f64> {
        Vector3::new(self.next(), self.next(), self.next()) * scale
    }
}

pub(crate) fn setup() -> Setup<'static> {
    Setup {
        update_rate: 2.0,
        outer_lever: Vector3::new(0.1, -0.2, 0.05),
        ..Setup::new(
            100.0,
            Site { latitude: 0.56, longitude: 2.07, height: 20.0 },
            InitialAttitude {
                attitude: UnitQuaternion::from_euler_angles(0.3, -0.2, 1.1),
                level_sigma: 5e-4,
                heading_sigma: 2e-3,
            },
            ReferenceSigma { velocity: 1e-3, position: 2e-3, attitude: 1e-4 },
            SensorNoise { angle_random_walk: 3e-7, velocity_random_walk: 5e-5 },
        )
    }
}

/// True signals of a unit that turns and warms, `t` seconds into a run: smooth, no axis at rest.
pub(crate) fn signals(t: f64) -> Signals<f64> {
    let wave = |a: f64, f: f64, p: f64| (a * (f * t + p).sin(), a * f * (f * t + p).cos());
    let ((wx, ax), (wy, ay), (wz, az)) = (wave(0.3, 0.9, 0.2), wave(0.4, 0.7, 1.3), wave(-0.25, 1.1, 2.0));
    let (fz, fz_rate) = wave(1.0, 0.8, 0.0);
    let f = [wave(3.0, 0.5, 0.1), wave(4.0, 0.4, 0.9), (9.0 + fz, fz_rate)];
    Signals {
        rate: Vector3::new(wx, wy, wz),
        angular_acceleration: Vector3::new(ax, ay, az),
        force: f.map(|(f, _)| f).into(),
        force_rate: f.map(|(_, rate)| rate).into(),
        temperature: Vector3::new(2.0 + 0.01 * t, 3.0 + 0.02 * t, 5.0 - 0.01 * t),
        temperature_rate: Vector3::new(0.01, 0.02, -0.01),
        gyro_temperature: Vector3::new(2.0 + 0.01 * t, 3.0 + 0.02 * t, 5.0 - 0.01 * t),
        dither: Vector3::new(3e-3, 4e-3, 5e-3),
        coupled_dither: Vector3::new(3e-3, 4e-3, 5e-3),
        time: t,
        ..Signals::default()
    }
}

/// Somewhere on some path.
pub(crate) fn point(numbers: &mut Numbers) -> Point<f64> {
    let c_bn = Rotation3::from_scaled_axis(numbers.vector(2.0)).into_inner();
    let (rate_eb, lever, velocity) = (numbers.vector(0.5), numbers.vector(0.3), numbers.vector(2.0));
    Point {
        c_bn,
        velocity,
        latitude: 0.7 * numbers.next(),
        height: 100.0 * numbers.next(),
        position: numbers.vector(5.0),
        force_n: Vector3::new(0.1, -0.2, 9.8) + numbers.vector(1.0),
        rate_eb,
        lever,
        point_velocity: velocity + c_bn * rate_eb.cross(&lever),
        point_acceleration: numbers.vector(1.0),
        point_position: numbers.vector(5.0),
        ..Point::default()
    }
}

/// A sample with the given increments and nothing else.
pub(crate) fn sample(time: f64, dtheta: Vector3<f64>, dvel: Vector3<f64>) -> Sample {
    Sample {
        time,
        dtheta,
        dvel,
        temperature: Vector3::repeat(f64::NAN),
        gyro_temperature: Vector3::repeat(f64::NAN),
        dither: Vector3::repeat(f64::NAN),
        reference: Reference::default(),
    }
}
