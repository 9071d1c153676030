//! What a table can do.

use rig::motion::Axis;

/// What turns the unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Table {
    /// About every axis of the body.
    ThreeAxis,
    /// An outer axis that stays level and points east, and an inner one that carries the unit by its z axis.
    TwoAxis,
    /// The unit's z axis.
    OneAxis,
    /// A person: quarter and half turns onto the faces of the housing.
    Hand,
}

impl Table {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::ThreeAxis, Self::TwoAxis, Self::OneAxis, Self::Hand];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::ThreeAxis => "three-axis",
            Self::TwoAxis => "two-axis",
            Self::OneAxis => "one-axis",
            Self::Hand => "hand",
        }
    }

    /// Axes that it turns about.
    pub fn axes(self) -> &'static [Axis] {
        const BODY: [Axis; 3] = [Axis::Body(0), Axis::Body(1), Axis::Body(2)];
        const TWO: [Axis; 2] = [Axis::Level(0), Axis::Body(2)];
        match self {
            Self::ThreeAxis | Self::Hand => &BODY,
            Self::TwoAxis => &TWO,
            Self::OneAxis => &BODY[2..],
        }
    }

    /// Sizes of its turns, deg; each goes both ways.
    pub fn angles(self) -> &'static [f64] {
        match self {
            Self::Hand => &[90.0, 180.0],
            _ => &[45.0, 90.0, 135.0, 180.0, 270.0, 360.0],
        }
    }

    /// Rates of its turns, deg/s, as far as the scenario allows them.
    pub fn rates(self) -> &'static [f64] {
        match self {
            Self::Hand => &[45.0],
            _ => &[60.0, 30.0, 10.0],
        }
    }

    /// Shortest rest between two turns, s.
    pub fn least_dwell(self) -> f64 {
        match self {
            Self::Hand => 10.0,
            _ => 1.0,
        }
    }
}
