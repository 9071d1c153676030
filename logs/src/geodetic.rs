//! Latitude, longitude and height as metres from the site.
//!
//! The frame is curvilinear, as that of the filters' position: north is the arc of the meridian, east that of the parallel, with the
//! radii of curvature at the site, and up is the difference of ellipsoidal heights. At 10 km from the site the tangent plane lies
//! 8 m above.

use sinscal::{Site, earth};
use std::f64::consts::PI;

/// East, north, up of the site, m, of a geodetic position, rad and m.
pub(super) fn local(site: &Site, latitude: f64, longitude: f64, height: f64) -> [f64; 3] {
    let (meridian, prime_vertical) = earth::radii(site.latitude);
    // the shorter way around, across the date line too
    let east = (longitude - site.longitude + PI).rem_euclid(2.0 * PI) - PI;
    // what the remainder rounds away is kept where nothing had to be wrapped
    let plain = longitude - site.longitude;
    let east = if plain.abs() <= PI { plain } else { east };
    [
        east * (prime_vertical + site.height) * site.latitude.cos(),
        (latitude - site.latitude) * (meridian + site.height),
        height - site.height,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_of_arc_is_as_long_as_it_is() {
        let site = Site { latitude: 0.7, longitude: -1.8, height: 1600.0 };
        let second = PI / 180.0 / 3600.0;
        let [east, north, up] = local(&site, 0.7 + second, -1.8 + second, 1605.0);
        // 30.8 m along the meridian, and the cosine of the latitude of 31 m along the parallel
        assert!((north - 30.84).abs() < 0.02 && (east - 23.67).abs() < 0.05 && up == 5.0, "{east} {north}");
        assert_eq!(local(&site, 0.7, -1.8, 1600.0), [0.0; 3]);
        let pacific = Site { longitude: 179.9_f64.to_radians(), ..site };
        let [east, ..] = local(&pacific, 0.7, (-179.9_f64).to_radians(), 1600.0);
        assert!(
            (east - 0.2_f64.to_radians() * (earth::radii(0.7_f64).1 + 1600.0) * 0.7_f64.cos()).abs() < 1e-6
        );
    }
}
