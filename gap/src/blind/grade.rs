//! How a diagnosis is scored, and how a series of them is summed up.

use core::fmt;

use serde::Serialize;

use super::Trial;

/// How a diagnosis did.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Grade {
    /// The one right answer.
    Right,
    /// The truth is in a list of at most three, or something was flagged without its name.
    Half,
    /// Nothing was said where something is.
    Miss,
    /// A wrong name, confirmed.
    Wrong,
    /// Something was said where nothing is.
    Alarm,
}

const GRADES: [(Grade, &str); 5] = [
    (Grade::Right, "right"),
    (Grade::Half, "half"),
    (Grade::Miss, "miss"),
    (Grade::Wrong, "wrong"),
    (Grade::Alarm, "alarm"),
];

impl Grade {
    /// What it counts.
    pub fn points(self) -> f64 {
        match self {
            Self::Right => 1.0,
            Self::Half => 0.5,
            Self::Miss => 0.0,
            Self::Wrong => -2.0,
            Self::Alarm => -1.0,
        }
    }
}

/// Strengths of single effects that are counted together: up to, name.
const STRENGTHS: [(f64, &str); 5] = [
    (5.0, "shows at less than 5"),
    (7.0, "shows at 5 to 7"),
    (10.0, "shows at 7 to 10"),
    (14.0, "shows at 10 to 14"),
    (f64::INFINITY, "shows at more than 14"),
];

/// A series of trials in numbers: one row for each kind of case, in the order of their names.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Table {
    /// Counts by kind: right, half, miss, wrong, alarm.
    pub rows: Vec<(&'static str, [usize; 5])>,
    /// The same for single effects, by the number of standard deviations at which they show to the filter.
    pub strengths: Vec<(&'static str, [usize; 5])>,
    /// Mean score; 1 is perfect.
    pub score: f64,
    /// Normalised squared error of the values of right names, per degree of freedom; 1 is expected.
    pub nees_per_dof: f64,
}

impl Table {
    /// Sums up `trials`.
    pub fn of(trials: &[Trial]) -> Self {
        let strengths = STRENGTHS.iter().map(|s| (s.1, [0; 5])).collect();
        let mut table = Self { strengths, ..Self::default() };
        let mut points = 0.0;
        let mut nees = (0.0, 0);
        for trial in trials {
            let at = table.rows.iter().position(|r| r.0 == trial.kind).unwrap_or_else(|| {
                table.rows.push((trial.kind, [0; 5]));
                table.rows.len() - 1
            });
            for (count, (grade, _)) in table.rows[at].1.iter_mut().zip(GRADES) {
                *count += usize::from(grade == trial.grade);
            }
            if let Some(strength) = trial.strength
                && let Some(at) = STRENGTHS.iter().position(|s| strength < s.0)
            {
                for (count, (grade, _)) in table.strengths[at].1.iter_mut().zip(GRADES) {
                    *count += usize::from(grade == trial.grade);
                }
            }
            points += trial.grade.points();
            if let Some((sum, n)) = trial.nees {
                nees = (nees.0 + sum, nees.1 + n);
            }
        }
        table.rows.sort_unstable_by_key(|r| r.0);
        table.score = points / trials.len().max(1) as f64;
        table.nees_per_dof = nees.0 / f64::from(nees.1.max(1) as u32);
        table
    }

    /// How many cases ended with `grade`.
    pub fn count(&self, grade: Grade) -> usize {
        let at = GRADES.iter().position(|g| g.0 == grade).unwrap_or_default();
        self.rows.iter().map(|r| r.1[at]).sum()
    }

    /// Number of cases.
    pub fn cases(&self) -> usize {
        self.rows.iter().map(|r| r.1.iter().sum::<usize>()).sum()
    }
}

/// Bounds that hold the true rate with 95 % (Wilson), of `k` out of `n`.
fn wilson(k: usize, n: usize) -> (f64, f64) {
    let (k, n, z) = (k as f64, n.max(1) as f64, 1.959_963_984_540_054);
    let centre = (k + z * z / 2.0) / (n + z * z);
    let half = z / (n + z * z) * (k * (n - k) / n + z * z / 4.0).sqrt();
    ((centre - half).max(0.0), (centre + half).min(1.0))
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:26}", "hidden")?;
        for (_, name) in GRADES {
            write!(f, " {name:>6}")?;
        }
        let rows = |rows: &[(&str, [usize; 5])], f: &mut fmt::Formatter<'_>| {
            for (kind, counts) in rows {
                write!(f, "\n{kind:26}")?;
                for count in counts {
                    write!(f, " {count:6}")?;
                }
            }
            Ok(())
        };
        rows(&self.rows, f)?;
        write!(f, "\n{:26}", "all")?;
        for (grade, _) in GRADES {
            write!(f, " {:6}", self.count(grade))?;
        }
        write!(f, "\nsingle effects, by sigmas at which they show to the filter:")?;
        rows(&self.strengths, f)?;
        writeln!(f)?;
        for (grade, name) in
            [(Grade::Right, "right"), (Grade::Wrong, "wrong names"), (Grade::Alarm, "alarms")]
        {
            let (low, high) = wilson(self.count(grade), self.cases());
            writeln!(f, "{name}: {:.1} % to {:.1} % (95 %)", 100.0 * low, 100.0 * high)?;
        }
        writeln!(f, "squared error of right names over its variance: {:.2}", self.nees_per_dof)?;
        write!(f, "score {:.3} over {} cases", self.score, self.cases())
    }
}
