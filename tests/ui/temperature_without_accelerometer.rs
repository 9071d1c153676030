//! A temperature effect on accelerometers that have no errors.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter(measures(velocity))]
struct Nav {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    temperature: AccelTemperatureScale,
}

fn main() {}
