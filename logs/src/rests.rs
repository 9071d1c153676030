//! Rests: stretches in which a unit did not move, found from the signals alone.
//!
//! Rows are taken together in blocks of a fifth of a second. Where a unit rests, the scatter within a block is that of the
//! sensors, and the means of neighbouring blocks agree as well as that scatter lets them. What the scatter of the sensors is
//! comes from the quietest blocks of the log, and then from the rests found with it; no noise has to be assumed. Of what is
//! still, only stretches that agree about the gyros' reading are rests: a turn at a constant rate is still too.

use nalgebra::{UnitQuaternion, Vector3};
use serde::Serialize;

/// Length of a block, s, and its fewest rows.
pub(crate) const BLOCK: f64 = 0.2;
const FEWEST: usize = 5;
/// Shorter stretches are no rests, s.
const SHORTEST: f64 = 1.0;
/// The part of the blocks that is quiet in any log that rests at all.
const QUIET: f64 = 0.05;
/// A block scatters at rest by no more than so many times the usual.
const LOUD: f64 = 3.0;
/// Means of blocks of one rest agree to so many standard deviations, and to what a rest may still drift: rad/s, m/s^2.
const AGREE: f64 = 6.0;
const DRIFT: [f64; 2] = [2e-3, 0.02];
/// Readings of the gyros in different rests agree to this, rad/s (0.3 deg/s), and to the standard deviations.
const SAME_RATE: f64 = 5e-3;

/// A stretch in which the unit did not move.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Rest {
    /// Its beginning, s.
    pub start_s: f64,
    /// Its end, s.
    pub end_s: f64,
    /// Its first row, counted from 1.
    pub first_row: u64,
    /// Its last row.
    pub last_row: u64,
    /// Mean rate, rad/s.
    pub rate: [f64; 3],
    /// Mean specific force, m/s^2.
    pub force: [f64; 3],
}

/// Rows taken together.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Block {
    pub(crate) start: f64,
    pub(crate) end: f64,
    pub(crate) first_row: u64,
    pub(crate) rows: usize,
    /// Means of rate and specific force.
    pub(crate) means: [Vector3<f64>; 2],
    /// Variances of a row within the block.
    pub(crate) variances: [Vector3<f64>; 2],
    /// The turn over the block by the gyros as they are, and by their opposite: in axes of either hand it is made of one of these.
    pub(crate) turns: [UnitQuaternion<f64>; 2],
}

/// Finds the rests of a log, row by row.
#[derive(Debug)]
pub struct RestFinder {
    rows_per_block: usize,
    interval: f64,
    open: Open,
    blocks: Vec<Block>,
    row: u64,
    last: Option<f64>,
}

/// The block being filled, by Welford's means.
#[derive(Clone, Copy, Debug)]
struct Open {
    start: f64,
    first_row: u64,
    rows: usize,
    means: [Vector3<f64>; 2],
    squares: [Vector3<f64>; 2],
    turns: [UnitQuaternion<f64>; 2],
}

impl Open {
    const EMPTY: Self = Self {
        start: 0.0,
        first_row: 0,
        rows: 0,
        means: [Vector3::new(0.0, 0.0, 0.0); 2],
        squares: [Vector3::new(0.0, 0.0, 0.0); 2],
        turns: [UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(1.0, 0.0, 0.0, 0.0)); 2],
    };
}

/// The rests of a log, and what its sensors scatter by in them.
#[derive(Clone, Debug, Default)]
pub struct Rests {
    /// In order.
    pub rests: Vec<Rest>,
    /// Angle random walk of each axis, rad/sqrt(s), and velocity random walk, m/s/sqrt(s); nothing without rests.
    pub noise: Option<[Vector3<f64>; 2]>,
    pub(crate) blocks: Vec<Block>,
}

impl RestFinder {
    /// Begins at the first row of a log whose rows are so far apart, s.
    pub fn new(interval: f64) -> Self {
        let rows_per_block = ((BLOCK / interval).round() as usize).max(FEWEST);
        Self { rows_per_block, interval, open: Open::EMPTY, blocks: Vec::new(), row: 0, last: None }
    }

