//! Five mistakes, five errors: a key, a measurement, a block twice, a need, and a type that is no block.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter(measures(velocity, speed), nmae = "x")]
struct Nav {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    gyro: GyroErrors,
    bias: GyroBias,
    dither: Dither,
    clock: u32,
}

fn main() {
    let _ = Kalman::<Nav>::prior();
}
