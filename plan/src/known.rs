//! Paths that are known. Those of 10, 24 and 25 positions that the literature names are missing: their turns are not at hand.

use rayon::prelude::*;
use rig::motion::{Axis, NINETEEN_POSITIONS, TWO_AXIS, Turn, eighteen_rotations, turns};
use rig::random::Stream;

use crate::criterion::{Group, groups};
use crate::draft::Limits;
use crate::evaluate::{Evaluator, Expected, Trouble};
use crate::search::{Way, takes};
use crate::table::Table;

/// A path of the literature.
#[derive(Clone, Copy, Debug)]
pub struct Known {
    /// Its name.
    pub name: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    list: fn() -> Vec<(Axis, f64)>,
}

/// A path is gone through once more where its rests are as long as this, s.
const REPEATED_REST: f64 = 10.0;

/// Random paths that are asked what noise alone would leave.
const RANDOM: usize = 12;

const X: Axis = Axis::Body(0);
const Y: Axis = Axis::Body(1);
const Z: Axis = Axis::Body(2);

/// The paths that are known.
pub const KNOWN: [Known; 6] = [
    Known {
        name: "eighteen-rotations",
        source: "Camberlein's, as Xing, Yang and Cai print it (Sensors 22(1):278, 2022); the original was not seen",
        list: || eighteen_rotations().into_iter().map(|(axis, angle)| (axis, angle.to_degrees())).collect(),
    },
    Known {
        name: "nineteen-positions",
        source: "the quarter turns of the PSINS toolbox's demonstration of systematic calibration",
        list: || NINETEEN_POSITIONS.to_vec(),
    },
    Known {
        name: "two-axis",
        source: "of this project, for a table with a level outer axis",
        list: || TWO_AXIS.to_vec(),
    },
    Known {
        name: "six-positions",
        source: "each axis up and down, as is usual for accelerometers; the order is of this project",
        list: || vec![(X, 90.0), (X, 90.0), (X, 90.0), (Y, 90.0), (Y, 180.0)],
    },
    Known {
        name: "tumble",
        source: "a whole turn about each axis in quarter turns; the order is of this project",
        list: || [X, Y, Z].into_iter().flat_map(|axis| [(axis, 90.0); 4]).collect(),
    },
    Known {
        name: "turns-about-one-axis",
        source: "two turns there and two back in half turns, for a table of one axis; of this project",
        list: || vec![(Z, 180.0), (Z, 180.0), (Z, -180.0), (Z, -180.0)],
    },
];

impl Known {
    /// Whether a table can turn it.
    pub fn suits(&self, table: Table) -> bool {
        let (list, axes) = ((self.list)(), table.axes());
        list.iter().all(|(axis, angle)| axes.contains(axis) && table.angles().contains(&angle.abs()))
    }

    /// The path in `duration` seconds, gone through so many `times`, all rests alike.
    ///
    /// # Errors
    /// When it does not fit.
    pub fn lasting(
        &self,
        evaluator: &Evaluator,
        table: Table,
        duration: f64,
        times: usize,
    ) -> Result<Way, Trouble> {
        let motion = &evaluator.scenario().motion;
        let rate = table.rates()[0].to_radians().min(motion.max_rate);
        let once = turns(&(self.list)(), rate, 0.0);
        let mut turns: Vec<Turn> = once.iter().cycle().take(once.len() * times).copied().collect();
        let turning: f64 = turns.iter().map(|turn| takes(turn, motion.acceleration)).sum();
        // tenths of a second can be set on a table
        let rest = ((duration - turning) / (turns.len() + 1) as f64 * 10.0).floor() / 10.0;
        let least = if times > 1 { REPEATED_REST } else { 0.0 };
        if rest < table.least_dwell().max(least) {
            return Err(Trouble::Impossible(format!("{} does not fit into {duration} s", self.name)));
        }
        turns.iter_mut().for_each(|turn| turn.dwell = rest);
        Ok((duration - turning - rest * turns.len() as f64, turns))
    }
}

/// What a table can do of the known paths in a time: once, and as often as rests of some ten seconds leave room for.
pub fn known_paths(evaluator: &Evaluator, table: Table, duration: f64) -> Vec<(&'static Known, Way)> {
    lasting(evaluator, table, duration, |known| known.suits(table))
}

fn lasting(
    evaluator: &Evaluator,
    table: Table,
    duration: f64,
    wanted: impl Fn(&Known) -> bool,
) -> Vec<(&'static Known, Way)> {
    let mut paths = Vec::new();
    for known in KNOWN.iter().filter(|known| wanted(known)) {
        let mut times = 1;
        while let Ok(way) = known.lasting(evaluator, table, duration, times) {
            paths.push((known, way));
            times *= 2;
        }
    }
    paths
}

/// The path to compare with on a table: of those that are known the one with the least mean of the logarithms of its sigmas.
///
/// # Errors
/// When none fits, or one cannot be evaluated.
pub fn best_known(evaluator: &Evaluator, table: Table, duration: f64) -> Result<Expected, Trouble> {
    let mut best: Option<(f64, Expected)> = None;
    for (_, (still, turns)) in known_paths(evaluator, table, duration) {
        let expected = evaluator.turns(&turns, still)?;
        let value = groups(&expected).iter().map(|(_, sigma)| sigma.ln()).sum::<f64>();
        if best.as_ref().is_none_or(|(least, _)| value < *least) {
            best = Some((value, expected));
        }
    }
    best.map(|(_, expected)| expected).ok_or_else(|| {
        Trouble::Impossible(format!(
            "no path of a {} table that is known fits into {duration} s",
            table.name()
        ))
    })
}

/// What noise leaves of each effect where all the others are known, on the best of the known paths and of some random ones: no path
/// shows an effect much better.
///
/// # Errors
/// When a path cannot be evaluated.
pub fn noise_alone(evaluator: &Evaluator, table: Table, duration: f64) -> Result<Vec<Group>, Trouble> {
    // three axes can do what fewer can, if by other turns
    let wanted = |known: &Known| table == Table::ThreeAxis || known.suits(table);
    let mut paths: Vec<Way> =
        lasting(evaluator, table, duration, wanted).into_iter().map(|(_, way)| way).collect();
    let motion = &evaluator.scenario().motion;
    let limits = Limits::new(table, motion.max_rate, motion.acceleration, duration);
    let mut random = Stream::new(0, "plan/noise");
    paths.extend((0..RANDOM).filter_map(|_| limits.path(&limits.random(&mut random))));
    let alone: Result<Vec<_>, _> =
        paths.par_iter().map(|(still, turns)| evaluator.alone(turns, *still)).collect();
    let mut least: Vec<Group> = Vec::new();
    for alone in alone? {
        if least.is_empty() {
            least = alone;
        } else {
            least.iter_mut().zip(alone).for_each(|(least, (_, sigma))| least.1 = least.1.min(sigma));
        }
    }
    Ok(least)
}
