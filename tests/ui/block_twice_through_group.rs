//! A block of a group once more by itself, and under another path.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter(measures(velocity))]
struct Nav {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    gyro: GyroErrors,
    bias: GyroBias,
    place: sinscal::Position,
}

fn main() {}
