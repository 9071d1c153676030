//! A group where a filter is asked for.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[group]
struct Nav {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
}

fn name<F: Filter>() -> &'static str {
    F::NAME
}

fn main() {
    name::<Nav>();
}
