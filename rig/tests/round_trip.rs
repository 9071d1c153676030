//! A simulated log, calibrated, gives the unit's parameters back.

use rig::{Scenario, Simulation};
use sinscal::{Calibration, Filter, Sins43B, Strapdown};

#[test]
fn default_scenario_calibrates() {
    let scenario = Scenario::default();
    let simulation = Simulation::new(&scenario, 1).unwrap();
    report::<Sins43B>(&simulation);
}

fn report<F: Filter<Dynamics = Strapdown>>(simulation: &Simulation) {
    let clock = std::time::Instant::now();
    let log: Vec<_> = simulation.clone().collect();
    println!("simulated {} in {:?}", log.len(), clock.elapsed());
    let mut calibration = Calibration::<F>::new(&simulation.description().setup(10.0, &[]));
    for _ in 0..2 {
        let clock = std::time::Instant::now();
        for sample in &log {
            calibration.step(sample).unwrap();
        }
        println!("NIS {} in {:?}", calibration.statistics().nis_per_dof(), clock.elapsed());
        calibration.parameters(&mut |p| {
            let truth = simulation.truth().of(&p.info);
            println!(
                "{:28} {:4} {:12.4e} {:12.4e} {:10.2e} {:6.2}",
                p.info.block, p.info.component, truth, p.value, p.sigma, (p.value - truth) / p.sigma
            );
        });
        calibration.begin_pass();
    }
}
