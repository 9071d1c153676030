//! What came of a run, and what to think of it.

use nalgebra::{UnitQuaternion, Vector3};
use serde::Serialize;
use sinscal::{
    ChannelInnovations, Gate, InitialAttitude, Parameter, SiteFault, SiteShown, Smoothed, Statistics,
};

use crate::budget::Budget;
use crate::history::History;
use crate::look::Look;
use crate::navigate::Values;
use crate::refusals::Stretch;
use crate::repeat::Repeat;

/// NIS per degree of freedom of a filter whose model and noise agree with the data: 1, give or take what a few per cent
/// of unmodelled noise make of it.
const FITS: (f64, f64) = (0.8, 1.2);
/// So many standard deviations of the prior from its mean nothing lies: the prior is wrong, or the log is.
const BEYOND: f64 = 5.0;
/// Passes agree whose results differ by less than this, in standard deviations; the stated sigmas contain the difference.
const AGREE: f64 = 3.0;
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
    /// By how many prior standard deviations each departs from what was believed before the run, a first guess or a coarse calibration
    /// included.
    pub departures: Vec<f64>,
    /// Values of their states, SI: without a first guess or what a coarse calibration took out of the samples.
    pub state_values: Vec<f64>,
    /// Attitude at the first sample that the last pass began with.
    pub begun: InitialAttitude,
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
    /// What the samples say by themselves.
    pub look: Look,
    /// What rests in several positions show of the site, where sigmas were asked to be relied on and the gyros feel the Earth.
    pub site: Option<SiteShown>,
    /// What that contradicts.
    pub site_fault: Option<SiteFault>,
    /// Whether the log tells any dither.
    pub dithers: bool,
    /// What the last pass left out of the reference.
    pub refused: Vec<Stretch>,
    /// The smoothed navigation solution at each update, if it was asked for.
    pub smoothed: Option<Vec<Smoothed>>,
    /// The residuals of the last pass, if they were asked for.
    pub residuals: Option<Vec<ChannelInnovations>>,
    /// The passes, and the shortened steps where a pass made it worse; empty where nobody asked whether passes agree.
    pub passes: Vec<Pass>,
    /// By how many standard deviations another pass would move what moves most, where that was asked.
    pub moved: Option<f64>,
    /// How far the sigmas repeat within the log, where that was asked.
    pub repeat: Option<Repeat>,
    /// What the sigmas are made of, where something is considered.
    pub budget: Vec<Budget>,
}

/// A pass over a log.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Pass {
    /// Logarithm of the posterior of what it found, up to a constant; nothing where that was not asked, or is beyond what a filter bears.
    pub log_posterior: Option<f64>,
    /// Whether what it found was kept.
    pub kept: bool,
}

/// Whether a filter explains a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Verdict {
    /// Its innovations are as large as it says.
    Fits,
    /// They are larger than its model allows.
    DoesNotFit,
    /// A further pass over the log finds something else: what was found rests on where the filter was linearised.
    PassesDisagree,
    /// A parameter departs further from what was believed before than can be believed.
    BeyondPrior(&'static str),
    /// Most readings of one kind contradict it.
    Contradicted(&'static str),
    /// The unit's rests contradict the site or the units of the log, whatever the filter makes of it.
    Site(SiteFault),
    /// It moves the unit where that is taken to stand still: at a fixed point, or in a rest.
    Elsewhere,
    /// The reference is a fixed point or the rests of the unit, which have no noise: a sound filter's innovations are a small part of what is stated, and what a
    /// filter lacks must be many times larger than the noise before they reach it.
    FixedPoint,
    /// The innovations are smaller than the noise of the description; the same holds.
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

    /// Whether the log says that they may not.
    pub fn contradicts(self) -> bool {
        matches!(
            self,
            Self::DoesNotFit
                | Self::PassesDisagree
                | Self::BeyondPrior(_)
                | Self::Contradicted(_)
                | Self::Site(_)
                | Self::Elsewhere
        )
    }

    /// The verdict in one word, as files have it: a log either speaks for a filter, or against it, or has no power to judge.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fits => "fits",
            Self::PassesDisagree => "passes-disagree",
            Self::DoesNotFit
            | Self::BeyondPrior(_)
            | Self::Contradicted(_)
            | Self::Site(_)
            | Self::Elsewhere => "does-not-fit",
            Self::FixedPoint | Self::Quiet | Self::TooFew | Self::Nothing => "no-power",
        }
    }
}

