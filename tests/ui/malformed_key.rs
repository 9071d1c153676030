//! Keys with values of the wrong form, and a key given twice.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter(measures = velocity, name = 43, dynamics(Strapdown), crate)]
struct Values {
    #[base]
    sins: sinscal::Sins36P,
}

#[derive(StateBlocks)]
#[filter(measures(velocity), measures(position), name = "a" name = "b", 3)]
struct Twice {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
}

#[derive(StateBlocks)]
#[filter = "nav"]
struct NotAList {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
}

fn main() {}
