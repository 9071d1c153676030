//! A run along a motion that is known beforehand: no samples and no residuals, the covariance alone.

use calib_core::{Array, Dynamics, Filter, Form, Residuals, Shape};
use nalgebra::ComplexField;

use super::Calibration;
use crate::outcome::Diverged;
use crate::{Point, Reference, Signals, Strapdown};

impl<F: Filter<Dynamics = Strapdown>, C: Form> Calibration<F, C> {
    /// Moves the covariance through `dt` seconds of a motion, with `at` and `signals` in their middle: short enough that the body turns
    /// by some 15 deg and the leading dynamics move to second order.
    pub fn foresee(&mut self, at: &Point<f64>, signals: &Signals<f64>, dt: f64) {
        let (at, signals) = self.seen_beforehand(at, signals);
        self.transition.absorb(&at, &signals, dt);
        self.transition.advance(&at, dt);
    }

    /// Updates the covariance by `readings` readings that will be taken about here, each as good as one of those that `reference` has;
    /// what they will say does not matter. What the increments will have missed is opened before.
    ///
    /// # Errors
    /// When the covariance is no longer one.
    pub fn foresee_readings(
        &mut self,
        time: f64,
        at: &Point<f64>,
        signals: &Signals<f64>,
        reference: &Reference,
        readings: f64,
    ) -> Result<(), Diverged> {
        let (at, signals) = self.seen_beforehand(at, signals);
        // a rate is read as the mean since the reading before
        self.turned.time = self.transition.elapsed() / readings;
        self.predict(&mut ());
        self.missed = reference.missed;
        self.open_missed(&mut ());
        let there = self.residuals(reference, &at);
        let mut residuals = Residuals::default();
        for row in (0..F::Shape::ROWS).filter(|row| there.is_present(*row)) {
            let variance = there.variances().as_slice()[row];
            residuals.set(row, 0.0, ComplexField::sqrt(variance / readings));
        }
        let found = self.kalman.update(&at, &signals, residuals, None);
        found.map_err(|_| Diverged { time, channel: "the reference" })?;
        Ok(())
    }

    /// Moves the covariance to the end of what was foreseen.
    pub fn foresee_end(&mut self) {
        self.predict(&mut ());
    }

    /// The same with what this filter knows and does not know of.
    fn seen_beforehand(&self, at: &Point<f64>, signals: &Signals<f64>) -> (Point<f64>, Signals<f64>) {
        let open = self.setup.open;
        let mut signals = Signals { open, ..*signals };
        if !open.couples_dither() {
            signals.coupled_dither.fill(0.0);
        }
        Strapdown::restrict::<F, f64>(&mut signals);
        (Point { open, ..*at }, signals)
    }
}
