//! The same type under two names.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter(measures(velocity))]
struct Nav {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    bias: GyroBias,
    drift: GyroBias,
}

fn main() {}
