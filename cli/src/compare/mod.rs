//! `sinscal compare`: calibrations side by side.

mod page;
mod read;
mod text;

use std::path::PathBuf;

use clap::Args;
use miette::{IntoDiagnostic, Result, miette};
use serde::Serialize;
use sinscal::StateInfo;
use study::compare::{Agreement, Estimate};

use crate::arguments::Results;
use crate::origin::Documented as _;
use read::Calibration;

/// What its help ends with.
const EXAMPLES: &str = "\
Examples:
  sinscal compare monday/calibration.json friday/calibration.json
  sinscal compare before.json after.json --out change
  sinscal compare unit-1.json unit-2.json unit-3.json --json -

Differences are to the first calibration, in standard deviations of the difference. The logs are taken as independent.
With --out: report.html, comparison.json, comparison.txt and the figures.";

/// Compare calibrations: of one unit on several days, before and after a repair, of several units, by several filters
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The calibrations, two or more: what `calibrate --json` wrote
    #[arg(value_name = "FILE.json", required = true, num_args = 2..=26)]
    calibrations: Vec<PathBuf>,
    #[command(flatten)]
    results: Results,
}

/// One parameter in all calibrations, in their order.
struct Row {
    info: StateInfo,
    estimates: Vec<Option<Estimate>>,
}

impl Row {
    /// By how many sigmas the calibration at `place` lies above the first, where both have an estimate.
    fn difference(&self, place: usize) -> Option<f64> {
        let (first, other) = (self.estimates.first()?.as_ref()?, self.estimates.get(place)?.as_ref()?);
        Some(other.beyond(first))
    }
}

/// All calibrations, and how each agrees with the first.
struct Comparison {
    calibrations: Vec<Calibration>,
    rows: Vec<Row>,
    /// Of the second and each after it: what its differences say, and the name of the parameter that differs most.
    agreements: Vec<(Agreement, String)>,
    notes: Vec<String>,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<()> {
        let mut target = self.results.target()?;
        self.calibrations.iter().try_for_each(|path| target.reads(path))?;
        let calibrations: Result<Vec<Calibration>> =
            self.calibrations.iter().enumerate().map(|(i, path)| read::read(path, i)).collect();
        let found = Comparison::new(calibrations?)?;
        let json = serde_json::to_string_pretty(&found.document()).into_diagnostic()? + "\n";
        target.write("comparison", &json, &text::text(&found), &text::verdict(&found), |files, folder| {
            let mut page = page::page(&found).with_program();
            for calibration in &found.calibrations {
                page = page.with_file(&format!("calibration {}", calibration.letter), &calibration.path);
            }
            page.write(files, folder)
        })
    }
}

impl Comparison {
    fn new(calibrations: Vec<Calibration>) -> Result<Self> {
        let mut rows: Vec<Row> = Vec::new();
        for (place, calibration) in calibrations.iter().enumerate() {
            for (info, estimate) in &calibration.estimates {
                let same = |row: &Row| row.info.block == info.block && row.info.component == info.component;
                let at = rows.iter().position(same).unwrap_or_else(|| {
                    rows.push(Row { info: *info, estimates: vec![None; calibrations.len()] });
                    rows.len() - 1
                });
                rows[at].estimates[place] = *estimate;
            }
        }
        let agreement = |place: usize| {
            let both: Vec<(f64, &Row)> =
                rows.iter().filter_map(|row| Some((row.difference(place)?, row))).collect();
            let differences: Vec<f64> = both.iter().map(|(difference, _)| *difference).collect();
            let agreement = Agreement::of(&differences).ok_or_else(|| {
                miette!(
                    help = "both must have been calibrated with filters that share parameters, on logs that show them",
                    "{} and {}: no parameter is estimated in both",
                    calibrations[0].path.display(),
                    calibrations[place].path.display()
                )
            })?;
            Ok((agreement, reports::parts::name(&both[agreement.at].1.info)))
        };
        let agreements: Result<Vec<_>> = (1..calibrations.len()).map(agreement).collect();
        let agreements = agreements?;
        let notes = read::notes(&calibrations);
        Ok(Self { calibrations, rows, agreements, notes })
    }

    fn document(&self) -> Document<'_> {
        let others = self.calibrations.iter().skip(1).zip(&self.agreements);
        Document {
            calibrations: &self.calibrations,
            parameters: self
                .rows
                .iter()
                .map(|row| ParameterRow {
                    name: row.info.block,
                    component: row.info.component,
                    unit: row.info.unit,
                    values: row.estimates.iter().map(|e| e.map(|e| e.value)).collect(),
                    sigmas: row.estimates.iter().map(|e| e.map(|e| e.sigma)).collect(),
                    differences_sigma: (1..row.estimates.len()).map(|place| row.difference(place)).collect(),
                })
                .collect(),
            against_first: others
                .map(|(calibration, (agreement, name))| Against {
                    calibration: calibration.letter,
                    agrees: agreement.agrees(),
                    compared: agreement.compared,
                    beyond: agreement.beyond,
                    limit_sigma: agreement.limit,
                    largest_sigma: agreement.largest,
                    largest_of: name,
                    rms_sigma: agreement.rms,
                })
                .collect(),
            notes: &self.notes,
        }
    }
}

/// `compare --json`.
#[derive(Serialize)]
struct Document<'a> {
    calibrations: &'a [Calibration],
    /// Values and sigmas in SI units, in the order of the calibrations; differences of the second and each after it to the first.
    parameters: Vec<ParameterRow>,
    against_first: Vec<Against<'a>>,
    notes: &'a [String],
}

#[derive(Serialize)]
struct ParameterRow {
    name: &'static str,
    component: &'static str,
    unit: &'static str,
    values: Vec<Option<f64>>,
    sigmas: Vec<Option<f64>>,
    differences_sigma: Vec<Option<f64>>,
}

#[derive(Serialize)]
struct Against<'a> {
    calibration: char,
    agrees: bool,
    compared: usize,
    beyond: usize,
    limit_sigma: f64,
    largest_sigma: f64,
    largest_of: &'a str,
    rms_sigma: f64,
}
