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

    /// All measurements that have names.
    #[derive(StateBlocks)]
    #[filter(measures(velocity, position, attitude, rate, r#height, heading))]
    pub(crate) struct AllSeen {
        #[base]
        nav: super::Nav,
    }

    /// By types, ours and one of one's own.
    #[derive(StateBlocks)]
    #[filter(measures(sinscal::measurements::Height, North, self::own::East))]
    pub(crate) struct Typed {
        #[base]
        nav: super::Nav,
    }

    macro_rules! channel {
        ($name:ident, $text:literal, $first:literal) => {
            pub(crate) struct $name;
            impl Measurement for $name {
                type Dynamics = Strapdown;
                const INFO: MeasurementInfo = MeasurementInfo {
                    name: $text,
                    components: &["x"],
                    unit: "m",
                    columns: &[$text],
                    sigma: 1.0,
                    channels: Some($first),
                };
            }
        };
    }

    channel!(North, "north", 4);
    mod own {
        use sinscal::prelude::*;
        channel!(East, "east", 3);
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
    let names = |measures: &[MeasurementInfo]| measures.iter().map(|info| info.name).collect::<Vec<_>>();
    let ours = ["velocity", "position", "attitude", "rate", "height", "heading"];
    assert_eq!(names(private::AllSeen::MEASURES), ours);
    assert_eq!(names(private::Typed::MEASURES), ["height", "north", "east"]);
}
