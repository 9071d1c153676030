//! Rocking about three axes at once.

use std::f64::consts::TAU;

use nalgebra::{Matrix3, Vector3};

use super::{Rotation, Turning};

/// Rocking: `C = C_start R_z R_x R_y`, the angle about each axis a sine.
///
/// The order is that of heading, pitch and roll; for the small angles of a rocking table it does not matter.
#[derive(Clone, Debug)]
pub struct Swing {
    /// Attitude about which it rocks.
    pub start: Matrix3<f64>,
    /// Amplitudes about x, y, z, rad.
    pub amplitude: Vector3<f64>,
    /// Frequencies, Hz.
    pub frequency: Vector3<f64>,
    /// Phases at time zero, rad.
    pub phase: Vector3<f64>,
}

impl Swing {
    /// The rotation at time `t`.
    #[inline]
    pub fn at(&self, t: f64) -> Rotation {
        let [x, y, z] = self.gimbals(t);
        let heading = Rotation::about(&Vector3::z(), &z);
        let outer = Rotation { c_bn: self.start * heading.c_bn, ..heading };
        outer.carrying(&Rotation::about(&Vector3::x(), &x)).carrying(&Rotation::about(&Vector3::y(), &y))
    }

    /// The angles about x, y and z.
    #[inline]
    pub(super) fn gimbals(&self, t: f64) -> [Turning; 3] {
        [0, 1, 2].map(|i| sine(self.amplitude[i], self.frequency[i], self.phase[i], t))
    }
}

/// `amplitude sin(2 pi frequency t + phase)` and its derivatives.
#[inline]
pub(super) fn sine(amplitude: f64, frequency: f64, phase: f64, t: f64) -> Turning {
    let w = TAU * frequency;
    let (s, c) = (w * t + phase).sin_cos();
    Turning { angle: amplitude * s, rate: amplitude * w * c, acceleration: -amplitude * w * w * s }
}

#[cfg(test)]
mod tests {
    use super::super::check_derivatives;
    use super::*;

    #[test]
    fn derivatives_agree_with_differences() {
        let start = sinscal::path::attitude(b"NED").unwrap().to_rotation_matrix().into_inner();
        let swing = Swing {
            start,
            amplitude: Vector3::new(0.1, 0.7, 0.3),
            frequency: Vector3::new(0.4, 0.3, 0.45),
            phase: Vector3::new(0.0, 1.0, 2.0),
        };
        check_derivatives(|t| swing.at(t), (0..500).map(|i| f64::from(i) * 0.0317));
    }
}
