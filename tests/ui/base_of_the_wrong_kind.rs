//! A base that is a group, and one that is a block.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter(measures(velocity))]
struct FromGroup {
    #[base]
    gyro: GyroErrors,
    accel: AccelErrors,
}

#[derive(StateBlocks)]
#[filter]
struct FromBlock {
    #[base]
    attitude: Attitude,
}

fn main() {}
