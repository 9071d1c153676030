//! What `benches/instructions.sh` and `benches/stack.sh` count: one thing, so many times.

#[path = "../../case/mod.rs"]
mod case;
#[path = "../../case/wave.rs"]
mod wave;

use std::hint::black_box;
use std::process::ExitCode;

use calib_core::{Conventional, Dim, Form, Shape, Ud};
use case::{Case, N, case, cycle, factors};
use nalgebra::{UnitQuaternion, Vector3};
use sinscal::{
    Calibration, InitialAttitude, Reference, ReferenceSigma, Sample, SensorNoise, Setup, Sins43B, Site,
};
use wave::Wave;

/// Samples a second.
const RATE: f64 = 200.0;

/// Cycles of one form, one after the other.
fn cycles<C: Form>(case: &Case, mut p: [[f64; N]; N], times: u32) -> f64 {
    (0..times).map(|_| cycle::<C>(case, black_box(&mut p))).sum()
}

/// Cycles of a filter of some size.
fn grown<S: Shape, C: Form>(times: u32) -> f64 {
    let wave = Wave::<S>::new();
    let (mut cov, mut x) = (wave.start::<C>(), S::vector(0.0));
    (0..times).map(|_| wave.cycle::<C>(black_box(&mut cov), &mut x)).sum()
}

/// [`grown`] with so many states, `None` where that size was not foreseen.
fn states<C: Form>(states: &str, times: u32) -> Option<f64> {
    macro_rules! sizes {
        ($($n:literal),*) => {
            match states {
                $(stringify!($n) => Some(grown::<Dim<$n, 9, 6>, C>(times)),)*
                _ => None,
            }
        };
    }
    sizes!(15, 21, 30, 36, 43, 60, 90)
}

/// Samples of a unit that stands for ten seconds, turns for ten, and so on, without reference.
fn navigate(times: u32) -> f64 {
    let setup = Setup {
        rate: RATE,
        site: Site { latitude: 0.56, longitude: 2.07, height: 20.0 },
        initial: InitialAttitude {
            attitude: UnitQuaternion::identity(),
            level_sigma: 5e-4,
            heading_sigma: 2e-3,
        },
        reference: ReferenceSigma { velocity: 1e-3, position: 2e-3, attitude: 1e-4 },
        update_rate: 1.0,
        noise: SensorNoise { angle_random_walk: 3e-7, velocity_random_walk: 5e-5 },
        reference_temperature: 25.0,
        outer_lever: Vector3::zeros(),
        priors: &[],
    };
    let mut run = Box::new(Calibration::<Sins43B>::new(&setup));
    // errors as large as those of a unit, so that compensation has something to do
    let mut parameters = [0.0; N];
    parameters[9..].fill(1e-5);
    run.begin_pass_about(&parameters);
    let mut angle = 0.0_f64;
    for k in 1..=times {
        let rate = if k / 2000 % 2 == 1 { 0.17 } else { 0.0 };
        angle += rate / RATE;
        let sample = Sample {
            time: f64::from(k) / RATE,
            dtheta: Vector3::new(rate / RATE, 3.0e-7, 1.9e-7),
            dvel: Vector3::new(0.0, angle.sin(), angle.cos()) * (9.795 / RATE),
            temperature: Vector3::repeat(30.0),
            gyro_temperature: Vector3::repeat(f64::NAN),
            dither: Vector3::repeat(0.08),
            reference: Reference::default(),
        };
        if run.step(black_box(&sample)).is_err() {
            return f64::NAN;
        }
    }
    run.position().x
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [what, times] = arguments.as_slice() else {
        eprintln!("what (conventional, ud, navigation, ud:NUMBER OF STATES, ...) and how many times");
        return ExitCode::from(2);
    };
    let Ok(times) = times.parse() else { return ExitCode::from(2) };
    let case = case();
    let found = match what.split_once(':') {
        None if what == "conventional" => Some(cycles::<Conventional>(&case, case.p, times)),
        None if what == "ud" => Some(cycles::<Ud>(&case, factors(&case.p), times)),
        None if what == "navigation" => Some(navigate(times)),
        Some(("conventional", size)) => states::<Conventional>(size, times),
        Some(("ud", size)) => states::<Ud>(size, times),
        _ => None,
    };
    let Some(found) = found else {
        eprintln!("no such thing: {what}");
        return ExitCode::from(2);
    };
    println!("{found}");
    ExitCode::SUCCESS
}
