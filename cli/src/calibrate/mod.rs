//! `sinscal calibrate`: runs a filter over a log, or over several of one unit.

mod budget;
mod json;
mod report;
mod several;
pub(crate) mod text;

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use clap::{Args, ValueEnum};
use logs::units::DEGREE;
use logs::{Bridged, Log};
use miette::Result;
use runs::{AnyFilter, Exact, Options, Outcome, Timing, Verdict, Watch};
use sinscal::{Coarse, Parameter, Statistics};

use crate::arguments::{self, Columns, FilterArgument, Results};
use crate::origin::Documented as _;
use crate::output::Target;
use crate::setup::Beginning;
use crate::source::{Source, fault, unreadable};
use crate::{say, setup};

/// What its help ends with.
const EXAMPLES: &str = "\
Examples:
  sinscal calibrate runs/unit-3 --filter 43d-b
  sinscal calibrate runs/unit-3 --filter 43d-b --out results
  sinscal calibrate runs/unit-3 --filter mems-30d --coarse --json -
  sinscal calibrate monday friday --filter 43d-b --out results

With --out: report.html, calibration.json, calibration.txt, history.csv (estimates and sigmas over time), with --smooth
trajectory.csv, and the figures. Of several logs: calibration.json and calibration.txt, with what each log says by itself.";

/// Calibrate a unit: run a filter over a log, or over several of one unit, and report its parameters
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// The log: path of its table or description, with or without ending. Of several logs of one unit the parameters are common, and
    /// where the logs contradict each other that is said and is in the sigmas
    #[arg(value_name = "LOG", required = true)]
    logs: Vec<PathBuf>,
    #[command(flatten)]
    columns: Columns,
    #[command(flatten)]
    filter: FilterArgument,
    /// Number of passes, by default what the filter's class of units needs; each after the first linearises about the
    /// parameters found before
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    passes: Option<u32>,
    #[command(flatten)]
    beginning: Beginning,
    /// Smooth the navigation solution over the whole log in the last pass; `--out` then holds trajectory.csv
    #[arg(long)]
    smooth: bool,
    /// Say what each sigma is made of: noise, and what site, clock, thermometers and reference may be wrong by, as [uncertainty] states or,
    /// where it does not, by default
    #[arg(long)]
    budget: bool,
    /// How the covariance is kept
    #[arg(long, value_enum, default_value_t = Form::Conventional)]
    form: Form,
    #[command(flatten)]
    results: Results,
}

/// How the covariance is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Form {
    /// As a symmetric matrix
    Conventional,
    /// As U D U' (Thornton and Bierman)
    Ud,
}

impl From<Form> for runs::Form {
    fn from(form: Form) -> Self {
        match form {
            Form::Conventional => Self::Conventional,
            Form::Ud => Self::Ud,
        }
    }
}

/// Tells how each pass went, to those who want to know.
struct Passes;

impl Watch for Passes {
    fn pass(&mut self, _: &str, pass: u32, of: u32, statistics: &Statistics) {
        say::detail(|| {
            format!("pass {pass} of {of}: NIS per degree of freedom {:.3}", statistics.nis_per_dof())
        });
    }
}

/// So many prior sigmas from zero the error model may not be linear any more.
const FAR: f64 = 5.0;

/// Turning by more than this from one sample to the next costs accuracy, rad. A unit that swings by 5 to 30 deg so fast that it turns
/// by 3 to 5 deg in an interval drifts by 2e-4 to 0.08 deg/h and errs by 0.1 to 50 ug; at 1.2 deg it is 1e-6 deg/h and 3 ng.
const LARGEST_TURN: f64 = 3.0 * DEGREE;

/// Stamps of a reference that are off by more than this are a suspicion where the filter does not fit, s.
const LATE: f64 = 0.01;

/// Whether a parameter that the coarse stage knows lies far out.
fn far_out(parameter: &Parameter) -> bool {
    parameter.estimated
        && parameter.value.abs() > FAR * parameter.prior_sigma
        && Coarse::EFFECTS.contains(&parameter.info.block)
}

/// A log that a filter was run over.
struct Ran {
    log: Log,
    options: Options,
    outcome: Outcome,
    bridged: Bridged,
    /// What was taken as exact, where nothing is considered.
    exact: Option<Exact>,
    wall: Duration,
}

impl Ran {
    fn report(&self, filter: &dyn AnyFilter) -> json::Report {
        json::Report::new(&self.log, filter, &self.options, &self.outcome, self.bridged, self.wall)
    }
}

impl Arguments {
    pub(crate) fn run(self) -> Result<()> {
        let mut target = self.results.target()?;
        let filter = self.filter.filter()?;
        let mut logs = Vec::with_capacity(self.logs.len());
        for path in &self.logs {
            let log = Log::open_counting(path, &self.columns.reading_for(&*filter))?;
            target.reads_log(&log)?;
            logs.push(log);
        }
        several::check(&logs, self.budget || !filter.considers().is_empty())?;
        let mut filter = filter;
        for log in &logs {
            filter = arguments::wandering(&filter, log)?;
        }
        let (filter, assumed) = match logs.as_slice() {
            [log] => arguments::uncertain(&filter, log, self.budget)?,
            _ => (filter, Vec::new()),
        };
        self.filter.change.files().try_for_each(|path| target.reads(path))?;
        let several = logs.len() > 1;
        let all = logs.into_iter().map(|log| self.over(log, &filter, several)).collect::<Result<Vec<_>>>()?;
        match all.as_slice() {
            [ran] => single(ran, &*filter, &assumed, target),
            several => several::write(several, &*filter, target),
        }
    }

