//! A filter that measures nothing, and one that does not say.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter(measures())]
struct Nothing {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
}

#[derive(StateBlocks)]
#[filter]
struct Silent {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
}

fn main() {}
