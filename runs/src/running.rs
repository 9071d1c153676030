//! One filter on its way over the passes of a log.

use std::io;

use calib_core::{Conventional, Filter, Shape, Ud};
use sinscal::{
    Calibration, CoarseCalibration, Diverged, Gate, InitialAttitude, Innovations, Parameter, Sample, Setup,
    Site, SiteRests, Smoother, StateInfo, Statistics, Strapdown,
};

use crate::compiled::{Selection, begun, boxed, placed};
use crate::filter::AnyFilter;
use crate::history::History;
use crate::look::Look;
use crate::outcome::Outcome;
use crate::refusals::Refusals;
use crate::samples::Extent;
use crate::scores::{Question, Scored, Scores};
use crate::tape::FileTape;
use crate::trace::{Trace as _, Tracer};

/// How to run.
#[derive(Clone, Debug)]
pub struct Options {
    /// Number of passes over the log; each after the first linearises about the parameters found before.
    pub passes: u32,
    /// How the covariance is kept.
    pub form: Form,
    /// Whether the navigation solution is smoothed over the last pass.
    pub smooth: bool,
    /// Whether residuals are remembered for a report.
    pub residuals: bool,
    /// Least time between two points of the history, s; zero keeps them as densely as memory allows.
    pub history_step: f64,
    /// Prior standard deviations of the parameters, in their order, SI; those of setup and blocks where empty.
    pub priors: Vec<f64>,
    /// What a coarse calibration took out of the samples: it stands in the estimates and makes the priors.
    pub coarse: Option<CoarseCalibration>,
    /// Whether passes must improve and agree, and sigmas repeat, where there is more than one pass: it takes one pass more.
    pub settle: bool,
}

impl Options {
    /// What suits a filter: its number of passes, and nothing beside the estimates.
    pub fn of(filter: &dyn AnyFilter) -> Self {
        Self {
            passes: filter.passes(),
            form: Form::Conventional,
            smooth: false,
            residuals: false,
            history_step: 0.0,
            priors: Vec::new(),
            coarse: None,
            settle: false,
        }
    }
}

/// How a covariance is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// As a symmetric matrix.
    Conventional,
    /// As U D U' (Thornton and Bierman).
    Ud,
}

impl Form {
    /// Name in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Conventional => "conventional",
            Self::Ud => "ud",
        }
    }
}

/// A filter that runs over a log: samples are handed to it pass by pass.
pub trait Running: Send {
    /// Begins a pass; `last` says that it is the one whose residuals and smoothing are wanted.
    ///
    /// # Errors
    /// When the memory of the smoother cannot be made.
    fn begin_pass(&mut self, last: bool) -> io::Result<()>;

    /// Begins a pass about given values of the parameters that take part, as [`values`](Self::values) has them.
    ///
    /// # Errors
    /// When the memory of the smoother cannot be made.
    fn begin_pass_about(&mut self, values: &[f64], last: bool) -> io::Result<()>;

    /// Takes in the next samples.
    ///
    /// # Errors
    /// When the filter has diverged.
    fn feed(&mut self, samples: &[Sample]) -> Result<(), Diverged>;

    /// Sums over the updates of this pass.
    fn statistics(&self) -> &Statistics;

    /// Values of the parameters so far: those of the states, without what a coarse calibration or a first guess adds.
    fn values(&self) -> Vec<f64>;

    /// The parameters so far, as people know them.
    fn parameters(&self) -> Vec<Parameter>;

    /// Prior standard deviations of the parameters that take part.
    fn priors(&self) -> Vec<f64> {
        self.parameters().iter().map(|parameter| parameter.prior_sigma).collect()
    }

    /// Times of the first and of the last sample so far in this pass, s.
    fn span(&self) -> (f64, f64);

    /// Further passes begin with this attitude.
    fn restart(&mut self, initial: &InitialAttitude);

    /// How the readings of the reference were spread.
    fn gate(&self) -> Gate;

    /// Judges readings in the next pass by how they were spread in a pass of another run.
    fn judge_as(&mut self, gate: Gate);

    /// What the samples of the first pass say by themselves.
    fn look(&self) -> &Look;

    /// What this pass says of the values that it was begun about; nothing in a first pass, and where nobody asked.
    fn scored(&mut self) -> Option<Scored>;

    /// What came of it.
    ///
    /// # Errors
    /// When the memory of the smoother fails.
    fn finish(self: Box<Self>) -> io::Result<Outcome>;
}

