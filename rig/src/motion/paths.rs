//! Lists of rotations that calibrate.

use nalgebra::Vector3;
use sinscal::path::EIGHTEEN_ROTATIONS;

/// What a table turns about: an axis of the body, or one that stays put in n (the outer axis of a two-axis table).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Axis 0, 1, 2 of b: right, forward, up.
    Body(usize),
    /// Axis 0, 1, 2 of n: east, north, up.
    Level(usize),
}

impl Axis {
    /// Names in scenarios.
    pub const NAMES: [&'static str; 6] = ["x", "y", "z", "east", "north", "up"];

    /// The axis of a name.
    pub fn of(name: &str) -> Option<Self> {
        let i = Self::NAMES.iter().position(|known| *known == name)?;
        Some(if i < 3 { Self::Body(i) } else { Self::Level(i - 3) })
    }

    /// Its number in its own triad.
    pub fn index(self) -> usize {
        match self {
            Self::Body(i) | Self::Level(i) => i,
        }
    }

    /// Its nominal direction in its own triad.
    pub fn direction(self) -> Vector3<f64> {
        let mut direction = Vector3::zeros();
        direction[self.index()] = 1.0;
        direction
    }
}

/// A rotation of a table and the rest after it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// What it turns about.
    pub axis: Axis,
    /// By how much, rad.
    pub angle: f64,
    /// How fast at most, rad/s.
    pub rate: f64,
    /// How long it stands still afterwards, s.
    pub dwell: f64,
}

/// Camberlein's 18 rotations, as axis and angle in rad.
pub fn eighteen_rotations() -> Vec<(Axis, f64)> {
    EIGHTEEN_ROTATIONS.iter().map(|turn| (Axis::Body(turn.axis), turn.angle)).collect()
}

const X: Axis = Axis::Body(0);
const Y: Axis = Axis::Body(1);
const Z: Axis = Axis::Body(2);
const EAST: Axis = Axis::Level(0);

/// Nineteen positions after the fashion of the PSINS toolbox: 18 quarter turns about body axes that visit every axis up and
/// down and undo each other. Axis and angle in degrees.
pub const NINETEEN_POSITIONS: [(Axis, f64); 18] = [
    (Y, 90.0),
    (Y, 90.0),
    (Y, 90.0),
    (Y, -90.0),
    (Y, -90.0),
    (Y, -90.0),
    (Z, 90.0),
    (X, 90.0),
    (X, 90.0),
    (X, 90.0),
    (X, -90.0),
    (X, -90.0),
    (X, -90.0),
    (Z, 90.0),
    (Z, 90.0),
    (Z, -90.0),
    (Z, -90.0),
    (Z, -90.0),
];

/// For a table with two axes: the outer one level and pointing east, the inner one carrying the unit by its z axis. Every body
/// axis comes up and down, and each is turned about while it is level. Axis and angle in degrees.
pub const TWO_AXIS: [(Axis, f64); 20] = [
    (EAST, 90.0),
    (Z, 90.0),
    (Z, 90.0),
    (Z, 90.0),
    (Z, 90.0),
    (EAST, 90.0),
    (EAST, 90.0),
    (EAST, 90.0),
    (Z, 90.0),
    (EAST, 90.0),
    (EAST, 90.0),
    (EAST, 90.0),
    (EAST, 90.0),
    (EAST, -90.0),
    (Z, 180.0),
    (Z, -180.0),
    (EAST, -180.0),
    (EAST, 180.0),
    (EAST, 90.0),
    (Z, -90.0),
];

/// Rotations in degrees as [`Turn`]s with the same rate and rest.
pub fn turns(list: &[(Axis, f64)], rate: f64, dwell: f64) -> Vec<Turn> {
    list.iter().map(|&(axis, angle)| Turn { axis, angle: angle.to_radians(), rate, dwell }).collect()
}
