//! A group that holds a block twice.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[group]
struct Gyro {
    errors: GyroErrors,
    scale: GyroScale,
}

fn main() {}
