//! `sinscal campaign map`: where each effect that a filter takes in helps.

use std::fmt::Write;

use clap::Args;
use miette::{IntoDiagnostic, Result, miette};
use rayon::prelude::*;
use serde::Serialize;
use sinscal::navigation::NAUTICAL_MILE;
use study::{Cell, Plan, Sizes, UnitResult};

use sinscal::PAPER;

use crate::ablate::paper;
use crate::arguments::{ALIGNMENT, Drawn, Results, hours, within};
use crate::origin::Documented as _;
use crate::say::progress_bar;
use reports::{Cell as Field, Report as Page, Section, Table, Tone, number};

/// What its help ends with.
const EXAMPLES: &str = "\
Examples:
  sinscal campaign map --units 6 --factors 0.25,4 --out runs/map

With --out: report.html, map.json, map.txt and the figures.";

/// Map the order of the paper's five filters over the sizes of the effects that they differ in
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Arguments {
    /// Number of units for each combination of sizes, the same for all
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    units: u64,
    #[command(flatten)]
    drawn: Drawn,
    /// Sizes of delay, temperature and dither to combine, against those of the scenario, separated by commas
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_values = ["0.25", "1", "4"], value_parser = factor)]
    factors: Vec<f64>,
    /// Hours of free-inertial navigation on the swing of the paper's table 2
    #[arg(long, value_name = "H", default_value_t = 4.0, value_parser = hours)]
    hours: f64,
    #[command(flatten)]
    results: Results,
}

fn factor(text: &str) -> Result<f64, String> {
    within(text, "times the usual size", 0.0, 100.0)
}

#[derive(Serialize)]
struct Report {
    filters: &'static [&'static str],
    units: u64,
    hours: f64,
    /// Combinations in which each filter is better than the one before.
    in_order: usize,
    cells: Vec<Cell>,
}

impl Arguments {
    pub(super) fn run(self) -> Result<()> {
        let mut target = self.results.target()?;
        self.drawn.scenario.iter().try_for_each(|path| target.reads(path))?;
        let plan = Plan {
            scenario: self.drawn.load()?,
            filters: paper()?,
            passes: 2,
            hours: self.hours,
            alignment: ALIGNMENT,
            motion: super::motion(None)?,
        };
        let grid = Sizes::grid(&self.factors);
        let bar = progress_bar(grid.len() as u64 * self.units, "units");
        let cell = |sizes: &Sizes| -> Result<Cell> {
            let plan = plan.sized(sizes);
            let one = |unit| {
                let result = plan.unit(unit).map_err(|error| miette!("{error}"));
                bar.inc(1);
                result
            };
            let units = self.drawn.seed..self.drawn.seed + self.units;
            let results: Vec<UnitResult> = units.into_par_iter().map(one).collect::<Result<_>>()?;
            Ok(Cell::new(*sizes, &results))
        };
        let cells: Vec<Cell> = grid.par_iter().map(cell).collect::<Result<_>>()?;
        bar.finish_and_clear();
        let in_order = cells.iter().filter(|cell| cell.in_order).count();
        let report = Report { filters: PAPER, units: self.units, hours: self.hours, in_order, cells };
        let json = serde_json::to_string_pretty(&report).into_diagnostic()? + "\n";
        target.write("map", &json, &table(&report), &verdict(&report), |files, folder| {
            let page = page(&report).with_program().with("seed", self.drawn.seed.to_string());
            page.with_scenario(self.drawn.scenario.as_deref()).write(files, folder)
        })
    }
}

/// The map as a page: each combination's errors by the largest of them.
fn page(report: &Report) -> Page {
    let row = |cell: &Cell| {
        let Sizes { delay, temperature, dither } = cell.sizes;
        let mut row =
            vec![number(delay.to_string()), number(temperature.to_string()), number(dither.to_string())];
        let largest = cell.median_m.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        row.extend(cell.median_m.iter().enumerate().map(|(f, median)| {
            let mark = if cell.worse.contains(&f) { " !" } else { "" };
            Field::Heat(median / largest, format!("{:.3}{mark}", median / NAUTICAL_MILE))
        }));
        row
    };
    let mut head = vec!["delay", "temperature", "dither"];
    head.extend(report.filters);
    let caption = format!(
        "Median over {} units of the largest horizontal error in {} h, nautical miles, by the sizes of the effects against those of \
         the scenario; the darker, the nearer to the largest of its row. ! worse than the filter before it.",
        report.units, report.hours
    );
    let table = Table::new(caption, &head, report.cells.iter().map(row).collect()).drawn_as("map");
    Page {
        title: "Where each effect that a filter takes in helps".into(),
        verdict: verdict(report),
        tone: Tone::Neutral,
        facts: vec![
            ("units for each combination".into(), report.units.to_string()),
            ("navigation".into(), format!("{} h", report.hours)),
        ],
        sections: vec![Section::new("Map", vec![table.into()])],
        origin: Vec::new(),
        attachments: Vec::new(),
    }
}

fn verdict(report: &Report) -> String {
    format!(
        "each filter navigates better than the one before it in {} of {} combinations of sizes",
        report.in_order,
        report.cells.len()
    )
}

/// Writing to a string does not fail.
fn table(report: &Report) -> String {
    let mut text = verdict(report) + "\n\n";
    let _ = write!(text, "{:>8} {:>12} {:>8} ", "delay", "temperature", "dither");
    for filter in report.filters {
        let _ = write!(text, " {filter:>8} ");
    }
    text.push('\n');
    for cell in &report.cells {
        let Sizes { delay, temperature, dither } = cell.sizes;
        let _ = write!(text, "{delay:>8} {temperature:>12} {dither:>8} ");
        for (f, median) in cell.median_m.iter().enumerate() {
            let mark = if cell.worse.contains(&f) { '!' } else { ' ' };
            let _ = write!(text, " {:>8.3}{mark}", median / NAUTICAL_MILE);
        }
        text.push('\n');
    }
    let _ = writeln!(
        text,
        "\nmedian over {} units of the largest horizontal error in {} h, nautical miles; ! worse than the filter before it\n\
         sizes are those of the scenario times: delay, temperature scale factors, size effect of the dither",
        report.units, report.hours
    );
    for (f, filter) in report.filters.iter().enumerate().skip(1) {
        let worse = report.cells.iter().filter(|cell| cell.worse.contains(&f)).count();
        let _ = writeln!(text, "{filter} is worse than {} in {worse} combinations", report.filters[f - 1]);
    }
    text
}
