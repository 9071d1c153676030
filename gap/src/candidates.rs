//! The effects that are priced against a filter.

use sinscal::{EffectInfo, FurtherEffects, Setup, effect};

/// Every effect of the catalogue that a filter may do without: one that joins the catalogue is a candidate.
///
/// A user's own effect is priced beside these by a group of both:
///
/// ```
/// # use sinscal::prelude::*;
/// # type MyEffect = Dither;
/// #[derive(StateBlocks)]
/// #[group]
/// struct Mine {
///     known: gap::Candidates,
///     own: MyEffect,
/// }
/// ```
pub type Candidates = FurtherEffects;

/// Factor on the default prior of a candidate that the description of the log does not name: how much larger than its
/// default the stated prior of its kin is ([`EffectInfo::kin`]).
pub(crate) fn prior_factor(setup: &Setup, block: &str) -> f64 {
    let stated = |name: &str| setup.priors.iter().find(|(n, _)| *n == name).map(|(_, sigma)| *sigma);
    if stated(block).is_some() {
        return 1.0;
    }
    let Some(kin) = effect(block).and_then(EffectInfo::kin) else { return 1.0 };
    match (stated(kin), effect(kin)) {
        (Some(stated), Some(effect)) if effect.prior_sigma > 0.0 => (stated / effect.prior_sigma).max(1.0),
        _ => 1.0,
    }
}