    /// Runs over one log, and says what is odd about it.
    fn over(&self, mut log: Log, filter: &Arc<dyn AnyFilter>, several: bool) -> Result<Ran> {
        let started = Instant::now();
        self.beginning.prepare(&mut log, &**filter)?;
        let options = Options {
            passes: self.passes.unwrap_or_else(|| filter.passes()),
            form: self.form.into(),
            smooth: self.smooth,
            residuals: self.results.out.is_some(),
            coarse: log.coarse().cloned(),
            settle: true,
            ..Options::of(&**filter)
        };
        let setup = setup::of(&log, setup::initial(&log)?);
        let source = Source::new(&log, "calibrating");
        let outcome = runs::calibrate(&**filter, &source, &setup, &options, &mut Passes)
            .map_err(|error| fault(&log, error))?;
        let bridged = source.bridged();
        if outcome.verdict().contradicts()
            && let Some(late) = Timing::of(&source).map_err(|error| unreadable(&log, error))?.late(&setup)
            && late.abs() > LATE
        {
            say::warn(&text::late(late));
        }
        let exact = match several || options.passes == 1 || !filter.considers().is_empty() {
            true => None,
            false => runs::exact(filter, &source, &setup, &options, &outcome)
                .map_err(|error| fault(&log, error))?,
        };
        drop(source);
        warn(&**filter, &log, &options, &outcome, bridged);
        Ok(Ran { log, options, outcome, bridged, exact, wall: started.elapsed() })
    }
}

/// Says what is odd about a run.
fn warn(filter: &dyn AnyFilter, log: &Log, options: &Options, outcome: &Outcome, bridged: Bridged) {
    if let Some(far) = outcome.parameters.iter().find(|parameter| far_out(parameter))
        && log.coarse().is_none()
    {
        say::warn(&format!(
            "{} {} lies beyond {FAR:.0} sigmas of its prior: try --coarse, which starts from the still positions",
            far.info.block, far.info.component
        ));
    }
    if outcome.statistics.largest_turn > LARGEST_TURN {
        say::warn(&format!(
            "the unit turns by up to {:.1} deg from one sample to the next: beyond {:.0} deg the mechanisation errs by \
             0.001 deg/h and 1 ug or more; log at a higher rate",
            outcome.statistics.largest_turn / DEGREE,
            LARGEST_TURN / DEGREE
        ));
    }
    if filter.needs_dither() && !outcome.dithers {
        say::warn(&format!(
            "{} reckons with the dither, and the log tells none in dither_x, dither_y, dither_z: if the unit dithers, what \
             that does to the accelerometers is in the estimates",
            filter.title()
        ));
    }
    text::oddities(&outcome.look, outcome.verdict().contradicts()).iter().for_each(|odd| say::warn(odd));
    if outcome.verdict() == Verdict::FixedPoint {
        say::remark(&format!(
            "what is taken to stand still has no noise to judge residuals by: `sinscal diagnose` looks for what {} lacks",
            outcome.filter
        ));
    }
    if let Some(fault) = text::site_fault(outcome) {
        say::warn(fault);
    }
    if let Some(doubt) = text::doubt(outcome, options.passes) {
        say::warn(&doubt);
    }
    if bridged.gaps > 0 {
        let (gaps, rows) = (bridged.gaps, bridged.rows);
        say::remark(&format!("{gaps} gaps were filled with {rows} interpolated rows"));
    }
}

/// Writes what came of a run over one log.
fn single(ran: &Ran, filter: &dyn AnyFilter, assumed: &[&str], target: Target<'_>) -> Result<()> {
    let Ran { log, options, outcome, bridged, exact, wall } = ran;
    let assumed = budget::assumed(assumed, log);
    let mut json = ran.report(filter).assuming(assumed.clone());
    let mut table = text::table(log, filter, outcome, *bridged, *wall) + &budget::table(outcome);
    for sentence in &assumed {
        table += &format!("assumed: {sentence}\n");
    }
    if let Some(exact) = exact {
        json = json.with_exact(outcome, exact);
        for line in [budget::exact(outcome, exact), budget::wander(outcome, exact)].into_iter().flatten() {
            table += &format!("\n{line}\n");
        }
    }
    let json = json.render()?;
    target.write("calibration", &json, &table, &text::verdict(outcome), |files, folder| {
        files.write(&folder.join("history.csv"), |file| text::history(outcome, file))?;
        if let Some(smoothed) = &outcome.smoothed {
            let site = &log.description().site;
            files.write(&folder.join("trajectory.csv"), |file| text::trajectory(smoothed, site, file))?;
        }
        report::report(log, filter, options, outcome, exact.as_ref())?.write(files, folder)
    })
}
