//! Coarse alignment against simulated still stretches.

use rig::{Scenario, Simulation};
use sinscal::{AlignError, Aligner, SensorNoise};

fn simulation(still: &str) -> Simulation {
    let text = format!("[motion]\nstart = \"EUS\"\nstill = \"{still}\"\ndwell = \"30 s\"\n");
    Simulation::new(&Scenario::parse(&text).expect("a scenario"), 3).expect("a simulation")
}

fn aligner(simulation: &Simulation, gyro_bias: f64) -> Aligner {
    let setup = simulation.description().setup(&[]);
    Aligner::new(setup.site, setup.rate, setup.noise, gyro_bias, 1e-3)
}

#[test]
fn the_attitude_is_found_within_its_sigmas() {
    let simulation = simulation("300 s");
    let mut aligner = aligner(&simulation, 2.4e-7);
    let truth = simulation.motion(0.0).0.attitude();
    let mut used = 0;
    for sample in simulation {
        if !aligner.push(&sample) {
            break;
        }
        used += 1;
    }
    assert!(used > 290 * 50 && used < 310 * 50, "stopped at the first turn, after {used} samples");
    let found = aligner.finish().expect("an attitude");
    // C_hat = (I - [phi x]) C
    let phi = -(found.attitude * truth.inverse()).scaled_axis();
    assert!(phi.x.hypot(phi.y) < 4.0 * found.level_sigma, "{phi:?}");
    assert!(phi.z.abs() < 4.0 * found.heading_sigma, "{phi:?}");
    assert!(found.level_sigma < 2e-4 && found.heading_sigma < 1e-2);
}

#[test]
fn what_stands_in_the_way_is_said() {
    let simulation = simulation("2 s");
    let mut aligner = aligner(&simulation, 2.4e-7);
    for sample in simulation {
        if !aligner.push(&sample) {
            break;
        }
    }
    assert!(matches!(aligner.finish(), Err(AlignError::NotStill { still }) if still < 5.0));
    assert!(aligner.finish().unwrap_err().to_string().contains("[initial]"));
}

#[test]
fn a_mems_unit_does_not_find_north() {
    let simulation = simulation("60 s");
    let setup = simulation.description().setup(&[]);
    let noise = SensorNoise { angle_random_walk: 1e-4, velocity_random_walk: 1e-3 };
    let mut aligner = Aligner::new(setup.site, setup.rate, noise, 1e-3, 0.1);
    for sample in simulation.take(3000) {
        aligner.push(&sample);
    }
    assert!(matches!(aligner.finish(), Err(AlignError::HeadingUnknown { sigma }) if sigma > 1.0));
}
