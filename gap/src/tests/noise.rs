//! The fit of the noise, on a log made by hand: six numbers that walk by themselves and are measured.

use super::{beginning, column, step};
use crate::linear::Noise;
use crate::noise::{TRUSTED, fit, price};
use crate::random::Stream;
use crate::recording::{CORE, Recording};

/// Attitude walks with the gyros, velocity with the accelerometers; both are measured every second. Standard deviations are those
/// times `actual`, stated as one.
fn recording(actual: &Noise, seed: u64) -> Recording {
    let mut stream = Stream::new(seed, "tests/noise");
    let mut truth = [0.0; 6];
    let mut steps = Vec::new();
    for k in 0..800 {
        let mut step = step(k as f64, 1, 6);
        for (i, truth) in truth.iter_mut().enumerate() {
            let stated = if i < 3 { &mut step.gyro_noise } else { &mut step.accel_noise };
            stated[i * CORE + i] = 1.0;
            *truth += stream.normal() * if i < 3 { actual.gyro } else { actual.accel };
            step.h[i * (CORE + 1) + i] = 1.0;
            step.z[i] = *truth + actual.reference * stream.normal();
        }
        steps.push(step);
    }
    Recording {
        columns: vec![column("accel-bias", true)],
        starts: vec![beginning(1)],
        steps,
        relaxing: Vec::new(),
        channels: Vec::new(),
    }
}

#[test]
fn scales_of_the_noise_are_found() {
    for (actual, seed) in [
        (Noise { gyro: 1.0, accel: 1.0, reference: 1.0 }, 1),
        (Noise { gyro: 2.0, accel: 1.0, reference: 1.0 }, 2),
        (Noise { gyro: 1.0, accel: 2.0, reference: 0.5 }, 3),
        (Noise { gyro: 0.5, accel: 1.5, reference: 2.0 }, 4),
    ] {
        let (found, hides) = fit(&recording(&actual, seed));
        for (found, actual) in
            [(found.gyro, actual.gyro), (found.accel, actual.accel), (found.reference, actual.reference)]
        {
            // 2400 numbers of each kind tell a scale to some per cent
            assert!((found / actual - 1.0).abs() < 0.12, "{seed}: {found} for {actual}");
        }
        assert!(!hides, "{seed}");
    }
}

#[test]
fn noise_far_beyond_what_is_stated_may_hide_anything() {
    let (found, hides) = fit(&recording(&Noise { gyro: 1.0, accel: 6.0, reference: 1.0 }, 5));
    assert!(hides && found.accel > TRUSTED, "{found:?}");
}

/// The normalised innovation squared of a sound filter is one for each number measured.
#[test]
fn innovations_are_normalised() {
    let (found, _) = price(&recording(&Noise::STATED, 6), &Noise::STATED).unwrap();
    let ratio = found.gram[0] / found.degrees_of_freedom as f64;
    assert_eq!(found.degrees_of_freedom, 4800);
    assert!((ratio - 1.0).abs() < 0.08, "{ratio}");
}
