//! The declared filters: five for a strapdown system with dithered ring laser gyros, two for MEMS units.
//!
//! The names of the first five count their states and say whether the dither coupling is in ("B") or not ("P"), as in
//! table 3 of Xing, Yang and Cai, *Sensors* 22(1):278, 2022 (DOI 10.3390/s22010278). Those of other authors stand in [`literature`].

pub mod literature;

use calib_core::{Block, Filter, MeasurementInfo, Sizes, StateInfo, declares};
use state_macro::StateBlocks;

use self::literature::{GnssIns15, PsinsCalibration, Systematic30, Systematic33};
use crate::Strapdown;
use crate::blocks::groups::*;
use crate::blocks::*;

/// 36 states: navigation 9, gyro 9, accelerometer 15, outer lever arm 3.
#[derive(Debug, StateBlocks)]
#[filter(name = "36d-p", measures(velocity, position))]
pub struct Sins36P {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    gyro: GyroErrors,
    accel: AccelErrors,
    outer_lever: OuterLeverArm,
}

/// 39 states: 36D-P and the inner lever arm of each accelerometer along its own axis.
#[derive(Debug, StateBlocks)]
#[filter(name = "39d-p", measures(velocity, position))]
pub struct Sins39P {
    #[base]
    sins: Sins36P,
    inner_lever: InnerLeverArm,
}

/// 40 states: 39D-P and the accelerometer delay.
#[derive(Debug, StateBlocks)]
#[filter(name = "40d-p", measures(velocity, position))]
pub struct Sins40P {
    #[base]
    sins: Sins39P,
    delay: AccelDelay,
}

/// 43 states: 40D-P and the temperature scale factor of each accelerometer.
#[derive(Debug, StateBlocks)]
#[filter(name = "43d-p", measures(velocity, position))]
pub struct Sins43P {
    #[base]
    sins: Sins40P,
    temperature: AccelTemperatureScale,
}

/// The states of 43D-P, with the gyros' dither acting through the inner lever arm.
#[derive(Debug, StateBlocks)]
#[filter(name = "43d-b", measures(velocity, position))]
pub struct Sins43B {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    gyro: GyroErrors,
    accel: AccelErrors,
    outer_lever: OuterLeverArm,
    inner_lever: InnerLeverArm,
    delay: AccelDelay,
    temperature: AccelTemperatureScale,
    dither: Dither,
}

/// 30 states for a unit carried by hand: navigation 9, gyro 9, accelerometer scale, installation and bias 12; its velocity
/// is known while it stands still, and so is its rate.
#[derive(Debug, StateBlocks)]
#[filter(name = "mems-30d", measures(velocity, rate))]
pub struct Mems30 {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    gyro: GyroErrors,
    accel: LinearAccelErrors,
}

/// 35 states for a unit seen by a motion-capture system: those of `mems-30d`, how the system's body frame is mounted on the
/// unit, and how its level is tilted.
#[derive(Debug, StateBlocks)]
#[filter(name = "tracked-35d", measures(position, attitude))]
pub struct Tracked35 {
    #[base]
    sins: Mems30,
    mounting: ReferenceMisalignment,
    tilt: ReferenceTilt,
}

/// What to do with a filter chosen by name at run time.
pub trait FilterVisitor {
    /// What comes of it.
    type Output;
    /// Called with the declared filter.
    fn visit<F: Filter<Dynamics = Strapdown, Shape: Sizes>>(self) -> Self::Output;
}

macro_rules! declared {
    (
        of the paper { $($paper:ty: $paper_passes:literal, $paper_about:literal;)+ }
        and { $($filter:ty: $passes:literal, $about:literal;)+ }
    ) => {
        /// Every filter that is named: those of the paper, for MEMS units, and of the literature.
        pub const FILTERS: &[FilterInfo] = &[
            $(FilterInfo::of::<$paper>($paper_passes, $paper_about),)+
            $(FilterInfo::of::<$filter>($passes, $about),)+
        ];

        /// Names of the filters of the paper, in the order of its table 3.
        pub const PAPER: &[&str] = &[$(<$paper as Block>::NAME),+];

        /// Calls `visitor` with the filter called `name`; `None` when there is none.
        pub fn visit_filter<V: FilterVisitor>(name: &str, visitor: V) -> Option<V::Output> {
            $(if name == <$paper as Block>::NAME {
                return Some(visitor.visit::<$paper>());
            })+
            $(if name == <$filter as Block>::NAME {
                return Some(visitor.visit::<$filter>());
            })+
            None
        }
    };
}

declared! {
    of the paper {
        Sins36P: 2, "gyro and accelerometer errors, outer lever arm";
        Sins39P: 2, "36d-p and inner lever arm";
        Sins40P: 2, "39d-p and accelerometer delay";
        Sins43P: 2, "40d-p and accelerometer temperature scale factor";
        Sins43B: 2, "43d-p with the dither coupling of the inner lever arm";
    } and {
        Mems30: 3, "a MEMS unit carried by hand, velocity and rate known when still";
        Tracked35: 3, "a MEMS unit tracked by position and attitude";
        Systematic30: 2, "of the literature: the 21 errors of scale, installation and bias from velocity alone";
        Systematic33: 2, "of the literature: systematic-30d and quadratic terms";
        PsinsCalibration: 2, "of the literature: what PSINS calibrates, all nine lever arms of the accelerometers";
        GnssIns15: 1, "of the literature: GNSS/INS with Gauss-Markov biases";
    }
}

/// A declared filter as people choose it.
#[derive(Clone, Copy, Debug)]
pub struct FilterInfo {
    /// Name on the command line.
    pub name: &'static str,
    /// Number of states.
    pub states: usize,
    /// What it holds, in a few words.
    pub about: &'static str,
    /// Passes over a log that a unit of its class needs. One leaves up to half a sigma in the scale factors of a good unit:
    /// until the first turn a tilt of 0.03 deg is taken for accelerometer biases, and acts to second order. The second
    /// removes it. Errors of 1e-2, those of a MEMS unit, take a third.
    pub passes: u32,
    dithers: bool,
    measures: &'static [MeasurementInfo],
    describe: fn(&mut dyn FnMut(StateInfo)),
}

impl FilterInfo {
    /// What the declaration of `F` says, with the passes its class of units needs and what it holds in a few words.
    pub const fn of<F: Filter<Dynamics = Strapdown>>(passes: u32, about: &'static str) -> Self {
        let (dithers, measures) = (declares::<F, Dither>(), F::MEASURES);
        Self { name: F::NAME, states: F::DIM, about, passes, dithers, measures, describe: F::states }
    }

    /// Describes the states in order.
    pub fn describe(&self, visit: &mut dyn FnMut(StateInfo)) {
        (self.describe)(visit);
    }

    /// Whether the filter takes the size effect of the dither from the places of the accelerometers: it then needs a log that
    /// tells the dither.
    pub fn needs_dither(&self) -> bool {
        self.dithers
    }

    /// Names of the measurements, in order.
    pub fn measures(&self) -> impl Iterator<Item = &'static str> {
        self.measures.iter().map(|info| info.name)
    }
}
