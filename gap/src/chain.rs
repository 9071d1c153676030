//! The chain of measurement in a diagnosis: what a log states and may be wrong about.
//!
//! Of it only that is priced which a unit can show by itself: the pick-offs of the dither, the latitude, thermometers that are late, and
//! gravity where no scale of the accelerometers is estimated, which is the same. To a unit near its place a wrong height and a wrong
//! clock are a wrong gravity, and a thermometer's scale and offset are in the coefficients and constants that are estimated. The scale of
//! a reference is not priced: the readings of a point that rests are noise, and noise goes with itself.

use core::f64::consts::FRAC_1_SQRT_2;

use calib_core::Block;
use sinscal::{
    AccelBias, AccelScale, AccelTemperatureBias, AccelTemperatureScale, ClockScale, DitherScale, GyroBias,
    GyroTemperatureBias, INFLUENCES, InnerLeverArm, Site, SiteGravity, SiteHeight, SiteLatitude,
    ThermometerLag, ThermometerOffset, ThermometerScale,
};

use crate::report::FoundEffect;

/// How far a diagnosis looks, SI. The catalogue's priors are of what is stated with care; mistakes are larger.
const GROSS: [(&str, f64); 4] = [
    // an amplitude that is told as its root mean square is 29 % too small, and one from peak to peak twice too large
    (DitherScale::NAME, 0.5),
    // the next town; what is further away the rests contradict
    (SiteLatitude::NAME, 1e-2),
    // what normal gravity leaves out in mountains, a height of the other side of the valley, a clock of a cheap crystal
    (SiteGravity::NAME, 3e-3),
    (ThermometerLag::NAME, 60.0),
];

/// Temperature coefficients, and the constants beside them that the reference temperature decides about.
const COEFFICIENTS: [(&str, &str); 3] = [
    (AccelTemperatureScale::NAME, AccelScale::NAME),
    (AccelTemperatureBias::NAME, AccelBias::NAME),
    (GyroTemperatureBias::NAME, GyroBias::NAME),
];

/// No less than this part of the told mean square is believed to be felt, 1.
const LEAST_FELT: f64 = 0.01;

/// So much are recognised mistakes looked for around their factor, 1.
const MISTAKEN: f64 = 0.15;

/// How far an effect of the chain is looked for, where it is.
pub(crate) fn gross(effect: &str) -> Option<f64> {
    GROSS.iter().find(|(name, _)| *name == effect).map(|(_, gross)| *gross)
}

/// Whether an effect is of the chain and not priced against a filter that `has` some blocks and may couple the dither to its arms.
pub(crate) fn is_left_out(effect: &str, has: &dyn Fn(&str) -> bool, couples_dither: bool) -> bool {
    if effect == DitherScale::NAME {
        return !(couples_dither && has(InnerLeverArm::NAME));
    }
    if effect == ThermometerLag::NAME {
        return !COEFFICIENTS.iter().any(|(coefficient, _)| has(coefficient));
    }
    if effect == SiteGravity::NAME {
        return has(AccelScale::NAME);
    }
    INFLUENCES.contains(&effect) && gross(effect).is_none()
}

/// What no run of a filter that `has` some blocks tells apart, whatever the path: the second hides the first.
pub(crate) fn by_construction(has: &dyn Fn(&str) -> bool) -> Vec<Vec<String>> {
    let pair = |a: &str, b: &str| vec![a.to_owned(), b.to_owned()];
    let twins = [SiteHeight::NAME, ClockScale::NAME];
    let mut pairs = if has(AccelScale::NAME) {
        [SiteGravity::NAME].into_iter().chain(twins).map(|name| pair(name, AccelScale::NAME)).collect()
    } else {
        twins.map(|name| pair(name, SiteGravity::NAME)).to_vec()
    };
    for (coefficient, constant) in COEFFICIENTS.into_iter().filter(|(coefficient, _)| has(coefficient)) {
        pairs.push(pair(ThermometerScale::NAME, coefficient));
        if has(constant) {
            pairs.push(pair(ThermometerOffset::NAME, constant));
        }
    }
    pairs
}

