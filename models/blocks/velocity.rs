use calib_core::{Block, BlockView, Real, StateInfo};

use super::units::MILLI;
use crate::Strapdown;

/// Velocity errors: east, north and up.
///
/// - Frame: n, m/s over ground.
/// - Equation:
///   `dv' = f_n x phi + C d_f - (2 omega_ie + omega_en) x dv - (2 d_omega_ie + d_omega_en) x v + d_g` (Eq.
///   41).
/// - Sign: computed minus true.
/// - Prior: 1 cm/s: an IMU on a table that is not perfectly still.
#[derive(Clone, Copy, Debug)]
pub struct Velocity;

impl Block for Velocity {
    type Dynamics = Strapdown;
    type View<'a, T: Real> = BlockView<'a, Self, T>;

    const NAME: &'static str = "velocity";
    const DIM: usize = 3;

    fn states(visit: &mut dyn FnMut(StateInfo)) {
        for &(component, prior_sigma) in &[("e", 1e-2), ("n", 1e-2), ("u", 1e-2)] {
            visit(StateInfo {
                block: Self::NAME,
                component,
                unit: "m/s",
                prior_sigma,
                sheet_unit: "mm/s",
                sheet_scale: MILLI,
            });
        }
    }
}
