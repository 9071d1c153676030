use calib_core::{Measurement, MeasurementInfo, Real};
use nalgebra::{Quaternion, Rotation3, UnitQuaternion};

use super::{ENU, channel};
use crate::{Point, Strapdown};

/// Attitude of the reference's body frame.
///
/// - Reading: the quaternion w, x, y, z of C_bn.
/// - Equation: `C_pred = exp(-[z x]) C_ref`: a rotation vector in n.
#[derive(Clone, Copy, Debug)]
pub struct Attitude;

impl Measurement for Attitude {
    type Dynamics = Strapdown;
    const INFO: MeasurementInfo = MeasurementInfo {
        name: "attitude",
        components: ENU,
        unit: "rad",
        columns: &["ref_quat_w", "ref_quat_x", "ref_quat_y", "ref_quat_z"],
        sigma: 1e-4,
        channels: Some(channel::ATTITUDE),
    };

    #[inline]
    fn residual<T: Real>(at: &Point<T>, reading: &[T], put: &mut impl FnMut(usize, T)) {
        let &[w, x, y, z] = reading else { return };
        let predicted = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(at.c_bn));
        let read = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
        let turn = (predicted * read.inverse()).scaled_axis();
        for i in 0..3 {
            put(i, -turn[i]);
        }
    }
}