/// What a verdict is judged by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evidence {
    /// Updates by the reference.
    pub updates: usize,
    /// Mean normalised innovation squared per scalar measurement.
    pub nis_per_dof: f64,
    /// Groups of readings that were left out as far off.
    pub rejected: usize,
    /// The kind of reading of which most were.
    pub contradicted: Option<&'static str>,
    /// Whether the reference is a point that never moves, which nobody has read.
    pub fixed_point: bool,
    /// By how many standard deviations another pass would move what moves most, where that was asked.
    pub moved: Option<f64>,
    /// The block of which a parameter lies further from its prior than can be believed.
    pub beyond: Option<&'static str>,
    /// What the rests of the unit contradict.
    pub site: Option<SiteFault>,
}

/// The verdict on a run.
///
/// The normalised innovations judge a filter only where they can be as large as stated: with readings of a reference whose noise is
/// stated right they are 1 on average, and grow with what the filter lacks. Below that they have no power either way.
pub fn judge(evidence: &Evidence) -> Verdict {
    let Evidence { updates, nis_per_dof, rejected, contradicted, fixed_point, moved, beyond, site } =
        *evidence;
    if let Some(fault) = site {
        Verdict::Site(fault)
    } else if fixed_point && (rejected > 0 || contradicted.is_some()) {
        Verdict::Elsewhere
    } else if let Some(channel) = contradicted {
        Verdict::Contradicted(channel)
    } else if nis_per_dof.is_nan() {
        Verdict::Nothing
    } else if moved.is_some_and(|moved| !(moved < AGREE)) {
        Verdict::PassesDisagree
    } else if updates < FEWEST {
        Verdict::TooFew
    } else if nis_per_dof > FITS.1 {
        Verdict::DoesNotFit
    } else if let Some(block) = beyond {
        Verdict::BeyondPrior(block)
    } else if fixed_point {
        Verdict::FixedPoint
    } else if nis_per_dof < FITS.0 {
        Verdict::Quiet
    } else {
        Verdict::Fits
    }
}

impl core::fmt::Display for Verdict {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Contradicted(channel) => {
                return write!(f, "does not fit: most readings of {channel} contradict it");
            }
            Self::Site(SiteFault::Latitude) => "does not fit: the rests of the unit show another latitude",
            Self::Site(SiteFault::Gravity) => "does not fit: the rests of the unit show another gravity",
            Self::Site(_) => "does not fit: the rests of the unit show another rate of the Earth",
            Self::TooFew => "cannot be judged by so few updates",
            Self::BeyondPrior(block) => {
                return write!(f, "does not fit: {block} lies beyond {BEYOND:.0} sigmas of its prior");
            }
            Self::PassesDisagree => "cannot be believed: a further pass over the log finds something else",
            Self::DoesNotFit => "does not fit: the residuals are larger than its model allows",
            Self::Elsewhere => "does not fit: it moves the unit where that is taken to stand still",
            Self::FixedPoint => {
                "cannot be judged by its residuals: what is taken to stand still has no noise to compare them with"
            }
            Self::Quiet => {
                "cannot be judged by its residuals: they are smaller than the noise of the description"
            }
            Self::Nothing => "says nothing",
            Self::Fits => "fits",
        })
    }
}

impl Outcome {
    /// Whether the filter explains the log.
    pub fn verdict(&self) -> Verdict {
        judge(&Evidence {
            updates: self.statistics.updates,
            nis_per_dof: self.statistics.nis_per_dof(),
            rejected: self.statistics.rejected,
            contradicted: self.contradicted(),
            fixed_point: self.look.is_fixed_point(),
            moved: self.moved,
            beyond: self.beyond(),
            site: self.site_fault,
        })
    }

