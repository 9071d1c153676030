//! Keys that do not exist, in one attribute.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter(measure(velocity), measures(velocity), colour = "red")]
struct Nav {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
}

#[derive(StateBlocks)]
#[group(measures(velocity), name = "gyro")]
struct Gyro {
    bias: GyroBias,
}

fn main() {}
