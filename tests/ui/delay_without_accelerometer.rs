//! A delay of accelerometers that have no errors.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter(measures(velocity))]
struct Nav {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    delay: AccelDelay,
}

fn main() {}
