//! What a search changes: turns, and how the time that they leave is shared among the rests.

use rig::motion::Turn;
use rig::random::Stream;

use crate::search::{Way, takes};
use crate::table::Table;

/// A path of random turns has one in about so many seconds, or in as many as its turns take and this.
const PACE: f64 = 16.0;
/// The rest before the first turn gets no less than this, s.
const LEAST_STILL: f64 = 5.0;
/// One change in so many is another one.
const KINDS: usize = 10;

/// A path whose rests share what time its turns leave.
#[derive(Clone, Debug)]
pub(crate) struct Draft {
    turns: Vec<Turn>,
    /// Shares of the rests: the first one, then those after each turn.
    shares: Vec<f64>,
}

/// What a path may be made of.
pub(crate) struct Limits {
    table: Table,
    rates: Vec<f64>,
    acceleration: f64,
    duration: f64,
}

fn place(random: &mut Stream, of: usize) -> usize {
    ((random.uniform() * of as f64) as usize).min(of - 1)
}

fn pick<'a, T>(random: &mut Stream, of: &'a [T]) -> &'a T {
    &of[place(random, of.len())]
}

impl Limits {
    pub(crate) fn new(table: Table, max_rate: f64, acceleration: f64, duration: f64) -> Self {
        let rates = table.rates().iter().map(|rate| rate.to_radians());
        let mut rates: Vec<f64> = rates.filter(|rate| *rate <= max_rate).collect();
        if rates.is_empty() {
            rates.push(max_rate);
        }
        Self { table, rates, acceleration, duration }
    }

    fn turn(&self, random: &mut Stream) -> Turn {
        let sign = if random.uniform() < 0.5 { -1.0 } else { 1.0 };
        Turn {
            axis: *pick(random, self.table.axes()),
            angle: sign * pick(random, self.table.angles()).to_radians(),
            rate: if random.uniform() < 0.7 { self.rates[0] } else { *pick(random, &self.rates) },
            dwell: 0.0,
        }
    }

    /// Some turns with rests of about the same length.
    pub(crate) fn random(&self, random: &mut Stream) -> Draft {
        let pace = PACE + self.table.least_dwell();
        let many = self.duration / pace * (0.4 + 1.2 * random.uniform());
        let turns: Vec<Turn> = (0..(many as usize).max(3)).map(|_| self.turn(random)).collect();
        let shares = (0..=turns.len()).map(|_| 0.5 + random.uniform()).collect();
        Draft { turns, shares }
    }

    /// A path that is known.
    pub(crate) fn draft(&self, (still, turns): &Way) -> Draft {
        let least = self.table.least_dwell();
        let rests = turns.iter().map(|turn| (turn.dwell - least).max(0.01));
        Draft {
            turns: turns.clone(),
            shares: [(still - LEAST_STILL).max(0.01)].into_iter().chain(rests).collect(),
        }
    }

    /// One to three changes.
    pub(crate) fn change(&self, from: &Draft, random: &mut Stream) -> Draft {
        let mut draft = from.clone();
        for _ in 0..=place(random, 3) {
            let turns = draft.turns.len();
            let at = place(random, turns);
            match place(random, KINDS) {
                0 | 1 => draft.turns[at] = self.turn(random),
                2 => {
                    draft.turns.insert(at, self.turn(random));
                    // the rest before it is divided
                    let part = draft.shares[at] * (0.2 + 0.6 * random.uniform());
                    draft.shares[at] -= part;
                    draft.shares.insert(at + 1, part);
                }
                3 if turns > 2 => {
                    draft.turns.remove(at);
                    let share = draft.shares.remove(at + 1);
                    draft.shares[at] += share;
                }
                4 => draft.turns.swap(at, place(random, turns)),
                5 => draft.turns[at].angle = -draft.turns[at].angle,
                6 => draft.turns[at].rate = *pick(random, &self.rates),
                7 => {
                    let (a, b) = (place(random, turns + 1), place(random, turns + 1));
                    draft.shares.swap(a, b);
                }
                _ => draft.shares[place(random, turns + 1)] *= random.normal().exp(),
            }
        }
        draft
    }

    /// The changes of a polish: each rest longer and shorter by a factor, each turn at the rates beside its own.
    pub(crate) fn changes(&self, from: &Draft, factor: f64) -> Vec<Draft> {
        let rests = from.shares.len();
        (0..2 * rests + 2 * from.turns.len())
            .map(|change| {
                let mut draft = from.clone();
                self.make(&mut draft, change, factor);
                draft
            })
            .collect()
    }

    /// All of these changes that are wanted, made together.
    pub(crate) fn together(&self, from: &Draft, factor: f64, wanted: &[bool]) -> Draft {
        let mut draft = from.clone();
        for change in (0..wanted.len()).filter(|change| wanted[*change]) {
            self.make(&mut draft, change, factor);
        }
        draft
    }

    fn make(&self, draft: &mut Draft, change: usize, factor: f64) {
        let (which, up, rests) = (change / 2, change.is_multiple_of(2), draft.shares.len());
        if which < rests {
            draft.shares[which] *= if up { factor } else { 1.0 / factor };
            return;
        }
        let turn = &mut draft.turns[which - rests];
        let now = self.rates.iter().position(|rate| *rate <= turn.rate).unwrap_or(0);
        let next = if up { now.saturating_sub(1) } else { (now + 1).min(self.rates.len() - 1) };
        turn.rate = self.rates[next];
    }

    /// The path, when it fits.
    pub(crate) fn path(&self, draft: &Draft) -> Option<Way> {
        let turning: f64 = draft.turns.iter().map(|turn| takes(turn, self.acceleration)).sum();
        let least = self.table.least_dwell();
        let left = self.duration - turning - LEAST_STILL - least * draft.turns.len() as f64;
        if left < 0.0 {
            return None;
        }
        let whole: f64 = draft.shares.iter().sum();
        // tenths of a second can be set on a table; what rounding leaves goes to the first rest
        let rest = |share: &f64| (left * share / whole * 10.0).floor() / 10.0;
        let mut turns = draft.turns.clone();
        for (turn, share) in turns.iter_mut().zip(&draft.shares[1..]) {
            turn.dwell = least + rest(share);
        }
        let resting: f64 = turns.iter().map(|turn| turn.dwell).sum();
        Some((self.duration - turning - resting, turns))
    }
}
