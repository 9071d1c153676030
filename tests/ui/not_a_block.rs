//! A field that is no block: said once.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter(measures(velocity))]
struct Nav {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    bias: f64,
}

fn main() {}
