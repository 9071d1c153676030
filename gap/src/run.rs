//! The nonlinear runs: the declared filter with chosen candidates, closed loop, relinearised, recorded.

use calib_core::{Array, Block, Dynamics, Extended, Filter, Shape, declares, relaxations};
use nalgebra::DVector;
use sinscal::navigation::{Pilot, pilot_of};
use sinscal::{Calibration, Dither, InnerLeverArm, Known, Setup, StateInfo, Strapdown};

use crate::candidates::prior_factor;
use crate::declaration::BaseFilter;
use crate::error::SceneError;
use crate::linear::{Found, Noise};
use crate::log::Log;
use crate::noise::price;
use crate::prices::Prices;
use crate::products::dot;
use crate::recording::{CORE, Column, Recorder, Recording};

/// Estimates have settled that are within so many standard deviations of where the pass was linearised.
const SETTLED: f64 = 1.0;
/// What a move leaves is second order. In the first recorded pass it is small when the largest angle that all moves make is less
/// than this, rad...
const SMALL: f64 = 2e-3;
/// ...and, times the largest move in standard deviations, less than this.
const SECOND_ORDER: f64 = 0.1;
/// No more recorded passes than this.
const PASSES: usize = 4;
/// Size of a specific force, m/s^2.
const GRAVITY: f64 = 9.8;

/// A filter was really run.
#[derive(Clone, Debug)]
pub(crate) struct Ran {
    pub(crate) recording: Recording,
    /// Log-likelihood of the base filter, and the prices of the candidates that took part.
    pub(crate) log_likelihood: f64,
    pub(crate) prices: Prices,
    /// Estimate of every parameter under base and all candidates, truth.
    pub(crate) estimate: Vec<f64>,
}

/// How many times larger than expected a block is taken to be; a candidate of size zero takes no part.
pub(crate) type Size<'a> = dyn Fn(&str) -> f64 + Sync + 'a;

/// What a diagnosis must be able to do with a declared filter, whatever its sizes.
pub(crate) trait Machine: Sync {
    /// What its declaration says.
    fn base(&self) -> BaseFilter;
    /// Whether the declared filter has a block.
    fn has(&self, block: &str) -> bool;
    /// Runs the filter and records a pass with all candidates' columns.
    fn run(&self, log: &Log, noise: &Noise, size: &Size) -> Result<Ran, SceneError>;
    /// The same, but it is the filter with the candidates that is run closed loop.
    fn rerun(&self, log: &Log, noise: &Noise, size: &Size) -> Result<Ran, SceneError>;
    /// Navigates with parameters in the order of the columns of a run; those it did not have are zero.
    fn pilot(&self, setup: &Setup, parameters: &[f64]) -> Box<dyn Pilot>;
}

/// The types of a filter, without one.
type Types<F, B> = core::marker::PhantomData<fn() -> (F, B)>;

/// Filter `F` with the candidates of `B`.
pub(crate) struct Declared<F, B>(Types<F, B>);

impl<F, B> Declared<F, B> {
    pub(crate) fn new() -> Self {
        Self(core::marker::PhantomData)
    }

    /// Standard deviation of a candidate's state before the run, from that of its block.
    fn prior<'a>(&'a self, log: &'a Log, size: &'a Size) -> impl Fn(&StateInfo, f64) -> f64 + 'a
    where
        Self: Machine,
    {
        |info, sigma| {
            if self.has(info.block) {
                0.0
            } else {
                sigma * size(info.block) * prior_factor(log.setup, info.block)
            }
        }
    }
}

fn blocks<B: Block>() -> Vec<&'static str> {
    let mut names = Vec::new();
    B::states(&mut |info| {
        if !names.contains(&info.block) {
            names.push(info.block);
        }
    });
    names
}

impl<F, B> Machine for Declared<F, B>
where
    F: Filter<Dynamics = Strapdown>,
    B: Block<Dynamics = Strapdown>,
    Extended<F, B>: Filter<Dynamics = Strapdown>,
{
    fn base(&self) -> BaseFilter {
        let path = core::any::type_name::<F>();
        // the types of the library are re-exported at its root
        let own = path.rsplit("::").next().unwrap_or(path);
        let path = if path.starts_with("sinscal::") { format!("sinscal::{own}") } else { path.into() };
        let channels = <Strapdown as Dynamics>::CHANNELS;
        BaseFilter {
            name: F::NAME.into(),
            path,
            measures: F::MEASURES.iter().map(|g| channels[*g].name.into()).collect(),
            has_inner_lever_arm: declares::<F, InnerLeverArm>(),
        }
    }

    fn has(&self, block: &str) -> bool {
        // a filter with the dither coupling knows the dither's size effect, without states for it
        blocks::<F>().contains(&block) || block == "dither-size-effect" && declares::<F, Dither>()
    }

    fn run(&self, log: &Log, noise: &Noise, size: &Size) -> Result<Ran, SceneError> {
        match drive::<F, Extended<F, B>>(log, noise, F::Shape::STATES, &self.prior(log, size)) {
            // it may well be what it lacks that it does not survive
            Err(SceneError::Diverged(_)) => self.rerun(log, noise, size),
            done => done,
        }
    }

    fn rerun(&self, log: &Log, noise: &Noise, size: &Size) -> Result<Ran, SceneError> {
        let own = F::Shape::STATES;
        if !blocks::<B>().into_iter().any(|block| size(block) > 0.0) {
            return drive::<F, F>(log, noise, own, &|_, sigma| sigma);
        }
        drive::<Extended<F, B>, Extended<F, B>>(log, noise, own, &self.prior(log, size))
    }

    fn pilot(&self, setup: &Setup, parameters: &[f64]) -> Box<dyn Pilot> {
        let mut states = <Extended<F, B> as Filter>::Shape::vector(0.0);
        states.as_mut_slice()[CORE..].iter_mut().zip(parameters).for_each(|(state, value)| *state = *value);
        pilot_of::<Extended<F, B>>(setup, &states)
    }
}

