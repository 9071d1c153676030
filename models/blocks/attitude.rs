use calib_core::{Block, BlockView, Real, StateInfo};

use super::units::ARCSEC;
use crate::Strapdown;

/// Attitude errors: phi, about east, north and up.
///
/// - Frame: rotation vector in n, radians.
/// - Equation: `C_hat = (I - [phi x]) C`; `phi' = -omega_in x phi + d_omega_in - C d_omega` (Eq. 40).
/// - Sign: computed minus true.
/// - Prior: 1 mrad of level, 5 mrad of heading, the size of a coarse alignment; a calibration replaces it by
///   what its description says of the initial attitude.
#[derive(Clone, Copy, Debug)]
pub struct Attitude;

impl Block for Attitude {
    type Dynamics = Strapdown;
    type View<'a, T: Real> = BlockView<'a, Self, T>;

    const NAME: &'static str = "attitude";
    const DIM: usize = 3;

    fn states(visit: &mut dyn FnMut(StateInfo)) {
        for &(component, prior_sigma) in &[("e", 1e-3), ("n", 1e-3), ("u", 5e-3)] {
            visit(StateInfo {
                block: Self::NAME,
                component,
                unit: "rad",
                prior_sigma,
                sheet_unit: "arcsec",
                sheet_scale: ARCSEC,
            });
        }
    }
}
