use calib_core::{Block, BlockView, Real, StateInfo};

use super::units::MILLI;
use crate::Strapdown;

/// Position errors: metres east, north and up.
///
/// - Frame: n; `dp = [(R_N + h) cos L dlambda, (R_M + h) dL, dh]`.
/// - Equation: the derivative of dp with everything it depends on, the radii included (Eq. 42).
/// - Sign: computed minus true.
/// - Prior: 0.1 m; a calibration replaces it by the reference's.
#[derive(Clone, Copy, Debug)]
pub struct Position;

impl Block for Position {
    type Dynamics = Strapdown;
    type View<'a, T: Real> = BlockView<'a, Self, T>;

    const NAME: &'static str = "position";
    const DIM: usize = 3;

    fn states(visit: &mut dyn FnMut(StateInfo)) {
        for &(component, prior_sigma) in &[("e", 0.1), ("n", 0.1), ("u", 0.1)] {
            visit(StateInfo {
                block: Self::NAME,
                component,
                unit: "m",
                prior_sigma,
                sheet_unit: "mm",
                sheet_scale: MILLI,
            });
        }
    }
}
