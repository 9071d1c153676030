//! A declared filter, whatever its sizes.

use core::marker::PhantomData;

use calib_core::{Dynamics, Filter};
use sinscal::navigation::{Pilot, parameters_of, pilot_of};
use sinscal::{FilterInfo, Setup, StateInfo, Strapdown};

use crate::Error;
use crate::observe::{Analysis, look};
use crate::running::{Options, Running, start};
use crate::samples::Samples;

/// What every declared filter can do, without its type: what commands, campaigns and diagnoses are written for.
pub trait AnyFilter: Send + Sync {
    /// What its declaration says.
    fn info(&self) -> &FilterInfo;

    /// Starts it; samples are handed over pass by pass.
    fn start(&self, setup: &Setup, options: &Options) -> Box<dyn Running>;

    /// Looks at a log with its eyes.
    ///
    /// # Errors
    /// When the log cannot be read.
    fn observe(&self, samples: &dyn Samples, setup: &Setup) -> Result<Analysis, Error>;

    /// A pilot with known parameters, by name as in [`parameters_of`].
    fn pilot(&self, setup: &Setup, value: &mut dyn FnMut(&StateInfo) -> Option<f64>) -> Box<dyn Pilot>;

    /// Name on the command line.
    fn name(&self) -> &'static str {
        self.info().name
    }

    /// What people call it: its name, and what was added to it.
    fn title(&self) -> String {
        self.name().to_owned()
    }

    /// Passes over a log that a unit of its class needs.
    fn passes(&self) -> u32 {
        self.info().passes
    }

    /// Names of the measurements, in order.
    fn measures(&self) -> Vec<&'static str> {
        self.info().measures().collect()
    }

    /// The states in order.
    fn states(&self) -> Vec<StateInfo> {
        let mut states = Vec::new();
        self.info().describe(&mut |state| states.push(state));
        states
    }

    /// The states after those of the navigation, in order.
    fn parameters(&self) -> Vec<StateInfo> {
        self.states().split_off(<Strapdown as Dynamics>::CORE)
    }
}

/// The declared filter `F`.
pub struct Declared<F> {
    info: FilterInfo,
    of: PhantomData<fn() -> F>,
}

impl<F: Filter<Dynamics = Strapdown>> Declared<F> {
    /// `F` with the number of passes that its class of units needs, and what it holds in a few words.
    pub const fn new(passes: u32, about: &'static str) -> Self {
        Self { info: FilterInfo::of::<F>(passes, about), of: PhantomData }
    }
}

impl<F: Filter<Dynamics = Strapdown>> AnyFilter for Declared<F> {
    fn info(&self) -> &FilterInfo {
        &self.info
    }

    fn start(&self, setup: &Setup, options: &Options) -> Box<dyn Running> {
        start::<F>(self.title(), setup, options)
    }

    fn observe(&self, samples: &dyn Samples, setup: &Setup) -> Result<Analysis, Error> {
        look::<F>(samples, setup)
    }

    fn pilot(&self, setup: &Setup, value: &mut dyn FnMut(&StateInfo) -> Option<f64>) -> Box<dyn Pilot> {
        pilot_of::<F>(setup, &parameters_of::<F>(setup, value))
    }
}
