//! For someone whose sensor does what no block knows: a block of one's own, with its Jacobian checked.
//!
//! The effect: accelerometers behind a rubber mount read more the faster the unit turns, `d_f_i = k_i |omega| f_i`, and
//! the mount's stiffness wanders: k forgets within ten minutes. Run it with `cargo run --release --example add_a_block`.

use sinscal::check::{self, Model};
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

/// What the sensors read, as one would write it down, for the check.
struct Reading(Signals<f64>);

impl Model<3, 6> for Reading {
    fn value<T: Real>(&self, k: &[T; 3]) -> [T; 6] {
        let (w, f) = (self.0.rate.map(T::of), self.0.force.map(T::of));
        let speed = (w.x * w.x + w.y * w.y + w.z * w.z).sqrt();
        let force = |i: usize| f[i] * (T::one() + k[i] * speed);
        [w.x, w.y, w.z, force(0), force(1), force(2)]
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
    let signals =
        Signals { rate: [0.2, -0.1, 0.3].into(), force: [1.0, -2.0, 9.5].into(), ..Signals::default() };
    check::inputs::<MountSoftness, 3, 6>(&signals, &Reading(signals), 1e-12)?;
    println!("the Jacobian is right: {}", check::block::<MountSoftness>()?);
    println!("{}", check::filter::<MountedUnit>()?);
    Ok(())
}
