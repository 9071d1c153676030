//! A simulated log, calibrated, gives the unit's parameters back.

use rig::Scenario;
use sinscal::{Filter, Mems30, Sins36P, Sins39P, Sins40P, Sins43B, Sins43P, Strapdown, Tracked35};

use crate::common::calibrate;

/// The default scenario with shorter rests, so that it is quick.
fn short(more: &str) -> Scenario {
    Scenario::parse(&format!("{more}\n[motion]\nstill = \"120 s\"\ndwell = \"60 s\"")).unwrap()
}

fn round_trip<F: Filter<Dynamics = Strapdown>>(scenario: &Scenario) {
    let scenario = scenario.clone().modelled_by::<F>();
    for seed in 1..=3 {
        let outcome = calibrate::<F>(&scenario, seed);
        let n = outcome.parameters as f64;
        assert!((outcome.nis - 1.0).abs() < 0.06, "{} NIS {}", F::NAME, outcome.nis);
        assert!(outcome.worst.0 < 4.5, "{}: {} sigma, {}", F::NAME, outcome.worst.0, outcome.worst.1);
        // six standard deviations of a sum of n squares
        assert!((outcome.nees - n).abs() < 6.0 * (2.0 * n).sqrt(), "{}: NEES {}", F::NAME, outcome.nees);
    }
}

#[test]
fn filters_of_the_paper() {
    let scenario = short("");
    round_trip::<Sins36P>(&scenario);
    round_trip::<Sins39P>(&scenario);
    round_trip::<Sins40P>(&scenario);
    round_trip::<Sins43P>(&scenario);
    round_trip::<Sins43B>(&scenario);
}

#[test]
fn filters_of_small_units() {
    let attitude = "[reference]\nattitude = true\n[population]\ngyro-scale = \"500 ppm\"\n\
        gyro-misalignment = \"1 mrad\"\ngyro-bias = \"1 deg/h\"\naccel-scale = \"500 ppm\"\n\
        accel-misalignment = \"1 mrad\"\naccel-bias = \"1 mg\"\nreference-misalignment = \"2 mrad\"\n\
        reference-tilt = \"0.2 mrad\"\n[gyro]\nrandom_walk = \"0.05 deg/sqrt(h)\"\nquantum = \"0 arcsec\"\n\
        [accelerometer]\nrandom_walk = \"50 ug/sqrt(Hz)\"";
    round_trip::<Mems30>(&short(attitude));
    round_trip::<Tracked35>(&short(attitude));
}

#[test]
fn other_paths_and_a_swing() {
    for path in ["nineteen-positions", "two-axis"] {
        let text = format!("[motion]\npath = \"{path}\"\nstill = \"120 s\"\ndwell = \"60 s\"");
        round_trip::<Sins43B>(&Scenario::parse(&text).unwrap());
    }
    let swing = "[motion]\npath = \"swing\"\nstart = \"ENU\"\nduration = \"600 s\"";
    let outcome = calibrate::<Sins43B>(&Scenario::parse(swing).unwrap(), 1);
    assert!((outcome.nis - 1.0).abs() < 0.1, "NIS {}", outcome.nis);
}

#[test]
fn the_full_dither_calibrates_like_its_mean() {
    let full = Scenario::parse(
        "[dither]\nmode = \"full\"\n[motion]\nstill = \"60 s\"\ndwell = \"20 s\"\nrate = \"20 deg/s\"\n\
         acceleration = \"40 deg/s^2\"",
    );
    let outcome = calibrate::<Sins43B>(&full.unwrap(), 1);
    assert!((outcome.nis - 1.0).abs() < 0.1, "NIS {}", outcome.nis);
    assert!(outcome.worst.0 < 4.5, "{} sigma, {}", outcome.worst.0, outcome.worst.1);
}

#[test]
fn a_missing_effect_shows() {
    // 36d-p on units with delay, temperature and dither
    let outcome = calibrate::<Sins36P>(&short(""), 1);
    assert!(outcome.nees > 1000.0, "NEES {}", outcome.nees);
}
