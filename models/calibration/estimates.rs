//! What a run has found, at any time.

use calib_core::{Filter, Form, Matrix, Relaxation, Shape, Vector};
use nalgebra::{ComplexField, UnitQuaternion, Vector3};

use super::Calibration;
use crate::Strapdown;
use crate::outcome::{Parameter, Statistics};
use crate::strapdown::NavigationState;

/// A parameter counts as estimated when the data say at least as much about it as its prior, that is when its standard
/// deviation fell below this fraction (1/sqrt 2) of the prior's.
const ESTIMATED: f64 = core::f64::consts::FRAC_1_SQRT_2;

impl<F: Filter<Dynamics = Strapdown>, C: Form> Calibration<F, C> {
    /// Visits the parameters in the order of the declaration; those of blocks that joined at run time by their own names.
    pub fn parameters(&self, visit: &mut dyn FnMut(Parameter)) {
        let mut i = 0;
        self.setup.open.states_of::<F>(&mut |info| {
            if i >= F::Shape::CORE {
                let sigma = self.kalman.sigma(i);
                let prior_sigma = self.prior_now(i);
                let estimated = sigma < ESTIMATED * prior_sigma;
                visit(Parameter { info, value: self.value(i), sigma, prior_sigma, estimated });
            }
            i += 1;
        });
    }

    /// Standard deviation that parameter `i` would have without any measurement: a random walk has gathered more by now.
    fn prior_now(&self, i: usize) -> f64 {
        let (prior, Relaxation { rate, density }) = (self.prior[i], self.relaxing[i]);
        if rate > 0.0 || density == 0.0 {
            prior
        } else {
            ComplexField::sqrt(prior * prior + density * self.covered)
        }
    }

    /// Estimate of state `i` as people know it: the outer lever arm includes its first guess.
    fn value(&self, i: usize) -> f64 {
        let guess = match self.lever_at {
            Some(at) if (at..at + 3).contains(&i) => self.setup.outer_lever[i - at],
            _ => 0.0,
        };
        guess + self.parameters[i] + self.kalman.x()[i]
    }

    /// Parameter estimates by state; the leading states are zero. What [`Compensator::compensate`](crate::Compensator::compensate) takes.
    pub fn estimate(&self) -> Vector<F, f64> {
        let mut estimate = self.parameters.clone();
        for i in F::Shape::CORE..F::Shape::STATES {
            estimate[i] += self.kalman.x()[i];
        }
        estimate
    }

    /// Covariance of the navigation errors and of the parameters.
    pub fn covariance(&self) -> Matrix<F, f64> {
        self.kalman.covariance()
    }

    /// The navigation solution at the last sample, with all that the filter knows.
    pub fn navigation(&self) -> NavigationState<f64> {
        let x = self.kalman.x();
        let part = |first: usize| Vector3::new(x[first], x[first + 1], x[first + 2]);
        let mut navigation = self.navigation;
        navigation.correct(&part(0), &part(3), &part(6));
        navigation
    }

    /// Position of the IMU from the site origin in n at the last sample, m.
    pub fn position(&self) -> Vector3<f64> {
        self.navigation().position(&self.setup.site)
    }

    /// Attitude at the last sample.
    pub fn attitude(&self) -> UnitQuaternion<f64> {
        self.navigation().attitude
    }

    /// Sums over the updates of this pass.
    pub fn statistics(&self) -> &Statistics {
        &self.statistics
    }
}
