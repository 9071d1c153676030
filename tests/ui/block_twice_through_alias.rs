//! A block once more under an alias of its type, alone and in a group.
use sinscal::prelude::*;

type Drift = GyroBias;

#[derive(StateBlocks)]
#[group]
struct Gyros {
    bias: GyroBias,
    drift: Drift,
}

#[derive(StateBlocks)]
#[group]
struct Drifts {
    drift: Drift,
}

#[derive(StateBlocks)]
#[filter(measures(velocity))]
struct Nav {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    gyro: GyroErrors,
    drifts: Drifts,
}

fn main() {}
