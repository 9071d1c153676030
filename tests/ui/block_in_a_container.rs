//! Blocks that may be there, or several times.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter(measures(velocity))]
struct Nav {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    bias: Option<GyroBias>,
    scale: Vec<Box<GyroScale>>,
    accel: [AccelBias; 3],
}

fn main() {
    let _ = Kalman::<Nav>::prior();
}
