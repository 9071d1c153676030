//! What gravity and the turns between rests say about axes: how the gyros stand to the accelerometers, and which way is up.

use nalgebra::{UnitQuaternion, Vector3};

use crate::axes::Pointing;
use crate::reading::Reading;
use crate::rests::{Block, Rest, Rests};
use crate::units::DEGREE;

/// Rests that differ by more than this show a turn, rad.
const TURNED: f64 = 20.0 * DEGREE;
/// Fewer turns show nothing.
const ENOUGH: usize = 3;
/// Turns of axes that are right leave no more than this of gravity's direction, rms, rad.
const FITS: f64 = 8.0 * DEGREE;
/// Other axes fit worse by this factor.
const CLEARER: f64 = 3.0;
/// The gyros saw less than this part of the turns: they were cut out.
const SEEN: f64 = 0.25;
/// Longer moves between rests say nothing any more, s.
const LONGEST: f64 = 60.0;
/// Gravity along an axis to this, rad, says which way it points.
const UPRIGHT: f64 = 20.0 * DEGREE;

/// A move from one rest to the next: gravity before and after, and the turn by gyros of either hand.
struct Move {
    before: Vector3<f64>,
    after: Vector3<f64>,
    turns: [UnitQuaternion<f64>; 2],
    rows: (u64, u64),
}

fn moves(rests: &Rests) -> Vec<Move> {
    let mut moves = Vec::new();
    let direction = |rest: &Rest| Vector3::from(rest.force).try_normalize(1e-6);
    for pair in rests.rests.windows(2) {
        let (Some(before), Some(after)) = (direction(&pair[0]), direction(&pair[1])) else { continue };
        if before.angle(&after) < TURNED || pair[1].start_s - pair[0].end_s > LONGEST {
            continue;
        }
        let bias = (Vector3::from(pair[0].rate) + Vector3::from(pair[1].rate)) * 0.5;
        let from = rests.blocks.partition_point(|block| block.first_row <= pair[0].last_row);
        let to = rests.blocks.partition_point(|block| block.first_row < pair[1].first_row);
        let mut turns = [UnitQuaternion::identity(); 2];
        for block in &rests.blocks[from..to] {
            let length = block.end - block.start;
            for (turn, (of, sign)) in turns.iter_mut().zip([(0, -1.0), (1, 1.0)]) {
                *turn *= turn_of(block, of) * UnitQuaternion::from_scaled_axis(bias * (sign * length));
            }
        }
        moves.push(Move { before, after, turns, rows: (pair[0].last_row + 1, pair[1].first_row - 1) });
    }
    moves
}

fn turn_of(block: &Block, of: usize) -> UnitQuaternion<f64> {
    block.turns[of]
}

/// What is left of gravity's direction, rms, rad, if the gyros' axes point so in those of the accelerometers.
fn left(moves: &[Move], axes: &Pointing) -> f64 {
    let matrix = axes.matrix();
    let squares = moves.iter().map(|of| {
        // a rate turned by a reflection is the opposite rate turned by a rotation
        let (turn, sign) = if axes.is_right_handed() { (&of.turns[0], 1.0) } else { (&of.turns[1], -1.0) };
        let rotation = matrix * sign;
        let expected = rotation * (turn.inverse() * (rotation.transpose() * of.before));
        let angle = expected.angle(&of.after);
        angle * angle
    });
    (squares.sum::<f64>() / moves.len() as f64).sqrt()
}

/// What the turns between rests contradict.
#[derive(Debug)]
pub(crate) enum Contradiction {
    /// The gyros' axes are others, and there is a way to say so.
    Axes(String),
    /// Something else.
    Other(String),
}

impl Contradiction {
    pub(crate) fn told(self) -> String {
        match self {
            Self::Axes(told) | Self::Other(told) => told,
        }
    }
}

/// What the turns between rests contradict, if anything.
pub(crate) fn contradictions(rests: &Rests) -> Option<Contradiction> {
    let moves = moves(rests);
    if moves.len() < ENOUGH {
        return None;
    }
    let rows = format!("rows {} to {}", moves[0].rows.0, moves[moves.len() - 1].rows.1);
    let felt: f64 = moves.iter().map(|of| of.before.angle(&of.after)).sum();
    let seen: f64 = moves.iter().map(|of| of.turns[0].angle()).sum();
    if seen < SEEN * felt {
        return Some(Contradiction::Other(format!(
            "{rows}: gravity turns by {:.0} deg in all from rest to rest, and the gyros see {:.0} deg of it: the turns were cut out, or \
             the gyros do not work; a calibration of gyros needs the log as it was recorded, turns too",
            felt / DEGREE,
            seen / DEGREE
        )));
    }
    let mut all: Vec<(f64, Pointing)> = Pointing::all().map(|axes| (left(&moves, &axes), axes)).collect();
    let ours = all[0].0;
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let [(best, axes), (second, _), ..] = all[..] else { return None };
    if ours > FITS && best < FITS && best * CLEARER < second && best * CLEARER < ours {
        let name = if axes.is_right_handed() { axes.body_name() } else { axes.signed_name() };
        return Some(Contradiction::Axes(format!(
            "{rows}: the gyros' axes are not those of the accelerometers: from rest to rest {:.1} deg of gravity are left; with \
             --axes gyro={name} it is {:.1} deg",
            ours / DEGREE,
            best / DEGREE
        )));
    }
    (ours > FITS).then(|| {
        Contradiction::Other(format!(
            "{rows}: from rest to rest {:.1} deg of gravity are left after the turns that the gyros saw: a unit of the gyros that is \
             wrong by some factor, turns beyond their range, or time that is wrong",
            ours / DEGREE
        ))
    })
}

/// What the rests say about which way the axes of the file point.
pub(super) fn likely(rests: &Rests, reading: &Reading) -> Option<String> {
    if reading.axes.names_unit() {
        return None;
    }
    // most logs begin upright, and a unit that lies on its head in all of them has other axes
    let first = rests.rests.first()?;
    let force = Vector3::from(first.force);
    let down = force.angle(&-Vector3::z()) < UPRIGHT;
    down.then(|| "imu=frd".to_owned())
}
