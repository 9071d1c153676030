//! Navigation blocks that are not there: said once, on the name of the filter.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter(measures(velocity))]
struct Nav {
    attitude: Attitude,
    gyro: GyroErrors,
}

fn main() {}
