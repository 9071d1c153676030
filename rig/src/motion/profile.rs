//! How a table turns by an angle: a trapezoid of rate with rounded corners.

/// Angle, rate and acceleration about an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Turning {
    /// rad.
    pub angle: f64,
    /// rad/s.
    pub rate: f64,
    /// rad/s^2.
    pub acceleration: f64,
}

/// A trapezoid of rate, convolved with a bell of finite width.
///
/// The trapezoid accelerates uniformly, keeps its rate and brakes uniformly; a turn too short to reach the rate is a triangle.
/// Convolution with the kernel `15/16 (1 - u^2)^2`, u from -1 to 1 over the width `rounding`, makes the acceleration twice
/// continuously differentiable. It keeps the limits of rate and acceleration and the angle exactly, and lets the motion begin
/// and end half a `rounding` outside the trapezoid's corners, so that nominal durations stay what they are. All derivatives
/// are polynomials in closed form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoundedTrapezoid {
    /// Signed acceleration, rad/s^2.
    acceleration: f64,
    /// Corners of the trapezoid, s.
    corners: [f64; 4],
    /// Half the width of the kernel, s.
    half: f64,
    angle: f64,
}

/// Signs of the changes of acceleration at the corners.
const SIGNS: [f64; 4] = [1.0, -1.0, -1.0, 1.0];

impl RoundedTrapezoid {
    /// A turn by `angle` that begins nominally at time zero. `rate`, `acceleration` and `rounding` are positive.
    pub fn new(angle: f64, rate: f64, acceleration: f64, rounding: f64) -> Self {
        let size = angle.abs();
        // a triangle where the rate is not reached
        let ramp = (rate / acceleration).min((size / acceleration).sqrt());
        let end = size / (ramp * acceleration) + ramp;
        Self {
            acceleration: acceleration.copysign(angle),
            corners: [0.0, ramp, end - ramp, end],
            half: 0.5 * rounding,
            angle,
        }
    }

    /// Nominal duration, s: between the outer corners of the trapezoid.
    pub fn duration(&self) -> f64 {
        self.corners[3]
    }

    /// The motion at time `t` after the nominal beginning.
    pub fn at(&self, t: f64) -> Turning {
        if t <= -self.half {
            return Turning::default();
        }
        if t >= self.corners[3] + self.half {
            return Turning { angle: self.angle, ..Turning::default() };
        }
        let mut sum = Turning::default();
        for (corner, sign) in self.corners.iter().zip(SIGNS) {
            let after = t - corner;
            if after <= -self.half {
                break;
            }
            let ramp = rounded_ramp(after, self.half);
            sum.angle += sign * ramp.angle;
            sum.rate += sign * ramp.rate;
            sum.acceleration += sign * ramp.acceleration;
        }
        Turning {
            angle: self.acceleration * sum.angle,
            rate: self.acceleration * sum.rate,
            acceleration: self.acceleration * sum.acceleration,
        }
    }
}

/// A step of acceleration at time zero, rounded over `half` on either side, for `t > -half`.
fn rounded_ramp(t: f64, half: f64) -> Turning {
    if t >= half {
        // the kernel's variance is half^2 / 7
        return Turning { angle: 0.5 * t * t + half * half / 14.0, rate: t, acceleration: 1.0 };
    }
    let u = t / half;
    let u2 = u * u;
    let k = 15.0 / 16.0;
    Turning {
        angle: half
            * half
            * (1.0 / 28.0
                + u * (5.0 / 32.0 + u * (0.25 + k * u * (1.0 / 6.0 - u2 * (1.0 / 30.0 - u2 / 210.0))))),
        rate: half * (5.0 / 32.0 + u * (0.5 + k * u * (0.5 - u2 * (1.0 / 6.0 - u2 / 30.0)))),
        acceleration: 0.5 + k * u * (1.0 - u2 * (2.0 / 3.0 - u2 / 5.0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cases() -> [RoundedTrapezoid; 4] {
        [
            RoundedTrapezoid::new(1.5, 0.17, 0.35, 0.2),
            RoundedTrapezoid::new(-3.1, 0.17, 0.35, 0.1),
            RoundedTrapezoid::new(0.05, 0.17, 0.35, 0.2), // never reaches its rate
            RoundedTrapezoid::new(-0.001, 0.17, 0.35, 0.3), // shorter than its own rounding
        ]
    }

    #[test]
    fn derivatives_agree_with_differences() {
        for profile in cases() {
            let step = 1e-5;
            let mut t = -0.3;
            while t < profile.duration() + 0.3 {
                let (a, b, c) = (profile.at(t - step), profile.at(t), profile.at(t + step));
                assert!(((c.angle - a.angle) / (2.0 * step) - b.rate).abs() < 1e-9, "{profile:?} {t}");
                assert!(((c.rate - a.rate) / (2.0 * step) - b.acceleration).abs() < 1e-7, "{profile:?} {t}");
                t += 0.0037;
            }
        }
    }

    #[test]
    fn angle_is_reached_and_limits_are_kept() {
        for profile in cases() {
            let end = profile.at(profile.duration() + 0.49999 * 2.0 * profile.half);
            assert!((end.angle - profile.angle).abs() < 1e-12, "{profile:?} {end:?}");
            for i in 0..10_000 {
                let now = profile.at(-0.2 + f64::from(i) * 2e-3);
                assert!(now.rate.abs() <= 0.17 + 1e-12);
                assert!(now.acceleration.abs() <= 0.35 + 1e-12);
                assert!(now.rate * profile.angle >= -1e-12);
            }
        }
    }

    #[test]
    fn duration_is_that_of_the_trapezoid() {
        let degree = f64::to_radians(1.0);
        let quarter = RoundedTrapezoid::new(90.0 * degree, 10.0 * degree, 20.0 * degree, 0.1);
        assert!((quarter.duration() - 9.5).abs() < 1e-12);
    }
}
