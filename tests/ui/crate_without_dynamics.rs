//! A crate that names the core itself must name the dynamics too.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter(crate = sinscal::calib_core, measures(velocity))]
struct Nav {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
}

fn main() {}
