//! What a path will show, from where the unit will be: no samples, one covariance pass.

use std::vec::IntoIter;

use nalgebra::{UnitQuaternion, Vector3};
use rig::motion::Turn;
use rig::{Ahead, Scenario};
use runs::Piece;
use sinscal::{Point, Reference, Signals};

use crate::search::takes;

/// While the unit turns the signals are taken every so often, rad and s.
const STEP_ANGLE: f64 = 0.35;
const STEP_TURNING: f64 = 1.0;
/// And at rest, s: the leading dynamics move to second order.
const STEP_RESTING: f64 = 4.0;
/// Readings in a rest are used in lots: of so many, or of this part of the rest where that is more.
const LOT: f64 = 4.0;
const PART: f64 = 1.0 / 6.0;
/// And in a turn those of this angle, rad.
const LOT_ANGLE: f64 = 0.6;

/// The pieces of a path: moves between the instants where the reference is read.
pub(crate) struct Foresight {
    ahead: Ahead,
    stretches: IntoIter<Stretch>,
    /// What is left of the stretch that is gone through.
    queue: Vec<Piece>,
    reference: Reference,
    /// Between readings, s.
    every: f64,
    /// Readings so far.
    read: f64,
    /// Where the last stretch ended, s.
    now: f64,
    started: bool,
}

/// A rest or a turn.
struct Stretch {
    end: f64,
    /// Step of a turn and its mean rate, rad/s; none at rest.
    turning: Option<(f64, f64)>,
}

impl Foresight {
    /// Of turns after a rest of `still` seconds.
    pub(crate) fn new(ahead: Ahead, scenario: &Scenario, turns: &[Turn], still: f64) -> Self {
        let motion = &scenario.motion;
        let mut stretches = vec![Stretch { end: still, turning: None }];
        let mut time = still;
        for turn in turns {
            let lasts = takes(turn, motion.acceleration);
            let steps = (turn.angle.abs() / STEP_ANGLE).max(lasts / STEP_TURNING).ceil();
            time += lasts;
            stretches.push(Stretch { end: time, turning: Some((lasts / steps, turn.angle.abs() / lasts)) });
            time += turn.dwell;
            stretches.push(Stretch { end: time, turning: None });
        }
        let plan = &scenario.reference;
        let reference = Reference {
            velocity: Some(Vector3::zeros()),
            position: Some(Vector3::zeros()),
            attitude: plan.attitude.then(UnitQuaternion::identity),
            ..Reference::default()
        };
        Self {
            ahead,
            stretches: stretches.into_iter(),
            queue: Vec::new(),
            reference,
            every: if plan.readings { 1.0 / plan.rate } else { 1.0 },
            read: 0.0,
            now: 0.0,
            started: false,
        }
    }

    fn read(&mut self, time: f64, readings: f64) {
        let (at, signals) = self.ahead.at(time);
        self.queue.push(Piece::Read { time, at, signals, reference: Box::new(self.reference), readings });
    }

    /// Moves to `end` in steps of about `step`.
    fn go(&mut self, end: f64, step: f64) {
        let steps = ((end - self.now) / step).ceil().max(1.0);
        let (start, dt) = (self.now, (end - self.now) / steps);
        if dt <= 0.0 {
            return;
        }
        for k in 0..steps as usize {
            let (at, signals): (Point<f64>, Signals<f64>) = self.ahead.at(start + (k as f64 + 0.5) * dt);
            self.queue.push(Piece::Moves { at, signals, dt });
        }
        self.now = end;
    }

    /// Goes through a stretch.
    fn through(&mut self, stretch: &Stretch) {
        let until = ((stretch.end + 1e-9) / self.every).floor();
        let due = until - self.read;
        let first = self.read;
        let (step, most) = match stretch.turning {
            Some((step, rate)) => (step, (LOT_ANGLE / (rate * self.every)).floor().max(1.0)),
            None => (STEP_RESTING, (due * PART).ceil().max(LOT)),
        };
        while self.read < until {
            let left = until - self.read;
            // those beside a turn, which show the lever arms, stand for themselves
            let together = left.min(self.read - first).clamp(1.0, most).min(left);
            let middle = (self.read + 0.5 * (together + 1.0)) * self.every;
            self.go(middle.min(stretch.end), step);
            self.read(middle.min(stretch.end), together);
            self.read += together;
        }
        self.go(stretch.end, step);
    }
}

impl Iterator for Foresight {
    type Item = Piece;

    fn next(&mut self) -> Option<Piece> {
        while self.queue.is_empty() {
            if self.started {
                let stretch = self.stretches.next()?;
                self.through(&stretch);
            } else {
                self.started = true;
                self.read(0.0, 1.0);
            }
            // taken from the end
            self.queue.reverse();
        }
        self.queue.pop()
    }
}
