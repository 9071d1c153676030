//! Increments are integrals of the true signals.

use nalgebra::Vector3;
use rig::{Scenario, Simulation};
use sinscal::strapdown::{Before, Increments, NavigationState};

/// No noise, no quantisation, strong errors, among them a long delay.
fn quiet(motion: &str) -> Scenario {
    let walks = "[gyro]\nrandom_walk = \"0 rad/sqrt(s)\"\nquantum = \"0 rad\"\n\
                 [accelerometer]\nrandom_walk = \"0 m/s/sqrt(s)\"\nquantum = \"0 m/s\"\n";
    let errors = "[population]\ngyro-scale = \"1 %\"\naccel-quadratic = \"100 ug/g^2\"\naccel-delay = \"20 ms\"\n\
                  outer-lever-arm = \"0.3 m\"\ninner-lever-arm = \"5 cm\"\ninner-lever-arm-tangential = \"2 cm\"\n\
                  accel-temperature-rate = \"100 ug/(K/min)\"\naccel-bias-drift = \"10 ug/h\"\n";
    Scenario::parse(&format!("{motion}\n{walks}{errors}")).unwrap()
}

const TURNS: &str = "[motion]\nstill = \"2 s\"\ndwell = \"1 s\"";
const SWING: &str = "[motion]\npath = \"swing\"\nduration = \"30 s\"";

/// Samples at `rate` against sums of samples at 1 kHz.
fn compare(motion: &str, rate: u32) {
    let coarse = quiet(motion).with_rate(f64::from(rate)).unwrap();
    let fine = coarse.clone().with_rate(1000.0).unwrap();
    let mut fine = Simulation::new(&fine, 1).unwrap();
    for sample in Simulation::new(&coarse, 1).unwrap() {
        let (mut dtheta, mut dvel) = (Vector3::zeros(), Vector3::zeros());
        for part in fine.by_ref().take(1000 / rate as usize) {
            dtheta += part.dtheta;
            dvel += part.dvel;
        }
        assert!(
            (sample.dtheta - dtheta).norm() < 2e-9,
            "{motion} {} {}",
            sample.time,
            sample.dtheta - dtheta
        );
        assert!((sample.dvel - dvel).norm() < 2e-8, "{motion} {} {}", sample.time, sample.dvel - dvel);
    }
}

#[test]
fn at_any_rate_are_sums_of_those_of_a_kilohertz() {
    for rate in [10, 50, 200] {
        compare(TURNS, rate);
        compare(SWING, rate);
    }
    compare("[motion]\nstill = \"2 s\"\ndwell = \"1 s\"\nrounding = \"10 ms\"", 50);
}

#[test]
fn a_delayed_accelerometer_reads_what_a_punctual_one_read_earlier() {
    // by exactly one sample, constant temperature
    let motion = format!("{SWING}\n[temperature]\nprofile = \"constant\"\n[dither]\nmode = \"off\"\n");
    let mut late = quiet(&motion);
    late.keep_effects(|effect| !effect.ends_with("drift"));
    let mut punctual = late.clone();
    for population in &mut late.population {
        if population.effect.name() == "accel-delay" {
            (population.mean, population.sigma) = (vec![0.02], vec![0.0]);
        }
    }
    punctual.keep_effects(|effect| effect != "accel-delay" && !effect.ends_with("drift"));
    let late: Vec<_> = Simulation::new(&late, 1).unwrap().collect();
    let punctual: Vec<_> = Simulation::new(&punctual, 1).unwrap().collect();
    for (late, before) in late[1..].iter().zip(&punctual) {
        assert!((late.dvel - before.dvel).norm() < 1e-12, "{} {}", late.time, late.dvel - before.dvel);
    }
}

/// At 10 Hz the unit turns by 1.2 deg in an interval and back in a hundred: what coning does in the middle of an interval is not
/// what it did at its beginning, and the difference has the same sign in every swing (8e-6 rad after 1000 s).
#[test]
fn few_samples_are_enough_for_a_swing() {
    let swing = "[motion]\npath = \"swing\"\nstart = \"ENU\"\nduration = \"1000 s\"\n\
                 [motion.swing]\nfrequency = [\"0.04 Hz\", \"0.03 Hz\", \"0.04 Hz\"]\namplitude = \"30 deg\"";
    let mut scenario = quiet(swing).with_rate(10.0).unwrap();
    scenario.keep_effects(|_| false);
    let simulation = Simulation::new(&scenario, 1).unwrap();
    let (first, _) = simulation.motion(0.1);
    let mut navigation = NavigationState::at_rest(&scenario.site, first.attitude());
    let mut before = Before::nothing();
    let mut off = 0_f64;
    for (k, sample) in simulation.clone().enumerate() {
        let now = Increments { dtheta: sample.dtheta, dvel: sample.dvel };
        if k == 0 {
            before.follow(&now);
        } else {
            navigation.step(&now, &mut before, 0.1);
        }
        let (rotation, _) = simulation.motion(sample.time);
        off = off.max(navigation.attitude.angle_to(&rotation.attitude()));
    }
    println!("{off:e} rad, {} m/s", navigation.velocity.norm());
    // the velocity is what a tilt of 2e-7 makes of gravity
    assert!(off < 3e-7 && navigation.velocity.norm() < 2e-3);
}

#[test]
fn imperfections_of_the_table_move_the_unit_and_are_felt_alike() {
    // navigation with the increments follows the motion, whatever the table does
    let table = "[table]\nnon_orthogonality = \"30 arcsec\"\nwobble = \"20 arcsec\"\nvibration_acceleration = \"1 mg\"\n\
                 vibration_tilt = \"5 arcsec\"\nvibration_frequency = \"10 Hz\"";
    let mut scenario = quiet(&format!("{TURNS}\n{table}")).with_rate(200.0).unwrap();
    scenario.keep_effects(|effect| effect == "outer-lever-arm");
    let simulation = Simulation::new(&scenario, 1).unwrap();
    let (first, _) = simulation.motion(1.0 / 200.0);
    let mut navigation = NavigationState::at_rest(&scenario.site, first.attitude());
    let (position, velocity) = simulation.position(1.0 / 200.0);
    navigation.displace(&position);
    navigation.velocity = velocity;
    let mut before = Before::nothing();
    let mut begun = false;
    for sample in simulation.clone() {
        let now = Increments { dtheta: sample.dtheta, dvel: sample.dvel };
        if begun {
            navigation.step(&now, &mut before, 1.0 / 200.0);
        } else {
            before.follow(&now);
        }
        begun = true;
        let (rotation, _) = simulation.motion(sample.time);
        let (position, velocity) = simulation.position(sample.time);
        assert!(navigation.attitude.angle_to(&rotation.attitude()) < 5e-7, "{}", sample.time);
        assert!(
            (navigation.velocity - velocity).norm() < 1e-3,
            "{} {}",
            sample.time,
            navigation.velocity - velocity
        );
        assert!((navigation.position(&scenario.site) - position).norm() < 0.05, "{}", sample.time);
    }
}
