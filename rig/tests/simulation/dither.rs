//! Dither at its own rate and as its mean.

use nalgebra::Vector3;
use rig::{Scenario, Simulation};

/// Mean specific force of a noiseless unit that stands still.
fn mean_force(mode: &str, motion: &str) -> (Vector3<f64>, Vector3<f64>) {
    let scenario = Scenario::parse(&format!(
        "[imu]\nrate = \"200 Hz\"\n{motion}\n\
         [gyro]\nrandom_walk = \"0 deg/sqrt(h)\"\nquantum = \"0 arcsec\"\n\
         [accelerometer]\nrandom_walk = \"0 ug/sqrt(Hz)\"\nquantum = \"0 m/s\"\n[dither]\nmode = \"{mode}\"\n\
         [population]\ninner-lever-arm = {{ mean = [\"40 mm\", \"45 mm\", \"35 mm\"], sigma = \"5 mm\" }}\n\
         inner-lever-arm-tangential = \"10 mm\""
    ))
    .unwrap();
    let mut simulation = Simulation::new(&scenario, 2).unwrap();
    let n = simulation.samples() as f64;
    let arms = simulation.truth().vector("inner-lever-arm");
    (simulation.by_ref().map(|sample| sample.dvel).sum::<Vector3<f64>>() / n * 200.0, arms)
}

#[test]
fn the_mean_of_the_size_effect_is_the_same() {
    let still = "[motion]\npath = \"still\"\nduration = \"60 s\"";
    let (off, arms) = mean_force("off", still);
    let mean = mean_force("mean", still).0 - off;
    let full = mean_force("full", still).0 - off;
    for i in 0..3 {
        assert!(mean[i] * arms[i] < 0.0 && mean[i].abs() > 5e-5);
        assert!((full[i] / mean[i] - 1.0).abs() < 0.01, "{i}: {} {}", full[i], mean[i]);
    }
}

#[test]
fn and_while_the_unit_rocks() {
    let swing = "[motion]\npath = \"swing\"\nduration = \"100 s\"";
    let off = mean_force("off", swing).0;
    let mean = mean_force("mean", swing).0 - off;
    let full = mean_force("full", swing).0 - off;
    assert!((full - mean).norm() < 0.01 * mean.norm(), "{full} {mean}");
}

#[test]
fn filtered_dither_leaves_little_noise() {
    let text = "[imu]\nrate = \"200 Hz\"\n[motion]\npath = \"still\"\nduration = \"20 s\"\n\
                [accelerometer]\nrandom_walk = \"0 ug/sqrt(Hz)\"\nquantum = \"0 m/s\"";
    let scenario = |mode: &str| Scenario::parse(&format!("{text}\n[dither]\nmode = \"{mode}\"")).unwrap();
    let log = |mode| Simulation::new(&scenario(mode), 1).unwrap();
    let (mut square, mut n) = (0.0, 0.0);
    for (full, mean) in log("full").zip(log("mean")) {
        square += ((full.dvel - mean.dvel) * 200.0).norm_squared() / 3.0;
        n += 1.0;
    }
    // the size effect itself is 2.5e-4 m/s^2, here left with the 10 % modulation of a few cycles
    let rms = f64::sqrt(square / n);
    assert!((1e-6..4e-5).contains(&rms), "{rms}");
}