    /// Takes in the next row: its time, s, the rate, rad/s, and the specific force, m/s^2, over the interval before it.
    pub fn push(&mut self, time: f64, rate: &Vector3<f64>, force: &Vector3<f64>) {
        self.row += 1;
        let step = self.last.replace(time).map_or(self.interval, |last| time - last);
        let sound = time.is_finite() && rate.iter().chain(force).all(|value| value.is_finite());
        // what is missing is no rest: a block ends at a gap
        if !(sound && step > 0.0 && step < 0.5 * BLOCK.max(4.0 * self.interval)) {
            self.open = Open::EMPTY;
            if !sound {
                return;
            }
        }
        let open = &mut self.open;
        if open.rows == 0 {
            *open = Open { start: time - self.interval, first_row: self.row, ..Open::EMPTY };
        }
        open.rows += 1;
        for (value, (mean, squares)) in
            [rate, force].into_iter().zip(open.means.iter_mut().zip(&mut open.squares))
        {
            let off = value - *mean;
            *mean += off / open.rows as f64;
            *squares += off.component_mul(&(value - *mean));
        }
        let turn = rate * step.min(2.0 * self.interval);
        open.turns[0] *= UnitQuaternion::from_scaled_axis(turn);
        open.turns[1] *= UnitQuaternion::from_scaled_axis(-turn);
        if open.rows == self.rows_per_block {
            let free = (open.rows - 1) as f64;
            self.blocks.push(Block {
                start: open.start,
                end: time,
                first_row: open.first_row,
                rows: open.rows,
                means: open.means,
                variances: open.squares.map(|squares| squares / free),
                turns: open.turns,
            });
            self.open = Open::EMPTY;
        }
    }

    /// The rests of all rows.
    pub fn finish(self) -> Rests {
        let blocks = self.blocks;
        let mut usual =
            [0, 1].map(|of| quantile(blocks.iter().map(|block| block.variances[of].sum()), QUIET));
        let mut stretches = Vec::new();
        for _ in 0..3 {
            stretches = still(&blocks, usual);
            if stretches.is_empty() {
                break;
            }
            let within = |of: usize| {
                stretches.iter().flat_map(|s| &blocks[s.clone()]).map(move |block| block.variances[of].sum())
            };
            usual = [quantile(within(0), 0.5), quantile(within(1), 0.5)];
        }
        let stretches = of_one_rate(&blocks, stretches, usual[0]);
        let rests = stretches.iter().map(|stretch| rest(&blocks[stretch.clone()])).collect();
        let noise = noise(&blocks, &stretches, self.interval);
        Rests { rests, noise, blocks }
    }
}

/// A quantile of numbers, 0 of none.
fn quantile(values: impl Iterator<Item = f64>, part: f64) -> f64 {
    let mut values: Vec<f64> = values.collect();
    if values.is_empty() {
        return 0.0;
    }
    let at = ((values.len() - 1) as f64 * part) as usize;
    *values.select_nth_unstable_by(at, f64::total_cmp).1
}

/// Stretches of blocks that are quiet against the usual variances (sums over the axes) and whose means stay where they are.
fn still(blocks: &[Block], usual: [f64; 2]) -> Vec<std::ops::Range<usize>> {
    let quiet = |block: &Block| (0..2).all(|of| block.variances[of].sum() <= LOUD * LOUD * usual[of]);
    let follows =
        |at: usize| at > 0 && blocks[at].first_row == blocks[at - 1].first_row + blocks[at - 1].rows as u64;
    let mut stretches = Vec::new();
    let mut start = 0;
    let mut sums = [Vector3::zeros(); 2];
    let mut end = |start: usize, end: usize| {
        let stretch = start..end;
        if stretch.len() > 1 && blocks[end - 1].end - blocks[start].start >= SHORTEST {
            stretches.push(stretch);
        }
    };
    for at in 0..=blocks.len() {
        let count = (at - start) as f64;
        let Some(block) = blocks.get(at) else {
            end(start, at);
            break;
        };
        let agrees = count == 0.0
            || follows(at)
                && (0..2).all(|of| {
                    let allowed = AGREE * (usual[of] / block.rows as f64).sqrt() + DRIFT[of];
                    (block.means[of] - sums[of] / count).norm() <= allowed
                });
        if quiet(block) && agrees {
            (0..2).for_each(|of| sums[of] += block.means[of]);
        } else {
            end(start, at);
            // a block that is quiet may begin another
            start = if quiet(block) { at } else { at + 1 };
            sums = if quiet(block) { block.means } else { [Vector3::zeros(); 2] };
        }
    }
    stretches
}

