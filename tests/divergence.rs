//! A filter that breaks down says so, with the time and the channel, and never goes on silently.

use nalgebra::Vector3;
use rig::{Scenario, Simulation};
use sinscal::{Block, Calibration, Conventional, Diverged, Form, Sample, Sins43B, Ud};

/// When a sound log is spoiled, s.
const SPOILED: f64 = 31.5;

fn log() -> (Simulation, Vec<Sample>) {
    let scenario = "[imu]\nrate = \"10 Hz\"\n[motion]\npath = \"turns\"\nstill = \"20 s\"\ndwell = \"10 s\"\n\
                    turns = [{ axis = \"x\", angle = \"90 deg\" }, { axis = \"y\", angle = \"90 deg\" }]";
    let simulation = Simulation::new(&Scenario::parse(scenario).expect("a scenario"), 1).expect("a unit");
    (simulation.clone(), simulation.collect())
}

/// Runs over a log whose samples from [`SPOILED`] on are changed.
fn run<C: Form>(spoil: fn(&mut Sample)) -> Result<(), Diverged> {
    let (simulation, mut log) = log();
    log.iter_mut().filter(|sample| sample.time >= SPOILED).for_each(spoil);
    let mut calibration =
        Calibration::<Sins43B, C>::new(&simulation.description().setup(&[])).expect("a sound setup");
    let end = log.last().expect("samples").time;
    assert!(end > SPOILED + 2.0 && Sins43B::NAME == "43d-b");
    log.iter().try_for_each(|sample| calibration.step(sample).map(drop))
}

#[test]
fn a_run_that_breaks_down_names_time_and_channel() {
    type Case = (fn(&mut Sample), &'static str);
    let cases: [Case; 4] = [
        (|sample| sample.dtheta.x = f64::NAN, "velocity"),
        (|sample| sample.dvel.z = f64::INFINITY, "velocity"),
        (|sample| sample.reference.position = Some(Vector3::repeat(f64::NAN)), "position"),
        (|sample| sample.reference.velocity = Some(Vector3::new(0.0, f64::NAN, 0.0)), "velocity"),
    ];
    for (number, (spoil, channel)) in cases.into_iter().enumerate() {
        for found in [run::<Conventional>(spoil), run::<Ud>(spoil)] {
            let found = found.expect_err("a run over numbers that are none");
            // at the first reading of the reference after it, which comes once a second
            assert!((SPOILED..SPOILED + 1.1).contains(&found.time), "case {number}: {found:?}");
            assert!(found.channel.contains(channel), "case {number}: {found:?}");
            assert!(found.to_string().contains(&format!("diverged at {:.2} s", found.time)), "{found}");
        }
    }
    assert_eq!(run::<Conventional>(|_| {}), Ok(()), "the log is sound");
}

/// Priors so wide that no arithmetic carries them break the covariance down, and that is told at the first reading.
#[test]
fn a_covariance_that_breaks_down_is_told() {
    let (simulation, log) = log();
    let wide = |_, _: &sinscal::StateInfo, sigma: f64| sigma * 1e12;
    let mut calibration = Calibration::<Sins43B>::with_prior(&simulation.description().setup(&[]), wide);
    let ended = log.iter().try_for_each(|sample| calibration.step(sample).map(drop));
    let found = ended.expect_err("a covariance of thirty orders of magnitude");
    assert!(found.time < SPOILED && !found.channel.is_empty(), "{found:?}");
}