/// A scale of the dither's amplitudes and its standard deviation, from those of the linear term. What the accelerometers feel is the mean
/// square, `1 / (1 + k)^2` of the told one, and the term puts `1 - 2 k` in its place: exact about zero, and at the mistakes that people
/// make no more.
pub(crate) fn amplitudes((term, sigma): (f64, f64)) -> (f64, f64) {
    let felt = (1.0 - 2.0 * term).max(LEAST_FELT);
    (felt.sqrt().recip() - 1.0, sigma * felt.powf(-1.5))
}

/// What a log taken at `site` states wrongly, where that was found, and the mistake that it looks like.
pub(crate) fn told_wrongly(found: &FoundEffect, site: &Site) -> Option<String> {
    let &[value, ..] = found.estimate.as_slice() else { return None };
    if found.name == DitherScale::NAME {
        return Some(pick_offs(&found.estimate));
    }
    if found.name == SiteLatitude::NAME {
        let (stated, sigma) = (site.latitude.to_degrees(), found.sigma[0].to_degrees());
        return Some(format!(
            "the log states a latitude of {stated:.3} deg, and the unit shows {:.3} +- {sigma:.3} deg",
            stated + value.to_degrees()
        ));
    }
    (found.name == SiteGravity::NAME).then(|| {
        "gravity is not what it is at the stated latitude and height by the clock that stamps the samples: one of the three is wrong"
            .to_owned()
    })
}

/// How the amplitudes of the dither are told.
fn pick_offs(scales: &[f64]) -> String {
    let told: Vec<f64> = scales.iter().map(|k| 1.0 + k).collect();
    let are = |times: f64| told.iter().all(|told| (told / times - 1.0).abs() < MISTAKEN);
    let looks = if are(FRAC_1_SQRT_2) {
        ", as root mean squares are: multiply them by sqrt(2)"
    } else if are(2.0) {
        ", as peak to peak is: halve them"
    } else {
        ""
    };
    let each: Vec<String> = told.iter().map(|told| format!("{told:.2}")).collect();
    format!("the log tells {} times the amplitudes that the accelerometers feel{looks}", each.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amplitudes_are_those_whose_mean_square_is_felt() {
        for scale in [core::f64::consts::FRAC_1_SQRT_2 - 1.0, -0.01, 0.0, 0.02, 1.0] {
            let term = |scale: f64| 0.5 * (1.0 - (1.0 + scale).powi(-2));
            let (found, sigma) = amplitudes((term(scale), 1e-3));
            assert!((found - scale).abs() < 1e-12, "{found}, {scale}");
            let slope = (term(scale + 1e-6) - term(scale - 1e-6)) / 2e-6;
            assert!((sigma * slope / 1e-3 - 1.0).abs() < 1e-6, "{scale}: {sigma}");
        }
        assert!(amplitudes((0.7, 1e-3)).1 > 0.9);
    }

    #[test]
    fn only_what_a_unit_can_show_is_priced() {
        let priced = |has: &dyn Fn(&str) -> bool, couples: bool| -> Vec<&str> {
            INFLUENCES.iter().copied().filter(|name| !is_left_out(name, has, couples)).collect()
        };
        assert_eq!(priced(&|_| true, true), ["site-latitude", "thermometer-lag", "dither-scale"]);
        assert_eq!(priced(&|_| true, false), ["site-latitude", "thermometer-lag"]);
        assert_eq!(priced(&|_| false, true), ["site-latitude", "site-gravity"]);
        assert!(!is_left_out("accel-scale", &|_| false, false));
    }

    #[test]
    fn height_and_clock_hide_where_gravity_does() {
        let pair = |a: &str, b: &str| vec![a.to_owned(), b.to_owned()];
        let has = |name: &str| ["accel-scale", "accel-temperature-scale"].contains(&name);
        let all = [
            pair("site-gravity", "accel-scale"),
            pair("site-height", "accel-scale"),
            pair("clock-scale", "accel-scale"),
            pair("thermometer-scale", "accel-temperature-scale"),
            pair("thermometer-offset", "accel-scale"),
        ];
        assert_eq!(by_construction(&has), all);
        let without = [pair("site-height", "site-gravity"), pair("clock-scale", "site-gravity")];
        assert_eq!(by_construction(&|_| false), without);
    }
}
