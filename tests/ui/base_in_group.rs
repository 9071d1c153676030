//! A group does not extend a filter.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[group]
struct Errors {
    #[base]
    gyro: GyroErrors,
    accel: AccelErrors,
}

fn main() {}
