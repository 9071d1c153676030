//! For someone whose sensor does what no block knows: a block of one's own, with its Jacobian checked.
//!
//! The effect: accelerometers behind a rubber mount read more the faster the unit turns, `d_f_i = k_i |omega| f_i`, and
//! the mount's stiffness wanders: k forgets within ten minutes. Run it with `cargo run --release --example add_a_block`.

use sinscal::check::{Model, compare, dual_jacobian};
use sinscal::prelude::*;
use sinscal::{FORCE, Signals};

/// Scale error of each accelerometer by the size of the angular rate, s: first-order Gauss-Markov.
pub struct MountSoftness;

/// What k forgets within, s.
const CORRELATION_TIME: f64 = 600.0;
/// Standard deviation of k, s.
const SIGMA: f64 = 1e-4;
/// How k wanders: the density keeps its standard deviation.
const WANDER: Relaxation<f64> =
    Relaxation { rate: 1.0 / CORRELATION_TIME, density: 2.0 * SIGMA * SIGMA / CORRELATION_TIME };

impl Block for MountSoftness {
    type Dynamics = Strapdown;
    type View<'a, T: Real> = BlockView<'a, Self, T>;
    const NAME: &'static str = "mount-softness";
    const DIM: usize = 3;
    const RELAXATIONS: &'static [(usize, Relaxation<f64>)] = &[(0, WANDER), (1, WANDER), (2, WANDER)];

    fn states(visit: &mut dyn FnMut(StateInfo)) {
        for component in ["x", "y", "z"] {
            visit(StateInfo {
                block: Self::NAME,
                component,
                unit: "s",
                prior_sigma: SIGMA,
                sheet_unit: "ppm/(rad/s)",
                sheet_scale: 1e-6,
            });
        }
    }

    fn input_jacobian<T: Real>(s: &Signals<T>, put: &mut impl FnMut(usize, usize, T)) {
        let speed = s.rate.norm();
        for i in 0..3 {
            put(FORCE + i, i, speed * s.force[i]);
        }
    }
}

/// The effect as one would write it down, for the check.
struct Reading {
    signals: Signals<f64>,
}

impl Model<3, 3> for Reading {
    fn value<T: Real>(&self, k: &[T; 3]) -> [T; 3] {
        let w = self.signals.rate.map(T::of);
        let f = self.signals.force.map(T::of);
        let speed = (w.x * w.x + w.y * w.y + w.z * w.z).sqrt();
        core::array::from_fn(|i| f[i] * (T::one() + k[i] * speed))
    }
}

#[derive(StateBlocks)]
#[filter(measures(velocity, position))]
struct MountedUnit {
    #[base]
    unit: sinscal::Sins36P,
    mount: MountSoftness,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let signals = Signals {
        rate: nalgebra::Vector3::new(0.2, -0.1, 0.3),
        force: nalgebra::Vector3::new(1.0, -2.0, 9.5),
        ..Signals::default()
    };
    let mut jacobian = [[0.0; 3]; 3];
    MountSoftness::input_jacobian(&signals, &mut |input, state, value| {
        jacobian[input - FORCE][state] = value
    });
    compare(&jacobian, &dual_jacobian(&Reading { signals }, &[0.0; 3]), 1e-12)?;
    println!("the Jacobian of MountSoftness is right; {} has {} states", MountedUnit::NAME, MountedUnit::DIM);
    Ok(())
}
