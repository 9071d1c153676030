//! What a delay of the accelerometers does to navigation: Eq. 16 to 21 and figure 3.
//!
//! The unit turns at constant rate about a level axis that stays put. In n the specific force is constant, and an accelerometer that
//! is late by tau errs by `d_f = tau (omega x f)`. About east that is `-tau omega g` to the north at every moment:
//!
//! ```text
//! dv_N = -tau omega g t        dp_N = -tau omega g t^2 / 2
//! ```
//!
//! and nothing to first order east and up. About up nothing happens at all. The simulation applies the delay exactly, by evaluating
//! the motion earlier, and navigates with the increments on a turning Earth.

use nalgebra::{UnitQuaternion, Vector3};
use sinscal::strapdown::{Before, Increments, NavigationState};
use sinscal::{Site, earth};

use crate::mechanics::Place;
use crate::motion::{Centre, Rotation, Turning};
use crate::simulate::NODES;

/// A rotation with late accelerometers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// Where.
    pub site: Site,
    /// Axis: 0, 1, 2 for east, north, up.
    pub axis: usize,
    /// Rate, rad/s.
    pub rate: f64,
    /// Delay of the accelerometers, s.
    pub delay: f64,
    /// Sampling rate, Hz.
    pub sampling: f64,
    /// s.
    pub duration: f64,
}

/// Navigation errors at one time, east, north, up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// s.
    pub time: f64,
    /// By the closed form, m/s.
    pub velocity: Vector3<f64>,
    /// By the closed form, m.
    pub position: Vector3<f64>,
    /// By simulated navigation, m/s.
    pub simulated_velocity: Vector3<f64>,
    /// By simulated navigation, m.
    pub simulated_position: Vector3<f64>,
    /// The same without delay: what the algorithm itself leaves, m.
    pub undelayed_position: Vector3<f64>,
}

impl Turn {
    /// The case of figure 3: 1 ms late, 50 s about the level east axis; 10 deg/s, since the paper's rate is not legible.
    pub fn figure_3(site: Site) -> Self {
        Self { site, axis: 0, rate: 10.0_f64.to_radians(), delay: 1e-3, sampling: 200.0, duration: 50.0 }
    }

    fn axis_n(&self) -> Vector3<f64> {
        let mut axis = Vector3::zeros();
        axis[self.axis] = 1.0;
        axis
    }

    /// Error of the specific force in n by the delay, m/s^2: Eq. 20.
    pub fn force_error(&self) -> Vector3<f64> {
        let force = Vector3::z() * earth::gravity(self.site.latitude, self.site.height);
        (self.axis_n() * self.rate).cross(&force) * self.delay
    }

    fn increments(&self, place: &Place, k: i64, delay: f64) -> Increments<f64> {
        let dt = 1.0 / self.sampling;
        let axis = self.axis_n();
        let felt = |t: f64| {
            let turning = Turning { angle: self.rate * t, rate: self.rate, acceleration: 0.0 };
            place.felt(&Rotation::about(&axis, &turning), &Centre::FIXED)
        };
        let mut sum = Increments::zero();
        for (node, weight) in NODES {
            let t = (k as f64 + node) * dt;
            sum.dtheta += felt(t).rate * (weight * dt);
            sum.dvel += felt(t - delay).force * (weight * dt);
        }
        sum
    }

    /// Errors over time, at about `points` times: closed form (Eq. 21) and simulation.
    pub fn errors(&self, points: u32) -> Vec<Errors> {
        let place = Place::new(&self.site, Vector3::zeros());
        let dt = 1.0 / self.sampling;
        let samples = (self.duration * self.sampling).round().max(1.0) as i64;
        let every = (samples / i64::from(points.max(1))).max(1);
        let start = NavigationState::at_rest(&self.site, UnitQuaternion::identity());
        let (mut late, mut punctual) = (start, start);
        let before = |delay| {
            let mut before = Before::nothing();
            for k in [-2, -1] {
                before.follow(&self.increments(&place, k, delay));
            }
            before
        };
        let (mut late_before, mut punctual_before) = (before(self.delay), before(0.0));
        let force = self.force_error();
        let mut series = Vec::with_capacity(points as usize + 1);
        for k in 0..samples {
            let now = self.increments(&place, k, self.delay);
            late.step(&now, &mut late_before, dt);
            let now = self.increments(&place, k, 0.0);
            punctual.step(&now, &mut punctual_before, dt);
            if (k + 1) % every == 0 {
                let time = (k + 1) as f64 * dt;
                series.push(Errors {
                    time,
                    velocity: force * time,
                    position: force * (0.5 * time * time),
                    simulated_velocity: late.velocity,
                    simulated_position: late.position(&self.site),
                    undelayed_position: punctual.position(&self.site),
                });
            }
        }
        series
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn site() -> Site {
        Site { latitude: 0.56, longitude: 2.07, height: 20.0 }
    }

    #[test]
    fn figure_3_north_error_is_quadratic_and_the_others_stay_small() {
        let series = Turn::figure_3(site()).errors(50);
        assert_eq!(series.len(), 50);
        for e in &series {
            let north = e.position.y;
            assert!((e.simulated_velocity.y - e.velocity.y).abs() < 0.01 * e.velocity.y.abs(), "{e:?}");
            assert!((e.simulated_position.y - north).abs() < 0.01 * north.abs(), "{e:?}");
            assert!(e.simulated_position.x.abs() < 0.01 * north.abs(), "{e:?}");
            assert!(e.simulated_position.z.abs() < 0.01 * north.abs(), "{e:?}");
            assert!(e.undelayed_position.norm() < 1e-3 * north.abs(), "{e:?}");
        }
        // -1 ms * 10 deg/s * 9.79 m/s^2 * (50 s)^2 / 2 = -2.14 m
        let last = series.last().unwrap().position.y;
        assert!((last + 2.137).abs() < 0.01, "{last}");
    }

    #[test]
    fn about_north_the_error_is_to_the_east_and_about_up_there_is_none() {
        let about = |axis| Turn { axis, ..Turn::figure_3(site()) }.errors(1)[0];
        let north = about(1);
        assert!((north.simulated_position.x / north.position.x - 1.0).abs() < 0.01);
        assert!(north.position.x > 2.0);
        let up = about(2);
        assert_eq!(up.position, Vector3::zeros());
        assert!(up.simulated_position.norm() < 1e-3, "{}", up.simulated_position);
    }
}
