//! What came of a run, and what to think of it.

use nalgebra::{UnitQuaternion, Vector3};
use sinscal::{ChannelInnovations, Gate, Parameter, Smoothed, Statistics};

use crate::history::History;
use crate::navigate::Values;
use crate::refusals::Stretch;

/// NIS per degree of freedom of a filter whose model and noise agree with the data: 1, give or take what a few per cent
/// of unmodelled noise make of it.
const FITS: (f64, f64) = (0.8, 1.2);
/// Fewer updates than this say nothing of the fit.
const FEWEST: usize = 10;

/// What came of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// What people call the filter.
    pub filter: String,
    /// Its number of states.
    pub states: usize,
    /// Samples read.
    pub samples: u64,
    /// Time of the start of the first interval, s.
    pub start: f64,
    /// From there to the end of the last interval, s.
    pub duration: f64,
    /// The parameters, SI.
    pub parameters: Vec<Parameter>,
    /// Their covariance, SI.
    pub covariance: Vec<Vec<f64>>,
    /// How they came about in the last pass.
    pub history: History,
    /// Sums over the updates of the last pass.
    pub statistics: Statistics,
    /// How the readings of the reference were spread, by which another run over the log may judge them.
    pub gate: Gate,
    /// Attitude at the last sample, C_bn.
    pub attitude: UnitQuaternion<f64>,
    /// Position of the IMU from the site origin in n at the last sample, m.
    pub position: Vector3<f64>,
    /// Velocity over ground in n at the last sample, m/s.
    pub velocity: Vector3<f64>,
    /// Whether the log tells any dither.
    pub dithers: bool,
    /// What the last pass left out of the reference.
    pub refused: Vec<Stretch>,
    /// The smoothed navigation solution at each update, if it was asked for.
    pub smoothed: Option<Vec<Smoothed>>,
    /// The residuals of the last pass, if they were asked for.
    pub residuals: Option<Vec<ChannelInnovations>>,
}

/// Whether a filter explains a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Verdict {
    /// Its innovations are as large as it says.
    Fits,
    /// They are larger than its model allows.
    DoesNotFit,
    /// Most readings of one kind contradict it.
    Contradicted(&'static str),
    /// They are smaller than the noise of the description.
    Quiet,
    /// There are too few updates to judge.
    TooFew,
    /// The innovations are no numbers.
    Nothing,
}

impl Verdict {
    /// Whether the estimates may be believed with their sigmas.
    pub fn fits(self) -> bool {
        matches!(self, Self::Fits)
    }
}

impl core::fmt::Display for Verdict {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Contradicted(channel) => {
                return write!(f, "does not fit: most readings of {channel} contradict it");
            }
            Self::TooFew => "cannot be judged by so few updates",
            Self::DoesNotFit => "does not fit: the residuals are larger than its model allows",
            Self::Quiet => "fits, with residuals smaller than the noise of the description",
            Self::Nothing => "says nothing",
            Self::Fits => "fits",
        })
    }
}

impl Outcome {
    /// Whether the filter explains the log.
    pub fn verdict(&self) -> Verdict {
        let nis = self.statistics.nis_per_dof();
        if let Some(channel) = self.contradicted() {
            Verdict::Contradicted(channel)
        } else if self.statistics.updates < FEWEST {
            Verdict::TooFew
        } else if nis.is_nan() {
            Verdict::Nothing
        } else if nis > FITS.1 {
            Verdict::DoesNotFit
        } else if nis < FITS.0 {
            Verdict::Quiet
        } else {
            Verdict::Fits
        }
    }

    /// Share of the readings of the reference that were left out as far off.
    pub fn left_out(&self) -> f64 {
        let rejected = self.statistics.rejected as f64;
        // a reading is a vector
        rejected / (rejected + self.statistics.degrees_of_freedom as f64 / 3.0)
    }

    /// The kind of reading of which most were left out as far off: it is not they that are wrong.
    fn contradicted(&self) -> Option<&'static str> {
        let outliers = || self.refused.iter().filter(|stretch| stretch.why == "outlier");
        outliers().map(|stretch| stretch.channel).find(|channel| {
            let refused: u64 =
                outliers().filter(|other| other.channel == *channel).map(|other| other.readings).sum();
            2 * refused > self.statistics.updates as u64
        })
    }

    /// What was estimated, by name: what [`navigate`](crate::navigate) takes. Without a value what the data do not show.
    pub fn estimates(&self) -> Values {
        self.named(|parameter| parameter.estimated.then_some(parameter.value))
    }

    /// The value of every parameter by name, also of those that the data say less about than the prior.
    pub fn values(&self) -> Values {
        self.named(|parameter| Some(parameter.value))
    }

    fn named(&self, value: impl Fn(&Parameter) -> Option<f64>) -> Values {
        let named = |parameter: &Parameter| {
            (parameter.info.block.to_owned(), parameter.info.component.to_owned(), value(parameter))
        };
        self.parameters.iter().map(named).collect()
    }

    /// When a parameter's sigma came within twice the final one for good, s after the start of the log.
    pub fn converged(&self, parameter: usize) -> Option<f64> {
        self.history.converged(parameter, self.start)
    }
}
