//! What a block of a group needs is asked for where the group is used.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[group]
struct Timing {
    delay: AccelDelay,
    dither: Dither,
}

#[derive(StateBlocks)]
#[filter(measures(velocity))]
struct Nav {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    timing: Timing,
}

fn main() {}
