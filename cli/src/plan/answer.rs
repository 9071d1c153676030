//! What a plan is, for machines and for people.

use std::fmt::Write;
use std::path::Path;

use calib_core::Dynamics;
use miette::{IntoDiagnostic, Result};
use plan::{Criterion, Expected, Group, Known, Table, groups};
use reports::figures::significant;
use reports::{Cell, Drawing, Item, Report, Section, Stand, Tone, number, text};
use rig::Scenario;
use rig::motion::{Axis, Turn};
use runs::AnyFilter;
use serde::Serialize;
use sinscal::Strapdown;

use super::verify::Verified;
use crate::origin::Documented as _;
use crate::output::Target;

/// `plan --json`.
#[derive(Serialize)]
pub(super) struct Answer {
    filter: String,
    duration_s: f64,
    still_s: f64,
    turns: Vec<Told>,
    sigma: Vec<Sigma>,
    /// Rank of the observability matrix along the path.
    pub(super) rank: usize,
    /// The worst of the ratios to what is asked for.
    criterion: Option<f64>,
    /// What noise would leave of it if for each effect all the others were known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) bound: Option<f64>,
    /// By effect, where the plan was designed.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    effects: Vec<Effect>,
    /// Paths of the literature in the same time.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    known: Vec<Literature>,
    /// What simulated units say of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) verified: Option<Verified>,
    #[serde(skip)]
    hand: bool,
    /// C_bn at the beginning and after each turn.
    #[serde(skip)]
    attitudes: Vec<nalgebra::Matrix3<f64>>,
}

/// How an effect's worst sigma compares.
#[derive(Serialize)]
struct Effect {
    name: String,
    /// To that of the path to compare with.
    #[serde(skip_serializing_if = "Option::is_none")]
    to_reference: Option<f64>,
    /// To what is asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    to_asked: Option<f64>,
    /// The part of it that noise would leave if all other effects were known.
    noise_part: f64,
}

/// A path of the literature.
#[derive(Serialize)]
struct Literature {
    name: &'static str,
    source: &'static str,
    turns: usize,
    criterion: f64,
}

/// A turn.
#[derive(Serialize)]
pub(super) struct Told {
    pub(super) axis: &'static str,
    pub(super) angle_deg: f64,
    pub(super) rate_deg_s: f64,
    pub(super) dwell_s: f64,
}

#[derive(Serialize)]
struct Sigma {
    name: &'static str,
    component: &'static str,
    sigma: f64,
    unit: &'static str,
    #[serde(skip)]
    sheet: (f64, &'static str),
}

/// As a table takes it, without the digits of rounding.
fn tidy(x: f64) -> f64 {
    format!("{x:.9}").parse().unwrap_or(x)
}

impl Told {
    fn new(turn: &Turn) -> Self {
        let triad = if matches!(turn.axis, Axis::Body(_)) { 0 } else { 3 };
        Self {
            axis: Axis::NAMES[triad + turn.axis.index()],
            angle_deg: tidy(turn.angle.to_degrees()),
            rate_deg_s: tidy(turn.rate.to_degrees()),
            dwell_s: tidy(turn.dwell),
        }
    }
}

impl Answer {
    /// Of a path that was given.
    pub(super) fn judged(filter: &dyn AnyFilter, expected: &Expected, turns: Vec<Turn>) -> Self {
        let sigma = |(info, sigma): &(sinscal::StateInfo, f64)| Sigma {
            name: info.block,
            component: info.component,
            sigma: *sigma,
            unit: info.unit,
            sheet: (info.sheet_scale, info.sheet_unit),
        };
        Self {
            filter: filter.title(),
            duration_s: tidy(expected.duration),
            still_s: 0.0,
            turns: turns.iter().map(Told::new).collect(),
            sigma: expected.sigma.iter().map(sigma).collect(),
            rank: 0,
            criterion: None,
            bound: None,
            effects: Vec::new(),
            known: Vec::new(),
            verified: None,
            hand: false,
            attitudes: Vec::new(),
        }
    }

    /// Of a path that was designed.
    pub(super) fn designed(
        filter: &dyn AnyFilter,
        expected: &Expected,
        turns: Vec<Turn>,
        table: Table,
    ) -> Self {
        let hand = table == Table::Hand;
        Self { hand, ..Self::judged(filter, expected, turns) }
    }

