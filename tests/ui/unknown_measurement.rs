//! Measurements that strapdown dynamics do not have.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter(measures(velocty, range))]
struct Nav {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
}

fn main() {}
