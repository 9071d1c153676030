//! Dither acts through the inner lever arm.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter(measures(velocity))]
struct Nav {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    accel: AccelErrors,
    dither: Dither,
}

fn main() {}
