//! Two filters that extend each other.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter]
struct One {
    #[base]
    two: Two,
    delay: AccelDelay,
}

#[derive(StateBlocks)]
#[filter]
struct Two {
    #[base]
    one: One,
    bias: GyroBias,
}

fn main() {}
