//! Watching a calibration run.

use calib_core::{CoreVector, Filter, Form, Kalman, Residuals, Transition, Vector};

use crate::strapdown::NavigationState;
use crate::{Point, Signals, Strapdown};

/// Is told what a [`Calibration`](crate::Calibration) does, step by step: for smoothing, for pricing effects, for figures.
///
/// Two observers in a pair both watch; `()` does not.
pub trait Observer<F: Filter<Dynamics = Strapdown>> {
    /// Something has happened.
    fn observe<C: Form>(&mut self, event: Event<'_, F, C>);
}

/// What happens in a run, in this order.
pub enum Event<'a, F: Filter<Dynamics = Strapdown>, C: Form> {
    /// State and covariance have moved over an interval.
    Predicted {
        /// `[Phi Psi]` over the interval.
        transition: &'a Transition<F, f64>,
        /// White noise on the leading states, its spectral densities.
        density: &'a CoreVector<F, f64>,
    },
    /// The filter as it is after a prediction, before anything is fed back; once more after [`Widened`](Self::Widened).
    Moved(&'a Kalman<F, f64, C>),
    /// A reading of a measurement was left out.
    Refused {
        /// Time of the sample, s.
        time: f64,
        /// Name of the measurement, for instance `velocity`.
        group: &'static str,
        /// What is wrong with it.
        why: Refusal,
    },
    /// These were added to the variances of the leading states: a reference that had been refused for long begins anew, or one says
    /// that what the increments made of the velocity is forgotten.
    Widened(&'a CoreVector<F, f64>),
    /// Residuals are about to be used.
    Measured {
        /// Time of the sample, s.
        time: f64,
        /// Where they were formed.
        at: &'a Point<f64>,
        /// What the sensors said there.
        signals: &'a Signals<f64>,
        /// The residuals.
        residuals: &'a Residuals<F, f64>,
    },
    /// A correction was taken out of the state vector and put into navigation solution and parameters.
    FedBack(&'a Vector<F, f64>),
    /// An update is complete, its result fed back.
    Updated {
        /// Time of the sample, s.
        time: f64,
        /// What the update added to the state vector, before feedback.
        change: &'a Vector<F, f64>,
        /// The navigation solution after feedback.
        navigation: &'a NavigationState<f64>,
    },
}

impl<F: Filter<Dynamics = Strapdown>, C: Form> Clone for Event<'_, F, C> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<F: Filter<Dynamics = Strapdown>, C: Form> Copy for Event<'_, F, C> {}

/// Why a reading was left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// Its innovation is far beyond those before it.
    Outlier,
    /// It repeats the reading before to the bit, where readings used to differ.
    Repeated,
}

impl<F: Filter<Dynamics = Strapdown>> Observer<F> for () {
    fn observe<C: Form>(&mut self, _: Event<'_, F, C>) {}
}

/// Watches where there is somebody.
impl<F: Filter<Dynamics = Strapdown>, O: Observer<F>> Observer<F> for Option<O> {
    fn observe<C: Form>(&mut self, event: Event<'_, F, C>) {
        if let Some(observer) = self {
            observer.observe(event);
        }
    }
}

impl<F: Filter<Dynamics = Strapdown>, A: Observer<F>, B: Observer<F>> Observer<F> for (A, B) {
    fn observe<C: Form>(&mut self, event: Event<'_, F, C>) {
        self.0.observe(event);
        self.1.observe(event);
    }
}
