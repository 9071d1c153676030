//! Declared error-state Kalman filters for the systematic calibration of strapdown inertial navigation systems.
#![cfg_attr(not(feature = "std"), no_std)]

extern crate self as sinscal;

mod align;
pub mod blocks;
mod calibration;
mod compensation;
pub mod earth;
mod effects;
mod filters;
mod observer;
pub mod path;
mod sample;
mod signals;
#[cfg(feature = "std")]
mod smoothing;
pub mod strapdown;
mod strapdown_model;
pub mod tables;

pub use align::{AlignError, Aligner};
pub use blocks::groups::{AccelErrors, GyroErrors, LinearAccelErrors};
pub use blocks::{
    AccelBias, AccelBiasDrift, AccelCrossCoupling, AccelCubic, AccelDelay, AccelMisalignment, AccelQuadratic,
    AccelScale, AccelScaleAsymmetry, AccelTemperatureBias, AccelTemperatureRate, AccelTemperatureScale,
    Attitude, Dither, DitherSizeEffect, GyroBias, GyroBiasDrift, GyroGSensitivity, GyroMisalignment,
    GyroRateNonlinearity, GyroScale, GyroScaleAsymmetry, GyroTemperatureBias, InnerLeverArm,
    InnerLeverArmTangential, OuterLeverArm, Position, ReferenceDelay, ReferenceMisalignment, ReferenceTilt,
    Velocity,
};
#[doc(hidden)]
pub use calib_core;
#[cfg(feature = "check")]
pub use calib_core::check;
pub use calib_core::{
    Block, BlockSet, BlockView, ChannelGroup, Conventional, Dim, Dynamics, Estimate, Filter, Form,
    Innovation, Kalman, Need, Real, Relaxation, Residuals, Shape, StateInfo, Transition, Ud, View,
};
pub use calibration::{Calibration, Diverged, Parameter, Statistics, Update};
pub use compensation::{Compensator, input_errors};
pub use effects::{EFFECTS, Effect, EffectInfo, effect};
pub use filters::{
    FILTERS, FilterInfo, FilterVisitor, Mems30, Sins36P, Sins39P, Sins40P, Sins43B, Sins43P, Tracked35,
    visit_filter,
};
pub use observer::{Observer, Updated};
pub use sample::{InitialAttitude, Reference, ReferenceSigma, Sample, SensorNoise, Setup, Site};
pub use signals::{Point, Signals};
#[cfg(feature = "std")]
pub use smoothing::{Smoothed, Smoother};
pub use state_macro::StateBlocks;
pub use strapdown_model::{FORCE, RATE, Strapdown};

/// What a declaration needs: `use sinscal::prelude::*;`.
pub mod prelude {
    pub use crate::blocks::groups::*;
    pub use crate::blocks::*;
    pub use crate::{
        Block, BlockSet, BlockView, Calibration, ChannelGroup, Conventional, Dynamics, Filter, Kalman, Need,
        Real, Relaxation, Residuals, StateBlocks, StateInfo, Strapdown, Transition, Ud,
    };
}
