//! What the sigmas are made of, and what was taken as exact.

use std::fmt::Write as _;

use logs::Log;
use logs::units::{DEGREE, MICRO_G};
use reports::figures::significant;
use reports::{Cell, Section, Table, number, parts, text};
use runs::{Budget, Exact, Outcome};
use serde::{Serialize, Serializer};
use sinscal::effect;

/// Factor of the expanded uncertainty.
const COVERAGE: f64 = 2.0;
/// So many contributions are named in a line, if they are at least this part of the whole.
const NAMED: usize = 3;
const WORTH_A_WORD: f64 = 0.1;
/// Degrees of freedom that are as good as infinitely many: Student's factor for 95 % is within 1 % of the normal one.
const MANY: f64 = 200.0;

/// The budget of a parameter as files have it; standard uncertainties in its SI unit.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Entry {
    budget: Parts,
    /// Expanded uncertainty.
    expanded: f64,
    /// Effective degrees of freedom; none where there are as many as one likes.
    degrees_of_freedom: Option<f64>,
}

/// Contributions by name.
#[derive(Clone, Debug)]
struct Parts(Vec<(&'static str, f64)>);

impl Serialize for Parts {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().copied())
    }
}

impl Entry {
    /// Of a parameter, by its place.
    pub(super) fn of(outcome: &Outcome, parameter: usize) -> Option<Self> {
        let budget = outcome.budget.iter().find(|budget| budget.parameter == parameter)?;
        Some(Self {
            budget: Parts(contributions(budget)),
            expanded: COVERAGE * budget.combined(),
            degrees_of_freedom: freedom(budget),
        })
    }
}

/// Everything that a sigma is made of, by name.
fn contributions(budget: &Budget) -> Vec<(&'static str, f64)> {
    let own = [
        ("noise", budget.noise),
        ("wander", budget.wander),
        ("linearisation", budget.linearisation),
        ("repeatability", budget.repeatability),
    ];
    let noise_first = own.into_iter().filter(|(name, part)| *part > 0.0 || *name == "noise");
    noise_first.chain(budget.influences.iter().copied()).collect()
}

fn freedom(budget: &Budget) -> Option<f64> {
    let freedom = budget.degrees_of_freedom();
    (freedom < MANY).then_some(freedom)
}

/// The contributions that matter, the largest first.
fn largest(budget: &Budget) -> Vec<(&'static str, f64)> {
    let combined = budget.combined();
    let mut all = contributions(budget);
    all.retain(|(_, part)| *part > WORTH_A_WORD * combined);
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    all.truncate(NAMED);
    all
}

/// The budgets of what was estimated.
fn estimated(outcome: &Outcome) -> impl Iterator<Item = &Budget> {
    outcome.budget.iter().filter(|budget| outcome.parameters[budget.parameter].estimated)
}

/// Standard deviations that nobody stated, in sentences.
pub(super) fn assumed(names: &[&str], log: &Log) -> Vec<String> {
    let sentence = |name: &&str| {
        let (size, unit) = size(name, log.description().prior(name));
        format!("{name} is uncertain by {} {unit}", significant(size))
    };
    names.iter().map(sentence).collect()
}

/// An uncertainty of an effect in its unit of data sheets.
fn size(name: &str, si: f64) -> (f64, &'static str) {
    effect(name).map_or((si, ""), |effect| (si / effect.sheet_scale, effect.sheet_unit))
}

