//! The accelerometers' delay where the unit is accelerated and not only turned: its whole form is needed.

use rig::{Scenario, Simulation};
use sinscal::prelude::*;
use sinscal::{Compensator, Sins40P};

/// Shaken by 2 m/s^2 at 0.7 to 1.3 Hz while it rocks, with a reference that follows.
const SHAKEN: &str = "[imu]\nrate = \"100 Hz\"\n[motion]\npath = \"swing\"\nduration = \"300 s\"\n\
    [motion.swing]\namplitude = [\"20 deg\", \"25 deg\", \"15 deg\"]\n\
    [table]\nvibration_acceleration = [\"2 m/s^2\", \"1.5 m/s^2\", \"1 m/s^2\"]\n\
    vibration_frequency = [\"0.7 Hz\", \"1.1 Hz\", \"1.3 Hz\"]\n[reference]\nrate = \"10 Hz\"\n\
    [population]\naccel-delay = { mean = \"2 ms\", sigma = \"0.5 ms\" }\naccel-bias = \"50 ug\"\n\
    gyro-bias = \"0.03 deg/h\"\n";

fn shaken() -> Simulation {
    Simulation::new(&Scenario::parse(SHAKEN).unwrap(), 5).unwrap()
}

#[test]
fn a_shaken_unit_gives_its_delay_back() {
    let simulation = shaken();
    let (truth, description) = (simulation.truth().clone(), simulation.description().clone());
    let mut run = Box::new(Calibration::<Sins40P>::new(&description.setup(&[])).expect("a sound setup"));
    let samples: Vec<_> = simulation.collect();
    for pass in 0..2 {
        if pass > 0 {
            run.begin_pass();
        }
        for sample in &samples {
            run.step(sample).unwrap();
        }
    }
    let mut delay = (0.0, 0.0);
    run.parameters(&mut |p| {
        if p.info.block == "accel-delay" {
            delay = (p.value, p.sigma);
        }
    });
    let error = delay.0 - truth.value("accel-delay", 0);
    assert!(delay.1 < 1e-5, "sigma {}", delay.1);
    // smoothing over 10 ms hides a few parts in a thousand of motion at 1 Hz
    assert!(error.abs() < 3.0 * delay.1 + 0.01 * delay.0.abs(), "{} +- {}, error {error}", delay.0, delay.1);
}

/// The error that the block predicts against the simulator's exact shift, summed to velocity as a filter sees it.
#[test]
fn the_block_predicts_what_an_exact_shift_does() {
    let text = SHAKEN.replace("accel-delay = { mean = \"2 ms\", sigma = \"0.5 ms\" }\n", "");
    let mut late = Scenario::parse(SHAKEN).unwrap();
    let mut none = Scenario::parse(&text).unwrap();
    for scenario in [&mut late, &mut none] {
        (scenario.gyro, scenario.accelerometer) =
            (rig::NoiseFigures::default(), rig::NoiseFigures::default());
        scenario.population.retain(|p| p.effect.name() == "accel-delay");
    }
    let late = Simulation::new(&late, 5).unwrap();
    let tau = late.truth().value("accel-delay", 0);
    let mut compensator = Compensator::new(25.0);
    let parameters = [0.0; Sins40P::DIM];
    let (mut seen, mut turning, mut whole) = ([0.0; 3], [0.0; 3], [0.0; 3]);
    let (mut worst_whole, mut worst_turning) = (0.0_f64, 0.0_f64);
    for (k, (sample, without)) in late.zip(Simulation::new(&none, 5).unwrap()).enumerate() {
        compensator.read(&without);
        let (_, signals) = compensator.compensate::<Sins40P>(&without, 0.01, &parameters);
        if k < 100 {
            continue;
        }
        let mut error = [0.0; 6];
        <AccelDelay as sinscal::Effect>::error(&signals, &[tau], &mut error);
        let narrow = tau * signals.rate.cross(&signals.force);
        for i in 0..3 {
            seen[i] += sample.dvel[i] - without.dvel[i];
            whole[i] += error[3 + i] * 0.01;
            turning[i] += narrow[i] * 0.01;
            worst_whole = worst_whole.max((seen[i] - whole[i]).abs());
            worst_turning = worst_turning.max((seen[i] - turning[i]).abs());
        }
    }
    assert!(worst_whole < 0.15 * worst_turning, "{worst_whole} m/s of {worst_turning} m/s");
    assert!(worst_turning > 1e-3, "{worst_turning}");
}
