//! Declared error-state Kalman filters for the systematic calibration of strapdown inertial navigation systems.
//!
//! # Declare
//!
//! A filter is a struct whose fields say what may be wrong:
//!
//! ```
//! use sinscal::prelude::*;
//!
//! #[derive(StateBlocks)]
//! #[filter(measures(velocity, position))]
//! pub struct MyUnit {
//!     attitude: Attitude,
//!     velocity: Velocity,
//!     position: Position,
//!     gyro: GyroErrors,           // scale, installation, bias
//!     accel: AccelErrors,         // scale, installation, bias, quadratic
//!     outer_lever: OuterLeverArm,
//!     delay: AccelDelay,
//! }
//!
//! assert_eq!(MyUnit::DIM, 37);
//! assert_eq!(MyUnit::OFFSETS.delay, 36);
//! ```
//!
//! The derive ([`StateBlocks`]) makes a [`Filter`] of it: its sizes, the sparse assembly of F and H, names, units and priors of the
//! states, and named access to estimates. [`blocks`] holds what there is to declare, [`EFFECTS`] lists it with equations; a
//! [`Block`] of your own takes one Jacobian. A declaration that cannot work does not compile:
//!
//! ```compile_fail
//! # use sinscal::prelude::*;
//! #[derive(StateBlocks)]
//! #[filter(measures(velocity, position))]
//! struct Impossible {
//!     attitude: Attitude,
//!     velocity: Velocity,
//!     position: Position,
//!     gyro: GyroErrors,
//!     accel: AccelErrors,
//!     dither: Dither, // `dither` acts through the inner lever arm, and there is none
//! }
//! ```
//!
//! # Run
//!
//! [`Calibration`] runs a declared filter over [`Sample`]s: navigation at their rate, updates at the reference's.
//!
//! ```
//! use sinscal::prelude::*;
//! use sinscal::{InitialAttitude, Reference, ReferenceSigma, Sample, SensorNoise, Setup, Sins36P, Site};
//! use nalgebra::{UnitQuaternion, Vector3};
//!
//! let setup = Setup {
//!     priors: &[("accel-bias", 5e-3)],
//!     ..Setup::new(
//!         50.0,
//!         Site { latitude: 0.56, longitude: 2.07, height: 20.0 },
//!         InitialAttitude {
//!             attitude: UnitQuaternion::identity(),
//!             level_sigma: 5e-4,
//!             heading_sigma: 2e-3,
//!         },
//!         ReferenceSigma { velocity: 1e-3, position: 2e-3, attitude: 1e-4 },
//!         SensorNoise { angle_random_walk: 3e-7, velocity_random_walk: 5e-5 },
//!     )
//! };
//! let mut run = Calibration::<Sins36P>::new(&setup)?;
//! for k in 1..=500 {
//!     let sample = Sample {
//!         time: f64::from(k) / 50.0,
//!         dtheta: Vector3::new(0.0, 1.2e-6, 7.8e-7), // the Earth turns
//!         dvel: Vector3::new(0.0, 0.0, 9.795 / 50.0),
//!         temperature: Vector3::repeat(f64::NAN),
//!         gyro_temperature: Vector3::repeat(f64::NAN),
//!         dither: Vector3::repeat(f64::NAN),
//!         reference: Reference {
//!             velocity: Some(Vector3::zeros()),
//!             position: Some(Vector3::zeros()),
//!             ..Reference::default()
//!         },
//!     };
//!     run.step(&sample)?;
//! }
//!
//! // it explains its log when this is near 1
//! println!("NIS per degree of freedom {:.2}", run.statistics().nis_per_dof());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Read
//!
//! What the data say less about than the prior did is not estimated. Values are SI; `sheet_scale` turns them into the units of data
//! sheets. All by name, no index is written by hand:
//!
//! ```
//! use sinscal::prelude::*;
//! use sinscal::Sins40P;
//!
//! fn tell(run: &Calibration<Sins40P>) {
//!     run.parameters(&mut |p| {
//!         if p.estimated {
//!             let sheet = p.info.sheet_scale;
//!             println!("{} {} = {} +- {} {}", p.info.block, p.info.component, p.value / sheet, p.sigma / sheet, p.info.sheet_unit);
//!         }
//!     });
//!     let (x, covariance) = (run.estimate(), run.covariance());
//!     let delay = Sins40P::view(&x, &covariance).delay();
//!     println!("delay {} +- {} s", delay.values()[0], delay.sigma(0));
//! }
//! ```
//!
//! [`Smoother`] and [`Innovations`] watch a run ([`Observer`]); [`Compensator`] takes the modelled errors out of samples in real time;
//! [`observability`] says what a path can show, [`navigation`] what a calibration is worth.
//!
//! # Conventions
//!
//! n is east-north-up, b right-forward-up. The error of a navigation quantity is *computed - true*, that of a sensor *measured - true*:
//! a positive parameter makes the sensor read more. Filters and equations: Xing, Yang and Cai, *Sensors* 22(1):278, 2022
//! (doi:10.3390/s22010278).
//!
//! # Features
//!
//! - `std` (default): faster elementary functions, [`Coarse`] and [`Smoother`]. Without it the library neither allocates nor links
//!   the standard library.
//! - `check`: `sinscal::check`, for the tests and benchmarks of your own blocks and filters.
#![cfg_attr(not(feature = "std"), no_std)]

