//! Measurements that there are not.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter(measures(velocty, range))]
struct Nav {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
}

fn main() {}
