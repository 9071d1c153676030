//! `sinscal campaign map`: where each effect that a filter takes in helps.

use std::fmt::Write;
use std::path::PathBuf;

use clap::Args;
use miette::{IntoDiagnostic, Result, miette};
use rayon::prelude::*;
use serde::Serialize;
use sinscal::navigation::NAUTICAL_MILE;
use study::{Cell, Plan, Sizes, UnitResult};

use crate::ablate::run::FILTERS;
use crate::broadcast::progress_bar;
use crate::navigate::ALIGNMENT;
use crate::paper::hours;
use crate::{output, scenario};

/// Map the order of the paper's five filters over the sizes of the effects that they differ in
#[derive(Args)]
pub(super) struct Arguments {
    /// Number of units for each combination of sizes, the same for all
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    units: u64,
    /// The scenario with sizes of one; without, the default one
    #[arg(long, value_name = "FILE")]
    scenario: Option<PathBuf>,
    /// Sizes of delay, temperature and dither to combine, against those of the scenario, separated by commas
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_values = ["0.25", "1", "4"], value_parser = factor)]
    factors: Vec<f64>,
    /// Hours of free-inertial navigation on the swing of the paper's table 2
    #[arg(long, value_name = "H", default_value_t = 4.0, value_parser = hours)]
    hours: f64,
    /// Number of the first unit
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(0..1 << 60))]
    seed: u64,
    /// Write the map as JSON; `-` writes it to standard output instead of the table
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write map.json and map.txt to this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

fn factor(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(factor) if (0.0..=100.0).contains(&factor) => Ok(factor),
        _ => Err("a factor from 0 to 100 was expected".into()),
    }
}

#[derive(Serialize)]
struct Report {
    filters: [&'static str; 5],
    units: u64,
    hours: f64,
    /// Combinations in which each filter is better than the one before.
    in_order: usize,
    cells: Vec<Cell>,
}

impl Arguments {
    pub(super) fn run(self) -> Result<()> {
        let target = output::Target::new(self.json.as_deref(), self.out.as_deref())?;
        let plan = Plan {
            scenario: scenario::load(self.scenario.as_deref())?,
            filters: FILTERS.map(str::to_owned).to_vec(),
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
            let units = self.seed..self.seed + self.units;
            let results: Vec<UnitResult> = units.into_par_iter().map(one).collect::<Result<_>>()?;
            Ok(Cell::new(*sizes, &results))
        };
        let cells: Vec<Cell> = grid.par_iter().map(cell).collect::<Result<_>>()?;
        bar.finish_and_clear();
        let in_order = cells.iter().filter(|cell| cell.in_order).count();
        let report = Report { filters: FILTERS, units: self.units, hours: self.hours, in_order, cells };
        let json = serde_json::to_string_pretty(&report).into_diagnostic()? + "\n";
        target.write("map", &json, &table(&report), &verdict(&report), |_, _| Ok(()))
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