/// Runs filter `A` closed loop, then records passes of filter `G` about what was found, until it has settled. The first states
/// of `G` are those of `A`, the first `own` of both those of the declared filter; `prior` adjusts the priors of the others.
fn drive<A: Filter<Dynamics = Strapdown>, G: Filter<Dynamics = Strapdown>>(
    log: &Log,
    noise: &Noise,
    own: usize,
    prior: &dyn Fn(&StateInfo, f64) -> f64,
) -> Result<Ran, SceneError> {
    let adjusted = |state, info: &StateInfo, sigma| if state < own { sigma } else { prior(info, sigma) };
    let mut first = Calibration::<A>::with_prior(log.setup, adjusted);
    log.try_each_joined(|sample| first.step(sample).map(drop).map_err(SceneError::Diverged))?;
    let mut columns: Vec<Column> = Vec::new();
    let mut pass = Calibration::<G, Known>::with_prior(log.setup, |state, info, sigma| {
        let sigma = adjusted(state, info, sigma);
        if state >= CORE {
            columns.push(Column { info: *info, prior: sigma, base: state < own, about: 0.0 });
        }
        sigma
    });
    pass.judge_after(&first);
    let covariance = pass.covariance();
    let start = core::array::from_fn(|i| covariance[i][i].sqrt());
    let mut relaxing = Vec::new();
    relaxations::<G, f64>(|state, r| relaxing.push((state - CORE, r.rate, r.density)));
    let mut about = G::Shape::vector(0.0);
    about.as_mut_slice()[..A::Shape::STATES].copy_from_slice(first.estimate().as_slice());
    let mut passes = 0;
    loop {
        columns.iter_mut().zip(&about.as_slice()[CORE..]).for_each(|(column, about)| column.about = *about);
        pass.begin_known(&about);
        let mut recorder = Recorder::<G>::new();
        log.try_each(|sample| {
            pass.step_observed(sample, &mut recorder).map(drop).map_err(SceneError::Diverged)
        })?;
        passes += 1;
        let recording =
            Recording { columns: columns.clone(), start, steps: recorder.steps, relaxing: relaxing.clone() };
        let (found, prices) = price(&recording, noise).ok_or(SceneError::Indefinite)?;
        let estimates = estimates(&recording, &found, &prices).ok_or(SceneError::Indefinite)?;
        let estimate: Vec<f64> = estimates.iter().map(|e| e.0).collect();
        let moves: Vec<f64> = columns.iter().zip(&estimate).map(|(column, e)| e - column.about).collect();
        let sigmas = moves.iter().zip(&estimates).filter(|(_, e)| e.1 > 0.0);
        let moved = sigmas.map(|(by, e)| by.abs() / e.1).fold(0.0, f64::max);
        let is_small = || angle_of(&recording, &moves) < SMALL.min(SECOND_ORDER / moved);
        if moved < SETTLED || passes == 1 && is_small() || passes == PASSES {
            return Ok(Ran { recording, log_likelihood: found.log_likelihood, prices, estimate });
        }
        about.as_mut_slice()[CORE..].copy_from_slice(&estimate);
    }
}

/// The largest angle, rad, by which moves of all parameters turn the computed attitude, or the specific force.
fn angle_of(recording: &Recording, moves: &[f64]) -> f64 {
    let mut angle: f64 = 0.0;
    let mut turned = [0.0; 3];
    for step in &recording.steps {
        let mut rows = step.rows.chunks_exact(CORE + moves.len() + 1).map(|row| dot(&row[CORE..], moves));
        for (turned, by) in turned.iter_mut().zip(&mut rows) {
            *turned += by;
            angle = angle.max(turned.abs());
        }
        for by in rows.take(3).filter(|_| step.elapsed > 0.0) {
            angle = angle.max(by.abs() / (GRAVITY * step.elapsed));
        }
    }
    angle
}

/// Estimate and standard deviation of every column under base and all candidates, from the run of the base filter that found
/// the candidates' prices; zero for what takes no part.
fn estimates(recording: &Recording, found: &Found, prices: &Prices) -> Option<Vec<(f64, f64)>> {
    let (priced, all) = (recording.candidates(), prices.all());
    let (mean, covariance) = prices.estimates(&all, &vec![1.0; all.len()])?;
    let members = prices.members(&all);
    let mut estimates = vec![(0.0, 0.0); recording.columns.len()];
    for (k, member) in members.iter().enumerate() {
        estimates[priced[*member]] = (mean[k], covariance[(k, k)].sqrt());
    }
    let nc = 1 + priced.len();
    for (k, i) in recording.base().into_iter().enumerate() {
        let errors = &found.errors[k * nc..(k + 1) * nc];
        let shares = DVector::from_iterator(members.len(), members.iter().map(|m| errors[1 + m]));
        let value = recording.columns[i].about - errors[0] + shares.dot(&mean);
        let variance = found.variances[k] + shares.dot(&(&covariance * &shares));
        estimates[i] = (value, variance.sqrt());
    }
    Some(estimates)
}
