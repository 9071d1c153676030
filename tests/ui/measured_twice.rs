//! A measurement named twice.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter(measures(velocity, position, velocity))]
struct Nav {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
}

fn main() {}
