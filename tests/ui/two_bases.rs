//! Two bases, which have blocks in common.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter]
struct Nav {
    #[base]
    sins: sinscal::Sins36P,
    #[base]
    mems: sinscal::Mems30,
}

fn main() {
    let _ = Kalman::<Nav>::prior();
}
