//! Random points, and NaN in chosen fields of them.

use nalgebra::{DMatrix, Matrix3, Rotation3, Vector3};
use sinscal::{OpenBlocks, Point, Signals};

/// Numbers for tests: a linear congruential generator.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Even between -1 and 1.
    pub(crate) fn unit(&mut self) -> f64 {
        // Knuth's MMIX constants; the high bits are the good ones.
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub(crate) fn vector(&mut self, size: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| size * self.unit())
    }
}

/// What Jacobians are evaluated at.
pub(crate) trait Inputs: Copy {
    fn random(random: &mut Random) -> Self;
    fn all_nan() -> Self;
    /// Name and place of every number.
    fn visit(&mut self, visit: &mut dyn FnMut(String, &mut f64));
}

fn visit_vectors<'a>(
    vectors: impl IntoIterator<Item = (&'a str, &'a mut Vector3<f64>)>,
    visit: &mut dyn FnMut(String, &mut f64),
) {
    for (name, vector) in vectors {
        for (axis, value) in ["x", "y", "z"].iter().zip(vector.iter_mut()) {
            visit(format!("{name}.{axis}"), value);
        }
    }
}

impl Inputs for Signals<f64> {
    fn random(random: &mut Random) -> Self {
        Self {
            rate: random.vector(2.0),
            angular_acceleration: random.vector(1.0),
            force: random.vector(20.0),
            force_rate: random.vector(20.0),
            temperature: random.vector(30.0),
            temperature_rate: random.vector(0.1),
            gyro_temperature: random.vector(30.0),
            dither: random.vector(0.05).abs(),
            coupled_dither: random.vector(0.05).abs(),
            time: 1800.0 * (random.unit() + 1.0),
            up: random.vector(1.0),
            earth_rate: random.vector(7e-5),
            earth_turn: random.vector(7e-5),
            gravity: 9.8 + 0.03 * random.unit(),
            gravity_by_latitude: 0.05 * random.unit(),
            gravity_by_height: -3e-6 * (1.0 + 0.1 * random.unit()),
            gyro_temperature_rate: random.vector(0.1),
            temperature_slope: random.vector(1e-3),
            gyro_temperature_slope: random.vector(1e-6),
            arms: random.vector(0.1),
            open: OpenBlocks::NONE,
        }
    }

    fn all_nan() -> Self {
        let v = Vector3::repeat(f64::NAN);
        Self {
            rate: v,
            angular_acceleration: v,
            force: v,
            force_rate: v,
            temperature: v,
            temperature_rate: v,
            gyro_temperature: v,
            dither: v,
            coupled_dither: v,
            time: f64::NAN,
            up: v,
            earth_rate: v,
            earth_turn: v,
            gravity: f64::NAN,
            gravity_by_latitude: f64::NAN,
            gravity_by_height: f64::NAN,
            gyro_temperature_rate: v,
            temperature_slope: v,
            gyro_temperature_slope: v,
            arms: v,
            open: OpenBlocks::NONE,
        }
    }

    fn visit(&mut self, visit: &mut dyn FnMut(String, &mut f64)) {
        // Taken apart, so that a new field cannot be forgotten here.
        let Self {
            rate,
            angular_acceleration,
            force,
            force_rate,
            temperature,
            temperature_rate,
            gyro_temperature,
            dither,
            coupled_dither,
            time,
            up,
            earth_rate,
            earth_turn,
            gravity,
            gravity_by_latitude,
            gravity_by_height,
            gyro_temperature_rate,
            temperature_slope,
            gyro_temperature_slope,
            arms,
            open: _,
        } = self;
        visit("time".to_owned(), time);
        visit("gravity".to_owned(), gravity);
        visit("gravity_by_latitude".to_owned(), gravity_by_latitude);
        visit("gravity_by_height".to_owned(), gravity_by_height);
        let vectors = [
            ("rate", rate),
            ("angular_acceleration", angular_acceleration),
            ("force", force),
            ("force_rate", force_rate),
            ("temperature", temperature),
            ("temperature_rate", temperature_rate),
            ("gyro_temperature", gyro_temperature),
            ("dither", dither),
            ("coupled_dither", coupled_dither),
            ("up", up),
            ("earth_rate", earth_rate),
            ("earth_turn", earth_turn),
            ("gyro_temperature_rate", gyro_temperature_rate),
            ("temperature_slope", temperature_slope),
            ("gyro_temperature_slope", gyro_temperature_slope),
            ("arms", arms),
        ];
        visit_vectors(vectors, visit);
    }
}

impl Inputs for Point<f64> {
    fn random(random: &mut Random) -> Self {
        Self {
            c_bn: Rotation3::from_scaled_axis(random.vector(3.0)).into_inner(),
            velocity: random.vector(300.0),
            latitude: 1.3 * random.unit(),
            height: 10_000.0 + 10_000.0 * random.unit(),
            position: random.vector(100.0),
            force_n: random.vector(20.0),
            rate_eb: random.vector(2.0),
            lever: random.vector(1.0),
            point_velocity: random.vector(10.0),
            point_acceleration: random.vector(10.0),
            point_position: random.vector(100.0),
            open: OpenBlocks::NONE,
        }
    }

    fn all_nan() -> Self {
        let v = Vector3::repeat(f64::NAN);
        Self {
            c_bn: Matrix3::repeat(f64::NAN),
            velocity: v,
            latitude: f64::NAN,
            height: f64::NAN,
            position: v,
            force_n: v,
            rate_eb: v,
            lever: v,
            point_velocity: v,
            point_acceleration: v,
            point_position: v,
            open: OpenBlocks::NONE,
        }
    }

    fn visit(&mut self, visit: &mut dyn FnMut(String, &mut f64)) {
        let Self {
            c_bn,
            velocity,
            latitude,
            height,
            position,
            force_n,
            rate_eb,
            lever,
            point_velocity,
            point_acceleration,
            point_position,
            open: _,
        } = self;
        for row in 0..3 {
            for column in 0..3 {
                visit(format!("c_bn.m{}{}", row + 1, column + 1), &mut c_bn[(row, column)]);
            }
        }
        visit("latitude".to_owned(), latitude);
        visit("height".to_owned(), height);
        let vectors = [
            ("velocity", velocity),
            ("position", position),
            ("force_n", force_n),
            ("rate_eb", rate_eb),
            ("lever", lever),
            ("point_velocity", point_velocity),
            ("point_acceleration", point_acceleration),
            ("point_position", point_position),
        ];
        visit_vectors(vectors, visit);
    }
}

/// NaN in every field that is not listed changes nothing; NaN in one that is listed shows.
pub(crate) fn poison<I: Inputs>(name: &str, listed: &[&str], at: &I, jacobian: impl Fn(&I) -> DMatrix<f64>) {
    let clean = jacobian(at);
    let mut found = 0;
    let mut poisoned = *at;
    poisoned.visit(&mut |field, value| {
        if listed.contains(&field.as_str()) {
            found += 1;
        } else {
            *value = f64::NAN;
        }
    });
    assert_eq!(found, listed.len(), "{name} lists a field that does not exist");
    assert_eq!(jacobian(&poisoned), clean, "{name} depends on a field it does not list");
    for wanted in listed {
        let mut poisoned = *at;
        poisoned.visit(&mut |field, value| {
            if field == *wanted {
                *value = f64::NAN;
            }
        });
        let shows = jacobian(&poisoned).iter().any(|v| v.is_nan());
        assert!(shows, "{name} lists {wanted} and does not depend on it");
    }
}