/// Starts filter `F`; `title` is what people call it.
pub(crate) fn start<F: Filter<Dynamics = Strapdown>>(
    title: String,
    setup: &Setup,
    options: &Options,
    selection: &Selection,
) -> Box<dyn Running> {
    match options.form {
        Form::Conventional => Box::new(Run::<F, Conventional>::new(title, setup, options, selection)),
        Form::Ud => Box::new(Run::<F, Ud>::new(title, setup, options, selection)),
    }
}

/// In the last pass: what is smoothed, and the residuals.
type Asked<F> = (Option<Smoother<F, FileTape>>, Option<Innovations<F>>);
/// In each pass about known values, where passes must agree.
type Scoring<F> = Option<Tracer<F, Scores>>;

struct Run<F: Filter<Dynamics = Strapdown>, C: sinscal::Form> {
    title: String,
    calibration: Box<Calibration<F, C>>,
    options: Options,
    selection: Selection,
    interval: f64,
    begun: InitialAttitude,
    pass: u32,
    extent: Extent,
    look: Look,
    /// Still positions, where they are asked what they show.
    rests: Option<SiteRests>,
    site: Site,
    dithers: bool,
    history: History,
    /// What is left out of the reference, and what the last pass asks for.
    observer: ((Refusals, Scoring<F>), Asked<F>),
}

impl<F: Filter<Dynamics = Strapdown>, C: sinscal::Form> Run<F, C> {
    fn new(title: String, setup: &Setup, options: &Options, selection: &Selection) -> Self {
        let setup = Setup { open: selection.open, ..*setup };
        let coarse = options.coarse.as_ref();
        let prior = |state, info: &StateInfo, sigma| match selection.place(state) {
            None if state >= F::Shape::CORE => 0.0,
            Some(place) if !options.priors.is_empty() => options.priors[place],
            _ => coarse.map_or(sigma, |coarse| coarse.prior(info, sigma)),
        };
        Self {
            title,
            calibration: boxed(|| Calibration::with_prior(&setup, prior)),
            options: options.clone(),
            selection: selection.clone(),
            interval: 1.0 / setup.rate,
            begun: setup.initial,
            pass: 0,
            extent: Extent::default(),
            look: Look::default(),
            rests: options.settle.then(|| SiteRests::new(setup.rate, setup.noise)).flatten(),
            site: setup.site,
            dithers: false,
            history: History::new(selection.states.len(), options.history_step),
            observer: ((Refusals::default(), None), (None, None)),
        }
    }

    fn prepare(&mut self, last: bool, scoring: Scoring<F>) -> io::Result<()> {
        self.pass += 1;
        self.extent = Extent::default();
        let smoother = (last && self.options.smooth).then(FileTape::new).transpose()?.map(Smoother::new);
        let innovations = (last && self.options.residuals).then(Innovations::default);
        self.observer = ((Refusals::default(), scoring), (smoother, innovations));
        Ok(())
    }
}

/// The parameters so far that take part, with what a coarse calibration took out of the samples.
fn estimates<F: Filter<Dynamics = Strapdown>, C: sinscal::Form>(
    calibration: &Calibration<F, C>,
    selection: &Selection,
    coarse: Option<&CoarseCalibration>,
) -> Vec<Parameter> {
    let mut all = Vec::with_capacity(F::Shape::STATES);
    calibration.parameters(&mut |parameter| all.push(parameter));
    let mut parameters: Vec<Parameter> =
        selection.states.iter().map(|state| all[state - F::Shape::CORE]).collect();
    if let Some(coarse) = coarse {
        let states: Vec<StateInfo> = parameters.iter().map(|parameter| parameter.info).collect();
        let mut values: Vec<f64> = parameters.iter().map(|parameter| parameter.value).collect();
        coarse.total(&states, &mut values);
        parameters.iter_mut().zip(values).for_each(|(parameter, value)| parameter.value = value);
    }
    parameters
}

impl<F: Filter<Dynamics = Strapdown>, C: sinscal::Form + Send> Running for Run<F, C> {
    fn begin_pass(&mut self, last: bool) -> io::Result<()> {
        if self.pass > 0 {
            return self.begin_pass_about(&self.values(), last);
        }
        self.prepare(last, None)
    }

