//! Filters of the literature as declarations: what each estimates, in the states of this library.
//!
//! Each is a few lines: what declaring means.

use calib_core::{Block, BlockView, Real, Relaxation, StateInfo};
use state_macro::StateBlocks;

use super::Sins40P;
use crate::blocks::groups::*;
use crate::blocks::*;
use crate::{FORCE, RATE, Signals, Strapdown};

/// 30 states: navigation and the 21 errors of scale, installation and bias, from velocity alone.
///
/// The errors that Ren, Dong, Chen and Wang identify from the velocity errors of 16 rotations (*Instrumentation Mesure Metrologie*
/// 18(4):397, 2019, doi:10.18280/i2m.180409), there by least squares.
#[derive(Debug, StateBlocks)]
#[filter(name = "systematic-30d", measures(velocity))]
pub struct Systematic30 {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    gyro: GyroErrors,
    accel: LinearAccelErrors,
}

/// 33 states: [`Systematic30`] and the quadratic scale factor of each accelerometer, the K2 of IEEE Std 1293.
#[derive(Debug, StateBlocks)]
#[filter(name = "systematic-33d", measures(velocity))]
pub struct Systematic33 {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    gyro: GyroErrors,
    accel: AccelErrors,
}

/// 46 states: what `sysclbt` of PSINS calibrates (G. Yan, Northwestern Polytechnical University), with all nine lever arms of the
/// accelerometers, their delay and quadratic terms, from velocity that is known to be zero at rests.
///
/// A common shift of the three accelerometers moves the unit's sensitive centre and nothing else. At rests alone no outer lever arm
/// shows, so that three of the 37 parameters keep their priors: see [`InnerLeverArmTangential`].
#[derive(Debug, StateBlocks)]
#[filter(name = "psins-46d", measures(velocity))]
pub struct PsinsCalibration {
    #[base]
    sins: Sins40P,
    tangential: InnerLeverArmTangential,
}

/// 15 states: loosely coupled GNSS/INS with first-order Gauss-Markov biases, as in chapter 14 of P. D. Groves, *Principles of GNSS,
/// Inertial, and Multisensor Integrated Navigation Systems*, 2nd edition, Artech House, 2013.
///
/// The biases are those of a tactical unit: see [`MarkovGyroBias`] and [`MarkovAccelBias`].
#[derive(Debug, StateBlocks)]
#[filter(name = "gnss-ins-15d", measures(velocity, position))]
pub struct GnssIns15 {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    gyro: MarkovGyroBias,
    accel: MarkovAccelBias,
}

macro_rules! markov {
    (
        $(#[$doc:meta])* $block:ident: $name:literal, $first:ident, $unit:literal, $sigma:expr, $sheet:literal = $scale:expr) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub struct $block;

        impl $block {
            /// Standard deviation of each bias at any time, SI.
            pub const SIGMA: f64 = $sigma;
            /// Its correlation time, s.
            pub const CORRELATION: f64 = 300.0;
        }

        impl Block for $block {
            type Dynamics = Strapdown;
            type View<'a, T: Real> = BlockView<'a, Self, T>;

            const NAME: &'static str = $name;
            const DIM: usize = 3;
            const RELAXATIONS: &'static [(usize, Relaxation<f64>)] = &{
                let rate = 1.0 / Self::CORRELATION;
                let wanders = Relaxation { rate, density: 2.0 * Self::SIGMA * Self::SIGMA * rate };
                [(0, wanders), (1, wanders), (2, wanders)]
            };

            fn states(visit: &mut dyn FnMut(StateInfo)) {
                for component in ["x", "y", "z"] {
                    visit(StateInfo {
                        block: Self::NAME,
                        component,
                        unit: $unit,
                        prior_sigma: Self::SIGMA,
                        sheet_unit: $sheet,
                        sheet_scale: $scale,
                    });
                }
            }

            #[inline(always)]
            fn input_jacobian<T: Real>(_: &Signals<T>, put: &mut impl FnMut(usize, usize, T)) {
                for i in 0..3 {
                    put($first + i, i, T::one());
                }
            }
        }
    };
}

markov! {
    /// Biases of the gyros that wander: first-order Gauss-Markov, 10 deg/h within 300 s, a tactical unit's.
    ///
    /// - Equation: `d_omega_i = b_i`, `b_i' = -b_i / 300 s + w_i`.
    /// - Sign: a positive state makes the gyro read more than the truth.
    MarkovGyroBias: "gyro-bias-wander", RATE, "rad/s", 10.0 * units::DEG_PER_HOUR, "deg/h" = units::DEG_PER_HOUR
}

markov! {
    /// Biases of the accelerometers that wander: first-order Gauss-Markov, 1 mg within 300 s, a tactical unit's.
    ///
    /// - Equation: `d_f_i = b_i`, `b_i' = -b_i / 300 s + w_i`.
    /// - Sign: a positive state makes the accelerometer read more than the truth.
    MarkovAccelBias: "accel-bias-wander", FORCE, "m/s^2", 1e3 * units::MICRO_G, "ug" = units::MICRO_G
}
