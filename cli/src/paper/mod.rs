//! `sinscal paper`: the tables and figures of the paper, on the simulated rig.
//!
//! Xing, Yang and Cai, *Sensors* 22(1):278, 2022.

mod figures;
mod html;
mod report;
mod size_effect;

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use miette::{IntoDiagnostic, Result, miette};
use rayon::prelude::*;
use rig::Simulation;
use rig::analyses::delay;
use study::{Plan, Summary, UnitResult};

use self::figures::Traces;
use crate::ablate::run::FILTERS;
use crate::arguments::{ALIGNMENT, Drawn, Results, hours};
use crate::campaign::motion;
use crate::observe::analysis::{Analysis, look};
use crate::say::progress_bar;

/// Points of figure 3.
const POINTS: u32 = 100;

/// What its help ends with.
const EXAMPLES: &str = "\
Examples:
  sinscal paper --out runs/paper
  sinscal paper --units 2 --hours 4 --out runs/paper

With --out: report.html, paper.json, paper.txt and every figure with its data. 8 units of 48 hours take some minutes.";

/// Reproduce the tables and figures of the paper on simulated units, with the paper's values beside
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// Number of units that Fig. 15 and Table 3 are made of
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    units: u64,
    /// Hours of free-inertial navigation
    #[arg(long, value_name = "H", default_value_t = 48.0, value_parser = hours)]
    hours: f64,
    #[command(flatten)]
    drawn: Drawn,
    /// The scenario whose [motion] is that of Table 2; without, the swing with amplitudes of 6 deg
    #[arg(long, value_name = "FILE")]
    swing: Option<PathBuf>,
    #[command(flatten)]
    results: Results,
}

/// Everything the report is made of.
struct Findings {
    plan: Plan,
    delay: delay::Turn,
    delay_errors: Vec<delay::Errors>,
    observability: Analysis,
    /// Of the first unit.
    traces: Traces,
    first: UnitResult,
    units: Vec<UnitResult>,
    summary: Summary,
    seconds: f64,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<()> {
        let started = Instant::now();
        let target = self.results.target()?;
        let plan = Plan {
            scenario: self.drawn.load()?,
            filters: FILTERS.map(str::to_owned).to_vec(),
            passes: 2,
            hours: self.hours,
            alignment: ALIGNMENT,
            motion: motion(self.swing.as_deref())?,
        };
        let delay = delay::Turn::figure_3(plan.scenario.site);
        let simulation =
            Simulation::new(&plan.scenario, self.drawn.seed).map_err(|error| miette!("{error}"))?;
        let description = simulation.description().clone();
        let extent = (0.0, plan.scenario.duration());
        let samples = Box::new(simulation.map(Ok));
        let observability = look("43d-b", &description.setup(&[]), "the simulated log", extent, samples)
            .unwrap_or_else(|| Err(miette!("there is no filter called 43d-b")))?;
        let (results, traces) = units(&plan, self.drawn.seed, self.units)?;
        let first = results.first().cloned().ok_or_else(|| miette!("there is no unit"))?;
        let findings = Findings {
            delay_errors: delay.errors(POINTS),
            delay,
            observability,
            traces,
            first,
            summary: Summary::new(&results),
            units: results,
            plan,
            seconds: started.elapsed().as_secs_f64(),
        };
        let json = serde_json::to_string_pretty(&report::Numbers::new(&findings)).into_diagnostic()? + "\n";
        let text = report::text(&findings);
        target.write("paper", &json, &text, &report::verdict(&findings), |files, folder| {
            figures::write(&findings, files, folder)?;
            let page = html::page(&findings, &text).with_scenario(self.drawn.scenario.as_deref());
            page.write(files, folder)
        })
    }
}

/// Puts the units through the plan; the first one is watched.
fn units(plan: &Plan, seed: u64, count: u64) -> Result<(Vec<UnitResult>, Traces)> {
    let bar = progress_bar(count, "units");
    let results: Result<Vec<(UnitResult, Traces)>> = (seed..seed + count)
        .into_par_iter()
        .map(|unit| {
            let mut traces = Traces::default();
            let result = if unit == seed { plan.unit_watched(unit, &mut traces) } else { plan.unit(unit) };
            bar.inc(1);
            Ok((result.map_err(|error| miette!("{error}"))?, traces))
        })
        .collect();
    bar.finish_and_clear();
    let (results, traces): (Vec<UnitResult>, Vec<Traces>) = results?.into_iter().unzip();
    Ok((results, traces.into_iter().next().unwrap_or_default()))
}