/// The budgets for people; nothing where nothing is considered. Writing to a string does not fail.
pub(super) fn table(outcome: &Outcome) -> String {
    let mut table = String::new();
    if outcome.budget.is_empty() {
        return table;
    }
    let _ = writeln!(
        table,
        "\nuncertainty budget: combined standard uncertainty, expanded uncertainty U (coverage factor k = {COVERAGE:.0}, about 95 %), effective \
         degrees of freedom\n{:30} {:>10} {:>10} {:>7}  {:10}  largest contributions",
        "parameter", "combined", "U", "freedom", "unit"
    );
    for budget in estimated(outcome) {
        let info = &outcome.parameters[budget.parameter].info;
        let scale = info.sheet_scale;
        let named = largest(budget);
        let named: Vec<String> =
            named.iter().map(|(name, part)| format!("{name} {}", significant(part / scale))).collect();
        let _ = writeln!(
            table,
            "{:30} {:>10} {:>10} {:>7}  {:10}  {}",
            format!("{} {}", info.block, info.component),
            significant(budget.combined() / scale),
            significant(COVERAGE * budget.combined() / scale),
            freedom(budget).map_or("many".into(), |freedom| format!("{freedom:.0}")),
            info.sheet_unit,
            named.join(", ")
        );
    }
    table
}

/// The budgets in a report: how much of each variance is whose.
pub(super) fn section(outcome: &Outcome) -> Option<Section> {
    if outcome.budget.is_empty() {
        return None;
    }
    let row = |budget: &Budget| {
        let info = &outcome.parameters[budget.parameter].info;
        let combined = budget.combined();
        let mut row = vec![
            text(parts::name(info)),
            number(significant(combined / info.sheet_scale)),
            number(significant(COVERAGE * combined / info.sheet_scale)),
            text(info.sheet_unit),
        ];
        let mut named = largest(budget).into_iter();
        row.extend((0..NAMED).map(|_| {
            named.next().map_or(Cell::Text(String::new()), |(name, part)| {
                let share = (part / combined).powi(2);
                Cell::Bar(share, format!("{name} {:.0} %", 100.0 * share))
            })
        }));
        row
    };
    let caption = "Combined standard uncertainty u and expanded uncertainty U = 2 u, and the largest shares of the variance: noise, wander and \
                   repeatability were observed (type A), the others are what was stated, times the sensitivity of the estimate, with the \
                   noise of the readings that these make it lean on (type B).";
    let head = ["parameter", "u", "U", "unit", "largest", "second", "third"];
    let table = Table::new(caption, &head, estimated(outcome).map(row).collect()).drawn_as("budget");
    Some(Section::new("Uncertainty budget", vec![table.into()]))
}

/// What was taken as exact, in a line.
pub(super) fn exact(outcome: &Outcome, exact: &Exact) -> Option<String> {
    let (influence, place, by) = exact.largest(outcome)?;
    let parameter = &outcome.parameters[place];
    let si = exact.sigmas.iter().find(|(name, _)| *name == influence)?.1;
    let (amount, unit) = size(influence, si);
    Some(format!(
        "taken as exact: site, clock, thermometers, pick-offs; {influence} off by {} {unit} would add {} {} to {} ({} of its sigmas); --budget \
         counts them in",
        significant(amount),
        significant(by / parameter.info.sheet_scale),
        parameter.info.sheet_unit,
        parts::name(&parameter.info),
        significant(by / parameter.sigma)
    ))
}

/// How much wander of the biases the sigmas bear, in a line: what would double the first of them.
pub(super) fn wander(outcome: &Outcome, exact: &Exact) -> Option<String> {
    let all = (0..outcome.parameters.len()).filter(|i| outcome.parameters[*i].estimated);
    let doubled: Vec<_> = all.map(|i| (i, exact.doubled_by(outcome, i))).collect();
    let units = [("gyro biases", DEGREE / 3600.0, "deg/h"), ("accelerometer biases", MICRO_G, "ug")];
    let least = units.into_iter().enumerate().filter_map(|(kind, (what, scale, unit))| {
        let found = doubled.iter().filter_map(|(i, by)| by[kind].map(|by| (*i, by)));
        let (i, by) = found.min_by(|a, b| a.1.total_cmp(&b.1))?;
        let name = parts::name(&outcome.parameters[i].info);
        Some(format!(
            "{what} that wander by {} {unit} over an hour double the sigma of {name}",
            significant(by / scale)
        ))
    });
    let least: Vec<String> = least.collect();
    (!least.is_empty()).then(|| least.join("; "))
}
