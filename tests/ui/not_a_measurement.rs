//! Types in `measures` that are none, and one that is measured under two paths.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter(measures(velocity, Position))]
struct OfABlock {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
}

#[derive(StateBlocks)]
#[filter(measures(position, sinscal::measurements::Position))]
struct Twice {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
}

fn main() {}
