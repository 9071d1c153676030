//! What is believed of the effects that are priced against a filter.

use sinscal::{DitherScale, Effect as _, EffectInfo, Setup, effect};

/// Pick-offs are calibrated to a few percent, but an amplitude that is told as its root mean square is 29 % too small and one from peak to
/// peak twice too large: a diagnosis looks so far, 1.
const GROSS: f64 = 0.5;

/// No less than this part of the told mean square is believed to be felt, 1.
const LEAST_FELT: f64 = 0.01;

/// Factor on the default prior of a candidate that the description of the log does not name: how much larger than its
/// default the stated prior of its kin is ([`EffectInfo::kin`]).
pub(crate) fn prior_factor(setup: &Setup, info: Option<&EffectInfo>) -> f64 {
    let Some(info) = info else { return 1.0 };
    let stated = |name: &str| setup.priors.iter().find(|(n, _)| *n == name).map(|(_, sigma)| *sigma);
    if stated(info.name()).is_some() {
        return 1.0;
    }
    if info.name() == DitherScale::EFFECT.name() {
        return GROSS / info.prior_sigma;
    }
    let Some(kin) = info.kin() else { return 1.0 };
    match (stated(kin), effect(kin)) {
        (Some(stated), Some(effect)) if effect.prior_sigma > 0.0 => (stated / effect.prior_sigma).max(1.0),
        _ => 1.0,
    }
}

/// A scale of the dither's amplitudes and its standard deviation, from those of the linear term. What the accelerometers feel is the mean
/// square, `1 / (1 + k)^2` of the told one, and the term puts `1 - 2 k` in its place: exact about zero, and at the mistakes that people
/// make no more.
pub(crate) fn amplitudes((term, sigma): (f64, f64)) -> (f64, f64) {
    let felt = (1.0 - 2.0 * term).max(LEAST_FELT);
    (felt.sqrt().recip() - 1.0, sigma * felt.powf(-1.5))
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
}
