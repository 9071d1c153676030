//! Motions of the unit, in closed form with their derivatives.

mod paths;
mod profile;
mod swing;
mod table;
mod turntable;

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

pub use paths::{Axis, NINETEEN_POSITIONS, TWO_AXIS, Turn, eighteen_rotations, turns};
pub use profile::{RoundedTrapezoid, Turning};
pub use swing::Swing;
pub use table::{Centre, Imperfections, Vibration};
pub use turntable::Turntable;

/// How the unit is turned against the Earth at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation {
    /// C_bn: turns b components into east, north, up at the site.
    pub c_bn: Matrix3<f64>,
    /// Angular rate against the Earth, omega_eb, in b, rad/s.
    pub rate: Vector3<f64>,
    /// Its derivative, rad/s^2.
    pub acceleration: Vector3<f64>,
}

impl Rotation {
    /// Stands still.
    pub fn still(c_bn: Matrix3<f64>) -> Self {
        Self { c_bn, rate: Vector3::zeros(), acceleration: Vector3::zeros() }
    }

    /// Turning about a unit vector `axis`.
    pub fn about(axis: &Vector3<f64>, turning: &Turning) -> Self {
        let (s, c) = turning.angle.sin_cos();
        let k = axis.cross_matrix();
        Self {
            c_bn: Matrix3::identity() + k * s + k * k * (1.0 - c),
            rate: axis * turning.rate,
            acceleration: axis * turning.acceleration,
        }
    }

    /// This rotation carrying `inner`: C = C_outer C_inner.
    pub fn carrying(&self, inner: &Self) -> Self {
        let back = inner.c_bn.transpose();
        let carried = back * self.rate;
        Self {
            c_bn: self.c_bn * inner.c_bn,
            rate: carried + inner.rate,
            acceleration: back * self.acceleration + inner.acceleration - inner.rate.cross(&carried),
        }
    }

    /// C_bn as a quaternion.
    pub fn attitude(&self) -> UnitQuaternion<f64> {
        UnitQuaternion::from_rotation_matrix(&nalgebra::Rotation3::from_matrix_unchecked(self.c_bn))
    }
}

/// What the unit is put through.
#[derive(Clone, Debug)]
pub enum Motion {
    /// It stands still.
    Still(Matrix3<f64>),
    /// A table turns it from one position to the next.
    Turntable(Turntable),
    /// It rocks about three axes.
    Swing(Swing),
}

impl Motion {
    /// The rotation at time `t`, any time.
    #[inline]
    pub fn at(&self, t: f64) -> Rotation {
        match self {
            Self::Still(c_bn) => Rotation::still(*c_bn),
            Self::Turntable(turntable) => turntable.at(t),
            Self::Swing(swing) => swing.at(t),
        }
    }

    /// Angle about each axis that the table has turned since the beginning, for imperfections that go with it.
    pub fn gimbals(&self, t: f64) -> [Turning; 3] {
        match self {
            Self::Still(_) => [Turning::default(); 3],
            Self::Turntable(turntable) => turntable.gimbals(t),
            Self::Swing(swing) => swing.gimbals(t),
        }
    }
}

/// Compares analytic derivatives of a motion with central differences.
#[cfg(test)]
pub(crate) fn check_derivatives(at: impl Fn(f64) -> Rotation, times: impl Iterator<Item = f64>) {
    let step = 1e-5;
    for t in times {
        let (before, now, after) = (at(t - step), at(t), at(t + step));
        let c_dot = (after.c_bn - before.c_bn) / (2.0 * step);
        assert!((c_dot - now.c_bn * now.rate.cross_matrix()).norm() < 1e-7, "C' at {t}");
        let rate_dot = (after.rate - before.rate) / (2.0 * step);
        assert!(
            (rate_dot - now.acceleration).norm() < 1e-6,
            "omega' at {t}: {rate_dot} {}",
            now.acceleration
        );
        assert!((now.c_bn * now.c_bn.transpose() - Matrix3::identity()).norm() < 1e-12);
    }
}
