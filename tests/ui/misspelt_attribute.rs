//! Attributes that rustc does not know: nothing else is said of them.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter]
struct Nav {
    #[bse]
    sins: sinscal::Sins36P,
    delay: AccelDelay,
}

#[derive(StateBlocks)]
#[fliter(measures(velocity))]
struct Other {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
}

fn main() {
    let _ = (Kalman::<Nav>::prior(), Kalman::<Other>::prior());
}
