//! Residuals, predicted minus reference, that a wrong estimate of a reference effect's parameters leaves.

use nalgebra::{Rotation3, Vector3};
use sinscal::Point;

/// z of `C_pred = exp(-[z x]) C_ref`.
pub(crate) fn attitude_residual(predicted: &Rotation3<f64>, reference: &Rotation3<f64>) -> Vector3<f64> {
    // Not the angle of the matrix's trace: it cannot tell small rotations from none.
    let e = (reference * predicted.inverse()).into_inner();
    let sine = Vector3::new(e.m32 - e.m23, e.m13 - e.m31, e.m21 - e.m12) / 2.0;
    let size = sine.norm();
    if size == 0.0 { sine } else { sine * (size.asin() / size) }
}

pub(crate) fn stack(velocity: Vector3<f64>, position: Vector3<f64>, attitude: Vector3<f64>) -> Vec<f64> {
    velocity.iter().chain(&position).chain(&attitude).copied().collect()
}

/// Residuals of velocity, position and attitude with an estimate that is `delta` below the truth.
pub(crate) fn residuals(name: &str, at: &Point<f64>, delta: &[f64]) -> Vec<f64> {
    let c = Rotation3::from_matrix_unchecked(at.c_bn);
    let none = Vector3::zeros();
    match name {
        "outer-lever-arm" => {
            let reading = |l: Vector3<f64>| (at.velocity + c * at.rate_eb.cross(&l), at.position + c * l);
            let (v, p) = reading(at.lever - Vector3::from_column_slice(delta));
            let (v_ref, p_ref) = reading(at.lever);
            stack(v - v_ref, p - p_ref, none)
        }
        "reference-delay" => {
            // The point's motion around the instant that the reference shows.
            let tau = 0.02;
            let state = |t: f64| {
                (
                    at.point_velocity + at.point_acceleration * t,
                    at.point_position + at.point_velocity * t + at.point_acceleration * (t * t / 2.0),
                    c * Rotation3::from_scaled_axis(at.rate_eb * t),
                )
            };
            let stamp = tau;
            let (v, p, a) = state(stamp - (tau - delta[0]));
            let (v_ref, p_ref, a_ref) = state(stamp - tau);
            stack(v - v_ref, p - p_ref, attitude_residual(&a, &a_ref))
        }
        "reference-misalignment" => {
            let estimate = Rotation3::from_scaled_axis(-Vector3::from_column_slice(delta));
            stack(none, none, attitude_residual(&(c * estimate), &c))
        }
        "reference-tilt" => {
            let estimate = -Vector3::new(delta[0], delta[1], 0.0);
            let tilted = Rotation3::from_scaled_axis(-estimate);
            let (v, p) = (at.point_velocity, at.point_position);
            stack(tilted * v - v, tilted * p - p, attitude_residual(&(tilted * c), &c))
        }
        "reference-scale" => {
            let scaled = |s: f64| (at.point_velocity * (1.0 + s), at.point_position * (1.0 + s));
            let s = 1e-4;
            let ((v, p), (v_ref, p_ref)) = (scaled(s - delta[0]), scaled(s));
            stack(v - v_ref, p - p_ref, none)
        }
        "table-orthogonality" => {
            // the angles of a table whose outer axis stands along up and whose inner one is the unit's x
            let inner = c * Vector3::x();
            let (heading, pitch) = (inner.y.atan2(inner.x), (-inner.z).asin());
            let about = |axis, angle| Rotation3::from_axis_angle(&axis, angle);
            let (outer, middle) = (about(Vector3::z_axis(), heading), about(Vector3::y_axis(), pitch));
            let square = outer * middle;
            let of_unit = square.inverse() * c;
            // m = o x i has the length of the cosine of the pitch
            let crooked = |[om, mi]: [f64; 2]| {
                let tilt = about(-Vector3::x_axis(), om * pitch.cos());
                let turn = about(-Vector3::z_axis(), mi * pitch.cos());
                outer * tilt * middle * turn * of_unit
            };
            // what is told with angles that are `delta` less, where the true ones are none
            let told = square * of_unit * crooked([-delta[0], -delta[1]]).inverse() * c;
            stack(none, none, attitude_residual(&told, &c))
        }
        _ => vec![0.0; 9],
    }
}
