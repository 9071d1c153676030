//! The class of a unit: what a description leaves open of its noise and its priors.

use std::str::FromStr;

use sinscal::SensorNoise;

use super::units::{DEG_PER_SQRT_HOUR, DEGREE, MICRO_G};

/// A prior standard deviation: the effect, SI, and as people write it.
pub(super) type Prior = (&'static str, f64, &'static str);

/// The class of a unit, as `[imu] grade` names it. The figures are round ones of what such units do before a calibration, as the classes
/// are told apart by Groves, *Principles of GNSS, Inertial, and Multisensor Integrated Navigation Systems* (2013), section 4.1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grade {
    /// Ring laser gyros and servo accelerometers of navigation class: the priors of the blocks.
    RingLaser,
    /// Fibre-optic gyros.
    FibreOptic,
    /// Tactical class.
    Tactical,
    /// Micromechanical, consumer or industrial class.
    Mems,
}

const NAMES: [(&str, Grade); 4] = [
    ("ring-laser", Grade::RingLaser),
    ("fibre-optic", Grade::FibreOptic),
    ("tactical", Grade::Tactical),
    ("mems", Grade::Mems),
];

const FIBRE_OPTIC: [Prior; 6] = [
    ("gyro-bias", 10.0 * DEGREE / 3600.0, "10 deg/h"),
    ("gyro-scale", 2e-3, "2000 ppm"),
    ("gyro-misalignment", 0.3 * DEGREE, "0.3 deg"),
    ("accel-bias", 5e3 * MICRO_G, "5 mg"),
    ("accel-scale", 3e-3, "3000 ppm"),
    ("accel-misalignment", 0.3 * DEGREE, "0.3 deg"),
];
const TACTICAL: [Prior; 6] = [
    ("gyro-bias", 100.0 * DEGREE / 3600.0, "100 deg/h"),
    ("gyro-scale", 5e-3, "5000 ppm"),
    ("gyro-misalignment", 0.5 * DEGREE, "0.5 deg"),
    ("accel-bias", 20e3 * MICRO_G, "20 mg"),
    ("accel-scale", 1e-2, "1 %"),
    ("accel-misalignment", 0.5 * DEGREE, "0.5 deg"),
];
const MEMS: [Prior; 6] = [
    ("gyro-bias", 2.0 * DEGREE, "2 deg/s"),
    ("gyro-scale", 0.03, "3 %"),
    ("gyro-misalignment", 2.0 * DEGREE, "2 deg"),
    ("accel-bias", 60e3 * MICRO_G, "60 mg"),
    ("accel-scale", 0.03, "3 %"),
    ("accel-misalignment", 2.0 * DEGREE, "2 deg"),
];

impl Grade {
    /// Name in descriptions.
    pub fn name(self) -> &'static str {
        NAMES.iter().find(|(_, grade)| *grade == self).map_or("", |(name, _)| name)
    }

    /// Priors that are wider than those of the blocks.
    pub(super) fn priors(self) -> &'static [Prior] {
        match self {
            Self::RingLaser => &[],
            Self::FibreOptic => &FIBRE_OPTIC,
            Self::Tactical => &TACTICAL,
            Self::Mems => &MEMS,
        }
    }

    /// Uncertainties of the chain of measurement that are larger than the defaults of the effects: the clock of a unit without a reference
    /// oscillator is a crystal, and a thermometer on the chip of a sensor is good to some kelvins.
    pub(super) fn influences(self) -> &'static [(&'static str, f64)] {
        match self {
            Self::RingLaser | Self::FibreOptic => &[],
            Self::Tactical => &[("clock-scale", 20e-6)],
            Self::Mems => &[("clock-scale", 50e-6), ("thermometer-scale", 0.02), ("thermometer-offset", 2.0)],
        }
    }

    /// Random walks, where neither the description nor the rests say them.
    pub(super) fn noise(self) -> SensorNoise {
        let (gyro, accel) = match self {
            Self::RingLaser => (0.001, 5.0),
            Self::FibreOptic => (0.01, 20.0),
            Self::Tactical => (0.1, 100.0),
            Self::Mems => (0.3, 150.0),
        };
        SensorNoise { angle_random_walk: gyro * DEG_PER_SQRT_HOUR, velocity_random_walk: accel * MICRO_G }
    }
}

impl FromStr for Grade {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let named = NAMES.iter().find(|(name, _)| *name == text).map(|(_, grade)| *grade);
        named.ok_or_else(|| format!("`{text}` is none of {}", NAMES.map(|(name, _)| name).join(", ")))
    }
}