/// Those stretches whose gyros agree with most of the time.
fn of_one_rate(
    blocks: &[Block],
    stretches: Vec<std::ops::Range<usize>>,
    usual: f64,
) -> Vec<std::ops::Range<usize>> {
    let mean = |stretch: &std::ops::Range<usize>| {
        let sum: Vector3<f64> = blocks[stretch.clone()].iter().map(|block| block.means[0]).sum();
        sum / stretch.len() as f64
    };
    let means: Vec<Vector3<f64>> = stretches.iter().map(mean).collect();
    let near = |a: usize, b: usize| {
        let rows = blocks[stretches[a].clone()].iter().map(|block| block.rows).sum::<usize>().max(1);
        (means[a] - means[b]).norm() <= SAME_RATE + AGREE * (usual / rows as f64).sqrt()
    };
    let time = |of: usize| -> usize {
        (0..means.len()).filter(|other| near(*other, of)).map(|other| stretches[other].len()).sum()
    };
    // a log of thousands of rests is judged by some of them
    let Some(centre) = (0..means.len()).step_by(means.len() / 200 + 1).max_by_key(|of| time(*of)) else {
        return stretches;
    };
    (0..means.len()).filter(|of| near(*of, centre)).map(|of| stretches[of].clone()).collect()
}

fn rest(blocks: &[Block]) -> Rest {
    let (first, last) = (&blocks[0], &blocks[blocks.len() - 1]);
    let rows: usize = blocks.iter().map(|block| block.rows).sum();
    let mean = |of: usize| -> [f64; 3] {
        let sum: Vector3<f64> = blocks.iter().map(|block| block.means[of] * block.rows as f64).sum();
        (sum / rows as f64).into()
    };
    Rest {
        start_s: first.start,
        end_s: last.end,
        first_row: first.first_row,
        last_row: last.first_row + last.rows as u64 - 1,
        rate: mean(0),
        force: mean(1),
    }
}

