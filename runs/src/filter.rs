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
    /// Name on the command line.
    fn name(&self) -> &'static str;

    /// What it holds, in a few words.
    fn about(&self) -> String;

    /// Passes over a log that a unit of its class needs.
    fn passes(&self) -> u32;

    /// Names of the measurements, in order.
    fn measures(&self) -> Vec<&'static str>;

    /// The states in order.
    fn states(&self) -> Vec<StateInfo>;

    /// Whether it takes the size effect of the dither from the places of the accelerometers: it then needs a log that tells the
    /// dither.
    fn needs_dither(&self) -> bool;

    /// Starts it; samples are handed over pass by pass.
    fn start(&self, setup: &Setup, options: &Options) -> Box<dyn Running>;

    /// Looks at a log with its eyes.
    ///
    /// # Errors
    /// When the log cannot be read.
    fn observe(&self, samples: &dyn Samples, setup: &Setup) -> Result<Analysis, Error>;

    /// A pilot with known parameters, by name as in [`parameters_of`].
    fn pilot(&self, setup: &Setup, value: &mut dyn FnMut(&StateInfo) -> Option<f64>) -> Box<dyn Pilot>;

    /// What people call it: its name, and what was added to it.
    fn title(&self) -> String {
        self.name().to_owned()
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
    fn name(&self) -> &'static str {
        F::NAME
    }

    fn about(&self) -> String {
        self.info.about.to_owned()
    }

    fn passes(&self) -> u32 {
        self.info.passes
    }

    fn measures(&self) -> Vec<&'static str> {
        self.info.measures().collect()
    }

    fn states(&self) -> Vec<StateInfo> {
        let mut states = Vec::with_capacity(F::DIM);
        F::states(&mut |state| states.push(state));
        states
    }

    fn needs_dither(&self) -> bool {
        self.info.needs_dither()
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
