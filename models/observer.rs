//! Watching a calibration run.

use calib_core::{CoreVector, Filter, Form, Kalman, Residuals, Transition, Vector};

use crate::strapdown::NavigationState;
use crate::{Point, Signals, Strapdown};

/// Is told what a [`Calibration`](crate::Calibration) does, step by step: for smoothing, for pricing effects, for figures.
///
/// Every method does nothing by default.
pub trait Observer<F: Filter<Dynamics = Strapdown>> {
    /// State and covariance have moved over `transition`; `density` is the white noise on the leading states.
    fn predicted(&mut self, transition: &Transition<F, f64>, density: &CoreVector<F, f64>) {
        let _ = (transition, density);
    }

    /// The filter as it is after a prediction, before anything is fed back.
    fn moved<C: Form>(&mut self, kalman: &Kalman<F, f64, C>) {
        let _ = kalman;
    }

    /// The residuals at the sample of `time`, formed at `at` under `signals`, are about to be used.
    fn measured(
        &mut self,
        time: f64,
        at: &Point<f64>,
        signals: &Signals<f64>,
        residuals: &Residuals<F, f64>,
    ) {
        let _ = (time, at, signals, residuals);
    }

    /// A reading of a channel group was left out.
    fn refused(&mut self, time: f64, group: &'static str, why: Refusal) {
        let _ = (time, group, why);
    }

    /// `variances` were added to those of the leading states: a reference that had been refused for long begins anew.
    fn widened(&mut self, variances: &CoreVector<F, f64>) {
        let _ = variances;
    }

    /// `correction` was taken out of the state vector and put into navigation solution and parameters.
    fn fed_back(&mut self, correction: &Vector<F, f64>) {
        let _ = correction;
    }

    /// An update is complete, its result fed back.
    fn updated(&mut self, update: &Updated<'_, F>) {
        let _ = update;
    }
}

/// Nobody watches.
impl<F: Filter<Dynamics = Strapdown>> Observer<F> for () {}

/// Watches where there is somebody.
impl<F: Filter<Dynamics = Strapdown>, O: Observer<F>> Observer<F> for Option<O> {
    fn predicted(&mut self, transition: &Transition<F, f64>, density: &CoreVector<F, f64>) {
        self.iter_mut().for_each(|observer| observer.predicted(transition, density));
    }

    fn moved<C: Form>(&mut self, kalman: &Kalman<F, f64, C>) {
        self.iter_mut().for_each(|observer| observer.moved(kalman));
    }

    fn measured(
        &mut self,
        time: f64,
        at: &Point<f64>,
        signals: &Signals<f64>,
        residuals: &Residuals<F, f64>,
    ) {
        self.iter_mut().for_each(|observer| observer.measured(time, at, signals, residuals));
    }

    fn refused(&mut self, time: f64, group: &'static str, why: Refusal) {
        self.iter_mut().for_each(|observer| observer.refused(time, group, why));
    }

    fn widened(&mut self, variances: &CoreVector<F, f64>) {
        self.iter_mut().for_each(|observer| observer.widened(variances));
    }

    fn fed_back(&mut self, correction: &Vector<F, f64>) {
        self.iter_mut().for_each(|observer| observer.fed_back(correction));
    }

    fn updated(&mut self, update: &Updated<'_, F>) {
        self.iter_mut().for_each(|observer| observer.updated(update));
    }
}

/// Both watch.
impl<F: Filter<Dynamics = Strapdown>, A: Observer<F>, B: Observer<F>> Observer<F> for (A, B) {
    fn predicted(&mut self, transition: &Transition<F, f64>, density: &CoreVector<F, f64>) {
        self.0.predicted(transition, density);
        self.1.predicted(transition, density);
    }

    fn moved<C: Form>(&mut self, kalman: &Kalman<F, f64, C>) {
        self.0.moved(kalman);
        self.1.moved(kalman);
    }

    fn measured(
        &mut self,
        time: f64,
        at: &Point<f64>,
        signals: &Signals<f64>,
        residuals: &Residuals<F, f64>,
    ) {
        self.0.measured(time, at, signals, residuals);
        self.1.measured(time, at, signals, residuals);
    }

    fn refused(&mut self, time: f64, group: &'static str, why: Refusal) {
        self.0.refused(time, group, why);
        self.1.refused(time, group, why);
    }

    fn widened(&mut self, variances: &CoreVector<F, f64>) {
        self.0.widened(variances);
        self.1.widened(variances);
    }

    fn fed_back(&mut self, correction: &Vector<F, f64>) {
        self.0.fed_back(correction);
        self.1.fed_back(correction);
    }

    fn updated(&mut self, update: &Updated<'_, F>) {
        self.0.updated(update);
        self.1.updated(update);
    }
}

/// Why a reading was left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// Its innovation is far beyond those before it.
    Outlier,
    /// It repeats the reading before to the bit, where readings used to differ.
    Repeated,
}

/// A complete update.
pub struct Updated<'a, F: Filter> {
    /// Time of the sample, s.
    pub time: f64,
    /// What the update added to the state vector, before feedback.
    pub change: &'a Vector<F, f64>,
    /// The navigation solution after feedback.
    pub navigation: &'a NavigationState<f64>,
}
