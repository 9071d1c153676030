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
use runs::{Analysis, observe};
use sinscal::Sample;
use study::{Plan, Summary, Traced, UnitResult};

use crate::ablate::paper;
use crate::arguments::{ALIGNMENT, Drawn, Results, hours};
use crate::campaign::motion;
use crate::origin::Documented as _;
use crate::say::progress_bar;
use crate::vocabulary::vocabulary;

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
    first: Traced,
    units: Vec<UnitResult>,
    summary: Summary,
    seconds: f64,
}

impl Arguments {
    pub(crate) fn run(self) -> Result<()> {
        let started = Instant::now();
        let mut target = self.results.target()?;
        [&self.drawn.scenario, &self.swing].into_iter().flatten().try_for_each(|path| target.reads(path))?;
        let plan = Plan {
            scenario: self.drawn.load()?,
            filters: paper()?,
            passes: 2,
            hours: self.hours,
            alignment: ALIGNMENT,
            motion: motion(self.swing.as_deref())?,
        };
        let delay = delay::Turn::figure_3(plan.scenario.site);
        let simulation =
            Simulation::new(&plan.scenario, self.drawn.seed).map_err(|error| miette!("{error}"))?;
        let description = simulation.description().clone();
        let samples: Vec<Sample> = simulation.collect();
        let shown = vocabulary().filter(figures::SHOWN).map_err(|error| miette!("{error}"))?;
        let observability =
            observe(&*shown, &samples, &description.setup(&[])).map_err(|error| miette!("{error}"))?;
        drop(samples);
        let (results, first) = units(&plan, self.drawn.seed, self.units)?;
        let findings = Findings {
            delay_errors: delay.errors(POINTS),
            delay,
            observability,
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

/// Puts the units through the plan; of the first one everything is kept.
fn units(plan: &Plan, seed: u64, count: u64) -> Result<(Vec<UnitResult>, Traced)> {
    let bar = progress_bar(count, "units");
    let one = |unit| {
        let traced = plan.unit_traced(unit).map_err(|error| miette!("{error}"))?;
        bar.inc(1);
        Ok((traced.result.clone(), (unit == seed).then_some(traced)))
    };
    let results: Result<Vec<(UnitResult, Option<Traced>)>> =
        (seed..seed + count).into_par_iter().map(one).collect();
    bar.finish_and_clear();
    let (results, traced): (Vec<UnitResult>, Vec<Option<Traced>>) = results?.into_iter().unzip();
    let first = traced.into_iter().flatten().next().ok_or_else(|| miette!("there is no unit"))?;
    Ok((results, first))
}
