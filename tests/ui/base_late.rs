//! A base that does not come first.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter(measures(velocity))]
struct Nav {
    inner_lever: InnerLeverArm,
    #[base]
    sins: sinscal::Sins36P,
}

fn main() {}
