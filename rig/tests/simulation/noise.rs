//! The noise of readings has the size that the scenario states. Taking it away leaves every other number as it was, so that it is
//! what two runs of one unit differ by.

use nalgebra::Vector3;
use rig::{Scenario, Simulation};
use sinscal::Sample;

/// A quarter of an hour at rest, read at each of ten samples a second.
const REST: &str = "[imu]\nrate = \"10 Hz\"\n[motion]\npath = \"still\"\nduration = \"900 s\"\n";

fn log(more: &str) -> Vec<Sample> {
    let scenario = Scenario::parse(&format!("{REST}{more}")).expect("a sound scenario");
    Simulation::new(&scenario, 4).expect("a unit").collect()
}

/// Root mean square of what differs between two logs, over rows and axes.
fn apart(a: &[Sample], b: &[Sample], of: impl Fn(&Sample) -> Vector3<f64>) -> f64 {
    let squares: Vec<f64> = a.iter().zip(b).map(|(a, b)| (of(a) - of(b)).norm_squared() / 3.0).collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// Of 27 000 numbers the root mean square is known to 0.43 %: four of these.
fn has_size(found: f64, stated: f64) {
    assert!((found / stated - 1.0).abs() < 0.018, "{found} {stated}");
}

#[test]
fn of_the_reference() {
    let reference = |velocity: &str, position: &str, attitude: &str| {
        log(&format!(
            "[reference]\nrate = \"10 Hz\"\nattitude = true\nvelocity_sigma = \"{velocity} mm/s\"\n\
             position_sigma = \"{position} mm\"\nattitude_sigma = \"{attitude} mrad\"\n"
        ))
    };
    let (small, large) = (reference("3", "4", "3"), reference("6", "10", "5"));
    // the same numbers times another size
    has_size(apart(&small, &large, |s| s.reference.velocity.expect("a reading")), 3e-3);
    has_size(apart(&small, &large, |s| s.reference.position.expect("a reading")), 6e-3);
    let turn = |s: &Sample| s.reference.attitude.expect("a reading");
    let first = turn(&small[0]).inverse();
    has_size(apart(&small, &large, |s| (first * turn(s)).scaled_axis()), 2e-3);
}

#[test]
fn of_thermometers_and_of_the_dither() {
    let readings = |kelvin: &str, rate: &str| {
        log(&format!(
            "[temperature]\nrate = \"10 Hz\"\nthermometer_noise = \"{kelvin} K\"\n\
             [dither]\nrate = \"10 Hz\"\nreading_noise = \"{rate} rad/s\"\n"
        ))
    };
    let (quiet, noisy) = (readings("0", "0"), readings("0.5", "0.002"));
    has_size(apart(&quiet, &noisy, |s| s.temperature), 0.5);
    has_size(apart(&quiet, &noisy, |s| s.gyro_temperature), 0.5);
    has_size(apart(&quiet, &noisy, |s| s.dither), 0.002);
}

#[test]
fn of_the_sensors() {
    let sensors = |gyro: &str, accelerometer: &str| {
        log(&format!(
            "[gyro]\nquantum = \"0 rad\"\nrandom_walk = \"{gyro} rad/sqrt(s)\"\n\
             [accelerometer]\nquantum = \"0 m/s\"\nrandom_walk = \"{accelerometer} m/s/sqrt(s)\"\n"
        ))
    };
    let (quiet, noisy) = (sensors("1e-9", "1e-9"), sensors("2e-5", "3e-4"));
    // an interval of a tenth of a second has the root of that of the density
    has_size(apart(&quiet, &noisy, |s| s.dtheta), 2e-5 * 0.1_f64.sqrt());
    has_size(apart(&quiet, &noisy, |s| s.dvel), 3e-4 * 0.1_f64.sqrt());
}
