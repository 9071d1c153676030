//! The Earth: WGS 84 ellipsoid, its rotation, Somigliana's normal gravity.
//!
//! Constants of NIMA TR8350.2, *Department of Defense World Geodetic System 1984*, third edition (2000). Angles in
//! rad, lengths in m, n is east, north, up.

use calib_core::Real;
use nalgebra::Vector3;

/// Semi-major axis a, m.
pub const SEMI_MAJOR_AXIS: f64 = 6_378_137.0;
/// Flattening f.
pub const FLATTENING: f64 = 1.0 / 298.257_223_563;
/// Rotation of the Earth against inertial space omega_ie, rad/s.
pub const ROTATION_RATE: f64 = 7.292_115e-5;
/// First eccentricity squared, e^2 = f (2 - f).
pub const ECCENTRICITY_SQUARED: f64 = FLATTENING * (2.0 - FLATTENING);
/// Normal gravity at the equator, m/s^2.
pub const GRAVITY_EQUATOR: f64 = 9.780_325_335_9;
/// Somigliana's constant k.
pub const SOMIGLIANA: f64 = 0.001_931_852_652_41;
/// Gravitational constant times mass of the Earth, atmosphere included, m^3/s^2.
pub const GRAVITATIONAL_PARAMETER: f64 = 3.986_004_418e14;
/// Ratio of centrifugal to gravitational acceleration at the equator, m = omega^2 a^2 b / GM.
pub const CENTRIFUGAL_RATIO: f64 =
    ROTATION_RATE * ROTATION_RATE * SEMI_MAJOR_AXIS * SEMI_MAJOR_AXIS * SEMI_MAJOR_AXIS * (1.0 - FLATTENING)
        / GRAVITATIONAL_PARAMETER;

/// Radii of curvature at geodetic `latitude`: in the meridian R_M and in the prime vertical R_N, m.
#[inline]
pub fn radii<T: Real>(latitude: T) -> (T, T) {
    let s = latitude.sin();
    let one = T::one();
    let w = one - T::of(ECCENTRICITY_SQUARED) * s * s;
    let prime_vertical = T::of(SEMI_MAJOR_AXIS) / w.sqrt();
    let meridian = prime_vertical * T::of(1.0 - ECCENTRICITY_SQUARED) / w;
    (meridian, prime_vertical)
}

/// Normal gravity at geodetic `latitude` and ellipsoidal `height`, m/s^2: Somigliana on the ellipsoid, second order in
/// height (TR8350.2, equations 4-1 and 4-3). Positive; it acts along -up.
#[inline]
pub fn gravity<T: Real>(latitude: T, height: T) -> T {
    let s = latitude.sin();
    let s2 = s * s;
    let one = T::one();
    let on_ellipsoid = T::of(GRAVITY_EQUATOR) * (one + T::of(SOMIGLIANA) * s2)
        / (one - T::of(ECCENTRICITY_SQUARED) * s2).sqrt();
    let ratio = height / T::of(SEMI_MAJOR_AXIS);
    let first = T::of(1.0 + FLATTENING + CENTRIFUGAL_RATIO) - T::of(2.0 * FLATTENING) * s2;
    on_ellipsoid * (one - T::of(2.0) * first * ratio + T::of(3.0) * ratio * ratio)
}

/// Rotation of the Earth omega_ie in n, rad/s.
#[inline]
pub fn rotation_n<T: Real>(latitude: T) -> Vector3<T> {
    let rate = T::of(ROTATION_RATE);
    Vector3::new(T::zero(), rate * latitude.cos(), rate * latitude.sin())
}

/// Rotation of n against the Earth omega_en caused by `velocity` over ground (n, m/s), in n, rad/s.
#[inline]
pub fn transport_n<T: Real>(latitude: T, height: T, velocity: &Vector3<T>) -> Vector3<T> {
    let (meridian, prime_vertical) = radii(latitude);
    let east = velocity.x / (prime_vertical + height);
    // sine and cosine are had already where the radii and the Earth's rotation are
    Vector3::new(-velocity.y / (meridian + height), east, east * (latitude.sin() / latitude.cos()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gravity_matches_published_values() {
        // TR8350.2 table 3.4: gamma_e, gamma_p; and the free-air decrease of 3.086e-6 /s^2 at 45 degrees
        assert!((gravity(0.0_f64, 0.0) - 9.780_325_335_9).abs() < 1e-10);
        assert!((gravity(core::f64::consts::FRAC_PI_2, 0.0) - 9.832_184_937_8).abs() < 1e-9);
        let slope = gravity(core::f64::consts::FRAC_PI_4, 1.0) - gravity(core::f64::consts::FRAC_PI_4, 0.0);
        assert!((slope + 3.0855e-6).abs() < 1e-9, "{slope}");
    }

    #[test]
    fn radii_meet_at_the_pole_and_bracket_the_axis_at_the_equator() {
        let (m, n) = radii::<f64>(core::f64::consts::FRAC_PI_2);
        assert!((m - n).abs() < 1e-6);
        assert!((m - 6_399_593.625_8).abs() < 1e-3);
        let (m, n) = radii::<f64>(0.0);
        assert!((m - 6_335_439.327_3).abs() < 1e-3);
        assert!((n - SEMI_MAJOR_AXIS).abs() < 1e-9);
    }
}
