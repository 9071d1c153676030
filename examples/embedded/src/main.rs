//! For someone with a small computer: a declared filter without the standard library and without an allocator.
//!
//! The unit rests for a minute, its vertical accelerometer reads 5 mm/s^2 too much, and the filter finds that. Here the samples
//! are made up; on your board they come from the sensors' interrupt. The exit code is 0 when the bias was found.
//! `bash examples/embedded/report.sh` says what it takes of memory.
#![no_std]
#![no_main]

use nalgebra::{UnitQuaternion, Vector3};
use sinscal::prelude::*;
use sinscal::{InitialAttitude, Reference, ReferenceSigma, Sample, SensorNoise, Setup, Site};

/// Biases, and nothing else.
#[cfg(not(feature = "full"))]
#[derive(StateBlocks)]
#[filter(measures(velocity, position))]
struct Unit {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    gyro_bias: GyroBias,
    accel_bias: AccelBias,
}

/// Everything that a laser-gyro unit may have.
#[cfg(feature = "full")]
type Unit = sinscal::Sins43B;

const RATE: f64 = 50.0;
/// What is too much along the vertical, m/s^2.
const BIAS: f64 = 5e-3;
/// Earth's rate towards north and up at 32 deg of latitude, rad/s; gravity there, m/s^2.
const EARTH: [f64; 2] = [6.18e-5, 3.87e-5];
const GRAVITY: f64 = 9.7946;

/// A minute at rest; the number of what went wrong, else 0.
#[inline(never)]
fn run() -> i32 {
    let setup = Setup {
        priors: &[("accel-bias", 0.05), ("outer-lever-arm", 1e-3)],
        ..Setup::new(
            RATE,
            Site { latitude: 0.56, longitude: 2.07, height: 20.0 },
            InitialAttitude { attitude: UnitQuaternion::identity(), level_sigma: 5e-4, heading_sigma: 2e-3 },
            ReferenceSigma { velocity: 1e-3, position: 2e-3, attitude: 1e-4 },
            SensorNoise { angle_random_walk: 3e-7, velocity_random_walk: 5e-5 },
        )
    };
    let Ok(mut run) = Calibration::<Unit>::new(&setup) else { return 1 };
    for k in 1..=3000 {
        let sample = Sample {
            time: f64::from(k) / RATE,
            dtheta: Vector3::new(0.0, EARTH[0], EARTH[1]) / RATE,
            dvel: Vector3::new(0.0, 0.0, GRAVITY + BIAS) / RATE,
            temperature: Vector3::repeat(f64::NAN),
            gyro_temperature: Vector3::repeat(f64::NAN),
            dither: Vector3::repeat(f64::NAN),
            reference: Reference {
                velocity: Some(Vector3::zeros()),
                position: Some(Vector3::zeros()),
                ..Reference::default()
            },
        };
        if run.step(&sample).is_err() {
            return 1;
        }
    }
    let mut verdict = 2;
    run.parameters(&mut |p| {
        // gravity at the site is known to 2e-4 m/s^2 here; the rest of the bias must be found
        if p.info.block == "accel-bias" && p.info.component == "z" {
            verdict = if (p.value - BIAS).abs() < 5e-4 { 0 } else { 3 };
        }
    });
    verdict
}

/// What the C start-up code calls; on a board, your reset handler does.
#[unsafe(no_mangle)]
extern "C" fn main(arguments: i32, _: *const *const u8) -> i32 {
    if cfg!(feature = "measure") { below(arguments == 1) } else { run() }
}

/// Runs the filter, or nothing, below a megabyte of stack: how much more the one needs than the other is the filter's stack. Without
/// the megabyte it would hide in what the system used before.
#[inline(never)]
fn below(filter: bool) -> i32 {
    let ballast = core::hint::black_box([0_u8; 1 << 20]);
    let verdict = if filter { run() } else { 0 };
    verdict + i32::from(core::hint::black_box(&ballast)[0])
}

/// Errors are values; a panic would be a mistake in this file.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    loop {}
}


// Where there is a system, the C library starts the program and copies memory.
#[cfg(not(target_os = "none"))]
#[link(name = "c")]
unsafe extern "C" {}