    fn begin_pass_about(&mut self, values: &[f64], last: bool) -> io::Result<()> {
        self.calibration.begin_pass_about(&placed::<F>(&self.selection, values));
        self.history.clear();
        let scoring = self.options.settle.then(|| {
            let mut scores = Scores::new(Question {
                about: values.to_vec(),
                priors: self.priors(),
                start: false,
                span: self.span(),
            });
            scores.begin(&begun(&self.calibration, &self.selection));
            Tracer::new(&self.selection, scores)
        });
        self.prepare(last, scoring)
    }

    fn feed(&mut self, samples: &[Sample]) -> Result<(), Diverged> {
        for sample in samples {
            self.extent.push(sample.time);
            // every pass reads the same
            if self.pass == 1 {
                self.look.push(sample);
                if let Some(rests) = &mut self.rests {
                    rests.push(sample);
                }
            }
            self.dithers |= sample.dither.iter().any(|amplitude| *amplitude > 0.0);
            let update = self.calibration.step_observed(sample, &mut self.observer)?;
            if update.is_some() && self.history.due(sample.time) {
                let now = estimates(&self.calibration, &self.selection, self.options.coarse.as_ref());
                self.history
                    .push(sample.time, now.iter().map(|parameter| (parameter.value, parameter.sigma)));
            }
        }
        Ok(())
    }

    fn statistics(&self) -> &Statistics {
        self.calibration.statistics()
    }

    fn values(&self) -> Vec<f64> {
        let estimate = self.calibration.estimate();
        self.selection.states.iter().map(|state| estimate[*state]).collect()
    }

    fn parameters(&self) -> Vec<Parameter> {
        estimates(&self.calibration, &self.selection, self.options.coarse.as_ref())
    }

    fn span(&self) -> (f64, f64) {
        (self.extent.first, self.extent.last)
    }

    fn restart(&mut self, initial: &InitialAttitude) {
        self.begun = *initial;
        self.calibration.restart(initial);
    }

    fn gate(&self) -> Gate {
        self.calibration.gate()
    }

    fn judge_as(&mut self, gate: Gate) {
        self.calibration.judge_as(gate);
    }

    fn look(&self) -> &Look {
        &self.look
    }

    fn scored(&mut self) -> Option<Scored> {
        let ((_, scoring), _) = &mut self.observer;
        scoring.take()?.to.finish()
    }

    fn finish(mut self: Box<Self>) -> io::Result<Outcome> {
        let parameters = self.parameters();
        let values = self.values();
        self.history
            .push(self.extent.last, parameters.iter().map(|parameter| (parameter.value, parameter.sigma)));
        let dense = self.calibration.covariance();
        let taken = &self.selection.states;
        let covariance = taken.iter().map(|i| taken.iter().map(|j| dense[*i][*j]).collect()).collect();
        let ((refusals, _), (smoother, innovations)) = self.observer;
        let start = self.extent.first - self.interval;
        let site = self.rests.and_then(|rests| rests.finish(&self.site));
        let scales = ["gyro-scale", "accel-scale"].map(|name| {
            let named = parameters.iter().filter(|parameter| parameter.info.block == name);
            let widest = named.map(|parameter| parameter.prior_sigma).reduce(f64::max);
            // where nobody says how good they are nothing is taken from them
            widest.filter(|sigma| *sigma > 0.0).unwrap_or(f64::INFINITY)
        });
        let departure = |(value, parameter): (f64, &Parameter)| {
            if parameter.prior_sigma > 0.0 { value / parameter.prior_sigma } else { 0.0 }
        };
        Ok(Outcome {
            departures: values.iter().copied().zip(&parameters).map(departure).collect(),
            state_values: values,
            begun: self.begun,
            filter: self.title,
            states: F::Shape::CORE + parameters.len(),
            samples: self.extent.samples,
            start,
            duration: self.extent.last - start,
            parameters,
            covariance,
            history: self.history,
            statistics: *self.calibration.statistics(),
            gate: self.calibration.gate(),
            attitude: self.calibration.attitude(),
            position: self.calibration.position(),
            velocity: self.calibration.navigation().velocity,
            look: self.look,
            site_fault: site.and_then(|shown| shown.contradicts(&self.site, scales)),
            site,
            dithers: self.dithers,
            refused: refusals.stretches,
            passes: Vec::new(),
            moved: None,
            repeat: None,
            budget: Vec::new(),
            smoothed: smoother.map(|smoother| smoother.finish(&dense)).transpose()?,
            residuals: innovations.map(Innovations::finish),
        })
    }
}
