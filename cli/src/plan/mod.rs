//! `sinscal plan`: the path of a calibration, designed or judged before it is run.

mod answer;
mod verify;
mod write;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;
use logs::{Log, units};
use miette::{IntoDiagnostic, Result, miette};
use plan::{Criterion, Effort, Evaluator, Expected, Table, Trouble};
use rig::{Scenario, Simulation};
use runs::{AnyFilter, Options, calibrate, observe};
use sinscal::Sample;

use self::answer::Answer;
use crate::arguments::{Columns, FilterArgument, Results, open_for};
use crate::output::Target;
use crate::setup::Beginning;
use crate::source::{Source, fault};
use crate::vocabulary::vocabulary;
use crate::{say, scenario, setup, signals};

/// What its help ends with.
const EXAMPLES: &str = "\
Examples:
  sinscal plan --filter 43d-b --duration 15min --out plans/quarter
  sinscal plan --filter 43d-b --evaluate plans/quarter/scenario.toml
  sinscal plan --filter 43d-b --duration 30min --require wanted.toml
  sinscal plan --filter 43d-b --target wanted.toml --duration 2h
  sinscal plan --filter mems-30d --duration 5min --table hand --out plans/hand

The file of --require and --target names effects, each with the sigma that is wanted: gyro-scale = \"2 ppm\".
With --out: scenario.toml for `simulate --scenario`, report.html, plan.json and plan.txt.";

/// Most of a search where no duration is given, s.
const LONGEST: f64 = 7200.0;
/// Endings of tables that a description may stand beside.
const TABLES: [&str; 11] = ["parquet", "csv", "txt", "dat", "tsv", "asc", "mat", "npy", "npz", "h5", "hdf5"];
/// Least of it, s.
const SHORTEST: f64 = 120.0;

/// Design the path of a calibration for a filter, a table and a time, or say what a given path will show
#[derive(Args)]
#[command(after_help = EXAMPLES)]
#[command(group(clap::ArgGroup::new("task").required(true).multiple(true).args(["duration", "target", "evaluate"])))]
pub(crate) struct Arguments {
    #[command(flatten)]
    filter: FilterArgument,
    /// How long the path takes, such as 15min, 900s, 1h; with --target the longest that may be proposed
    #[arg(long, value_name = "TIME", value_parser = time)]
    duration: Option<f64>,
    /// Design the shortest path that reaches the sigmas in this file
    #[arg(long, value_name = "FILE.toml", conflicts_with_all = ["evaluate", "require", "separate"])]
    target: Option<PathBuf>,
    /// Say what this path will show: a log, or a scenario
    #[arg(long, value_name = "LOG_OR_SCENARIO", conflicts_with = "duration")]
    evaluate: Option<PathBuf>,
    /// Surroundings, limits of the table, and the path to compare with; without, the default scenario
    #[arg(long, value_name = "FILE.toml", conflicts_with = "evaluate")]
    scenario: Option<PathBuf>,
    /// What turns the unit
    #[arg(long, value_name = "KIND", default_value = "three-axis", value_parser = table())]
    table: Table,
    /// Make the worst ratio to the sigmas in this file small, instead of that to what a path to compare with shows: the scenario's
    /// own, or the best known one that another table can turn
    #[arg(long, value_name = "FILE.toml", conflicts_with_all = ["evaluate", "separate"])]
    require: Option<PathBuf>,
    /// Keep these effects apart: both are estimated, and the worst of them against its prior is made small
    #[arg(long, value_name = "A,B", value_delimiter = ',', conflicts_with = "evaluate")]
    separate: Vec<String>,
    /// Compare with paths of the literature in the same time
    #[arg(long, requires = "duration")]
    known: bool,
    /// Number of paths that are tried, with --target in each duration; without, what takes a minute or two: 40 000 of a quarter of
    /// an hour, half as many of an hour
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(16..=10_000_000))]
    evaluations: Option<u32>,
    /// Number of simulated units that the plan is tried on; 0 for none
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(0..=1000))]
    verify: u32,
    /// Of the random draws
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    columns: Columns,
    #[command(flatten)]
    results: Results,
}

fn time(text: &str) -> Result<f64, String> {
    let digits = text.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(text.len());
    let (number, unit) = text.split_at(digits);
    let seconds = match unit.trim() {
        "s" | "" => 1.0,
        "min" => 60.0,
        "h" => 3600.0,
        _ => return Err("a time such as 900s, 15min or 1h was expected".into()),
    };
    match number.trim().parse::<f64>() {
        Ok(number) if (30.0..=864e3).contains(&(number * seconds)) => Ok(number * seconds),
        _ => Err("a time from 30s to 240h was expected, such as 15min".into()),
    }
}

