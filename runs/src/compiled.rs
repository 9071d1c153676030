//! What is compiled for a filter: everything that needs its sizes.

use core::marker::PhantomData;
use core::ops::Range;

use calib_core::{Array, Filter, Shape, relaxations};
use sinscal::navigation::{Pilot, pilot_of};
use sinscal::{Calibration, Gate, Known, OpenBlocks, Setup, Strapdown};
use sinscal::{Corrector, corrector_of};

use crate::Error;
use crate::channels::Channels;
use crate::foresee::{Piece, foresee};
use crate::observe::{Analysis, look};
use crate::running::{Options, Running, start};
use crate::samples::{Samples, each};
use crate::trace::{Trace, Traced, Tracer};

/// Which states of a compiled filter take part, and what joined it at run time.
#[derive(Clone, Debug)]
pub struct Selection {
    /// The parameters that take part, as states of the compiled filter, in the order in which they are reported. The others have a
    /// prior of zero.
    pub states: Vec<usize>,
    /// Blocks in the filter's [`Open`](sinscal::Open) block, and whether the dither acts through the inner lever arm.
    pub open: OpenBlocks,
}

impl Selection {
    /// All parameters of a filter.
    pub fn all<F: Filter>() -> Self {
        Self { states: own::<F>().collect(), open: OpenBlocks::NONE }
    }

    /// Where a state of the compiled filter is reported.
    pub(crate) fn place(&self, state: usize) -> Option<usize> {
        self.states.iter().position(|taken| *taken == state)
    }
}

/// The parameters of filter `F`, as states.
pub(crate) fn own<F: Filter>() -> Range<usize> {
    F::Shape::CORE..F::Shape::STATES
}

/// A filter with its code, as an object.
pub trait Compiled: Send + Sync {
    /// Starts it; samples are handed over pass by pass. `title` is what people call it.
    fn start(
        &self,
        title: String,
        setup: &Setup,
        options: &Options,
        selection: &Selection,
    ) -> Box<dyn Running>;

    /// Looks at a log with its eyes.
    ///
    /// # Errors
    /// When the log cannot be read.
    fn observe(&self, samples: &dyn Samples, setup: &Setup, selection: &Selection)
    -> Result<Analysis, Error>;

    /// Standard deviations of the parameters that take part, as they will be after a motion that is known beforehand.
    ///
    /// # Errors
    /// When the covariance breaks down.
    fn foresee(
        &self,
        ahead: &mut dyn Iterator<Item = Piece>,
        setup: &Setup,
        selection: &Selection,
    ) -> Result<Vec<f64>, Error>;

    /// A pilot with known values of the parameters that take part.
    fn pilot(&self, setup: &Setup, selection: &Selection, values: &[f64]) -> Box<dyn Pilot>;

    /// What takes out of samples the errors of known values of the parameters that take part.
    fn corrector(&self, setup: &Setup, selection: &Selection, values: &[f64]) -> Corrector;

    /// Runs a pass with the parameters taken as known, and tells the linear system that it is.
    ///
    /// # Errors
    /// When the log cannot be read or the filter diverges.
    fn trace(
        &self,
        samples: &dyn Samples,
        setup: &Setup,
        selection: &Selection,
        about: &About,
        trace: &mut dyn Trace,
    ) -> Result<Traced, Error>;
}

/// What a traced pass is linearised about.
#[derive(Clone, Debug)]
pub struct About<'a> {
    /// Values of the parameters that take part.
    pub values: &'a [f64],
    /// How readings of the reference are judged: as another pass over the log found them spread.
    pub gate: Gate,
}

/// The code of filter `F`.
pub(crate) struct Of<F>(pub(crate) PhantomData<fn() -> F>);

impl<F> Of<F> {
    pub(crate) const NEW: Self = Self(PhantomData);
}

impl<F: Filter<Dynamics = Strapdown>> Compiled for Of<F> {
    fn start(
        &self,
        title: String,
        setup: &Setup,
        options: &Options,
        selection: &Selection,
    ) -> Box<dyn Running> {
        start::<F>(title, setup, options, selection)
    }

    fn observe(
        &self,
        samples: &dyn Samples,
        setup: &Setup,
        selection: &Selection,
    ) -> Result<Analysis, Error> {
        look::<F>(samples, setup, selection)
    }

    fn foresee(
        &self,
        ahead: &mut dyn Iterator<Item = Piece>,
        setup: &Setup,
        selection: &Selection,
    ) -> Result<Vec<f64>, Error> {
        foresee::<F>(ahead, setup, selection)
    }

    fn pilot(&self, setup: &Setup, selection: &Selection, values: &[f64]) -> Box<dyn Pilot> {
        let setup = Setup { open: selection.open, ..*setup };
        pilot_of::<F>(&setup, &placed::<F>(selection, values))
    }

    fn corrector(&self, setup: &Setup, selection: &Selection, values: &[f64]) -> Corrector {
        let setup = Setup { open: selection.open, ..*setup };
        corrector_of::<F>(&setup, &placed::<F>(selection, values))
    }

    fn trace(
        &self,
        samples: &dyn Samples,
        setup: &Setup,
        selection: &Selection,
        about: &About,
        trace: &mut dyn Trace,
    ) -> Result<Traced, Error> {
        let setup = Setup { open: selection.open, ..*setup };
        let mut pass = boxed(|| Calibration::<F, Known>::with_prior(&setup, |_, _, sigma| sigma));
        pass.judge_as(about.gate);
        let mut traced = begun::<F, _>(&pass, selection);
        pass.begin_known(&placed::<F>(selection, about.values));
        trace.begin(&traced);
        let mut tracer = Tracer::<F, _>::new(selection, trace);
        each(samples, |sample| {
            let diverged = |diverged| Error::Diverged { filter: F::NAME.to_owned(), diverged };
            pass.step_observed(sample, &mut tracer).map(drop).map_err(diverged)
        })?;
        (traced.gate, traced.statistics) = (pass.gate(), *pass.statistics());
        Ok(traced)
    }
}

/// On the heap, by way of a stack frame that ends here: the matrices of all blocks at once fill a good part of a thread's stack, and
/// without full optimisation a frame keeps room for everything that was ever made in it.
#[inline(never)]
pub(crate) fn boxed<T>(make: impl FnOnce() -> T) -> Box<T> {
    Box::new(make())
}

/// What a traced pass of a calibration begins with.
pub(crate) fn begun<F: Filter<Dynamics = Strapdown>, C: sinscal::Form>(
    calibration: &Calibration<F, C>,
    selection: &Selection,
) -> Traced {
    let covariance = calibration.covariance();
    let mut relaxing = Vec::new();
    relaxations::<F, f64>(|state, _| {
        relaxing.extend(selection.place(state).map(|place| (place, calibration.relaxing()[state])));
    });
    Traced {
        gate: calibration.gate(),
        statistics: *calibration.statistics(),
        start: core::array::from_fn(|i| covariance[i][i].sqrt()),
        relaxing,
        channels: Channels::of(F::MEASURES).names,
    }
}

/// Values of the parameters that take part, as states of the compiled filter.
pub(crate) fn placed<F: Filter>(selection: &Selection, values: &[f64]) -> calib_core::Vector<F, f64> {
    let mut states = F::Shape::vector(0.0);
    for (state, value) in selection.states.iter().zip(values) {
        states.as_mut_slice()[*state] = *value;
    }
    states
}
