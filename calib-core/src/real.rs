use nalgebra::RealField;

/// The scalar a filter computes with: `f64` on a workstation, `f32` on a small target, a dual number
/// where a Jacobian is checked.
///
/// Implemented for everything that is a copyable [`nalgebra::RealField`].
pub trait Real: RealField + Copy {
    /// The nearest representable value to `value`.
    #[inline(always)]
    fn of(value: f64) -> Self {
        nalgebra::convert(value)
    }
}

impl<T: RealField + Copy> Real for T {}
