//! What is done with each unit.

use std::sync::Arc;

use rig::scenario::MotionPlan;
use rig::{Scenario, ScenarioError};
use runs::AnyFilter;

/// Table 2 of the paper: the defaults of a swing of the rig, level, x east at rest.
const SWING: &str = "[motion]\npath = \"swing\"\nstart = \"ENU\"";

/// An experiment.
#[derive(Clone)]
pub struct Plan {
    /// How units differ and how they are calibrated.
    pub scenario: Scenario,
    /// The filters that calibrate each unit.
    pub filters: Vec<Arc<dyn AnyFilter>>,
    /// Passes of a calibration.
    pub passes: u32,
    /// Free-inertial navigation after the calibration, h; none when zero.
    pub hours: f64,
    /// Alignment before it, s.
    pub alignment: f64,
    /// How the unit is moved meanwhile.
    pub motion: MotionPlan,
}

/// Why a unit could not be put through the experiment.
#[derive(Debug, thiserror::Error)]
pub enum Trouble {
    /// The scenario is not one that can be simulated.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// A filter came to no result.
    #[error("unit {unit}, {error}")]
    Run {
        /// The unit.
        unit: u64,
        /// Which filter, and why.
        error: runs::Error,
    },
}

impl Plan {
    /// The swing of the paper's table 2: 0.4, 0.3 and 0.4 Hz about x, y and z. The amplitudes are lost, 6 deg is a choice; so is a
    /// quarter period between x and z, without which nothing cones.
    ///
    /// # Errors
    /// Never, as long as the rig knows its own defaults.
    pub fn paper_swing() -> Result<MotionPlan, ScenarioError> {
        Ok(Scenario::parse(SWING)?.motion)
    }

    /// The scenario of the navigation after the calibration: the same unit on another day, with other noise and another phase
    /// of the dither, its centre a known fixed point.
    pub fn navigation(&self) -> Scenario {
        let mut scenario = self.scenario.clone();
        scenario.run += 1;
        scenario.motion = self.motion.clone();
        scenario.motion.duration = self.hours * 3600.0;
        scenario.reference.readings = false;
        scenario.reference.attitude = false;
        scenario
    }

    /// How long a unit is aligned before it navigates, s: no more than half of the time.
    pub(crate) fn aligning(&self) -> f64 {
        self.alignment.min(0.5 * self.hours * 3600.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn navigation_is_another_day_as_long_as_asked_for() -> Result<(), ScenarioError> {
        let motion = Plan::paper_swing()?;
        let scenario = Scenario::default();
        let plan = |alignment| Plan {
            scenario: scenario.clone(),
            filters: Vec::new(),
            passes: 1,
            hours: 2.0,
            alignment,
            motion: motion.clone(),
        };
        let navigation = plan(100.0).navigation();
        assert_eq!((navigation.motion.duration, navigation.run), (7200.0, scenario.run + 1));
        assert!(!navigation.reference.readings && !navigation.reference.attitude);
        assert_eq!((plan(100.0).aligning(), plan(1e6).aligning()), (100.0, 3600.0));
        Ok(())
    }
}
