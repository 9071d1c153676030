//! The same scenario and seed give the same bits, and turning one thing off leaves the rest as it was.

use rig::{Scenario, Simulation};
use sinscal::Sample;

fn log(scenario: &Scenario, seed: u64) -> Vec<Sample> {
    Simulation::new(scenario, seed).unwrap().collect()
}

fn bits(log: &[Sample]) -> Vec<u64> {
    let mut bits = Vec::new();
    for s in log {
        let mut put = |x: f64| bits.push(x.to_bits());
        put(s.time);
        for v in [s.dtheta, s.dvel, s.temperature, s.gyro_temperature, s.dither] {
            v.iter().for_each(|x| put(*x));
        }
        for v in [s.reference.velocity, s.reference.position].into_iter().flatten() {
            v.iter().for_each(|x| put(*x));
        }
    }
    bits
}

fn short() -> Scenario {
    Scenario::parse("[motion]\nstill = \"5 s\"\ndwell = \"1 s\"\n[gyro]\nbias_instability = \"0.01 deg/h\"")
        .unwrap()
}

#[test]
fn same_seed_same_bits_on_any_number_of_threads() {
    let scenario = short();
    let first = bits(&log(&scenario, 5));
    std::thread::scope(|scope| {
        let runs: Vec<_> = (0..4).map(|_| scope.spawn(|| bits(&log(&scenario, 5)))).collect();
        for run in runs {
            assert!(run.join().unwrap() == first);
        }
    });
    assert!(bits(&log(&scenario, 6)) != first);
}

#[test]
fn a_clone_goes_on_where_the_original_stands() {
    let mut simulation = Simulation::new(&short(), 5).unwrap();
    simulation.by_ref().take(1234).for_each(drop);
    let clone: Vec<_> = simulation.clone().collect();
    let rest: Vec<_> = simulation.collect();
    assert!(bits(&clone) == bits(&rest));
}

#[test]
fn turning_one_thing_off_leaves_the_rest() {
    let with = short();
    let mut without = with.clone();
    without.keep_effects(|effect| effect != "accel-bias");
    let (a, b) = (with.unit(3), without.unit(3));
    for (effect, values) in b.effects() {
        assert_eq!(a.effects().get(effect), Some(values), "{effect}");
    }
    // the gyros do not notice what happens to the accelerometers
    let mut silent = with.clone();
    silent.accelerometer.white = 0.0;
    silent.reference.readings = false;
    for (a, b) in log(&with, 3).iter().zip(&log(&silent, 3)) {
        assert_eq!(a.dtheta, b.dtheta);
        assert!(b.reference.velocity == Some(nalgebra::Vector3::zeros()));
    }
}

#[test]
fn rate_changes_the_samples_and_not_the_unit() {
    let slow = short();
    let fast = slow.clone().with_rate(200.0).unwrap();
    assert_eq!(slow.unit(9), fast.unit(9));
    assert_eq!(fast.samples(), 4 * slow.samples());
    assert_eq!(fast.duration(), slow.duration());
}

#[test]
fn readings_stand_in_the_first_row_and_at_whole_seconds() {
    let log = log(&short(), 1);
    for (k, sample) in log.iter().enumerate() {
        let due = k == 0 || (k + 1) % 50 == 0;
        assert_eq!(sample.temperature.x.is_nan(), !due);
        assert_eq!(sample.dither.x.is_nan(), !due);
        assert_eq!(sample.reference.position.is_some(), due);
        assert!((sample.time - (k + 1) as f64 * 0.02).abs() < 1e-12);
    }
}

#[test]
fn another_run_is_the_same_unit_with_other_noise() {
    let first = short();
    let mut second = first.clone();
    second.run = 1;
    assert_eq!(first.unit(4), second.unit(4));
    let (a, b) = (log(&first, 4), log(&second, 4));
    assert!(a.iter().zip(&b).filter(|(a, b)| a.dvel == b.dvel).count() < 5);
}
