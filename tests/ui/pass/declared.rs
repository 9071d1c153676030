//! Every form of a declaration, without a warning.
#![deny(warnings, missing_docs, unreachable_pub, unused, clippy::all)]

use sinscal::prelude::*;

/// A filter.
#[derive(StateBlocks)]
#[filter(measures(velocity, position, attitude))]
pub struct Nav {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    gyro: Gyro,
}

/// A group.
#[derive(StateBlocks)]
#[group]
pub struct Gyro {
    r#type: GyroErrors,
    sensitivity: sinscal::GyroGSensitivity,
}

mod private {
    use sinscal::prelude::*;

    #[derive(StateBlocks)]
    #[filter(name = "extended", measures(position))]
    pub(crate) struct Extended {
        #[base]
        nav: super::Nav,
        accel: AccelErrors,
        inner_lever: InnerLeverArm,
        dither: Dither,
    }

    #[derive(StateBlocks)]
    #[filter]
    struct Unused {
        #[base]
        nav: super::Nav,
    }
}

fn main() {
    const { assert!(Nav::DIM == 9 + Gyro::DIM) }
    assert_eq!(Nav::NAME, "nav");
    assert_eq!(private::Extended::NAME, "extended");
    assert_eq!(private::Extended::OFFSETS.dither, private::Extended::DIM);
}
