//! Dynamics that are a type of another kind.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter(dynamics = GyroBias, measures(velocity))]
struct Nav {
    attitude: Attitude,
}

fn main() {}
