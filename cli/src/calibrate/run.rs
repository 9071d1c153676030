//! Driving the library's calibration over the passes of a log.

use miette::{Result, miette};
use nalgebra::{UnitQuaternion, Vector3};
use sinscal::{
    Calibration, ChannelInnovations, CoarseCalibration, Conventional, Filter, FilterVisitor, InitialAttitude,
    Innovations, Parameter, Smoothed, Smoother, StateInfo, Statistics, Strapdown, Ud,
};

use super::Form;
use super::refusals::{Refusals, Stretch};
use super::tape::FileTape;
use crate::history::History;
use crate::{say, setup};
use logs::{Bridged, Log};

/// What to look at when a filter breaks down over a log whose every row is plausible.
const DIVERGED: &str = "look at that time in the log; and at [prior] and [initial] of its description: a sigma that is far too wide \
                        leaves the arithmetic no digits, one far too small no room";

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
    /// Whether the log tells any dither.
    pub(super) dithers: bool,
    /// What the last pass left out of the reference.
    pub(super) refused: Vec<Stretch>,
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
        let coarse = self.log.coarse();
        let prior = |_, info: &StateInfo, sigma| coarse.map_or(sigma, |coarse| coarse.prior(info, sigma));
        let mut calibration =
            Box::new(Calibration::<F, C>::with_prior(&setup::of(self.log, self.initial), prior));
        let mut history = History::new(estimates(&calibration, coarse).len());
        let mut samples = 0_u64;
        let mut times = (0.0, 0.0);
        let mut dithers = false;
        let mut bridged = Bridged::default();
        let trouble = |error| miette!("the temporary file of the smoother: {error}");
        let mut observer = (Refusals::default(), (None, None));

        let bar = say::progress_bar(self.log.size() * u64::from(self.options.passes), "calibrating");
        for pass in 0..self.options.passes {
            if pass > 0 {
                calibration.begin_pass();
                history.clear();
            }
            observer.0 = Refusals::default();
            if pass + 1 == self.options.passes {
                let tape = self.options.smooth.then(FileTape::new).transpose().map_err(trouble)?;
                observer.1.0 = tape.map(Smoother::<F, FileTape>::new);
                observer.1.1 = self.options.residuals.then(Innovations::<F>::default);
            }
            samples = 0;
            for chunk in self.log.ahead()? {
                let chunk = chunk?;
                for sample in &chunk.samples {
                    if samples == 0 {
                        times.0 = sample.time - 1.0 / description.rate;
                    }
                    times.1 = sample.time;
                    samples += 1;
                    dithers |= sample.dither.iter().any(|amplitude| *amplitude > 0.0);
                    let update = calibration.step_observed(sample, &mut observer);
                    let table = self.log.table().display();
                    let update = update.map_err(|error| miette!(help = DIVERGED, "{table}: {error}"))?;
                    if update.is_some() && history.due() {
                        history.push(sample.time, |put| {
                            let now = estimates(&calibration, coarse);
                            now.iter().for_each(|parameter| put(parameter.value, parameter.sigma));
                        });
                    }
                }
                bar.set_position(self.log.size() * u64::from(pass) + chunk.position);
                bridged = chunk.bridged;
            }
            say::detail(|| {
                let nis = calibration.statistics().nis_per_dof();
                format!("pass {} of {}: NIS per degree of freedom {nis:.3}", pass + 1, self.options.passes)
            });
        }
        bar.finish_and_clear();
        let parameters = estimates(&calibration, coarse);
        history.push(times.1, |put| {
            parameters.iter().for_each(|parameter| put(parameter.value, parameter.sigma));
        });
        let (refusals, (smoother, innovations)) = observer;
        let smoothed = smoother.map(|s| s.finish(&calibration.covariance())).transpose().map_err(trouble)?;
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
            dithers,
            refused: refusals.stretches,
            smoothed,
            residuals: innovations.map(Innovations::finish),
        })
    }
}

/// The parameters so far, with what a coarse calibration took out of the samples.
fn estimates<F: Filter<Dynamics = Strapdown>, C: sinscal::Form>(
    calibration: &Calibration<F, C>,
    coarse: Option<&CoarseCalibration>,
) -> Vec<Parameter> {
    let mut parameters = Vec::new();
    calibration.parameters(&mut |parameter| parameters.push(parameter));
    if let Some(coarse) = coarse {
        let states: Vec<StateInfo> = parameters.iter().map(|parameter| parameter.info).collect();
        let mut values: Vec<f64> = parameters.iter().map(|parameter| parameter.value).collect();
        coarse.total(&states, &mut values);
        parameters.iter_mut().zip(values).for_each(|(parameter, value)| parameter.value = value);
    }
    parameters
}