    /// Says how it compares, and what noise alone would leave.
    pub(super) fn compare(
        &mut self,
        criterion: &Criterion,
        expected: &Expected,
        reference: &Expected,
        alone: &[Group],
    ) {
        self.criterion = Some(criterion.of(expected));
        let find = |list: &[Group], name: &str| {
            list.iter().find(|(other, _)| other == name).map(|(_, value)| *value)
        };
        let (reference, asked) = (groups(reference), criterion.ratios(expected));
        let effect = |(name, sigma): Group| Effect {
            to_reference: find(&reference, &name).map(|other| sigma / other),
            to_asked: find(&asked, &name),
            noise_part: find(alone, &name).map_or(f64::NAN, |alone| alone / sigma),
            name,
        };
        self.effects = groups(expected).into_iter().map(effect).collect();
    }

    /// Adds a path of the literature.
    pub(super) fn known(&mut self, known: &Known, turns: usize, criterion: f64) {
        self.known.push(Literature { name: known.name, source: known.source, turns, criterion });
    }

    /// Says how the unit stands at the beginning and after each turn.
    pub(super) fn starts(&mut self, scenario: &Scenario) {
        self.attitudes = scenario.motion.attitudes();
        if !self.turns.is_empty() {
            self.still_s = tidy(scenario.motion.still);
        }
    }

    pub(super) fn filter(&self) -> &str {
        &self.filter
    }

    pub(super) fn duration(&self) -> f64 {
        self.duration_s
    }

    pub(super) fn still(&self) -> f64 {
        self.still_s
    }

    pub(super) fn turns(&self) -> &[Told] {
        &self.turns
    }

    fn verdict(&self) -> String {
        let criterion = self.criterion.map_or_else(String::new, |value| format!(", criterion {value:.3}"));
        let bound = self.bound.map_or_else(String::new, |value| format!(" (noise alone {value:.3})"));
        let verified = self.verified.as_ref().map_or_else(String::new, |verified| format!("; {verified}"));
        format!(
            "{}: {:.0} s, {} turns, rank {}{criterion}{bound}{verified}",
            self.filter,
            self.duration_s,
            self.turns.len(),
            self.rank
        )
    }

    /// What the path shows, as a page begins.
    fn headline(&self) -> String {
        let states = self.sigma.len() + <Strapdown as Dynamics>::CORE;
        let shown = if self.rank == states {
            format!("all {states}")
        } else {
            format!("{} of the {states}", self.rank)
        };
        let (turns, seconds) = (self.turns.len(), self.duration_s);
        let verified = self.verified.as_ref().map_or_else(String::new, |verified| format!("\n{verified}"));
        format!("{turns} turns in {seconds:.0} s show {shown} states of {}{verified}", self.filter)
    }

    /// The numbers that a page begins with.
    fn facts(&self) -> Vec<(String, String)> {
        let mut facts = Vec::new();
        if let Some(criterion) = self.criterion {
            facts.push(("worst sigma, of what is asked for".into(), format!("{criterion:.3}")));
        }
        if let Some(bound) = self.bound {
            facts.push(("of it noise alone would leave".into(), format!("{bound:.3}")));
        }
        if let [first, ..] = self.known.as_slice() {
            let best = self.known.iter().min_by(|a, b| a.criterion.total_cmp(&b.criterion)).unwrap_or(first);
            facts.push((format!("the best known path, {}", best.name), format!("{:.3}", best.criterion)));
        }
        facts
    }

    /// What an operator does, line by line.
    fn steps(&self) -> Vec<String> {
        let first = (self.still_s > 0.0).then(|| format!("rest {:.1} s", self.still_s));
        let step = |turn: &Told| {
            if self.hand {
                let way = if turn.angle_deg > 0.0 { "right-handed" } else { "left-handed" };
                format!(
                    "turn it by {:.0} deg about its {} axis, {way}, put it down and wait {:.0} s",
                    turn.angle_deg.abs(),
                    turn.axis,
                    turn.dwell_s
                )
            } else {
                format!(
                    "{} by {:+.0} deg at {:.0} deg/s, rest {:.1} s",
                    turn.axis, turn.angle_deg, turn.rate_deg_s, turn.dwell_s
                )
            }
        };
        first.into_iter().chain(self.turns.iter().map(step)).collect()
    }

    fn text(&self) -> String {
        let mut text = format!("{}\n", self.verdict());
        // writing to a string cannot fail
        for (i, step) in self.steps().iter().enumerate() {
            let _ = writeln!(text, "{:4}. {step}", i + 1);
        }
        text += "\nsigma to expect\n";
        for sigma in &self.sigma {
            let name = format!("{} {}", sigma.name, sigma.component);
            let _ = writeln!(
                text,
                "  {name:32} {:>10} {}",
                significant(sigma.sigma / sigma.sheet.0),
                sigma.sheet.1
            );
        }
        if !self.effects.is_empty() {
            text += "\nworst component: to the path compared with, to what is asked for, part that noise alone would leave\n";
        }
        for effect in &self.effects {
            let ratio =
                |ratio: Option<f64>| ratio.map_or_else(|| "-".to_owned(), |ratio| format!("{ratio:.3}"));
            let (reference, asked) = (ratio(effect.to_reference), ratio(effect.to_asked));
            let _ =
                writeln!(text, "  {:32} {reference:>10} {asked:>10} {:10.2}", effect.name, effect.noise_part);
        }
        if !self.known.is_empty() {
            text += "\ncriterion of known paths in the same time, all rests alike\n";
        }
        for known in &self.known {
            let name = format!("{}, {} turns", known.name, known.turns);
            let _ = writeln!(text, "  {name:32} {:10.3}  {}", known.criterion, known.source);
        }
        text
    }

