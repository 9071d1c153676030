//! Families of dynamics: how the leading states of a filter move and what is seen of them.

use crate::{Block, Need, Real};

/// How the leading states of a filter move, how sensor errors enter, and what of it can be seen.
///
/// The continuous error model is `x_c' = A x_c + B u`, `z = H x_c + L u + (direct effects)`, with `x_c` the
/// [`CORE`](Self::CORE) leading states and `u` the errors of the [`INPUTS`](Self::INPUTS) sensor inputs
/// that parameter blocks cause through [`Block::input_jacobian`](crate::Block::input_jacobian).
/// For a strapdown system the inputs are the three angular rates and the three specific forces.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a family of dynamics",
    label = "no dynamics",
    note = "implement `Dynamics` for it, or leave `dynamics` out for a strapdown system"
)]
pub trait Dynamics: Sized + 'static {
    /// Number of leading states.
    const CORE: usize;
    /// Number of sensor inputs.
    const INPUTS: usize;
    /// Number of channels: what [`Measurement`](crate::Measurement)s are made of.
    const CHANNELS: usize;
    /// The blocks that every declaration of the family begins with, in the order of their states, with what to say
    /// otherwise.
    const NEEDS: &'static [Need];

    /// What the input Jacobians of blocks depend on.
    type Signals<T: Real>;
    /// Where the error model is linearised.
    type Point<T: Real>;

    /// Removes from `signals` what declaration `F` does not model, as [`declares`](crate::declares) tells. Does nothing by
    /// default.
    #[inline(always)]
    fn restrict<F: Block<Dynamics = Self>, T: Real>(signals: &mut Self::Signals<T>) {
        let _ = signals;
    }

    /// The matrix A: `put(row, column, value)`, both below [`CORE`](Self::CORE).
    fn core_jacobian<T: Real>(at: &Self::Point<T>, put: &mut impl FnMut(usize, usize, T));

    /// Column `input` of B times `value`: `put(row, value)`.
    fn inject<T: Real>(at: &Self::Point<T>, input: usize, value: T, put: &mut impl FnMut(usize, T));

    /// Channels by leading states: `put(channel, column, value)`.
    fn measurement_jacobian<T: Real>(at: &Self::Point<T>, put: &mut impl FnMut(usize, usize, T));

    /// Column `input` of L times `value`: `put(channel, value)`. No effect by default.
    #[inline(always)]
    fn measure_input<T: Real>(at: &Self::Point<T>, input: usize, value: T, put: &mut impl FnMut(usize, T)) {
        let _ = (at, input, value, put);
    }
}
