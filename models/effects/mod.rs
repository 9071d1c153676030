//! Effects: what a filter can be asked to model, and a simulator to have.

mod any;
mod catalogue;
mod info;
#[cfg(feature = "std")]
mod law;
#[cfg(feature = "std")]
mod term;

use calib_core::Block;

pub use self::any::{AnyBlock, AnyEffect};
pub use self::catalogue::{CATALOGUE, Catalogue, EFFECTS, INFLUENCES, any_effect, effect};
pub use self::info::{EffectInfo, Kind};
#[cfg(feature = "std")]
pub use self::law::Law;
#[cfg(feature = "std")]
pub use self::term::Motion;
use crate::{Point, Signals, Strapdown};

/// A block whose states are the parameters of one error of the unit or of the reference.
///
/// Those of the library are listed in [`EFFECTS`]. One of your own is a block with an entry like theirs:
///
/// ```
/// use sinscal::prelude::*;
/// use sinscal::{Effect, EffectInfo, FORCE, Kind, Signals};
///
/// /// Accelerometers behind a rubber mount read more the faster the unit turns.
/// pub struct MountSoftness;
///
/// impl Effect for MountSoftness {
///     const EFFECT: EffectInfo = EffectInfo::new("mount-softness", Kind::Force, &["x", "y", "z"], "s", 1e-4)
///         .model("d_f_i = k_i |omega| f_i", "accelerometers behind a rubber mount")
///         .sheet("ppm/(rad/s)", 1e-6)
///         .akin_to("accel-scale");
/// }
///
/// impl Block for MountSoftness {
///     type Dynamics = Strapdown;
///     type View<'a, T: Real> = BlockView<'a, Self, T>;
///     const NAME: &'static str = "mount-softness";
///     const DIM: usize = 3;
///
///     fn states(visit: &mut dyn FnMut(StateInfo)) {
///         Self::EFFECT.states(visit);
///     }
///
///     fn input_jacobian<T: Real>(s: &Signals<T>, put: &mut impl FnMut(usize, usize, T)) {
///         for i in 0..3 {
///             put(FORCE + i, i, s.rate.norm() * s.force[i]);
///         }
///     }
/// }
/// ```
pub trait Effect: Block<Dynamics = Strapdown> {
    /// Its entry.
    const EFFECT: EffectInfo;

    /// Adds to `error` the errors of the three rates (rad/s) and of the three specific forces (m/s^2) in b, measured minus true, that a
    /// unit with the parameters `values`, in the order and unit of the states, has under the true `signals`.
    ///
    /// The Jacobian times the values, unless the effect says what it is when it is not small.
    #[inline(always)]
    fn error(signals: &Signals<f64>, values: &[f64], error: &mut [f64; 6]) {
        Self::input_jacobian(signals, &mut |input, state, value| error[input] += value * values[state]);
    }

    /// Adds to `error` the errors of the reference's velocity (m/s), position (m) and attitude (rad) in n where the true motion is
    /// `at`: reading minus what an ideal reference reads of the IMU's own place, the attitude as in `C_read = (I - [e x]) C`.
    ///
    /// Minus the Jacobian times the values, since that is of the residual predicted minus reference.
    #[inline(always)]
    fn reference_error(at: &Point<f64>, values: &[f64], error: &mut [f64; 9]) {
        Self::measurement_jacobian(at, &mut |channel, state, value| error[channel] -= value * values[state]);
    }
}