/// Random walks from the scatter of the rows, or from that of the blocks' means where it is another: rows of a sensor behind a
/// filter are not independent.
fn noise(blocks: &[Block], stretches: &[std::ops::Range<usize>], interval: f64) -> Option<[Vector3<f64>; 2]> {
    let all: usize = stretches.iter().map(ExactSizeIterator::len).sum();
    let length = stretches.first().map(|stretch| &blocks[stretch.start])?.rows as f64 * interval;
    let mut noise = [Vector3::zeros(); 2];
    for (of, noise) in noise.iter_mut().enumerate() {
        let rows: Vector3<f64> = stretches
            .iter()
            .flat_map(|s| &blocks[s.clone()])
            .map(|block| block.variances[of])
            .sum::<Vector3<f64>>()
            / all as f64;
        let steps = stretches.iter().flat_map(|s| blocks[s.clone()].windows(2));
        let (mut squares, mut count) = (Vector3::zeros(), 0.0);
        for pair in steps {
            let step = pair[1].means[of] - pair[0].means[of];
            squares += step.component_mul(&step);
            count += 1.0;
        }
        // half the square of a difference is a variance
        let means: Vector3<f64> = squares * 0.5 / f64::max(count, 1.0);
        let by_rows = rows * interval;
        let by_means = means * length;
        let uncertain = 4.0 * (3.0 / f64::max(count, 1.0)).sqrt();
        *noise = by_rows.zip_map(&by_means, |rows, means| {
            let agree = (means / rows - 1.0).abs() <= uncertain.min(0.9);
            (if agree || count < 8.0 { rows } else { means }).sqrt()
        });
    }
    Some(noise)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Noise that is the same every time: a sum of twelve uniform numbers less their mean.
    struct Noise(u64);

    impl Noise {
        fn next(&mut self) -> f64 {
            let uniform = (0..12).map(|_| {
                self.0 =
                    self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (self.0 >> 11) as f64 / (1_u64 << 53) as f64
            });
            uniform.sum::<f64>() - 6.0
        }

        fn vector(&mut self) -> Vector3<f64> {
            Vector3::new(self.next(), self.next(), self.next())
        }
    }

    /// Rates and forces row by row at 100 Hz.
    fn found(seconds: f64, signal: impl Fn(f64) -> (Vector3<f64>, Vector3<f64>), scatter: [f64; 2]) -> Rests {
        let mut finder = RestFinder::new(0.01);
        let mut noise = Noise(1);
        for row in 1..=(seconds * 100.0) as usize {
            let time = row as f64 * 0.01;
            let (rate, force) = signal(time);
            finder.push(time, &(rate + noise.vector() * scatter[0]), &(force + noise.vector() * scatter[1]));
        }
        finder.finish()
    }

    /// Three seconds of rest, two of turning, again and again.
    fn carried(time: f64) -> (Vector3<f64>, Vector3<f64>) {
        let bias = Vector3::new(0.01, -0.02, 0.005);
        let turns = (time / 5.0).floor();
        let within = (time - 5.0 * turns - 3.0).max(0.0);
        let angle =
            std::f64::consts::FRAC_PI_2 * (turns + 0.5 - 0.5 * (std::f64::consts::PI * within / 2.0).cos());
        let angle = if within == 0.0 { std::f64::consts::FRAC_PI_2 * turns } else { angle };
        let rate = if within == 0.0 { 0.0 } else { 1.23 * (std::f64::consts::PI * within / 2.0).sin() };
        (bias + Vector3::x() * rate, Vector3::new(0.0, angle.sin(), angle.cos()) * 9.81)
    }

    #[test]
    fn rests_of_three_seconds_are_found_whatever_the_noise() {
        for scatter in [[1e-6, 1e-5], [1e-4, 1e-3], [2e-3, 0.03], [8e-3, 0.1]] {
            let Rests { rests, noise, .. } = found(100.0, carried, scatter);
            assert_eq!(rests.len(), 20, "{scatter:?}: {rests:?}");
            for (index, rest) in rests.iter().enumerate() {
                let start = 5.0 * index as f64;
                assert!(rest.start_s >= start - 0.25 && rest.end_s <= start + 3.45, "{rest:?}");
                assert!(rest.end_s - rest.start_s > 2.3, "{rest:?}");
            }
            let [gyro, accel] = noise.expect("noise");
            for (found, scatter) in [(gyro, scatter[0]), (accel, scatter[1])] {
                assert!(
                    found.iter().all(|walk| (walk / (scatter * 0.1) - 1.0).abs() < 0.12),
                    "{found} {scatter}"
                );
            }
        }
    }

    #[test]
    fn what_never_rests_has_no_rests() {
        let walk = |time: f64| {
            let shake = Vector3::new((7.0 * time).sin(), (11.0 * time).cos(), (5.0 * time).sin());
            (shake * 0.5, shake * 2.0 + Vector3::z() * 9.81)
        };
        assert!(found(60.0, walk, [1e-3, 0.02]).rests.is_empty());
        assert!(found(0.5, walk, [1e-3, 0.02]).rests.is_empty());
        assert!(RestFinder::new(0.01).finish().rests.is_empty());
    }

    #[test]
    fn an_even_turn_about_the_vertical_is_no_rest() {
        let table = |time: f64| {
            let turning = time % 20.0 > 12.0;
            (Vector3::z() * if turning { 0.17 } else { 0.0 }, Vector3::z() * 9.81)
        };
        let rests = found(100.0, table, [1e-5, 1e-3]).rests;
        assert_eq!(rests.len(), 5);
        assert!(
            rests.iter().all(|rest| rest.rate[2].abs() < 0.01 && rest.end_s - rest.start_s > 11.0),
            "{rests:?}"
        );
    }
}
