//! A name that cannot be typed on a command line.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter(name = "My Filter", measures(velocity))]
struct Nav {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
}

fn main() {}
