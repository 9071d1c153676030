//! A family of dynamics small enough to check by hand: a cart on a rail with one accelerometer.
//!
//! Leading states are position and velocity, the one input is the acceleration error, measured are position and
//! velocity, a beacon adds its own place to the position residual.
#![allow(dead_code, reason = "each test uses its part of the family")]

use calib_core::{
    Block, BlockView, Dynamics, Measurement, MeasurementInfo, Need, Real, Relaxation, StateInfo,
};

pub(crate) struct Rail;

/// The specific force.
pub(crate) struct Force<T> {
    pub(crate) force: T,
}

impl Dynamics for Rail {
    const CORE: usize = 2;
    const INPUTS: usize = 1;
    const CHANNELS: usize = 2;
    const NEEDS: &'static [Need] = &[
        Need { any_of: &[Place::NAME], message: "a cart begins with `Place`" },
        Need { any_of: &[Speed::NAME], message: "then `Speed`" },
    ];
    type Signals<T: Real> = Force<T>;
    type Point<T: Real> = ();

    fn core_jacobian<T: Real>(_: &(), put: &mut impl FnMut(usize, usize, T)) {
        put(0, 1, T::one());
    }
    fn inject<T: Real>(_: &(), _: usize, value: T, put: &mut impl FnMut(usize, T)) {
        put(1, value);
    }
    fn measurement_jacobian<T: Real>(_: &(), put: &mut impl FnMut(usize, usize, T)) {
        put(0, 0, T::one());
        put(1, 1, T::one());
    }
}

macro_rules! measurement {
    ($name:ident, $text:literal, $channels:expr, $unit:literal, { $($item:tt)* }) => {
        pub(crate) struct $name;
        impl Measurement for $name {
            type Dynamics = Rail;
            const INFO: MeasurementInfo = MeasurementInfo {
                name: $text,
                components: &["x"],
                unit: $unit,
                columns: &[$text],
                sigma: 0.1,
                channels: $channels,
            };
            $($item)*
        }
    };
}

measurement!(PlaceSeen, "place", Some(0), "m", {
    fn residual<T: Real>(_: &(), reading: &[T], put: &mut impl FnMut(usize, T)) {
        put(0, -reading[0]);
    }
});
measurement!(SpeedSeen, "speed", Some(1), "m/s", {});
// place and three times speed
measurement!(Sum, "sum", None, "1", {
    fn jacobian<T: Real>(_: &(), put: &mut impl FnMut(usize, usize, T)) {
        put(0, 0, T::one());
        put(0, 1, T::of(3.0));
    }
});

const fn info(block: &'static str, unit: &'static str) -> StateInfo {
    StateInfo { block, component: "", unit, prior_sigma: 1.0, sheet_unit: unit, sheet_scale: 1.0 }
}

macro_rules! block {
    ($(#[$attr:meta])* $name:ident, $unit:literal, { $($item:tt)* }) => {
        $(#[$attr])*
        pub(crate) struct $name;
        impl Block for $name {
            type Dynamics = Rail;
            type View<'a, T: Real> = BlockView<'a, Self, T>;
            const NAME: &'static str = stringify!($name);
            const DIM: usize = 1;
            fn states(visit: &mut dyn FnMut(StateInfo)) {
                visit(info(Self::NAME, $unit));
            }
            $($item)*
        }
    };
}

block!(Place, "m", {});
block!(Speed, "m/s", {});
block!(Bias, "m/s^2", {
    fn input_jacobian<T: Real>(_: &Force<T>, put: &mut impl FnMut(usize, usize, T)) {
        put(0, 0, T::one());
    }
});
block!(Scale, "1", {
    fn input_jacobian<T: Real>(signals: &Force<T>, put: &mut impl FnMut(usize, usize, T)) {
        put(0, 0, signals.force);
    }
});
block!(Wander, "m/s^2", {
    const RELAXATIONS: &'static [(usize, Relaxation<f64>)] = &[(0, Relaxation { rate: 0.1, density: 1e-6 })];
    fn input_jacobian<T: Real>(_: &Force<T>, put: &mut impl FnMut(usize, usize, T)) {
        put(0, 0, T::one());
    }
});
block!(Beacon, "m", {
    fn measurement_jacobian<T: Real>(_: &(), put: &mut impl FnMut(usize, usize, T)) {
        put(0, 0, -T::one());
    }
});

/// No states: a beacon that moves, which needs a beacon.
pub(crate) struct Sway;

impl Block for Sway {
    type Dynamics = Rail;
    type View<'a, T: Real> = BlockView<'a, Self, T>;
    const NAME: &'static str = "Sway";
    const DIM: usize = 0;
    const NEEDS: &'static [Need] = &[Need { any_of: &[Beacon::NAME], message: "sway without a beacon" }];
    fn states(_: &mut dyn FnMut(StateInfo)) {}
}
