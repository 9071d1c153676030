//! A group of leading blocks and parameter blocks.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[group]
struct Mixed {
    position: Position,
    bias: GyroBias,
}

fn main() {}
