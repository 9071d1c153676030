//! What is done with each unit.

use rig::scenario::Path;
use rig::{Scenario, ScenarioError};

/// Amplitude of the swing about each axis, rad: the paper's are lost, 6 deg is a choice.
const AMPLITUDE: f64 = 6.0 * std::f64::consts::PI / 180.0;

/// An experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// How units differ and how they are calibrated.
    pub scenario: Scenario,
    /// Names of the filters that calibrate each unit.
    pub filters: Vec<String>,
    /// Passes of a calibration.
    pub passes: u32,
    /// Free-inertial navigation after the calibration, h; none when zero.
    pub hours: f64,
    /// Alignment before it, s.
    pub alignment: f64,
}

/// Why a unit could not be put through the experiment.
#[derive(Debug, thiserror::Error)]
pub enum Trouble {
    /// The scenario is not one that can be simulated.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// A filter has diverged.
    #[error("unit {unit}, {filter}: {error}")]
    Diverged {
        /// The unit.
        unit: u64,
        /// The filter.
        filter: String,
        /// When.
        error: sinscal::Diverged,
    },
    /// There is no such filter.
    #[error("there is no filter called {0}")]
    Filter(String),
}

impl Plan {
    /// The swing of the paper's table 2 after the calibration: the same unit on another day (other noise, another phase of
    /// the dither), about x, y and z with 0.4, 0.3 and 0.4 Hz, its centre a known fixed point.
    pub fn swing(&self) -> Scenario {
        let mut scenario = self.scenario.clone();
        scenario.run += 1;
        scenario.motion.path = Path::Swing {
            amplitude: [AMPLITUDE; 3].into(),
            frequency: [0.4, 0.3, 0.4].into(),
            phase: [0.0, 0.0, std::f64::consts::FRAC_PI_2].into(),
        };
        scenario.motion.start = nalgebra::UnitQuaternion::identity();
        scenario.motion.duration = self.hours * 3600.0;
        scenario.reference.readings = false;
        scenario.reference.attitude = false;
        scenario
    }
}
