//! A table that turns the unit about one axis at a time.

use nalgebra::{Matrix3, Vector3};

use super::paths::{Axis, Turn};
use super::profile::{RoundedTrapezoid, Turning};
use super::{Imperfections, Rotation};

/// A list of turns with the rests between them.
#[derive(Clone, Debug)]
pub struct Turntable {
    start: Matrix3<f64>,
    moves: Vec<Move>,
    end: f64,
}

#[derive(Clone, Debug)]
struct Move {
    /// Nominal beginning, s.
    at: f64,
    /// When the rounded motion begins and ends, s.
    begins: f64,
    ends: f64,
    profile: RoundedTrapezoid,
    /// Direction of the axis in b, the same before and after.
    axis: Vector3<f64>,
    number: usize,
    before: Matrix3<f64>,
    after: Matrix3<f64>,
    /// Angles of the three axes before it, rad.
    angles: [f64; 3],
}

impl Turntable {
    /// Starts at attitude `start`, rests for `still` seconds and goes through `turns` with ramps of `acceleration`, rounded
    /// over `rounding` seconds.
    pub fn new(
        start: Matrix3<f64>,
        still: f64,
        turns: &[Turn],
        acceleration: f64,
        rounding: f64,
        imperfections: &Imperfections,
    ) -> Self {
        let mut moves = Vec::with_capacity(turns.len());
        let (mut now, mut time, mut angles) = (start, still, [0.0; 3]);
        for turn in turns {
            let profile = RoundedTrapezoid::new(turn.angle, turn.rate, acceleration, rounding);
            let axis = match turn.axis {
                Axis::Body(i) => imperfections.axis(i),
                Axis::Level(i) => now.transpose() * imperfections.axis(i),
            };
            let whole = Turning { angle: turn.angle, ..Turning::default() };
            let after = now * Rotation::about(&axis, &whole).c_bn;
            let number = turn.axis.index();
            moves.push(Move {
                at: time,
                begins: time - 0.5 * rounding,
                ends: time + profile.duration() + 0.5 * rounding,
                profile,
                axis,
                number,
                before: now,
                after,
                angles,
            });
            angles[number] += turn.angle;
            now = after;
            time += profile.duration() + turn.dwell;
        }
        Self { start, moves, end: time }
    }

    /// When the last rest ends, s.
    pub fn duration(&self) -> f64 {
        self.end
    }

    /// The move that began last.
    #[inline]
    fn last(&self, t: f64) -> Option<&Move> {
        let i = self.moves.partition_point(|motion| motion.begins <= t);
        self.moves.get(i.checked_sub(1)?)
    }

    /// The rotation at time `t`.
    #[inline]
    pub fn at(&self, t: f64) -> Rotation {
        match self.last(t) {
            None => Rotation::still(self.start),
            Some(motion) if t >= motion.ends => Rotation::still(motion.after),
            Some(motion) => {
                let turning = Rotation::about(&motion.axis, &motion.profile.at(t - motion.at));
                Rotation { c_bn: motion.before * turning.c_bn, ..turning }
            }
        }
    }

    /// Angles of the three axes.
    pub(super) fn gimbals(&self, t: f64) -> [Turning; 3] {
        let mut gimbals = [Turning::default(); 3];
        if let Some(motion) = self.last(t) {
            for (gimbal, angle) in gimbals.iter_mut().zip(motion.angles) {
                gimbal.angle = angle;
            }
            let turning = motion.profile.at(t - motion.at);
            let gimbal = &mut gimbals[motion.number];
            *gimbal = Turning { angle: gimbal.angle + turning.angle, ..turning };
        }
        gimbals
    }
}

#[cfg(test)]
mod tests {
    use super::super::{check_derivatives, eighteen_rotations};
    use super::*;

    fn degrees(x: f64) -> f64 {
        x.to_radians()
    }

    fn path(imperfections: &Imperfections) -> Turntable {
        let turns: Vec<_> = eighteen_rotations()
            .into_iter()
            .map(|(axis, angle)| Turn { axis, angle, rate: degrees(10.0), dwell: 180.0 })
            .collect();
        let start = sinscal::path::attitude(b"NED").unwrap().to_rotation_matrix().into_inner();
        Turntable::new(start, 300.0, &turns, degrees(20.0), 0.1, imperfections)
    }

    #[test]
    fn default_path_takes_3765_seconds_and_closes() {
        let table = path(&Imperfections::default());
        assert!((table.duration() - 3765.0).abs() < 1e-9);
        assert!((table.at(4000.0).c_bn - table.at(0.0).c_bn).norm() < 1e-12);
        // the first move begins half a rounding early
        assert_eq!(table.at(299.9).rate, Vector3::zeros());
        assert!((table.at(305.0).rate - Vector3::y() * degrees(10.0)).norm() < 1e-12);
    }

    #[test]
    fn derivatives_agree_with_differences() {
        let skewed =
            Imperfections { non_orthogonality: Vector3::new(1e-2, -2e-2, 3e-2), ..Imperfections::default() };
        let table = path(&skewed);
        check_derivatives(|t| table.at(t), (0..4000).map(|i| 299.0 + f64::from(i) * 0.011));
    }

    #[test]
    fn an_axis_level_in_n_stays_there() {
        let turns =
            [Axis::Body(2), Axis::Level(0)].map(|axis| Turn { axis, angle: 1.0, rate: 0.2, dwell: 5.0 });
        let table = Turntable::new(Matrix3::identity(), 1.0, &turns, 0.3, 0.1, &Imperfections::default());
        let now = table.at(1.0 + 5.0 / 0.87 + 8.0);
        assert!(now.rate.norm() > 0.1);
        let in_n = now.c_bn * now.rate;
        assert!(in_n.y.abs() < 1e-12 && in_n.z.abs() < 1e-12 && in_n.x > 0.0, "{in_n}");
    }
}
