//! What an ideal unit feels on a table fixed to the Earth.

use nalgebra::Vector3;
use sinscal::{Site, earth};

use crate::motion::{Centre, Rotation};

/// The unit's place: where the table stands and where on it the unit sits.
///
/// The centre of rotation is the origin of the site; the unit's sensitive centre is at `-C l` from it, l the outer lever arm in b.
/// Rates and forces are those against inertial space: the Earth's rotation, Coriolis acceleration, and gravity with its size
/// and direction at the unit's own position. Gravity is expanded to first order about the site; for a lever arm of 1 m that
/// leaves less than 1e-12 m/s^2.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Outer lever arm l in b, m.
    pub lever: Vector3<f64>,
    rotation_n: Vector3<f64>,
    gravity: f64,
    /// Change of gravity per metre north and up, 1/s^2.
    gradient: (f64, f64),
    /// Turning of the vertical per metre east and north, rad/m.
    curvature: (f64, f64),
}

/// What an ideal unit feels at one instant, in b.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Felt {
    /// Angular rate against inertial space, rad/s.
    pub rate: Vector3<f64>,
    /// Its derivative, rad/s^2.
    pub angular_acceleration: Vector3<f64>,
    /// Specific force at the sensitive centre, m/s^2.
    pub force: Vector3<f64>,
}

impl Place {
    /// A unit on a table at `site`, displaced by the outer lever arm `lever`.
    pub fn new(site: &Site, lever: Vector3<f64>) -> Self {
        let (meridian, prime_vertical) = earth::radii(site.latitude);
        let (meridian, prime_vertical) = (meridian + site.height, prime_vertical + site.height);
        let step = 100.0;
        let by_latitude = earth::gravity(site.latitude + step / meridian, site.height)
            - earth::gravity(site.latitude - step / meridian, site.height);
        let by_height = earth::gravity(site.latitude, site.height + step)
            - earth::gravity(site.latitude, site.height - step);
        Self {
            lever,
            rotation_n: earth::rotation_n(site.latitude),
            gravity: earth::gravity(site.latitude, site.height),
            gradient: (by_latitude / (2.0 * step), by_height / (2.0 * step)),
            curvature: (1.0 / prime_vertical, 1.0 / meridian),
        }
    }

    /// The same place with gravity stronger by `excess`, m/s^2.
    #[must_use]
    pub(crate) fn heavier(self, excess: f64) -> Self {
        Self { gravity: self.gravity + excess, ..self }
    }

    /// Position (m) and velocity (m/s) of the unit's sensitive centre in n.
    pub fn position(&self, rotation: &Rotation, centre: &Centre) -> (Vector3<f64>, Vector3<f64>) {
        (
            centre.position - rotation.c_bn * self.lever,
            centre.velocity - rotation.c_bn * rotation.rate.cross(&self.lever),
        )
    }

    /// What the unit feels while it turns and its centre of rotation moves.
    #[inline]
    pub fn felt(&self, rotation: &Rotation, centre: &Centre) -> Felt {
        let Rotation { c_bn, rate, acceleration } = rotation;
        let c_nb = c_bn.transpose();
        let earth = c_nb * self.rotation_n;
        let (position, velocity) = self.position(rotation, centre);
        let gravity = -(self.gravity + self.gradient.0 * position.y + self.gradient.1 * position.z);
        let gravity = Vector3::new(
            gravity * self.curvature.0 * position.x,
            gravity * self.curvature.1 * position.y,
            gravity,
        );
        let turning = acceleration.cross(&self.lever) + rate.cross(&rate.cross(&self.lever));
        let level = centre.acceleration + self.rotation_n.cross(&velocity) * 2.0 - gravity;
        Felt {
            rate: rate + earth,
            angular_acceleration: acceleration - rate.cross(&earth),
            force: c_nb * level - turning,
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;

    use super::*;
    use crate::motion::Swing;

    fn site() -> Site {
        Site { latitude: 0.56, longitude: 2.07, height: 20.0 }
    }

    #[test]
    fn at_rest_the_unit_feels_gravity_and_the_earths_rotation() {
        let place = Place::new(&site(), Vector3::zeros());
        let felt = place.felt(&Rotation::still(Matrix3::identity()), &Centre::FIXED);
        assert!((felt.force - Vector3::z() * earth::gravity(0.56, 20.0)).norm() < 1e-12);
        assert!((felt.rate - earth::rotation_n(0.56)).norm() < 1e-18);
    }

    #[test]
    fn force_and_acceleration_agree_with_differences_of_position_and_rate() {
        let place = Place::new(&site(), Vector3::new(0.2, -0.3, 0.5));
        let swing = Swing {
            start: Matrix3::identity(),
            amplitude: Vector3::new(0.3, 0.5, 0.2),
            frequency: Vector3::new(0.4, 0.3, 0.45),
            phase: Vector3::new(0.0, 1.0, 2.0),
        };
        let felt = |t: f64| place.felt(&swing.at(t), &Centre::FIXED);
        let motion = |t: f64| place.position(&swing.at(t), &Centre::FIXED);
        let h = 1e-4;
        for i in 0..100 {
            let t = f64::from(i) * 0.07;
            let (before, now, after) = (motion(t - h), motion(t), motion(t + h));
            assert!(((after.0 - before.0) / (2.0 * h) - now.1).norm() < 1e-6);
            let acceleration = (after.1 - before.1) / (2.0 * h);
            // f_n = a + 2 omega_ie x v - g, written out anew
            let g = -Vector3::z() * earth::gravity(0.56, 20.0);
            let expected = acceleration + 2.0 * earth::rotation_n(0.56).cross(&now.1) - g;
            let force = swing.at(t).c_bn * felt(t).force;
            assert!((force - expected).norm() < 3e-6, "{force} {expected}");
            let rate_dot = (felt(t + h).rate - felt(t - h).rate) / (2.0 * h);
            assert!((rate_dot - felt(t).angular_acceleration).norm() < 1e-5);
        }
    }

    #[test]
    fn gravity_follows_the_unit() {
        // one metre above the centre of rotation
        let lever = Vector3::new(0.0, 0.0, -1.0);
        let felt = Place::new(&site(), lever).felt(&Rotation::still(Matrix3::identity()), &Centre::FIXED);
        assert!((felt.force.z - earth::gravity(0.56, 21.0)).abs() < 1e-12);
        // one metre east: the vertical leans east
        let lever = Vector3::new(-1.0, 0.0, 0.0);
        let felt = Place::new(&site(), lever).felt(&Rotation::still(Matrix3::identity()), &Centre::FIXED);
        assert!((felt.force.x - 9.79 / 6.384e6).abs() < 1e-8, "{}", felt.force.x);
    }
}
