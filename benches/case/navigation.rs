//! Navigation between updates: compensation, mechanisation, sensitivities, what `[Phi Psi]` takes in.

use nalgebra::{UnitQuaternion, Vector3};
use sinscal::{
    Calibration, InitialAttitude, Reference, ReferenceSigma, Sample, SensorNoise, Setup, Sins43B, Site,
};

/// Samples a second.
const RATE: f64 = 200.0;
/// After which the motion is as it was in the beginning.
pub(crate) const PERIOD: u32 = 4000;

/// A unit that stands for ten seconds, turns for ten, and so on, without reference.
pub(crate) struct Navigation {
    run: Box<Calibration<Sins43B>>,
    angle: f64,
    samples: u32,
}

impl Navigation {
    pub(crate) fn new() -> Self {
        let setup = Setup::new(
            RATE,
            Site { latitude: 0.56, longitude: 2.07, height: 20.0 },
            InitialAttitude { attitude: UnitQuaternion::identity(), level_sigma: 5e-4, heading_sigma: 2e-3 },
            ReferenceSigma { velocity: 1e-3, position: 2e-3, attitude: 1e-4 },
            SensorNoise { angle_random_walk: 3e-7, velocity_random_walk: 5e-5 },
        );
        let mut run = Box::new(Calibration::new(&setup).expect("a sound setup"));
        // errors as large as those of a unit, so that compensation has something to do
        let mut parameters = [0.0; Sins43B::DIM];
        parameters[9..].fill(1e-5);
        run.begin_pass_about(&parameters);
        Self { run, angle: 0.0, samples: 0 }
    }

    /// One more sample; whether that went well.
    pub(crate) fn step(&mut self) -> bool {
        self.samples += 1;
        let turns = self.samples % PERIOD >= PERIOD / 2;
        let rate = if turns { 0.17 } else { 0.0 };
        self.angle += rate / RATE;
        let sample = Sample {
            time: f64::from(self.samples) / RATE,
            dtheta: Vector3::new(rate / RATE, 3.0e-7, 1.9e-7),
            dvel: Vector3::new(0.0, self.angle.sin(), self.angle.cos()) * (9.795 / RATE),
            temperature: Vector3::repeat(30.0),
            gyro_temperature: Vector3::repeat(f64::NAN),
            dither: Vector3::repeat(0.08),
            reference: Reference::default(),
        };
        self.run.step(&sample).is_ok()
    }
}