    /// The block of the first parameter that lies further from its prior than can be believed.
    fn beyond(&self) -> Option<&'static str> {
        let departed = self.parameters.iter().zip(&self.departures);
        let mut departed = departed.filter(|(parameter, by)| parameter.estimated && by.abs() > BEYOND);
        departed.next().map(|(parameter, _)| parameter.info.block)
    }

    /// What was believed of a parameter before the run, SI: a first guess or a coarse calibration, or zero.
    pub(crate) fn prior_mean(&self, parameter: usize) -> f64 {
        let Parameter { value, prior_sigma, .. } = &self.parameters[parameter];
        value - self.departures[parameter] * prior_sigma
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

    /// Between which values a parameter went that changes in the course of a run, as the bias of a sensor does that wanders: from when it
    /// converged, in the estimates of the last pass. `changes` says which blocks do.
    pub fn range(&self, parameter: usize, changes: impl Fn(&str) -> bool) -> Option<(f64, f64)> {
        let known = &self.parameters[parameter];
        let wanted = known.estimated && changes(known.info.block);
        self.history.range(parameter, self.start).filter(|_| wanted)
    }

    /// When a parameter's sigma came within twice the final one for good, s after the start of the log.
    pub fn converged(&self, parameter: usize) -> Option<f64> {
        self.history.converged(parameter, self.start)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOUND: Evidence = Evidence {
        updates: 1000,
        nis_per_dof: 1.0,
        rejected: 0,
        contradicted: None,
        fixed_point: false,
        moved: Some(0.1),
        beyond: None,
        site: None,
    };

    #[test]
    fn readings_speak_for_a_filter_and_against_it() {
        for (nis_per_dof, name) in [
            (1.0, "fits"),
            (0.85, "fits"),
            (1.15, "fits"),
            (1.25, "does-not-fit"),
            (0.5, "no-power"),
            (f64::NAN, "no-power"),
        ] {
            assert_eq!(judge(&Evidence { nis_per_dof, ..SOUND }).name(), name, "{nis_per_dof}");
        }
        // a few outliers of 1000 readings are those of the reference
        assert_eq!(judge(&Evidence { rejected: 12, ..SOUND }), Verdict::Fits);
        let most = judge(&Evidence { contradicted: Some("velocity"), ..SOUND });
        assert!(most.contradicts() && most.to_string().contains("most readings of velocity contradict it"));
        assert_eq!(judge(&Evidence { updates: 9, ..SOUND }).name(), "no-power");
    }

    #[test]
    fn what_the_next_pass_moves_or_no_prior_allows_does_not_fit() {
        let moves = judge(&Evidence { moved: Some(3.1), ..SOUND });
        assert!(moves.contradicts() && moves.name() == "passes-disagree");
        assert_eq!(judge(&Evidence { moved: Some(f64::NAN), ..SOUND }), Verdict::PassesDisagree);
        assert_eq!(judge(&Evidence { moved: None, ..SOUND }), Verdict::Fits);
        let elsewhere = judge(&Evidence { site: Some(SiteFault::Latitude), ..SOUND });
        assert!(elsewhere.contradicts() && elsewhere.to_string().contains("another latitude"));
        let beyond = judge(&Evidence { beyond: Some("accel-scale"), ..SOUND });
        assert_eq!(beyond.to_string(), "does not fit: accel-scale lies beyond 5 sigmas of its prior");
        assert_eq!(beyond.name(), "does-not-fit");
    }

    #[test]
    fn a_fixed_point_never_speaks_for_a_filter() {
        let fixed = Evidence { fixed_point: true, ..SOUND };
        for nis_per_dof in [0.03, 0.5, 1.07, 1.19] {
            assert_eq!(judge(&Evidence { nis_per_dof, ..fixed }).name(), "no-power", "{nis_per_dof}");
        }
        assert_eq!(judge(&Evidence { nis_per_dof: 1.3, ..fixed }), Verdict::DoesNotFit);
        // it has no readings that could be outliers
        let elsewhere = judge(&Evidence { nis_per_dof: 0.2, rejected: 12, ..fixed });
        assert!(elsewhere == Verdict::Elsewhere && elsewhere.name() == "does-not-fit");
    }
}
