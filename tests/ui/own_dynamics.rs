//! The rules that user-defined dynamics are held to.
use sinscal::prelude::*;

/// A train on a line: place and speed.
struct Train;

impl Dynamics for Train {
    const CORE: usize = 2;
    const INPUTS: usize = 0;
    const CHANNELS: usize = 1;
    const NEEDS: &'static [Need] = &[
        Need { any_of: &[Place::NAME], message: "a train has a place" },
        Need { any_of: &[Speed::NAME], message: "a train has a speed" },
    ];
    type Signals<T: Real> = ();
    type Point<T: Real> = ();
    fn core_jacobian<T: Real>(_: &(), _: &mut impl FnMut(usize, usize, T)) {}
    fn inject<T: Real>(_: &(), _: usize, _: T, _: &mut impl FnMut(usize, T)) {}
    fn measurement_jacobian<T: Real>(_: &(), _: &mut impl FnMut(usize, usize, T)) {}
}

struct Range;

impl Measurement for Range {
    type Dynamics = Train;
    const INFO: MeasurementInfo = MeasurementInfo {
        name: "range",
        components: &["x"],
        unit: "m",
        columns: &["range"],
        sigma: 1.0,
        channels: Some(0),
    };
}

macro_rules! block {
    ($name:ident, $dim:literal, $called:literal, $relaxations:expr) => {
        struct $name;
        impl Block for $name {
            type Dynamics = Train;
            type View<'a, T: Real> = BlockView<'a, Self, T>;
            const NAME: &'static str = $called;
            const DIM: usize = $dim;
            const RELAXATIONS: &'static [(usize, Relaxation<f64>)] = $relaxations;
            fn states(_: &mut dyn FnMut(StateInfo)) {}
        }
    };
}

block!(Place, 1, "place", &[]);
block!(Speed, 1, "speed", &[]);
block!(SlowingSpeed, 1, "speed", &[(0, Relaxation { rate: 0.1, density: 0.0 })]);
block!(PlaneSpeed, 2, "speed", &[]);
block!(Clock, 1, "clock", &[]);

#[derive(StateBlocks)]
#[filter(dynamics = Train, measures(velocity))]
struct OtherMeasurement {
    place: Place,
    speed: Speed,
}

#[derive(StateBlocks)]
#[filter(dynamics = Train, measures(Range))]
struct TooManyStates {
    place: Place,
    speed: PlaneSpeed,
}

#[derive(StateBlocks)]
#[filter(dynamics = Train, measures(Range))]
struct RelaxingCore {
    place: Place,
    speed: SlowingSpeed,
}

#[derive(StateBlocks)]
#[filter(dynamics = Train, measures(Range))]
struct OtherDynamics {
    place: Place,
    speed: Speed,
    clock: Clock,
    bias: GyroBias,
}

#[derive(StateBlocks)]
#[group]
struct OtherGroup {
    clock: Clock,
}

fn main() {}