    /// Writes and prints it, with the scenario where there is one.
    pub(super) fn finish(
        self,
        target: Target<'_>,
        base: Option<&Path>,
        scenario: Option<&str>,
    ) -> Result<()> {
        let json = serde_json::to_string_pretty(&self).into_diagnostic()? + "\n";
        let (said, verdict) = (self.text(), self.verdict());
        target.write("plan", &json, &said, &verdict, |files, folder| {
            if let Some(scenario) = scenario {
                files.write(&folder.join("scenario.toml"), |file| file.write_all(scenario.as_bytes()))?;
            }
            self.page().with_program().with_scenario(base).write(files, folder)
        })
    }

    /// A picture of the unit at each rest.
    fn drawing(&self) -> Option<Item> {
        let step = |(k, attitude): (usize, &nalgebra::Matrix3<f64>)| {
            let rest =
                if k == 0 { self.still_s } else { self.turns.get(k - 1).map_or(0.0, |turn| turn.dwell_s) };
            Stand {
                label: format!("{}: {rest:.0} s", k + 1),
                axes: [0, 1, 2].map(|i| attitude.column(i).into()),
            }
        };
        let stands: Vec<Stand> = self.attitudes.iter().enumerate().map(step).collect();
        let caption = "Seen from the south and above; east is to the right. x, y, z are the axes of the unit's body. Numbers are those of \
                       the steps, times those of the rests.";
        (!self.turns.is_empty()).then(|| Drawing::of_stands("stands", caption, &stands).into())
    }

    fn page(&self) -> Report {
        let rows = self.sigma.iter().map(|sigma| {
            let name = format!("{} {}", sigma.name, sigma.component);
            vec![text(name), number(significant(sigma.sigma / sigma.sheet.0)), text(sigma.sheet.1)]
        });
        let sigmas = reports::Table::new("", &["parameter", "sigma", "unit"], rows.collect());
        let steps = self
            .steps()
            .into_iter()
            .enumerate()
            .map(|(i, step)| vec![number((i + 1).to_string()), text(step)]);
        let steps = reports::Table::new("", &["step", "what is done"], steps.collect());
        let effects = self.effects.iter().map(|effect| {
            let ratio = |ratio: Option<f64>| {
                ratio.map_or_else(|| text("-"), |ratio| Cell::Bar(0.5 * ratio, format!("{ratio:.3}")))
            };
            vec![
                text(effect.name.clone()),
                ratio(effect.to_reference),
                ratio(effect.to_asked),
                Cell::Bar(effect.noise_part, format!("{:.2}", effect.noise_part)),
            ]
        });
        let effects = reports::Table::new(
            "Sigma of the worst component of each effect. Where noise alone would leave most of it, only more time helps; elsewhere other \
             effects are mistaken for it, and other turns may help.",
            &["effect", "to the path compared with", "to what is asked for", "noise alone"],
            effects.collect(),
        )
        .drawn_as("effects");
        let known = self.known.iter().map(|known| {
            vec![
                text(known.name),
                number(known.turns.to_string()),
                number(format!("{:.3}", known.criterion)),
                text(known.source),
            ]
        });
        let known = reports::Table::new("", &["path", "turns", "criterion", "source"], known.collect());
        let mut sections = vec![Section::new("What is done", vec![steps.into()])];
        if let Some(drawing) = self.drawing() {
            sections.push(Section::new("How the unit stands", vec![drawing]));
        }
        sections.push(Section::new("Sigmas to expect", vec![sigmas.into()]));
        if !self.effects.is_empty() {
            sections.push(Section::new("What limits it", vec![effects.into()]));
        }
        if !self.known.is_empty() {
            sections.push(Section::new("Known paths in the same time", vec![known.into()]));
        }
        Report {
            title: format!("Plan for {}", self.filter),
            verdict: self.headline(),
            tone: Tone::Neutral,
            facts: self.facts(),
            sections,
            origin: Vec::new(),
            attachments: Vec::new(),
        }
    }
}
