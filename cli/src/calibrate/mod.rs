//! `sinscal calibrate`: runs a filter over a log.

mod json;
mod report;
pub(crate) mod text;

use std::time::Instant;

use clap::{Args, ValueEnum};
use logs::Log;
use logs::units::DEGREE;
use miette::Result;
use runs::{Options, Verdict, Watch};
use sinscal::{Coarse, Parameter, Statistics, UnknownPulses};

use crate::arguments::{self, FilterArgument, LogArgument, Results};
use crate::origin::Documented as _;
use crate::source::{Source, fault};
use crate::{say, setup};

/// What its help ends with.
const EXAMPLES: &str = "\
Examples:
  sinscal calibrate runs/unit-3 --filter 43d-b
  sinscal calibrate runs/unit-3 --filter 43d-b --out results
  sinscal calibrate runs/unit-3 --filter mems-30d --coarse --json -

With --out: report.html, calibration.json, calibration.txt, history.csv (estimates and sigmas over time), with --smooth
trajectory.csv, and the figures.";

/// Calibrate a unit: run a filter over a log and report its parameters
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    #[command(flatten)]
    log: LogArgument,
    #[command(flatten)]
    filter: FilterArgument,
    /// Number of passes, by default what the filter's class of units needs; each after the first linearises about the
    /// parameters found before
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    passes: Option<u32>,
    /// Begin with a coarse calibration from the log's own still positions and the turns between them: for errors far beyond the
    /// priors. Pulses of unknown size need it and get it unasked
    #[arg(long)]
    coarse: bool,
    /// Smooth the navigation solution over the whole log in the last pass; `--out` then holds trajectory.csv
    #[arg(long)]
    smooth: bool,
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

/// Whether a parameter that the coarse stage knows lies far out.
fn far_out(parameter: &Parameter) -> bool {
    parameter.estimated
        && parameter.value.abs() > FAR * parameter.prior_sigma
        && Coarse::EFFECTS.contains(&parameter.info.block)
}

impl Arguments {
    pub(crate) fn run(self) -> Result<()> {
        let started = Instant::now();
        let mut target = self.results.target()?;
        let filter = self.filter.filter()?;
        let filter = &*filter;
        let mut log = Log::open_counting(&self.log.log, &self.log.columns.reading_for(filter))?;
        target.reads_log(&log)?;
        self.filter.change.files().try_for_each(|path| target.reads(path))?;
        if self.coarse || log.unknown_pulses() != UnknownPulses::default() {
            setup::coarse(&mut log)?;
        }
        log.refer(&filter.measures())?;
        if log.coarse().is_none() && setup::coarse_if_far(&mut log)? {
            say::remark(
                "the still positions show errors beyond the priors: the coarse stage takes them out first",
            );
            log.refer(&filter.measures())?;
        }
        arguments::tell(&log);
        let options = Options {
            passes: self.passes.unwrap_or_else(|| filter.passes()),
            form: self.form.into(),
            smooth: self.smooth,
            residuals: self.results.out.is_some(),
            coarse: log.coarse().cloned(),
            ..Options::of(filter)
        };
        let setup = setup::of(&log, setup::initial(&log)?);
        let source = Source::new(&log, "calibrating");
        let outcome = runs::calibrate(filter, &source, &setup, &options, &mut Passes)
            .map_err(|error| fault(&log, error))?;
        let bridged = source.bridged();
        drop(source);
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
        if let Some(doubt) = text::doubt(&outcome, options.passes) {
            say::warn(&doubt);
        }
        if bridged.gaps > 0 {
            let (gaps, rows) = (bridged.gaps, bridged.rows);
            say::remark(&format!("{gaps} gaps were filled with {rows} interpolated rows"));
        }

        let document = json::Report::new(&log, filter, &options, &outcome, bridged, started.elapsed());
        let json = document.render()?;
        let table = text::table(&log, &outcome, bridged, started.elapsed());
        target.write("calibration", &json, &table, &text::verdict(&outcome), |files, folder| {
            files.write(&folder.join("history.csv"), |file| text::history(&outcome, file))?;
            if let Some(smoothed) = &outcome.smoothed {
                let site = &log.description().site;
                files.write(&folder.join("trajectory.csv"), |file| text::trajectory(smoothed, site, file))?;
            }
            report::report(&log, filter, &options, &outcome)?.write(files, folder)
        })
    }
}
