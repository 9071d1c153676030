//! The nonlinear runs: the declared filter with chosen candidates, closed loop, relinearised, recorded.

use calib_core::{Array, Block, Dynamics, Extended, Filter, Shape};
use sinscal::navigation::{Pilot, pilot_of};
use sinscal::{Calibration, Setup, StateInfo, Strapdown};

use crate::candidates::prior_factor;
use crate::declaration::BaseFilter;
use crate::error::SceneError;
use crate::log::Log;
use crate::recording::{CORE, Column, Recorder, Recording};

/// Estimates that still move by more than this many standard deviations call for another pass. What a move leaves is second
/// order in it.
const SETTLED: f64 = 1.0;
/// No more passes than this.
const PASSES: usize = 5;

/// A filter was really run.
#[derive(Clone, Debug)]
pub(crate) struct Ran {
    pub(crate) recording: Recording,
    /// Estimate and standard deviation of every parameter, truth.
    pub(crate) estimate: Vec<(f64, f64)>,
}

/// What a diagnosis must be able to do with a declared filter, whatever its sizes.
pub(crate) trait Machine: Sync {
    /// What its declaration says.
    fn base(&self) -> BaseFilter;
    /// Whether the declared filter has a block.
    fn has(&self, block: &str) -> bool;
    /// Runs the filter until it has settled; each candidate's prior is multiplied by `size`, and a candidate of size zero
    /// takes no part.
    fn run(&self, log: &Log, size: &(dyn Fn(&str) -> f64 + Sync)) -> Result<Ran, SceneError>;
    /// Navigates with parameters in the order of the columns of a run; those it did not have are zero.
    fn pilot(&self, setup: &Setup, parameters: &[f64]) -> Box<dyn Pilot>;
}

/// The types of a filter, without one.
type Types<F, B, K> = core::marker::PhantomData<fn() -> (F, B, K)>;

/// Filter `F` with the candidates of `B`, of which there are `K` states.
pub(crate) struct Declared<F, B, K>(Types<F, B, K>);

impl<F, B, K> Declared<F, B, K> {
    pub(crate) fn new() -> Self {
        Self(core::marker::PhantomData)
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

impl<F, B, K> Machine for Declared<F, B, K>
where
    F: Filter<Dynamics = Strapdown>,
    B: Block<Dynamics = Strapdown>,
    K: 'static,
    Extended<F, B, K>: Filter<Dynamics = Strapdown>,
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
            has_inner_lever_arm: F::SET.contains(sinscal::blocks::set::INNER_LEVER_ARM),
        }
    }

    fn has(&self, block: &str) -> bool {
        // a filter with the dither coupling knows the dither's size effect, without states for it
        blocks::<F>().contains(&block)
            || block == "dither-size-effect" && F::SET.contains(sinscal::blocks::set::DITHER)
    }

    fn run(&self, log: &Log, size: &(dyn Fn(&str) -> f64 + Sync)) -> Result<Ran, SceneError> {
        let own = F::Shape::STATES;
        if !blocks::<B>().into_iter().any(|block| size(block) > 0.0) {
            return drive::<F>(log, own, &|_, sigma| sigma);
        }
        drive::<Extended<F, B, K>>(log, own, &|info, sigma| {
            if self.has(info.block) {
                0.0
            } else {
                sigma * size(info.block) * prior_factor(log.setup, info.block)
            }
        })
    }

    fn pilot(&self, setup: &Setup, parameters: &[f64]) -> Box<dyn Pilot> {
        let mut states = <Extended<F, B, K> as Filter>::Shape::vector(0.0);
        states.as_mut_slice()[CORE..].iter_mut().zip(parameters).for_each(|(state, value)| *state = *value);
        pilot_of::<Extended<F, B, K>>(setup, &states)
    }
}

/// Runs filter `G`, of whose states the first `own` are the declared filter's, until it has settled; `prior` adjusts the
/// priors of the others.
fn drive<G: Filter<Dynamics = Strapdown>>(
    log: &Log,
    own: usize,
    prior: &dyn Fn(&StateInfo, f64) -> f64,
) -> Result<Ran, SceneError> {
    let mut columns: Vec<Column> = Vec::new();
    let mut calibration = Calibration::<G>::with_prior(log.setup, |state, info, sigma| {
        let sigma = if state < own { sigma } else { prior(info, sigma) };
        if state >= CORE {
            columns.push(Column { info: *info, prior: sigma, base: state < own, about: 0.0 });
        }
        sigma
    });
    let covariance = calibration.covariance();
    let start = core::array::from_fn(|i| covariance[i][i].sqrt());
    let mut relaxing = Vec::new();
    G::relaxation(&mut |state, r: calib_core::Relaxation<f64>| {
        relaxing.push((state - CORE, r.rate, r.density));
    });
    log.try_each(|sample| calibration.step(sample).map(drop).map_err(SceneError::Diverged))?;
    let mut passes = 1;
    loop {
        let about = calibration.estimate();
        calibration.begin_pass();
        let mut recorder = Recorder::<G>::new();
        log.try_each(|sample| {
            calibration.step_observed(sample, &mut recorder).map(drop).map_err(SceneError::Diverged)
        })?;
        passes += 1;
        let estimate = calibration.estimate();
        let covariance = calibration.covariance();
        let mut moved: f64 = 0.0;
        let mut settled = Vec::with_capacity(columns.len());
        for (i, column) in columns.iter_mut().enumerate() {
            let state = CORE + i;
            column.about = about[state];
            let sigma = covariance[state][state].max(0.0).sqrt();
            if sigma > 0.0 {
                moved = moved.max((estimate[state] - about[state]).abs() / sigma);
            }
            settled.push((estimate.as_slice()[state], sigma));
        }
        if moved < SETTLED || passes >= PASSES {
            let recording = Recording { columns, start, steps: recorder.steps, relaxing };
            return Ok(Ran { recording, estimate: settled });
        }
    }
}
