//! Cutting a log into still positions and the turns between them, whatever its units.

use std::vec::Vec;

use nalgebra::Vector3;

use crate::Sample;

/// Stillness is judged over blocks of this length, s.
const BLOCK: f64 = 0.5;
/// The log begins with so many blocks of stillness: they show the noise.
const FIRST_BLOCKS: usize = 10;
/// A still position has at least this many blocks beside the first and the last, in which it may still move.
const FEWEST_BLOCKS: usize = 3;
/// A block is still when its rate is within this part of the log's largest, beside six standard deviations of noise: a rate
/// threshold that needs no scale. 0.1 deg/s on a table that turns at 10 deg/s.
const RATE_PART: f64 = 0.01;
/// And its specific force within this part of gravity of the block before.
const FORCE_PART: f64 = 0.003;
/// Turns are remembered by increments over this time, s.
const GROUP: f64 = 0.01;

/// A stretch in which the unit rests.
#[derive(Clone, Copy, Debug)]
pub(super) struct Position {
    /// Mean of the gyros per second.
    pub(super) rate: Vector3<f64>,
    /// Mean of the accelerometers per second.
    pub(super) force: Vector3<f64>,
    /// Length, s.
    pub(super) time: f64,
}

/// Gyro increments with the time they took, s.
pub(super) type Increment = (f64, Vector3<f64>);

/// Positions, and the turn after each but the last.
#[derive(Clone, Debug)]
pub(super) struct Track {
    pub(super) positions: Vec<Position>,
    pub(super) turns: Vec<Vec<Increment>>,
}

impl Track {
    /// Multiplies everything by the sizes of pulses.
    pub(super) fn scale(&mut self, gyro: &Vector3<f64>, accel: &Vector3<f64>) {
        for position in &mut self.positions {
            position.rate.component_mul_assign(gyro);
            position.force.component_mul_assign(accel);
        }
        for (_, angle) in self.turns.iter_mut().flatten() {
            angle.component_mul_assign(gyro);
        }
    }
}

/// Remembers a log.
#[derive(Clone, Debug)]
pub(super) struct Recorder {
    nominal: f64,
    /// Whether turns are remembered.
    turns: bool,
    time: Option<f64>,
    group: Increment,
    groups: Vec<Increment>,
    block: Block,
    blocks: Vec<Block>,
}

#[derive(Clone, Copy, Debug)]
struct Block {
    time: f64,
    dtheta: Vector3<f64>,
    dvel: Vector3<f64>,
    /// Groups up to its end.
    groups: usize,
}

const EMPTY: Vector3<f64> = Vector3::new(0.0, 0.0, 0.0);

impl Block {
    const EMPTY: Self = Self { time: 0.0, dtheta: EMPTY, dvel: EMPTY, groups: 0 };

    fn rate(&self) -> Vector3<f64> {
        self.dtheta / self.time
    }

    fn force(&self) -> Vector3<f64> {
        self.dvel / self.time
    }
}

impl Recorder {
    pub(super) fn new(rate: f64) -> Self {
        Self {
            nominal: 1.0 / rate,
            turns: true,
            time: None,
            group: (0.0, EMPTY),
            groups: Vec::new(),
            block: Block::EMPTY,
            blocks: Vec::new(),
        }
    }

    /// The same without a memory of turns: 5 MB for ten hours.
    pub(super) fn without_turns(self) -> Self {
        Self { turns: false, ..self }
    }

    pub(super) fn push(&mut self, sample: &Sample) {
        let dt = self.time.map_or(self.nominal, |before| sample.time - before);
        self.time = Some(sample.time);
        self.group.0 += dt;
        self.group.1 += sample.dtheta;
        self.block.time += dt;
        self.block.dtheta += sample.dtheta;
        self.block.dvel += sample.dvel;
        // half a sample of slack against rounding
        let full = self.block.time >= BLOCK - 0.5 * self.nominal;
        if self.turns && (full || self.group.0 >= GROUP - 0.5 * self.nominal) {
            self.groups.push(self.group);
            self.group = (0.0, EMPTY);
        }
        if full {
            self.block.groups = self.groups.len();
            self.blocks.push(self.block);
            self.block = Block::EMPTY;
        }
    }

    /// The positions found; none where the log is too short to show its noise.
    pub(super) fn finish(self) -> Track {
        let mut track = Track { positions: Vec::new(), turns: Vec::new() };
        let Some(first) = self.blocks.get(..FIRST_BLOCKS) else { return track };
        let limits = Limits::new(first, &self.blocks);
        let mut run = 0..0;
        let mut turn_from = 0;
        for i in 0..=self.blocks.len() {
            let goes_on = self.blocks.get(i).is_some_and(|block| {
                limits.rests(block) && (run.is_empty() || limits.same(block, &self.blocks[i - 1]))
            });
            if goes_on {
                run = if run.is_empty() { i..i + 1 } else { run.start..i + 1 };
                continue;
            }
            if run.len() >= FEWEST_BLOCKS + 2 {
                let kept = &self.blocks[run.start + 1..run.end - 1];
                let begin = self.blocks[run.start].groups;
                if !track.positions.is_empty() {
                    track.turns.push(self.groups[turn_from..begin].to_vec());
                }
                turn_from = kept.last().map_or(begin, |block| block.groups);
                let time: f64 = kept.iter().map(|block| block.time).sum();
                track.positions.push(Position {
                    rate: kept.iter().map(|block| block.dtheta).sum::<Vector3<f64>>() / time,
                    force: kept.iter().map(|block| block.dvel).sum::<Vector3<f64>>() / time,
                    time,
                });
            }
            // what ends a run because the force steps may begin the next one
            let begins = self.blocks.get(i).is_some_and(|block| limits.rests(block));
            run = if begins { i..i + 1 } else { 0..0 };
        }
        track
    }
}

/// What counts as still.
struct Limits {
    rest: Vector3<f64>,
    rate: f64,
    force: f64,
}

impl Limits {
    fn new(first: &[Block], all: &[Block]) -> Self {
        let n = first.len() as f64;
        let rest = first.iter().map(Block::rate).sum::<Vector3<f64>>() / n;
        let force = first.iter().map(Block::force).sum::<Vector3<f64>>() / n;
        let scatter = |of: fn(&Block) -> Vector3<f64>| {
            let squares: f64 =
                first.windows(2).map(|pair| (of(&pair[1]) - of(&pair[0])).norm_squared()).sum();
            (0.5 * squares / (n - 1.0)).sqrt()
        };
        let reach = all.iter().map(|block| (block.rate() - rest).norm()).fold(0.0, f64::max);
        Self {
            rest,
            rate: RATE_PART * reach + 6.0 * scatter(Block::rate),
            force: FORCE_PART * force.norm() + 6.0 * scatter(Block::force),
        }
    }

    fn rests(&self, block: &Block) -> bool {
        (block.rate() - self.rest).norm() < self.rate
    }

    fn same(&self, block: &Block, before: &Block) -> bool {
        (block.force() - before.force()).norm() < self.force
    }
}
