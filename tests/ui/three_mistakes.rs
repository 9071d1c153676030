//! Three unrelated mistakes: one seen in the attribute, one in the names, one in the types. Three errors.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter(measures(velocity, position), color = "red")]
struct Nav {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    gyro: GyroErrors,
    gyro_again: GyroErrors,
    accel: AccelErrors,
    dither: Dither,
}

fn main() {
    let _ = (Nav::DIM, Nav::OFFSETS.gyro, Nav::NAME);
}
