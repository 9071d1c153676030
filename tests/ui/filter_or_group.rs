//! A struct that says both, and one that says neither.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter(measures(velocity))]
#[group]
struct Both {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
}

#[derive(StateBlocks)]
struct Neither {
    bias: GyroBias,
}

fn main() {}