fn table() -> impl clap::builder::TypedValueParser<Value = Table> {
    use clap::builder::{PossibleValuesParser, TypedValueParser as _};
    PossibleValuesParser::new(Table::ALL.map(Table::name)).try_map(|name| {
        Table::ALL.into_iter().find(|table| table.name() == name).ok_or("is no kind of table")
    })
}

impl Arguments {
    pub(crate) fn run(self) -> Result<()> {
        let mut target = self.results.target()?;
        let files = [&self.scenario, &self.require, &self.target];
        files.into_iter().flatten().try_for_each(|path| target.reads(path))?;
        self.filter.change.files().try_for_each(|path| target.reads(path))?;
        let filter = self.separating()?;
        match &self.evaluate {
            Some(path) => self.judge(path, filter, target),
            None => self.design(filter, target),
        }
    }

    /// The filter, with states for all that is to be kept apart.
    fn separating(&self) -> Result<Arc<dyn AnyFilter>> {
        let filter = self.filter.filter()?;
        let mut added = Vec::new();
        for name in &self.separate {
            let effect = vocabulary().effect(name).map_err(|error| miette!("--separate: {error}"))?;
            if !filter.parameters().iter().any(|state| state.block == effect.name()) {
                added.push(effect);
            }
        }
        if added.is_empty() {
            return Ok(filter);
        }
        let composed = runs::Composition::with_states_for(&*filter, &added);
        Ok(Arc::new(composed.map_err(|error| miette!("--separate: {error}"))?))
    }

    fn judge(&self, path: &Path, filter: Arc<dyn AnyFilter>, mut target: Target<'_>) -> Result<()> {
        if is_scenario(path) {
            target.reads(path)?;
            let scenario = scenario::load(Some(path))?;
            let expected = Evaluator::new(filter.clone(), &scenario, self.seed).own().into_diagnostic()?;
            let mut answer = Answer::judged(&*filter, &expected, scenario.motion.turns().unwrap_or_default());
            answer.starts(&scenario);
            answer.rank = rank(&*filter, &scenario, self.seed)?;
            return answer.finish(target, Some(path), None);
        }
        let log = open_for(path, &self.columns, &*filter, Beginning::default())?;
        target.reads_log(&log)?;
        let setup = setup::of(&log, setup::initial(&log)?);
        let mut answer = Answer::judged(&*filter, &of_log(&log, &*filter, &setup)?, Vec::new());
        let source = Source::new(&log, "observing");
        answer.rank = observe(&*filter, &source, &setup).map_err(|error| fault(&log, error))?.rank;
        answer.finish(target, None, None)
    }

    fn design(&self, filter: Arc<dyn AnyFilter>, target: Target<'_>) -> Result<()> {
        let scenario = scenario::load(self.scenario.as_deref())?;
        let evaluator = Evaluator::new(filter.clone(), &scenario, self.seed);
        let limit = self.duration.unwrap_or(LONGEST);
        let reference = self.reference(&evaluator, limit).into_diagnostic()?;
        // from here on the first interrupt leaves an answer
        let stop = signals::first_interrupt();
        let mut noise = None;
        let criterion = match self.require.as_ref().or(self.target.as_ref()) {
            Some(path) => Criterion(wanted(path, &*filter)?),
            None if !self.separate.is_empty() => Criterion::apart(&filter.parameters(), &self.separate),
            None => {
                let found = plan::noise_alone(&evaluator, self.table, limit).into_diagnostic()?;
                Criterion::against(&reference, noise.insert(found), limit)
            }
        };
        let (still, turns) = self.search(&evaluator, &criterion, limit, &stop)?;
        let expected = evaluator.turns(&turns, still).into_diagnostic()?;
        let flown = evaluator.along(&turns, still);
        let alone = evaluator.alone(&turns, still).into_diagnostic()?;
        let mut answer = Answer::designed(&*filter, &expected, turns, self.table);
        answer.starts(&flown);
        answer.compare(&criterion, &expected, &reference, &alone);
        answer.bound = noise.map(|noise| criterion.bound(&[&noise, &alone]));
        if self.known {
            for (known, (still, turns)) in plan::known_paths(&evaluator, self.table, limit) {
                let found = evaluator.turns(&turns, still).into_diagnostic()?;
                answer.known(known, turns.len(), criterion.of(&found));
            }
        }
        let text = write::scenario(self.scenario.as_deref(), &answer)?;
        // with the errors that units have
        let flown = Scenario { population: scenario.population.clone(), ..flown };
        answer.rank = rank(&*filter, &flown, self.seed)?;
        if self.verify > 0 {
            answer.verified = Some(verify::fly(&filter, &flown, &expected, (self.seed, self.verify))?);
        }
        answer.finish(target, self.scenario.as_deref(), Some(&text))
    }

