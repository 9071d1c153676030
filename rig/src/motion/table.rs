//! What is wrong with the table.

use nalgebra::Vector3;

use super::swing::sine;
use super::{Motion, Rotation, Turning};

/// Imperfections of a table. All zero: a perfect one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Imperfections {
    /// How far axis y leans to x, z to x, and z to y, rad: turns are about axes that are not at right angles.
    pub non_orthogonality: Vector3<f64>,
    /// Wobble of each axis, rad: while it turns by theta the unit tilts by `w sin(2 theta)` and `w (1 - cos(2 theta))` about the
    /// next two axes.
    pub wobble: Vector3<f64>,
    /// Standard deviation of the attitude that the table's encoders report, per component, rad.
    pub encoder_noise: f64,
    /// Vibration of the base.
    pub vibration: Vibration,
}

/// Sinusoidal vibration of the base along and about the axes east, north, up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vibration {
    /// Frequencies along and about each axis, Hz.
    pub frequency: Vector3<f64>,
    /// Amplitudes of the acceleration of the centre of rotation, m/s^2.
    pub acceleration: Vector3<f64>,
    /// Amplitudes of the tilting, rad.
    pub tilt: Vector3<f64>,
}

/// Motion of the centre of rotation against the Earth in n.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Centre {
    /// m.
    pub position: Vector3<f64>,
    /// m/s.
    pub velocity: Vector3<f64>,
    /// m/s^2.
    pub acceleration: Vector3<f64>,
}

impl Centre {
    /// A centre that stands still.
    pub const FIXED: Self = Self {
        position: Vector3::new(0.0, 0.0, 0.0),
        velocity: Vector3::new(0.0, 0.0, 0.0),
        acceleration: Vector3::new(0.0, 0.0, 0.0),
    };
}

impl Vibration {
    fn centre(&self, t: f64) -> Centre {
        let mut centre = Centre::FIXED;
        for i in 0..3 {
            if self.acceleration[i] != 0.0 {
                let w = std::f64::consts::TAU * self.frequency[i];
                let motion = sine(-self.acceleration[i] / (w * w), self.frequency[i], 0.0, t);
                centre.position[i] = motion.angle;
                centre.velocity[i] = motion.rate;
                centre.acceleration[i] = motion.acceleration;
            }
        }
        centre
    }

    fn turn(&self, t: f64) -> Option<Rotation> {
        let mut all: Option<Rotation> = None;
        for i in 0..3 {
            if self.tilt[i] != 0.0 {
                let mut axis = Vector3::zeros();
                axis[i] = 1.0;
                let turn = Rotation::about(&axis, &sine(self.tilt[i], self.frequency[i], 0.0, t));
                all = Some(all.map_or(turn, |outer| outer.carrying(&turn)));
            }
        }
        all
    }
}

impl Imperfections {
    /// Direction of axis `i` in its own triad.
    pub(super) fn axis(&self, i: usize) -> Vector3<f64> {
        let lean = &self.non_orthogonality;
        match i {
            0 => Vector3::x(),
            1 => Vector3::new(lean.x, 1.0, 0.0).normalize(),
            _ => Vector3::new(lean.y, lean.z, 1.0).normalize(),
        }
    }

    /// Whether the motion is just that of perfect gimbals about the given axes.
    pub fn is_rigid(&self) -> bool {
        self.wobble == Vector3::zeros() && self.vibration == Vibration::default()
    }

    /// The motion at time `t` with these imperfections.
    pub fn apply(&self, motion: &Motion, t: f64) -> (Rotation, Centre) {
        let mut rotation = motion.at(t);
        if self.wobble != Vector3::zeros() {
            let gimbals = motion.gimbals(t);
            for (i, tilt) in self.tilts(&gimbals).iter().enumerate() {
                let mut axis = Vector3::zeros();
                axis[i] = 1.0;
                rotation = rotation.carrying(&Rotation::about(&axis, tilt));
            }
        }
        if let Some(base) = self.vibration.turn(t) {
            rotation = base.carrying(&rotation);
        }
        (rotation, self.vibration.centre(t))
    }

    /// Small rotations about the body axes that go with the angles of the gimbals.
    fn tilts(&self, gimbals: &[Turning; 3]) -> [Turning; 3] {
        let mut tilts = [Turning::default(); 3];
        for (i, gimbal) in gimbals.iter().enumerate() {
            let w = self.wobble[i];
            let (s, c) = (2.0 * gimbal.angle).sin_cos();
            let (r, a) = (2.0 * gimbal.rate, 2.0 * gimbal.acceleration);
            let next = &mut tilts[(i + 1) % 3];
            next.angle += w * s;
            next.rate += w * c * r;
            next.acceleration += w * (c * a - s * r * r);
            let last = &mut tilts[(i + 2) % 3];
            last.angle += w * (1.0 - c);
            last.rate += w * s * r;
            last.acceleration += w * (s * a + c * r * r);
        }
        tilts
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;

    use super::super::{Swing, check_derivatives};
    use super::*;

    #[test]
    fn derivatives_agree_with_differences() {
        let swing = Motion::Swing(Swing {
            start: Matrix3::identity(),
            amplitude: Vector3::new(0.1, 0.2, 0.3),
            frequency: Vector3::new(0.4, 0.3, 0.45),
            phase: Vector3::zeros(),
        });
        let table = Imperfections {
            wobble: Vector3::new(1e-2, 2e-2, -1e-2),
            vibration: Vibration {
                frequency: Vector3::new(3.0, 2.0, 1.0),
                acceleration: Vector3::new(0.1, 0.0, 0.2),
                tilt: Vector3::new(1e-3, 0.0, 2e-3),
            },
            ..Imperfections::default()
        };
        let times = || (0..300).map(|i| f64::from(i) * 0.0317);
        check_derivatives(|t| table.apply(&swing, t).0, times());
        for t in times() {
            let h = 1e-5;
            let at = |t| table.apply(&swing, t).1;
            let velocity = (at(t + h).position - at(t - h).position) / (2.0 * h);
            let acceleration = (at(t + h).velocity - at(t - h).velocity) / (2.0 * h);
            assert!((velocity - at(t).velocity).norm() < 1e-8);
            assert!((acceleration - at(t).acceleration).norm() < 1e-7);
        }
    }
}
