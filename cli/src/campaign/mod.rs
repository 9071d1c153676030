//! `sinscal campaign`: Monte Carlo over simulated units.

pub(crate) mod html;
mod map;
mod store;
mod tables;
pub(crate) mod text;

use std::collections::{BTreeMap, HashSet};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use clap::{Args, Subcommand};
use miette::{IntoDiagnostic, Report, Result, miette};
use rayon::prelude::*;
use rig::scenario::MotionPlan;
use runs::AnyFilter;
use sinscal::PAPER;
use study::{Plan, Summary, UnitResult};

use self::store::{Identity, Store};
use crate::arguments::{self, ALIGNMENT, Drawn, Results, alignment, hours};
use crate::compose::Change;
use crate::origin::Documented as _;
use crate::output::{self, Files};
use crate::say::progress_bar;
use crate::{say, scenario};

/// Without a terminal the state of affairs is said at most this often, s.
const REMARK: u64 = 30;

/// What its help ends with.
const EXAMPLES: &str = "\
Examples:
  sinscal campaign --units 100 --out runs/campaign
  sinscal campaign --units 100 --filters 36d-p,43d-b --hours 0
  sinscal campaign --units 100 --shard 2/4 --out runs/campaign
  sinscal campaign merge runs/campaign --out results
  sinscal campaign map --units 6 --factors 0.25,4 --out runs/map

With --out every finished unit is kept: the same command takes a stopped campaign up again. Then report.html, summary.json,
summary.txt, filters.parquet and parameters.parquet are written.";

/// Calibrate many simulated units with each filter: errors, whether the filters know them, navigation
#[derive(Args)]
#[command(after_help = EXAMPLES)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    /// Number of units
    #[arg(long, value_name = "N", required = true, value_parser = clap::value_parser!(u64).range(1..=10_000_000))]
    units: Option<u64>,
    #[command(flatten)]
    drawn: Drawn,
    /// The filters, separated by commas
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_values = PAPER, ignore_case = true,
          value_parser = arguments::filter())]
    filters: Vec<Arc<dyn AnyFilter>>,
    #[command(flatten)]
    change: Change,
    /// Hours of free-inertial navigation on a swinging table with each calibration; 0 leaves it out
    #[arg(long, value_name = "H", default_value_t = 4.0, value_parser = hours_or_none)]
    hours: f64,
    /// The scenario whose [motion] the unit is moved by meanwhile; without, the swing of the paper's table 2
    #[arg(long, value_name = "FILE")]
    swing: Option<PathBuf>,
    /// Align over the first so many seconds of it, at most half
    #[arg(long, value_name = "SECONDS", default_value_t = ALIGNMENT, value_parser = alignment)]
    align: f64,
    /// Number of passes of a calibration
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=1000))]
    passes: u32,
    /// Only every Nth unit, beginning with the ith: `1/4` to `4/4` together are the whole campaign
    #[arg(long, value_name = "i/N", value_parser = shard, requires = "out")]
    shard: Option<(u64, u64)>,
    #[command(flatten)]
    results: Results,
}

#[derive(Subcommand)]
enum Command {
    Map(map::Arguments),
    /// Summarise the units of the shards of a campaign
    Merge {
        /// Folders of shards; they may share one
        #[arg(required = true, value_name = "DIR")]
        folders: Vec<PathBuf>,
        #[command(flatten)]
        results: Results,
    },
}

fn hours_or_none(text: &str) -> Result<f64, String> {
    if text == "0" { Ok(0.0) } else { hours(text).map_err(|error| format!("0, or {error}")) }
}

fn shard(text: &str) -> Result<(u64, u64), String> {
    let parsed = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
    match parsed {
        Some((i, n)) if (1..=n).contains(&i) => Ok((i, n)),
        _ => Err("which shard of how many was expected, such as 1/4 to 4/4".into()),
    }
}

impl Arguments {
    pub(crate) fn run(self) -> Result<()> {
        match self.command {
            Some(Command::Merge { folders, results }) => return merge(&folders, &results),
            Some(Command::Map(map)) => return map.run(),
            None => {}
        }
        let mut target = self.results.target()?;
        [&self.drawn.scenario, &self.swing].into_iter().flatten().try_for_each(|path| target.reads(path))?;
        self.change.files().try_for_each(|path| target.reads(path))?;
        let mut filters: Vec<Arc<dyn AnyFilter>> = Vec::new();
        for filter in &self.filters {
            if filters.iter().any(|other| other.title() == filter.title()) {
                return Err(miette!("--filters: {} stands there twice", filter.title()));
            }
            filters.push(self.change.of(filter)?);
        }
        let plan = Plan {
            scenario: self.drawn.load()?,
            filters,
            passes: self.passes,
            hours: self.hours,
            alignment: self.align,
            motion: motion(self.swing.as_deref())?,
        };
        if plan.hours > 0.0 {
            plan.navigation().check().map_err(|error| miette!("the swing after the calibration: {error}"))?;
        }
        let (i, n) = self.shard.unwrap_or((1, 1));
        let units: Vec<u64> =
            (0..self.units.unwrap_or(0)).filter(|k| k % n == i - 1).map(|k| self.drawn.seed + k).collect();
        let identity = Identity::of(&plan);
        let store = self
            .results
            .out
            .as_deref()
            .map(|out| Store::create(out, &identity, self.shard.is_some()))
            .transpose()?;
        let results = put_through(&plan, &units, store.as_ref())?;
        if self.shard.is_some() {
            return output::print(&format!(
                "shard {i} of {n}: {} units are done; `sinscal campaign merge` makes the summary\n",
                results.len()
            ));
        }
        let given =
            |path: Option<&Path>| path.map_or("default".to_owned(), |path| path.display().to_string());
        let settings = vec![
            ("scenario", given(self.drawn.scenario.as_deref())),
            ("swing", given(self.swing.as_deref())),
            ("passes", plan.passes.to_string()),
            ("hours", plan.hours.to_string()),
            ("alignment", format!("{} s", plan.alignment)),
        ];
        report(&results, target, settings, self.drawn.scenario.as_deref())
    }
}

