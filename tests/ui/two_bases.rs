//! Two bases.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter]
struct Nav {
    #[base]
    sins: sinscal::Sins36P,
    #[base]
    mems: Free,
}

/// Blocks that 36D-P does not have: the second base is the only mistake.
#[derive(StateBlocks)]
#[group]
struct Free {
    inner_lever: InnerLeverArm,
}

fn main() {}
