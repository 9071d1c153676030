//! What is believed of the effects that are priced against a filter.

use sinscal::{EffectInfo, Setup, effect};

use crate::chain::gross;

/// Factor on the default prior of a candidate that the description of the log does not name: how much larger than its
/// default the stated prior of its kin is ([`EffectInfo::kin`]).
pub(crate) fn prior_factor(setup: &Setup, info: Option<&EffectInfo>) -> f64 {
    let Some(info) = info else { return 1.0 };
    let stated = |name: &str| setup.priors.iter().find(|(n, _)| *n == name).map(|(_, sigma)| *sigma);
    if stated(info.name()).is_some() {
        return 1.0;
    }
    if let Some(gross) = gross(info.name()) {
        return gross / info.prior_sigma;
    }
    let Some(kin) = info.kin() else { return 1.0 };
    match (stated(kin), effect(kin)) {
        (Some(stated), Some(effect)) if effect.prior_sigma > 0.0 => (stated / effect.prior_sigma).max(1.0),
        _ => 1.0,
    }
}
