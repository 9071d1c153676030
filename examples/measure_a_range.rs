//! A measurement of one's own: no position, but distances to three beacons, as a total station or UWB anchors give them.
//!
//! Its residual and Jacobian are written once, of where the observed point is; every block of the catalogue that acts on what is
//! seen (the outer lever arm here) acts on the ranges too, by the chain rule. The program checks the Jacobian, then calibrates a
//! simulated unit. Run it with `cargo run --release --example measure_a_range`.

use nalgebra::Vector3;
use rig::{Scenario, Simulation};
use sinscal::check::{Model, compare, dual_jacobian};
use sinscal::prelude::*;
use sinscal::{Point, channel, own_columns};

/// Where the beacons stand from the site origin, east, north, up, m: at right angles, so that the noise of the simulated position
/// makes independent noise of the three distances.
const BEACONS: [[f64; 3]; 3] = [[6.0, 8.0, 0.0], [-8.0, 6.0, 0.0], [0.0, 0.0, 5.0]];
/// Standard deviation of a distance, m.
const SIGMA: f64 = 1e-3;

/// Distances to the three beacons.
struct Ranges;

/// From a beacon to the observed point.
fn way<T: Real>(at: &Point<T>, beacon: usize) -> Vector3<T> {
    at.point_position - Vector3::from(BEACONS[beacon]).map(T::of)
}

impl Measurement for Ranges {
    type Dynamics = Strapdown;
    const INFO: MeasurementInfo = MeasurementInfo {
        name: "ranges",
        components: &["1", "2", "3"],
        unit: "m",
        columns: &["range_1_m", "range_2_m", "range_3_m"],
        sigma: SIGMA,
        channels: None,
    };

    fn residual<T: Real>(at: &Point<T>, reading: &[T], put: &mut impl FnMut(usize, T)) {
        for beacon in 0..3 {
            put(beacon, way(at, beacon).norm() - reading[beacon]);
        }
    }

    fn jacobian<T: Real>(at: &Point<T>, put: &mut impl FnMut(usize, usize, T)) {
        for beacon in 0..3 {
            let direction = way(at, beacon).normalize();
            for axis in 0..3 {
                put(beacon, channel::POSITION + axis, direction[axis]);
            }
        }
    }
}

/// The residuals by the position of the observed point, for the check.
struct Residuals {
    at: Point<f64>,
}

impl Model<3, 3> for Residuals {
    fn value<T: Real>(&self, position: &[T; 3]) -> [T; 3] {
        let at = Point { point_position: Vector3::from(*position), ..self.at.map(T::of) };
        let mut residuals = [T::zero(); 3];
        Ranges::residual(&at, &[T::zero(); 3], &mut |row, z| residuals[row] = z);
        residuals
    }
}

#[derive(StateBlocks)]
#[filter(name = "ranged", measures(velocity, Ranges))]
struct Ranged {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    gyro: GyroErrors,
    accel: AccelErrors,
    outer_lever: OuterLeverArm,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let at = Point { point_position: Vector3::new(0.4, -0.3, 0.2), ..Point::default() };
    let mut jacobian = [[0.0; 3]; 3];
    Ranges::jacobian(&at, &mut |row, channel, value| jacobian[row][channel - channel::POSITION] = value);
    let exact = dual_jacobian(&Residuals { at }, &[0.4, -0.3, 0.2]);
    compare(&jacobian, &exact, 1e-12)?;
    println!("the Jacobian of the ranges is right");

    let scenario = Scenario::parse(
        r#"
        [motion]
        still = "120 s"
        dwell = "60 s"
        [dither]
        mode = "off"
        [reference]
        position_sigma = "1 mm"
        [population]
        gyro-scale = "20 ppm"
        gyro-bias = "0.03 deg/h"
        accel-scale = "50 ppm"
        accel-bias = "50 ug"
        outer-lever-arm = "0.2 m"
        "#,
    )?;
    let log = Simulation::new(&scenario, 7)?;
    let (description, truth) = (log.description().clone(), log.truth().clone());
    println!(
        "columns that a log must have for it: {}",
        own_columns::<Ranged>().collect::<Vec<_>>().join(", ")
    );

    let mut run = Calibration::<Ranged>::new(&description.setup(&[]))?;
    let mut samples: Vec<sinscal::Sample> = log.collect();
    for sample in &mut samples {
        // what the beacons would have said
        if let Some(position) = sample.reference.position.take() {
            for (beacon, range) in BEACONS.iter().zip(&mut sample.reference.own) {
                *range = (position - Vector3::from(*beacon)).norm();
            }
        }
    }
    for pass in 0..2 {
        if pass > 0 {
            run.begin_pass();
        }
        for sample in &samples {
            run.step(sample)?;
        }
    }
    println!("NIS per degree of freedom {:.2}", run.statistics().nis_per_dof());
    let (mut errors, mut count) = (0.0, 0.0);
    run.parameters(&mut |p| {
        let (scale, true_value) = (p.info.sheet_scale, truth.of(&p.info));
        if p.estimated {
            println!(
                "{:18} {:3} {:10.3} +- {:6.3} {:8} truth {:10.3}",
                p.info.block,
                p.info.component,
                p.value / scale,
                p.sigma / scale,
                p.info.sheet_unit,
                true_value / scale
            );
            errors += ((p.value - true_value) / p.sigma).powi(2);
            count += 1.0;
        }
    });
    println!("mean square of error over sigma, {count} parameters: {:.2}", errors / count);
    Ok(())
}
