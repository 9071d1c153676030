use calib_core::{Block, BlockView, Need, Real, StateInfo};

use crate::{InnerLeverArm, Strapdown};

/// The coupling of dither into the size effect: no states, what turns a P filter into a B filter.
///
/// A gyro's case dithers the sensor block about its axis i at the rate `A_i sin(2 pi F_i t)`. The gyro's
/// output has filtered it away, the accelerometers feel its mean square:
/// [`InnerLeverArm`](crate::InnerLeverArm) becomes
///
/// - Equation: `d_f_i = -(omega_j^2 + omega_k^2 + A_j^2/2 + A_k^2/2) r_i`, j and k the other axes (Eq. 6-11,
///   23, 35).
/// - Frame and unit: amplitudes A of the sensor block about the axes of b, rad/s, from the log.
/// - Without this block the model ignores the amplitudes, whatever the log holds.
#[derive(Clone, Copy, Debug)]
pub struct Dither;

impl Block for Dither {
    type Dynamics = Strapdown;
    type View<'a, T: Real> = BlockView<'a, Self, T>;

    const NAME: &'static str = "dither";
    const DIM: usize = 0;
    const NEEDS: &'static [Need] = &[Need {
        any_of: &[InnerLeverArm::NAME],
        message: "dither acts through the inner lever arm: declare `InnerLeverArm` beside it",
    }];

    fn states(_: &mut dyn FnMut(StateInfo)) {}
}
