//! Attributes of the struct on a field, of a field on the struct, and one with arguments it does not take.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[base]
#[filter(measures(velocity))]
struct Nav {
    #[base(Sins36P)]
    sins: sinscal::Sins36P,
    #[filter(measures(velocity))]
    #[group]
    inner_lever: InnerLeverArm,
}

#[derive(StateBlocks)]
#[filter]
struct Twice {
    #[base]
    #[base]
    sins: sinscal::Sins36P,
}

fn main() {}
