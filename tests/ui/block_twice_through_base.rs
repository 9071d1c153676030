//! A block of a base once more.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter(measures(velocity))]
struct Nav {
    #[base]
    sins: Sins36P,
    gyro: GyroErrors,
}

use sinscal::Sins36P;

fn main() {}
