//! A reference that is slower than the rows, written again in every row until the next reading: only the first of the same counts.

use super::columns::{Batch, Group};

/// The groups of which it may be so.
const GROUPS: [Group; 3] = [Group::REF_VEL, Group::REF_POS, Group::REF_QUAT];
/// So many changes show how long a reading is held.
const ENOUGH: usize = 8;
/// This part of the runs has the usual length.
const USUAL: f64 = 0.8;

/// Rows for which each group holds a reading: 1 where every row has one of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Period([usize; 3]);

impl Period {
    /// Every row has its own reading.
    pub(super) const NONE: Self = Self([1; 3]);

    /// What the first rows of a log show.
    pub(super) fn of(batch: &Batch) -> Self {
        Self(GROUPS.map(|group| usual_run(batch, group)))
    }

    /// What to say of it.
    pub(super) fn notes(self) -> impl Iterator<Item = String> {
        let names = ["ref_vel", "ref_pos", "ref_quat"];
        names.into_iter().zip(self.0).filter(|(_, rows)| *rows > 1).map(|(name, rows)| {
            format!("{name}_* holds each reading for {rows} rows: it is used once, in the first of them")
        })
    }
}

fn reading(batch: &Batch, group: Group, row: usize) -> [f64; 4] {
    std::array::from_fn(|of| if of < group.len { batch.cell(group.first + of, row) } else { 0.0 })
}

/// The usual number of equal readings in a row; 1 unless nearly all runs are of that length.
fn usual_run(batch: &Batch, group: Group) -> usize {
    let mut runs = Vec::new();
    let (mut last, mut run) = ([f64::NAN; 4], 0);
    for row in 0..batch.rows {
        let now = reading(batch, group, row);
        // nothing, and zero, are no readings that could be held
        let counts =
            now.iter().all(|value| value.is_finite()) && now[..group.len].iter().any(|value| *value != 0.0);
        if counts && now == last {
            run += 1;
        } else {
            if run > 0 {
                runs.push(run);
            }
            run = usize::from(counts);
            last = now;
        }
    }
    // the first run may have begun before the log
    runs.get_mut(1..).filter(|runs| runs.len() >= ENOUGH).map_or(1, |runs| {
        runs.sort_unstable();
        let usual = runs[runs.len() / 2];
        let near = runs.iter().filter(|run| run.abs_diff(usual) <= 1).count();
        if near as f64 >= USUAL * runs.len() as f64 && runs[0] > 1 { usual } else { 1 }
    })
}

/// Leaves the first of equal readings, and one for every further period: at rest a reading is the same again.
pub(super) struct Held {
    period: Period,
    last: [([f64; 4], usize); 3],
}

impl Held {
    pub(super) fn new(period: Period) -> Self {
        Self { period, last: [([f64::NAN; 4], 0); 3] }
    }

    pub(super) fn apply(&mut self, batch: &mut Batch) {
        for ((group, period), last) in GROUPS.into_iter().zip(self.period.0).zip(&mut self.last) {
            if period == 1 {
                continue;
            }
            for row in 0..batch.rows {
                let now = reading(batch, group, row);
                if now == last.0 && last.1 < period {
                    last.1 += 1;
                    for slot in group.slots() {
                        if let Some(value) = batch.column_mut(slot).get_mut(row) {
                            *value = f64::NAN;
                        }
                    }
                } else {
                    *last = (now, 1);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn batch(rows: usize, value: impl Fn(usize) -> f64) -> Batch {
        let mut batch = Batch::new();
        for slot in Group::REF_POS.slots() {
            *batch.column_mut(slot) = (0..rows).map(&value).collect();
        }
        batch.rows = rows;
        batch
    }

    fn left(batch: &Batch) -> Vec<usize> {
        (0..batch.rows).filter(|row| batch.cell(Group::REF_POS.first, *row).is_finite()).collect()
    }

    #[test]
    fn held_readings_count_once_and_again_at_rest() {
        let walk = |row: usize| (row / 20) as f64 + 1.0;
        let mut held = batch(400, walk);
        let period = Period::of(&held);
        assert_eq!(period, Period([1, 20, 1]));
        assert_eq!(period.notes().count(), 1);
        // from row 200 on the unit stands, and the reading stays the same
        let mut stage = Held::new(period);
        held = batch(400, |row| walk(row.min(200)));
        stage.apply(&mut held);
        assert_eq!(left(&held), (0..20).map(|reading| 20 * reading).collect::<Vec<_>>());
    }

    #[test]
    fn readings_of_their_own_and_zeros_stay() {
        for value in [&(|row: usize| row as f64) as &dyn Fn(usize) -> f64, &|_| 0.0, &|_| 5.0] {
            let mut own = batch(400, value);
            assert_eq!(Period::of(&own), Period::NONE);
            Held::new(Period::of(&own)).apply(&mut own);
            assert_eq!(left(&own).len(), 400);
        }
    }
}
