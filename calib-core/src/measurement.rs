//! Measurements: what a filter's residuals are of.

use crate::{Dynamics, Real};

/// What people call a measurement, and where its readings come from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasurementInfo {
    /// Name in reports and set-ups, for instance `velocity`.
    pub name: &'static str,
    /// The rows, for instance `e`, `n`, `u`.
    pub components: &'static [&'static str],
    /// SI unit of the residuals.
    pub unit: &'static str,
    /// Columns of a log that hold a reading, in the order in which [`Measurement::residual`] takes them. Without one of them there is
    /// no reading.
    pub columns: &'static [&'static str],
    /// Standard deviation of a row where neither the reading nor the set-up states one, in [`unit`](Self::unit).
    pub sigma: f64,
    /// First of the channels that the rows are, one by one; `None` where the rows are functions of channels.
    pub channels: Option<usize>,
}

/// Some rows of residuals, `computed - read`.
///
/// Blocks and dynamics say how *channels* depend on the states: motion of the observed point, as a reference would see it. A
/// measurement says how its residuals depend on channels, and the chain rule makes its rows of the measurement matrix: it works
/// beside every block, and no block knows of it.
///
/// Most measurements are channels as they are: these name the first one in their [`INFO`](Self::INFO) and write no Jacobian.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a measurement",
    label = "no measurement",
    note = "`measures(...)` takes `velocity`, `position`, `attitude`, `rate`, `height`, `heading`, and types that implement `Measurement`"
)]
pub trait Measurement: 'static {
    /// The family of dynamics whose channels it is made of.
    type Dynamics: Dynamics;

    /// Its name, rows, columns and noise.
    const INFO: MeasurementInfo;

    /// The residuals at `at`, the state that the reference should see, for a `reading` of the [columns](MeasurementInfo::columns):
    /// `put(row, computed - read)`.
    ///
    /// Who calls [`Kalman::update`](crate::Kalman::update) with residuals of their own need not write it.
    #[inline]
    fn residual<T: Real>(
        at: &<Self::Dynamics as Dynamics>::Point<T>,
        reading: &[T],
        put: &mut impl FnMut(usize, T),
    ) {
        const { panic!("a measurement that a run takes from readings needs its `residual`") };
        let _ = (at, reading, put);
    }

    /// Derivatives of the residuals by the channels: `put(row, channel, value)`.
    #[inline(always)]
    fn jacobian<T: Real>(at: &<Self::Dynamics as Dynamics>::Point<T>, put: &mut impl FnMut(usize, usize, T)) {
        let first = const {
            match Self::INFO.channels {
                Some(first) => first,
                None => panic!("a measurement whose rows are functions of channels needs their `jacobian`"),
            }
        };
        let _ = at;
        for row in 0..Self::INFO.components.len() {
            put(row, first + row, T::one());
        }
    }
}

/// First row of the measurement `measured` of a list.
pub(crate) const fn first_row(measures: &[MeasurementInfo], measured: usize) -> usize {
    let mut row = 0;
    let mut k = 0;
    while k < measured && k < measures.len() {
        row += measures[k].components.len();
        k += 1;
    }
    row
}
