//! The rotation path of the systematic calibration (table 1 of the paper).

use nalgebra::{Matrix3, Unit, UnitQuaternion, Vector3};

/// One rotation of a path about a body axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// Body axis: 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// Angle, rad.
    pub angle: f64,
}

impl Turn {
    const fn degrees(axis: usize, angle: f64) -> Self {
        Self { axis, angle: angle * core::f64::consts::PI / 180.0 }
    }

    /// The rotation that turns body components after it into body components before it.
    pub fn rotation(&self) -> UnitQuaternion<f64> {
        let mut axis = Vector3::zeros();
        axis[self.axis] = 1.0;
        UnitQuaternion::from_axis_angle(&Unit::new_unchecked(axis), self.angle)
    }
}

/// The 18 rotations of Camberlein's path as the paper prints them.
///
/// The printed column "attitude after rotation" is the attitude *before* each rotation: only so are all 18 rows
/// consistent and the path closes, starting and ending with x north, y east, z down.
pub const EIGHTEEN_ROTATIONS: [Turn; 18] = [
    Turn::degrees(1, 90.0),
    Turn::degrees(1, 180.0),
    Turn::degrees(1, 180.0),
    Turn::degrees(2, 90.0),
    Turn::degrees(2, 180.0),
    Turn::degrees(2, 180.0),
    Turn::degrees(0, 90.0),
    Turn::degrees(0, 180.0),
    Turn::degrees(0, 180.0),
    Turn::degrees(0, 90.0),
    Turn::degrees(0, 90.0),
    Turn::degrees(0, 90.0),
    Turn::degrees(2, 90.0),
    Turn::degrees(2, 90.0),
    Turn::degrees(2, 90.0),
    Turn::degrees(1, 90.0),
    Turn::degrees(1, 90.0),
    Turn::degrees(1, 90.0),
];

/// Attitude whose body axes x, y, z point along three of `N E D S W U`, for instance `b"NED"`; `None` when a letter is
/// unknown or the axes are not right-handed.
pub fn attitude(letters: &[u8; 3]) -> Option<UnitQuaternion<f64>> {
    let mut columns = [Vector3::zeros(); 3];
    for (column, letter) in columns.iter_mut().zip(letters) {
        *column = match letter {
            b'E' => Vector3::x(),
            b'W' => -Vector3::x(),
            b'N' => Vector3::y(),
            b'S' => -Vector3::y(),
            b'U' => Vector3::z(),
            b'D' => -Vector3::z(),
            _ => return None,
        };
    }
    let c_bn = Matrix3::from_columns(&columns);
    (c_bn.determinant() > 0.5)
        .then(|| UnitQuaternion::from_rotation_matrix(&nalgebra::Rotation3::from_matrix_unchecked(c_bn)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The column "attitude after rotation" of table 1, row by row.
    const PRINTED: [&[u8; 3]; 18] = [
        b"NED", b"UEN", b"DES", b"UEN", b"EDN", b"WUN", b"EDN", b"ENU", b"ESD", b"ENU", b"EUS", b"ESD",
        b"EDN", b"DWN", b"WUN", b"UEN", b"SEU", b"DES",
    ];

    #[test]
    fn printed_attitudes_are_those_before_each_rotation_and_the_path_closes() {
        let start = attitude(b"NED").unwrap();
        let mut now = start;
        for (row, (turn, printed)) in EIGHTEEN_ROTATIONS.iter().zip(PRINTED).enumerate() {
            let expected = attitude(printed).unwrap();
            assert!(now.angle_to(&expected) < 1e-9, "row {}: {}", row + 1, now.angle_to(&expected));
            now *= turn.rotation();
        }
        assert!(now.angle_to(&start) < 1e-9);
    }

    #[test]
    fn printed_attitudes_are_not_those_after_each_rotation() {
        let mut now = attitude(b"NED").unwrap();
        let wrong = EIGHTEEN_ROTATIONS.iter().zip(PRINTED).filter(|(turn, printed)| {
            now *= turn.rotation();
            now.angle_to(&attitude(printed).unwrap()) > 1e-9
        });
        assert!(wrong.count() > 9);
    }

    #[test]
    fn a_left_handed_attitude_is_none() {
        assert!(attitude(b"NEU").is_none());
        assert!(attitude(b"NEX").is_none());
    }
}
