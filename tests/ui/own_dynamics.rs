//! The rules that user-defined dynamics are held to.
use sinscal::prelude::*;

/// A train on a line: place and speed.
struct Train;

const PLACE: BlockSet = BlockSet::only(0);
const SPEED: BlockSet = BlockSet::only(1);

impl Dynamics for Train {
    const CORE: usize = 2;
    const INPUTS: usize = 0;
    const CHANNELS: &'static [ChannelGroup] =
        &[ChannelGroup { name: "range", first: 0, components: &["x"], unit: "m" }];
    const NEEDS: &'static [Need] = &[
        Need { any_of: PLACE, message: "a train has a place" },
        Need { any_of: SPEED, message: "a train has a speed" },
    ];
    type Signals<T: Real> = ();
    type Point<T: Real> = ();
    fn core_jacobian<T: Real>(_: &(), _: &mut impl FnMut(usize, usize, T)) {}
    fn inject<T: Real>(_: &(), _: usize, _: T, _: &mut impl FnMut(usize, T)) {}
    fn measurement_jacobian<T: Real>(_: &(), _: &mut impl FnMut(usize, usize, T)) {}
}

macro_rules! block {
    ($name:ident, $dim:literal, $set:expr, $relaxes:literal) => {
        struct $name;
        impl Block for $name {
            type Dynamics = Train;
            type View<'a, T: Real> = BlockView<'a, Self, T>;
            const DIM: usize = $dim;
            const SET: BlockSet = $set;
            const RELAXES: bool = $relaxes;
            fn states(_: &mut dyn FnMut(StateInfo)) {}
        }
    };
}

block!(Place, 1, PLACE, false);
block!(Speed, 1, SPEED, false);
block!(SlowingSpeed, 1, SPEED, true);
block!(PlaneSpeed, 2, SPEED, false);
block!(Clock, 1, BlockSet::EMPTY, false);

#[derive(StateBlocks)]
#[filter(dynamics = Train, measures(velocity))]
struct UnknownMeasurement {
    place: Place,
    speed: Speed,
}

#[derive(StateBlocks)]
#[filter(dynamics = Train, measures(range))]
struct TooManyStates {
    place: Place,
    speed: PlaneSpeed,
}

#[derive(StateBlocks)]
#[filter(dynamics = Train, measures(range))]
struct RelaxingCore {
    place: Place,
    speed: SlowingSpeed,
}

#[derive(StateBlocks)]
#[filter(dynamics = Train, measures(range))]
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