extern crate self as sinscal;

mod align;
pub mod blocks;
mod calibration;
#[cfg(feature = "std")]
mod coarse;
mod compensation;
pub mod earth;
mod effects;
mod filters;
mod gate;
#[cfg(feature = "std")]
mod innovations;
pub mod measurements;
pub mod navigation;
pub mod observability;
mod observer;
mod outcome;
pub mod path;
mod sample;
mod setup;
mod signals;
#[cfg(feature = "std")]
mod smoothing;
pub mod strapdown;
mod strapdown_model;
pub mod tables;

pub use align::{AlignError, Aligner};
pub use blocks::groups::{AccelErrors, GyroErrors, LinearAccelErrors};
pub use blocks::{
    AccelBias, AccelBiasDrift, AccelBiasRandomWalk, AccelBiasWander, AccelCrossCoupling, AccelCubic,
    AccelDelay, AccelMisalignment, AccelQuadratic, AccelScale, AccelScaleAsymmetry, AccelTemperatureBias,
    AccelTemperatureRate, AccelTemperatureScale, Attitude, ClockScale, Dither, DitherScale, DitherSizeEffect,
    GyroBias, GyroBiasDrift, GyroBiasRandomWalk, GyroBiasWander, GyroGSensitivity, GyroMisalignment,
    GyroRateNonlinearity, GyroScale, GyroScaleAsymmetry, GyroTemperatureBias, InnerLeverArm,
    InnerLeverArmTangential, Open, OpenBlocks, OpenError, OuterLeverArm, Position, ReferenceDelay,
    ReferenceMisalignment, ReferenceScale, ReferenceTilt, SiteGravity, SiteHeight, SiteLatitude,
    TableOrthogonality, ThermometerLag, ThermometerOffset, ThermometerScale, Velocity,
};
#[doc(hidden)]
pub use calib_core;
#[cfg(feature = "check")]
pub use calib_core::check;
pub use calib_core::{
    Block, BlockView, BlockVisitor, Conventional, Counted, Dim, Dynamics, Estimate, Extended, Fault, Filter,
    Flaw, Form, Innovation, Kalman, Leaf, Measurement, MeasurementInfo, Need, Real, Relaxation, Residuals,
    Shape, Sizes, StateInfo, Transition, Ud, View, considered_in, declares, first_state, leaves, relaxations,
    relaxes,
};
pub use calibration::{Calibration, Known};
#[cfg(feature = "std")]
pub use coarse::{
    Coarse, CoarseCalibration, CoarseError, CoarseParameter, SiteFault, SiteRests, SiteShown, UnknownPulses,
};
pub use compensation::{Compensator, input_errors};
#[cfg(feature = "std")]
pub use compensation::{Corrector, corrector_of};
pub use effects::{
    AnyBlock, AnyEffect, CATALOGUE, Catalogue, EFFECTS, Effect, EffectInfo, INFLUENCES, Kind, any_effect,
    effect,
};
#[cfg(feature = "std")]
pub use effects::{Law, Motion};
pub use filters::{
    FILTERS, FilterInfo, FilterVisitor, Mems30, PAPER, Sins36P, Sins39P, Sins40P, Sins43B, Sins43P,
    Tracked35, literature, visit_filter,
};
pub use gate::Gate;
#[cfg(feature = "std")]
pub use innovations::{ChannelInnovations, Innovations};
pub use measurements::channel;
pub use observer::{Event, Observer, Refusal};
pub use outcome::{Diverged, Parameter, Statistics, Update};
pub use sample::{Missed, OWN, ReadingSigma, Reference, Sample, own_columns};
pub use setup::{
    BiasWander, InitialAttitude, InitialVelocity, ReferenceSigma, SensorNoise, Setup, SetupError, Site, Word,
};
pub use signals::{Point, Signals};
#[cfg(feature = "std")]
pub use smoothing::{Smoothed, Smoother, Tape};
pub use state_macro::StateBlocks;
pub use strapdown_model::{FORCE, RATE, Strapdown, probe};

/// What a declaration needs: `use sinscal::prelude::*;`.
pub mod prelude {
    pub use crate::blocks::groups::*;
    pub use crate::blocks::*;
    pub use crate::{
        Block, BlockView, Calibration, Conventional, Dynamics, Filter, Kalman, Measurement, MeasurementInfo,
        Need, Real, Relaxation, Residuals, StateBlocks, StateInfo, Strapdown, Transition, Ud,
    };
}

/// The examples of the README and of the guide, as tests.
#[cfg(doctest)]
mod guide {
    #[doc = include_str!("../README.md")]
    struct Readme;
    #[doc = include_str!("../docs/guide/01-quick-start.md")]
    #[doc = include_str!("../docs/guide/02-calibrate-my-log.md")]
    #[doc = include_str!("../docs/guide/03-read-the-report.md")]
    #[doc = include_str!("../docs/guide/04-declare-my-filter.md")]
    #[doc = include_str!("../docs/guide/05-write-my-block.md")]
    #[doc = include_str!("../docs/guide/06-find-what-is-missing.md")]
    #[doc = include_str!("../docs/guide/07-embed-the-filter.md")]
    #[doc = include_str!("../docs/guide/08-mathematics.md")]
    #[doc = include_str!("../docs/guide/11-your-own-project.md")]
    struct Guide;
}