    /// The path to compare with: the scenario's own, or the best one that the table can turn.
    fn reference(&self, evaluator: &Evaluator, duration: f64) -> Result<Expected, Trouble> {
        if self.table == Table::ThreeAxis {
            return evaluator.own();
        }
        plan::best_known(evaluator, self.table, duration)
    }

    fn search(
        &self,
        evaluator: &Evaluator,
        criterion: &Criterion,
        limit: f64,
        stop: &signals::FirstInterrupt,
    ) -> Result<plan::Way> {
        let evaluations =
            self.evaluations.map_or_else(|| Effort::usual(limit), |evaluations| evaluations as usize);
        let effort = Effort { evaluations, seed: self.seed };
        let bar = say::progress_bar(evaluations as u64, "planning");
        let mut told = |tried: usize, best: f64| {
            bar.set_position(tried as u64);
            bar.set_message(format!("planning, best {best:.3}"));
            !stop.asked()
        };
        let found = if self.target.is_some() {
            let span = (SHORTEST.min(limit), limit);
            plan::shortest(evaluator, self.table, span, criterion, &effort, &mut told)
        } else {
            plan::design(evaluator, self.table, limit, criterion, &effort, &mut told)
        };
        bar.finish_and_clear();
        if stop.asked() {
            say::remark("interrupted: this is the best path so far");
        }
        found.into_diagnostic()
    }
}

/// The rank of the observability matrix along a path.
fn rank(filter: &dyn AnyFilter, scenario: &Scenario, seed: u64) -> Result<usize> {
    let simulation = Simulation::new(scenario, seed).into_diagnostic()?;
    let description = simulation.description().clone();
    let samples: Vec<Sample> = simulation.collect();
    Ok(observe(filter, &samples, &description.setup(&[])).into_diagnostic()?.rank)
}

/// Whether a file is a scenario: a TOML file that does not stand beside a table of its name, whatever the table's format.
fn is_scenario(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "toml") && path.is_file() && !has_table(path)
}

/// Whether there is a file beside a description that it may describe.
fn has_table(path: &Path) -> bool {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let of_this = |file: std::fs::DirEntry| {
        let other = file.path();
        let ending = other.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_lowercase();
        other.file_stem() == path.file_stem() && TABLES.contains(&ending.as_str())
    };
    std::fs::read_dir(folder).is_ok_and(|files| files.flatten().any(of_this))
}

/// What the path of a log shows: the sigmas of the filter's first pass over it.
fn of_log(log: &Log, filter: &dyn AnyFilter, setup: &sinscal::Setup) -> Result<Expected> {
    let options = Options { passes: 1, ..Options::of(filter) };
    let source = Source::new(log, "evaluating");
    let outcome = calibrate(filter, &source, setup, &options, &mut ()).map_err(|error| fault(log, error))?;
    Ok(Expected::from(&outcome))
}

/// Sigmas by effect, SI.
fn wanted(path: &Path, filter: &dyn AnyFilter) -> Result<std::collections::BTreeMap<String, f64>> {
    let at = path.display();
    let text = std::fs::read_to_string(path).map_err(|error| miette!("{at}: cannot be read: {error}"))?;
    let table: toml::Table = text.parse().map_err(|error| miette!("{at}: {error}"))?;
    let parameters = filter.parameters();
    let mut wanted = std::collections::BTreeMap::new();
    for (name, value) in table {
        let Some(state) = parameters.iter().find(|state| state.block == name) else {
            let known = parameters.iter().map(|state| state.block);
            return Err(miette!(
                help = logs::suggest::hint(&name, known),
                "{at}, field `{name}`: {} has no such effect",
                filter.title()
            ));
        };
        let accepted = units::of_parameters(state.unit);
        let sigma = value
            .as_str()
            .ok_or_else(|| "a number, a space and its unit in quotes".to_owned())
            .and_then(|text| units::read(text, accepted))
            .map_err(|error| miette!("{at}, field `{name}`: {error}"))?;
        if !(sigma > 0.0 && sigma.is_finite()) {
            return Err(miette!("{at}, field `{name}`: a sigma above zero was expected"));
        }
        wanted.insert(name, sigma);
    }
    if wanted.is_empty() {
        return Err(miette!("{at}: names no effect; a line such as gyro-scale = \"2 ppm\" was expected"));
    }
    Ok(wanted)
}
