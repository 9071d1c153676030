//! For someone who knows PSINS: its calibration demonstration, simulated here and calibrated with a declaration of two fields.
//!
//! Run it with `cargo run --release --example psins`.

use nalgebra::{UnitQuaternion, Vector3};
use rig::{Scenario, Simulation};
use sinscal::prelude::*;

/// 40D-P with all nine lever arms of the accelerometers.
#[derive(StateBlocks)]
#[filter(name = "46d", measures(velocity, position))]
struct Sins46 {
    #[base]
    sins: sinscal::Sins40P,
    tangential: InnerLeverArmTangential,
}

/// Pitch 1, roll -91, yaw -91 deg, as PSINS applies them: `C_bn = Rz(yaw) Rx(pitch) Ry(roll)`.
fn start() -> UnitQuaternion<f64> {
    let about =
        |axis: Vector3<f64>, degrees: f64| UnitQuaternion::from_scaled_axis(axis * degrees.to_radians());
    about(Vector3::z(), -91.0) * about(Vector3::x(), 1.0) * about(Vector3::y(), -91.0)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut scenario = Scenario::parse(include_str!("scenario.toml"))?;
    scenario.motion.start = start();
    let simulation = Simulation::new(&scenario, 1)?;
    let truth = simulation.truth().clone();
    let mut run = Box::new(Calibration::<Sins46>::new(&simulation.description().setup(&[]))?);
    let samples: Vec<_> = simulation.collect();
    for pass in 0..2 {
        if pass > 0 {
            run.begin_pass();
        }
        for sample in &samples {
            run.step(sample)?;
        }
    }
    // the common shift of the accelerometers and of the observed point, which no log shows
    let mut shift = Vector3::zeros();
    run.parameters(&mut |p| {
        let (sheet, error) = (p.info.sheet_scale, p.value - truth.of(&p.info));
        println!(
            "{:27} {:3} {:10.4} {:8.4} off {}",
            p.info.block,
            p.info.component,
            p.value / sheet,
            error / sheet,
            p.info.sheet_unit
        );
        if let ("outer-lever-arm", Some(axis)) =
            (p.info.block, ["x", "y", "z"].iter().position(|c| *c == p.info.component))
        {
            shift[axis] = error;
        }
    });
    println!("lever arms are off by a common shift that no log shows: {:.2?} mm", (shift * 1e3).as_slice());
    Ok(())
}
