//! What sensors read beyond the truth, written from the physics and not from the tables.

use std::f64::consts::TAU;

use nalgebra::{Matrix3, Rotation3, Vector3};
use sinscal::Signals;

/// Errors of the three gyros and the three accelerometers with an effect of parameters `p`.
pub(crate) fn error(name: &str, s: &Signals<f64>, p: &[f64]) -> Vec<f64> {
    let (w, f) = (s.rate, s.force);
    let v = |values: &[f64]| Vector3::from_column_slice(&values[..3]);
    let times = |x: Vector3<f64>| v(p).component_mul(&x);
    let none = Vector3::zeros();
    let (gyros, accelerometers) = match name {
        "gyro-scale" => (Matrix3::from_diagonal(&v(p)) * w, none),
        "gyro-misalignment" => (Matrix3::new(0.0, 0.0, 0.0, p[0], 0.0, 0.0, p[1], p[2], 0.0) * w, none),
        "gyro-bias" | "gyro-bias-wander" | "gyro-bias-random-walk" => (v(p), none),
        "gyro-temperature-bias" => (times(s.gyro_temperature), none),
        "gyro-g-sensitivity" => (Matrix3::from_row_slice(&p[..9]) * f, none),
        "gyro-scale-asymmetry" => (times(w.abs()), none),
        "gyro-rate-nonlinearity" => (times(w.map(|x| x.signum() * x.powi(2))), none),
        "gyro-bias-drift" => (s.time * v(p), none),
        "accel-scale" => (none, Matrix3::from_diagonal(&v(p)) * f),
        "accel-misalignment" => (none, Matrix3::new(0.0, p[0], p[1], p[2], 0.0, p[3], p[4], p[5], 0.0) * f),
        "accel-bias" | "accel-bias-wander" | "accel-bias-random-walk" => (none, v(p)),
        "accel-quadratic" => (none, times(f.map(|x| x.powi(2)))),
        "accel-cubic" => (none, times(f.map(|x| x.powi(3)))),
        "accel-scale-asymmetry" => (none, times(f.map(f64::abs))),
        "accel-cross-coupling" => (none, times(Vector3::new(f.y * f.z, f.x * f.z, f.x * f.y))),
        "accel-temperature-scale" => (none, times(s.temperature).component_mul(&f)),
        "accel-temperature-bias" => (none, times(s.temperature)),
        "accel-temperature-rate" => (none, times(s.temperature_rate)),
        "accel-bias-drift" => (none, s.time * v(p)),
        // At t - tau the body was turned back by omega tau, and the specific force along the axes that do not turn was another: its
        // derivative there is what that in b has beyond the turning.
        "accel-delay" => {
            let change = s.force_rate + w.cross(&f);
            (none, Rotation3::from_scaled_axis(w * p[0]) * (f - change * p[0]) - f)
        }
        "inner-lever-arm" => {
            (none, size_effect(s, &s.coupled_dither, [[p[0], 0.0, 0.0], [0.0, p[1], 0.0], [0.0, 0.0, p[2]]]))
        }
        "inner-lever-arm-tangential" => (
            none,
            size_effect(s, &s.coupled_dither, [[0.0, p[0], p[1]], [p[2], 0.0, p[3]], [p[4], p[5], 0.0]]),
        ),
        "dither-size-effect" => {
            let r = [[p[0], 0.0, 0.0], [0.0, p[1], 0.0], [0.0, 0.0, p[2]]];
            (none, size_effect(s, &s.dither, r) - size_effect(s, &none, r))
        }
        // in a stamped second the Earth turns and gravity pulls for 1 + c seconds
        "clock-scale" => {
            (s.earth_rate * (1.0 + p[0]) - s.earth_rate, s.up * (s.gravity * (1.0 + p[0]) - s.gravity))
        }
        "site-latitude" => {
            (s.earth_turn * p[0].sin(), s.up * (s.gravity + s.gravity_by_latitude * p[0]) - s.up * s.gravity)
        }
        "site-height" => (none, s.up * s.gravity_by_height * p[0]),
        "site-gravity" => (none, s.up * ((s.gravity + p[0]) - s.gravity)),
        // the errors that are modelled are those of the temperature that is read, the true ones those of the temperature
        "thermometer-lag" => (
            s.gyro_temperature_slope.component_mul(&(s.gyro_temperature_rate * p[1])),
            s.temperature_slope.component_mul(&(s.temperature_rate * p[0])),
        ),
        "thermometer-scale" => {
            let true_of = |read: &Vector3<f64>, s: f64| read / (1.0 + s);
            (
                s.gyro_temperature_slope
                    .component_mul(&(true_of(&s.gyro_temperature, p[1]) - s.gyro_temperature)),
                s.temperature_slope.component_mul(&(true_of(&s.temperature, p[0]) - s.temperature)),
            )
        }
        "thermometer-offset" => (s.gyro_temperature_slope * -p[1], s.temperature_slope * -p[0]),
        "dither-scale" => {
            let r = [[s.arms.x, 0.0, 0.0], [0.0, s.arms.y, 0.0], [0.0, 0.0, s.arms.z]];
            let felt = s.coupled_dither.component_div(&v(p).map(|k| (1.0 + k).powi(2)));
            (none, size_effect(s, &felt, r) - size_effect(s, &s.coupled_dither, r))
        }
        "reference-scale"
        | "outer-lever-arm"
        | "reference-delay"
        | "reference-misalignment"
        | "reference-tilt"
        | "table-orthogonality" => (none, none),
        _ => panic!("no model of {name}"),
    };
    gyros.iter().chain(&accelerometers).copied().collect()
}

/// What accelerometers at `r` feel beyond the sensitive centre, as a mean over the phases of three dithers.
fn size_effect(s: &Signals<f64>, dither: &Vector3<f64>, r: [[f64; 3]; 3]) -> Vector3<f64> {
    // Equally spaced phases average products of up to three sines and cosines exactly from four on.
    const PHASES: usize = 4;
    let amplitude = dither.map(|mean_square| (2.0 * mean_square).sqrt());
    let frequency = Vector3::new(410.0, 450.0, 490.0);
    let mut mean = Vector3::zeros();
    for k in 0..PHASES.pow(3) {
        let phase = Vector3::new(k % PHASES, k / PHASES % PHASES, k / PHASES.pow(2))
            .map(|step| TAU * (step as f64 + 0.3) / PHASES as f64);
        let w = s.rate + amplitude.component_mul(&phase.map(f64::sin));
        let wd = s.angular_acceleration
            + amplitude.component_mul(&phase.map(f64::cos)).component_mul(&frequency) * TAU;
        for i in 0..3 {
            let r = Vector3::from(r[i]);
            mean[i] += (w.cross(&w.cross(&r)) + wd.cross(&r))[i];
        }
    }
    mean / PHASES.pow(3) as f64
}