/// The motion of the scenario in a file, or the paper's swing.
pub(crate) fn motion(path: Option<&Path>) -> Result<MotionPlan> {
    match path {
        Some(path) => Ok(scenario::load(Some(path))?.motion),
        None => Plan::paper_swing().map_err(|error| miette!("the swing: {error}")),
    }
}

/// Puts units through the plan, in parallel; what is in the store already is not done again.
fn put_through(plan: &Plan, units: &[u64], store: Option<&Store>) -> Result<Vec<UnitResult>> {
    let mut results: Vec<UnitResult> =
        units.iter().filter_map(|unit| store.and_then(|store| store.unit(*unit))).collect();
    let before: HashSet<u64> = results.iter().map(|result| result.unit).collect();
    let todo: Vec<u64> = units.iter().copied().filter(|unit| !before.contains(unit)).collect();
    if !results.is_empty() {
        say::remark(&format!("{} of {} units were done before", results.len(), units.len()));
    }
    let bar = progress_bar(todo.len() as u64, "units");
    let quiet = !std::io::stderr().is_terminal();
    let (started, done, said) = (Instant::now(), AtomicU64::new(0), AtomicU64::new(0));
    let one = |unit: &u64| -> Result<UnitResult> {
        let result = plan.unit(*unit).map_err(|error| miette!("{error}"))?;
        if let Some(store) = store {
            store.keep(&result)?;
        }
        bar.inc(1);
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        let elapsed = started.elapsed().as_secs();
        let before = said.load(Ordering::Relaxed);
        if quiet
            && elapsed >= before + REMARK
            && said.compare_exchange(before, elapsed, Ordering::Relaxed, Ordering::Relaxed).is_ok()
        {
            let left = elapsed * (todo.len() as u64 - done) / done;
            say::remark(&format!("{done} of {} units, {left} s left", todo.len()));
        }
        Ok(result)
    };
    let fresh: Result<Vec<UnitResult>, Report> = todo.par_iter().map(one).collect();
    bar.finish_and_clear();
    results.extend(fresh?);
    results.sort_by_key(|result| result.unit);
    Ok(results)
}

fn merge(folders: &[PathBuf], results: &Results) -> Result<()> {
    let mut target = results.target()?;
    let mut results: BTreeMap<u64, UnitResult> = BTreeMap::new();
    let mut identity: Option<(Identity, &PathBuf)> = None;
    for folder in folders {
        let store = Store::open(folder);
        let found = store.identity()?;
        target.reads(&store.plan_path())?;
        if let Some((first, at)) = &identity {
            if let Some(field) = first.difference(&found) {
                return Err(miette!(
                    "{} and {} hold results of different campaigns: `{field}` differs",
                    at.display(),
                    folder.display()
                ));
            }
        } else {
            identity = Some((found, folder));
        }
        for unit in store.finished()? {
            target.reads(&store.unit_path(unit))?;
            let Some(result) = store.unit(unit) else {
                say::warn(&format!("{}: unit {unit} is damaged and left out", folder.display()));
                continue;
            };
            match results.get(&unit) {
                Some(other) if *other != result => {
                    return Err(miette!(
                        "{}: unit {unit} differs from that of another folder",
                        folder.display()
                    ));
                }
                Some(_) => {}
                None => {
                    results.insert(unit, result);
                }
            }
        }
    }
    let results: Vec<UnitResult> = results.into_values().collect();
    let gaps = results.windows(2).map(|pair| pair[1].unit - pair[0].unit - 1).sum::<u64>();
    if gaps > 0 {
        say::warn(&format!("{gaps} units between the first and the last are not there yet"));
    }
    report(&results, target, Vec::new(), None)
}

fn report(
    results: &[UnitResult],
    target: output::Target<'_>,
    settings: Vec<(&str, String)>,
    scenario: Option<&Path>,
) -> Result<()> {
    if results.is_empty() {
        return Err(miette!("no unit is there to summarise"));
    }
    let summary = Summary::new(results);
    let json = serde_json::to_string_pretty(&summary).into_diagnostic()? + "\n";
    target.write("summary", &json, &text::table(&summary), &text::verdict(&summary), |files, folder| {
        write_tables(files, folder, results)?;
        let page = html::report(&summary, results);
        let page = settings.into_iter().fold(page, |page, (name, value)| page.with(name, value));
        page.with_scenario(scenario).write(files, folder)
    })
}

fn write_tables(files: &mut Files, folder: &Path, results: &[UnitResult]) -> Result<()> {
    let (filters, parameters) = (tables::filters(results)?, tables::parameters(results)?);
    files.write(&folder.join("filters.parquet"), |file| file.write_all(&filters))?;
    files.write(&folder.join("parameters.parquet"), |file| file.write_all(&parameters))
}
