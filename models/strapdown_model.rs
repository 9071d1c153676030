//! The strapdown error model as a family of dynamics.

use calib_core::{Block, Dynamics, Fault, Need, Real, declares};
use nalgebra::Vector3;

use crate::{Attitude, Dither, Point, Position, Signals, Velocity, tables};

/// Navigation errors of a strapdown system: attitude, velocity and position, nine states.
///
/// - States: phi (rad), dv (m/s) and dp (m), each east, north, up; computed minus true,
///   `C_hat = (I - [phi x]) C`.
/// - Inputs: errors of the three angular rates (0 to 2) and the three specific forces (3 to 5) in b, measured
///   minus true.
/// - Channels: velocity (0 to 2) and position (3 to 5) of the observed point, attitude (6 to 8), and rate of the body
///   against the Earth in b (9 to 11), predicted minus reference; `C_pred = (I - [z_a x]) C_ref`.
/// - Source: Eq. 40-42 and 46-49 of doi:10.3390/s22010278.
#[derive(Clone, Copy, Debug)]
pub struct Strapdown;

/// Sensor input of the angular rate about x; y and z follow. What [`Block::input_jacobian`](crate::Block) puts for gyros.
pub const RATE: usize = 0;
/// Sensor input of the specific force along x; y and z follow. What a block puts for accelerometers.
pub const FORCE: usize = 3;

impl Dynamics for Strapdown {
    const CORE: usize = 9;
    const INPUTS: usize = 6;
    const CHANNELS: usize = 12;
    const NEEDS: &'static [Need] = &[
        Need {
            any_of: &[Attitude::NAME],
            message: "a strapdown filter begins with attitude errors: declare `attitude: Attitude` first",
        },
        Need {
            any_of: &[Velocity::NAME],
            message: "a strapdown filter carries velocity errors: declare `velocity: Velocity` after `attitude`",
        },
        Need {
            any_of: &[Position::NAME],
            message: "a strapdown filter carries position errors: declare `position: Position` after `velocity`",
        },
    ];

    type Signals<T: Real> = Signals<T>;
    type Point<T: Real> = Point<T>;

    /// Without `Dither` in the declaration the inner lever arm knows nothing of the dither.
    #[inline(always)]
    fn restrict<F: Block<Dynamics = Self>, T: Real>(signals: &mut Signals<T>) {
        if const { !declares::<F, Dither>() } {
            signals.coupled_dither = Vector3::zeros();
        }
    }

    #[inline(always)]
    fn core_jacobian<T: Real>(at: &Point<T>, put: &mut impl FnMut(usize, usize, T)) {
        tables::strapdown_core::core_jacobian(at, put);
    }

    #[inline(always)]
    fn inject<T: Real>(at: &Point<T>, input: usize, value: T, put: &mut impl FnMut(usize, T)) {
        tables::strapdown_injection::inject(at, input, value, put);
    }

    #[inline(always)]
    fn measurement_jacobian<T: Real>(at: &Point<T>, put: &mut impl FnMut(usize, usize, T)) {
        tables::strapdown_residual::measurement_jacobian(at, put);
        tables::strapdown_rate::measurement_jacobian(at, put);
    }

    #[inline(always)]
    fn measure_input<T: Real>(at: &Point<T>, input: usize, value: T, put: &mut impl FnMut(usize, T)) {
        tables::strapdown_residual_input::measure_input(at, input, value, put);
    }
}

/// Looks at every block of a strapdown filter or group once: do its states, Jacobians and relaxations keep to what it says of
/// itself? For whoever sets a filter up that others have declared; [`Calibration`](crate::Calibration) relies on it.
///
/// # Errors
/// The first fault, with the name of the block.
pub fn probe<F: Block<Dynamics = Strapdown>>() -> Result<(), Fault> {
    calib_core::probe::<F>(&Point::default(), &Signals::default())
}
