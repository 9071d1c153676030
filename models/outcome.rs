//! What a calibration run says: of each update, of the whole, and of the parameters.

use crate::StateInfo;

/// One calibrated parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Name, component and units.
    pub info: StateInfo,
    /// Estimate, SI.
    pub value: f64,
    /// Standard deviation, SI.
    pub sigma: f64,
    /// Prior standard deviation, SI.
    pub prior_sigma: f64,
    /// Whether the data say at least as much as the prior.
    pub estimated: bool,
}

/// What a measurement update found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Update {
    /// Time of the sample, s.
    pub time: f64,
    /// Normalised innovation squared.
    pub nis: f64,
    /// Scalar measurements used.
    pub degrees_of_freedom: usize,
    /// Measurements that the gate refused, as bits in the order of the declaration.
    pub rejected: u32,
}

/// Sums over the updates of one pass.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Updates made.
    pub updates: usize,
    /// Scalar measurements used.
    pub degrees_of_freedom: usize,
    /// Sum of the normalised innovations squared.
    pub nis: f64,
    /// Gaussian log-likelihood of the innovations.
    pub log_likelihood: f64,
    /// Readings that the gate refused.
    pub rejected: usize,
    /// Readings that repeated the one before to the bit, where readings used to differ: no news.
    pub repeated: usize,
    /// Times at which a reference that had been refused for long was taken to begin anew.
    pub reopened: usize,
    /// Largest angle that the unit turned by from one sample to the next, rad.
    pub largest_turn: f64,
}

impl Statistics {
    /// Mean normalised innovation squared per scalar measurement; 1 when prediction and data agree.
    pub fn nis_per_dof(&self) -> f64 {
        self.nis / self.degrees_of_freedom as f64
    }
}

/// The filter stopped making sense.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diverged {
    /// Time of the sample, s.
    pub time: f64,
    /// What was measured then: the first measurement whose innovations are no numbers any more, or whose covariance is not positive definite
    /// any more; `the reference` where only all together show it.
    pub channel: &'static str,
}

impl core::fmt::Display for Diverged {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(
            f,
            "the filter diverged at {:.2} s, when {} was measured: its innovations are no longer finite, or their \
             covariance no longer positive definite. The increments, the reference and the initial attitude contradict each \
             other beyond all sigmas",
            self.time, self.channel
        )
    }
}

impl core::error::Error for Diverged {}
