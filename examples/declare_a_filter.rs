//! For someone with a unit of their own: a filter is the list of what may be wrong.
//!
//! Run it with `cargo run --release --example declare_a_filter`.

use sinscal::prelude::*;

/// Gyros and accelerometers, a delay of the accelerometers, and gyros that feel acceleration.
#[derive(StateBlocks)]
#[filter(measures(velocity, position))]
pub struct MyUnit {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    gyro: GyroErrors,
    accel: LinearAccelErrors,
    delay: AccelDelay,
    g_sensitivity: GyroGSensitivity,
}

/// The same on a marker plate that is not aligned with the unit, seen by a motion-capture system.
#[derive(StateBlocks)]
#[filter(name = "my-unit-tracked", measures(position, attitude))]
pub struct MyTrackedUnit {
    #[base]
    unit: MyUnit,
    mounting: ReferenceMisalignment,
}

fn main() {
    const { assert!(MyUnit::DIM == 40 && MyTrackedUnit::DIM == 43) };
    println!(
        "{} has {} states, {} has {}:",
        MyUnit::NAME,
        MyUnit::DIM,
        MyTrackedUnit::NAME,
        MyTrackedUnit::DIM
    );
    MyTrackedUnit::states(&mut |s| {
        let sheet = s.prior_sigma / s.sheet_scale;
        println!("  {:24} {:3}  prior {sheet:8.3} {}", s.block, s.component, s.sheet_unit);
    });
    println!("the delay stands at {} of {:?}", MyUnit::OFFSETS.delay, MyUnit::OFFSETS);
}
