//! Figures of sections 3.2 and 3.3: the size effect of dither (Eq. 8-11) and the delay (Fig. 3).

use nalgebra::{Matrix3, Vector3};
use rig::analyses::delay;
use rig::analyses::size_effect::{Dithering, sweep};

use reports::{Curve, Figure, Style};

/// A dithering x gyro, with accelerometers 4 cm along and 1 cm across their axes.
pub(super) fn dithering() -> Dithering {
    Dithering {
        axis: 0,
        amplitude: 0.08,
        frequency: 400.0,
        arms: Matrix3::from_element(0.01) + Matrix3::from_diagonal(&Vector3::repeat(0.03)),
    }
}

const AXES: [&str; 3] = ["x", "y", "z"];
/// Micro-g in m/s^2.
const MICRO_G: f64 = 9.806_65e-6;

/// The figures of the size effect.
pub(super) fn figures() -> Vec<Figure> {
    let dithering = dithering();
    let (seconds, points) = (50.0, 100);
    let drift = dithering.drift(seconds, points);
    let over_time = |of: fn(&rig::analyses::size_effect::Drift) -> [Vector3<f64>; 2]| {
        let mut curves = Vec::new();
        // the accelerometer on the dithering axis feels nothing
        for axis in 1..3 {
            for (name, style, which) in [("simulated", Style::Full, 0), ("Eq. 9", Style::Dashed, 1)] {
                let points = drift.iter().map(|d| (d.time, of(d)[which][axis])).collect();
                curves.push(Curve::new(format!("{} {name}", AXES[axis]), style, points));
            }
        }
        curves
    };
    let frequencies: Vec<f64> = (0..=30).map(|k| 300.0 + 10.0 * f64::from(k)).collect();
    let amplitudes: Vec<f64> = (1..=20).map(|k| 0.01 * f64::from(k)).collect();
    let sweep = sweep(&dithering, &frequencies, &amplitudes);
    let constants = |of: &[(f64, Vector3<f64>)]| {
        (1..3)
            .map(|axis| {
                let points = of.iter().map(|(x, constant)| (*x, constant[axis] / MICRO_G)).collect();
                Curve::new(format!("accelerometer {}", AXES[axis]), Style::Full, points)
            })
            .collect()
    };
    vec![
        Figure {
            file: "equation-09-velocity".into(),
            title: "Dither about x: velocity error (Eq. 9)".into(),
            axes: ["time, s", "velocity error, m/s"],
            curves: over_time(|d| [d.simulated_velocity, d.velocity]),
        },
        Figure {
            file: "equation-09-position".into(),
            title: "Dither about x: position error (Eq. 9)".into(),
            axes: ["time, s", "position error, m"],
            curves: over_time(|d| [d.simulated_position, d.position]),
        },
        Figure {
            file: "equation-08-frequency".into(),
            title: "Constant of the size effect over the frequency of dither (Eq. 8)".into(),
            axes: ["frequency, Hz", "constant, micro-g"],
            curves: constants(&sweep.by_frequency),
        },
        Figure {
            file: "equation-08-amplitude".into(),
            title: "Constant of the size effect over the amplitude of dither (Eq. 8)".into(),
            axes: ["amplitude, rad/s", "constant, micro-g"],
            curves: constants(&sweep.by_amplitude),
        },
    ]
}

/// Fig. 3: errors of velocity and position that a delay makes of a turn about the level east axis.
pub(super) fn delay_figures(errors: &[delay::Errors]) -> Vec<Figure> {
    let curves = |of: fn(&delay::Errors) -> [Vector3<f64>; 2]| {
        let mut curves = Vec::new();
        for (axis, name) in ["east", "north", "up"].into_iter().enumerate() {
            for (kind, style, which) in [("simulated", Style::Full, 0), ("Eq. 21", Style::Dashed, 1)] {
                let points = errors.iter().map(|e| (e.time, of(e)[which][axis])).collect();
                curves.push(Curve::new(format!("{name} {kind}"), style, points));
            }
        }
        curves
    };
    vec![
        Figure {
            file: "figure-03-velocity".into(),
            title: "Accelerometer delay of 1 ms: velocity error (Fig. 3)".into(),
            axes: ["time, s", "velocity error, m/s"],
            curves: curves(|e| [e.simulated_velocity, e.velocity]),
        },
        Figure {
            file: "figure-03-position".into(),
            title: "Accelerometer delay of 1 ms: position error (Fig. 3)".into(),
            axes: ["time, s", "position error, m"],
            curves: curves(|e| [e.simulated_position, e.position]),
        },
    ]
}
