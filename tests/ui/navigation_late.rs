//! A block before the navigation blocks.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter(measures(velocity))]
struct Early {
    attitude: Attitude,
    gyro: GyroErrors,
    velocity: Velocity,
    position: Position,
}

#[derive(StateBlocks)]
#[filter(measures(velocity))]
struct Swapped {
    velocity: Velocity,
    attitude: Attitude,
    position: Position,
}

fn main() {}
