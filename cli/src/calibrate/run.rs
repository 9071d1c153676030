//! Driving the library's calibration over the passes of a log.

use indicatif::{ProgressBar, ProgressStyle};
use miette::{Result, miette};
use nalgebra::{UnitQuaternion, Vector3};
use sinscal::{
    Calibration, ChannelInnovations, Conventional, Filter, FilterVisitor, InitialAttitude, Innovations,
    Parameter, Smoothed, Smoother, Statistics, Strapdown, Ud,
};

use super::Form;
use crate::history::History;
use crate::log::{Bridged, Log};
use crate::setup;

/// The progress bar moves every so many samples.
const BAR_SAMPLES: u64 = 4096;

/// How to run.
#[derive(Clone, Copy)]
pub(super) struct Options {
    pub(super) passes: u32,
    pub(super) form: Form,
    pub(super) smooth: bool,
    /// Whether residuals are remembered for a report.
    pub(super) residuals: bool,
}

/// What came of it.
pub(super) struct Outcome {
    pub(super) samples: u64,
    /// From the start of the first interval to the end of the last, s.
    pub(super) duration: f64,
    /// Time of the start of the first interval, s.
    pub(super) start: f64,
    pub(super) parameters: Vec<Parameter>,
    pub(super) history: History,
    pub(super) statistics: Statistics,
    pub(super) attitude: UnitQuaternion<f64>,
    pub(super) position: Vector3<f64>,
    pub(super) velocity: Vector3<f64>,
    pub(super) bridged: Bridged,
    /// The smoothed navigation solution at each update, if it was asked for.
    pub(super) smoothed: Option<Vec<Smoothed>>,
    /// The residuals of the last pass, if they were asked for.
    pub(super) residuals: Option<Vec<ChannelInnovations>>,
}

/// Runs the filter called `filter` over the log.
pub(super) fn run(log: &Log, filter: &str, options: Options) -> Result<Outcome> {
    let initial = setup::initial(log)?;
    sinscal::visit_filter(filter, Run { log, initial, options })
        .unwrap_or_else(|| Err(miette!("there is no filter called {filter}")))
}

struct Run<'a> {
    log: &'a Log,
    initial: InitialAttitude,
    options: Options,
}

impl FilterVisitor for Run<'_> {
    type Output = Result<Outcome>;

    fn visit<F: Filter<Dynamics = Strapdown>>(self) -> Self::Output {
        match self.options.form {
            Form::Conventional => self.calibrate::<F, Conventional>(),
            Form::Ud => self.calibrate::<F, Ud>(),
        }
    }
}

impl Run<'_> {
    fn calibrate<F: Filter<Dynamics = Strapdown>, C: sinscal::Form>(self) -> Result<Outcome> {
        let description = self.log.description();
        let mut calibration = Box::new(Calibration::<F, C>::new(&setup::of(self.log, self.initial)));
        let mut parameters = Vec::new();
        calibration.parameters(&mut |parameter| parameters.push(parameter));
        let mut history = History::new(parameters.len());
        let mut samples = 0_u64;
        let mut times = (0.0, 0.0);
        let mut bridged = Bridged::default();
        let mut observer = (None, None);

        let bar = progress_bar(self.log.size() * u64::from(self.options.passes));
        for pass in 0..self.options.passes {
            if pass > 0 {
                calibration.begin_pass();
                history.clear();
            }
            if pass + 1 == self.options.passes {
                observer.0 = self.options.smooth.then(Smoother::<F>::default);
                observer.1 = self.options.residuals.then(Innovations::<F>::default);
            }
            samples = 0;
            let mut rows = self.log.samples()?;
            while let Some(row) = rows.next() {
                let sample = row?;
                if samples == 0 {
                    times.0 = sample.time - 1.0 / description.rate;
                }
                times.1 = sample.time;
                samples += 1;
                if samples.is_multiple_of(BAR_SAMPLES) {
                    bar.set_position(self.log.size() * u64::from(pass) + rows.position());
                }
                let update = calibration.step_observed(&sample, &mut observer);
                let update = update.map_err(|error| miette!("{}: {error}", self.log.table().display()))?;
                if update.is_some() && history.due() {
                    history.push(sample.time, |put| {
                        calibration.parameters(&mut |parameter| put(parameter.value, parameter.sigma));
                    });
                }
            }
            bridged = rows.bridged();
        }
        bar.finish_and_clear();
        history.push(times.1, |put| {
            calibration.parameters(&mut |parameter| put(parameter.value, parameter.sigma));
        });
        parameters.clear();
        calibration.parameters(&mut |parameter| parameters.push(parameter));
        Ok(Outcome {
            samples: samples - bridged.rows,
            duration: times.1 - times.0,
            start: times.0,
            parameters,
            history,
            statistics: *calibration.statistics(),
            attitude: calibration.attitude(),
            position: calibration.position(),
            velocity: calibration.navigation().velocity,
            bridged,
            smoothed: observer.0.map(Smoother::finish),
            residuals: observer.1.map(Innovations::finish),
        })
    }
}

/// A bar on standard error when that is a terminal, else nothing.
fn progress_bar(length: u64) -> ProgressBar {
    let bar = ProgressBar::new(length);
    match ProgressStyle::with_template("calibrating {wide_bar} {percent:>3} %  {eta} left") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
