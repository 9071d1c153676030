//! For someone who calibrates from Rust: the loop over samples, the passes, the results.
//!
//! Run it with `cargo run --release --example calibrate_a_log`; the log is a simulated one. Samples of your own come from
//! wherever you have them: fill a [`Sample`](sinscal::Sample) for each.

use rig::{Scenario, Simulation};
use sinscal::prelude::*;
use sinscal::{Sins40P, Smoother};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scenario = Scenario::parse(
        r#"
        [motion]
        still = "120 s"
        dwell = "60 s"
        [dither]
        mode = "off"
        [population]
        gyro-scale = "20 ppm"
        gyro-bias = "0.03 deg/h"
        accel-scale = "50 ppm"
        accel-bias = "50 ug"
        outer-lever-arm = "0.2 m"
        inner-lever-arm = "40 mm"
        accel-delay = "0.5 ms"
        "#,
    )?;
    let log = Simulation::new(&scenario, 7)?;
    let description = log.description().clone();

    let mut run = Calibration::<Sins40P>::new(&description.setup(&[]))?;
    let mut smoother: Smoother<Sins40P> = Smoother::default();
    for sample in log {
        if let Some(update) = run.step_observed(&sample, &mut smoother)? {
            let expected = update.degrees_of_freedom as f64;
            if update.nis > expected + 8.0 * expected.sqrt() {
                println!(
                    "{:7.1} s: the reference disagrees, NIS {:.0} for {expected}",
                    update.time, update.nis
                );
            }
        }
    }

    println!("NIS per degree of freedom {:.2}", run.statistics().nis_per_dof());
    run.parameters(&mut |p| {
        let (value, sigma) = (p.value / p.info.sheet_scale, p.sigma / p.info.sheet_scale);
        if p.estimated {
            println!(
                "{:20} {:3} {value:9.3} +- {sigma:6.3} {}",
                p.info.block, p.info.component, p.info.sheet_unit
            );
        }
    });

    // the same by name: no index is written by hand
    let (x, p) = (run.estimate(), run.covariance());
    let delay = Sins40P::view(&x, &p).delay();
    println!("delay {:.3} +- {:.3} ms", delay.values()[0] * 1e3, delay.sigma(0) * 1e3);

    let smoothed = smoother.finish(&p)?;
    let first = smoothed[0].navigation.attitude.euler_angles();
    println!("attitude at the start, known from the whole run: {:.4?} rad", first);
    Ok(())
}
