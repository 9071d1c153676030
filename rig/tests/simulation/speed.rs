//! How long simulations take.

use std::time::{Duration, Instant};

use rig::{Scenario, Simulation};
use sinscal::EFFECTS;

use crate::common::can_be_given;

fn time(scenario: &Scenario) -> (u64, Duration) {
    let clock = Instant::now();
    let simulation = Simulation::new(scenario, 1).unwrap();
    let samples = simulation.samples();
    let sum: f64 = simulation.map(|sample| sample.dvel.x).sum();
    assert!(sum.is_finite());
    (samples, clock.elapsed())
}

#[test]
#[ignore = "a measurement, in release"]
fn all_effects_at_200_hz_take_less_than_two_seconds() {
    let mut text =
        String::from("[imu]\nrate = \"200 Hz\"\n[gyro]\nbias_instability = \"0.001 deg/h\"\n[population]\n");
    for effect in EFFECTS.iter().filter(|effect| can_be_given(effect.name())) {
        text += &format!("{} = \"1e-9 {}\"\n", effect.name(), effect.unit());
    }
    let all = Scenario::parse(&text).unwrap();
    let (samples, elapsed) = time(&all);
    println!("3765 s at 200 Hz, all effects: {samples} samples in {elapsed:.2?}");
    let quick = Scenario::default().with_rate(200.0).unwrap();
    println!("3765 s at 200 Hz, default: {:.2?}", time(&quick).1);
    let swing =
        Scenario::parse("[imu]\nrate = \"100 Hz\"\n[motion]\npath = \"swing\"\nduration = \"48 h\"").unwrap();
    let (samples, day) = time(&swing);
    println!("48 h of swing at 100 Hz: {samples} samples in {day:.2?}");
    let full = Scenario::parse("[imu]\nrate = \"200 Hz\"\n[dither]\nmode = \"full\"").unwrap();
    println!("3765 s at 200 Hz, dither at 16 kHz: {:.2?}", time(&full).1);
    assert!(elapsed < Duration::from_secs(2));
}
