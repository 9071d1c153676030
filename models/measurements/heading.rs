use calib_core::{Measurement, MeasurementInfo, Real};

use super::channel;
use crate::{Point, Strapdown};

/// Heading of the body's forward axis, from north over east.
///
/// - Equation: with f = C e_y, `psi = atan2(f_e, f_n)`, and `z = psi - psi_ref` within half a turn. The attitude residual turns
///   f into `f - z_a x f`, hence `z = z_a_u - f_u (f_e z_a_e + f_n z_a_n) / (f_e^2 + f_n^2)`.
/// - Where the forward axis points up or down there is no heading, and nothing is measured.
#[derive(Clone, Copy, Debug)]
pub struct Heading;

/// The forward axis is within 0.6 deg of the vertical below this square of its horizontal part.
const VERTICAL: f64 = 1e-4;

impl Measurement for Heading {
    type Dynamics = Strapdown;
    const INFO: MeasurementInfo = MeasurementInfo {
        name: "heading",
        components: &["psi"],
        unit: "rad",
        columns: &["ref_heading"],
        sigma: 1e-3,
        channels: None,
    };

    #[inline]
    fn residual<T: Real>(at: &Point<T>, reading: &[T], put: &mut impl FnMut(usize, T)) {
        let (east, north) = (at.c_bn.m12, at.c_bn.m22);
        if east * east + north * north > T::of(VERTICAL) {
            let (sine, cosine) = reading[0].sin_cos();
            // of the difference
            put(0, (east * cosine - north * sine).atan2(north * cosine + east * sine));
        }
    }

    #[inline(always)]
    fn jacobian<T: Real>(at: &Point<T>, put: &mut impl FnMut(usize, usize, T)) {
        let (east, north, up) = (at.c_bn.m12, at.c_bn.m22, at.c_bn.m32);
        let slope = -up / (east * east + north * north);
        put(0, channel::ATTITUDE, slope * east);
        put(0, channel::ATTITUDE + 1, slope * north);
        put(0, channel::ATTITUDE + 2, T::one());
    }
}
