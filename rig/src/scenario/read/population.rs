//! What the parameters of a unit are drawn from.

use sinscal::{AnyEffect, CATALOGUE, any_effect};

use crate::scenario::Population;
use crate::scenario::reader::{Entry, Must, Reader, as_table};
use logs::{suggest, units};

/// Parameters may be this many times their default prior.
const ABSURD: f64 = 1e6;

pub(super) fn population(r: &mut Reader<'_>, own: &[&'static dyn AnyEffect]) -> Vec<Population> {
    let known = || CATALOGUE.iter().chain(own).copied();
    let mut populations = Vec::new();
    for (name, entry) in r.whole("population") {
        if r.is_full() {
            break;
        }
        let Some(effect) = known().find(|effect| effect.name() == name).or_else(|| any_effect(name)) else {
            r.refuse(&entry, "is not an effect", suggest::accepted(name, known().map(<dyn AnyEffect>::name)));
            continue;
        };
        if name == "dither-size-effect" {
            let accepted = "[dither] mode = \"mean\" or \"full\" and a population of inner-lever-arm";
            r.refuse(&entry, "follows from the dither and the inner lever arms", accepted);
            continue;
        }
        if effect.is_wander() {
            let accepted =
                "bias_instability, bias_correlation and bias_random_walk of [gyro] and [accelerometer]";
            r.refuse(&entry, "is drawn as the log goes on", accepted);
            continue;
        }
        let units = units::of_effect(effect.info());
        let n = effect.dim();
        // beyond this nothing of the signal is left
        let most = ABSURD * effect.info().prior_sigma;
        let (mean, sigma) = match as_table(entry.value) {
            None => (Some(vec![0.0; n]), r.list(&entry, n, units, Must::NotBeNegative(most))),
            Some(table) => {
                r.only(table, &entry.field, &["mean", "sigma"]);
                let part = |key: &str| {
                    table.get(key).map(|value| Entry { field: format!("{}.{key}", entry.field), value })
                };
                let zero = || Some(vec![0.0; n]);
                let mean = part("mean")
                    .map_or_else(zero, |part| r.list(&part, n, units, Must::LieWithin(-most, most)));
                let sigma = part("sigma")
                    .map_or_else(zero, |part| r.list(&part, n, units, Must::NotBeNegative(most)));
                (mean, sigma)
            }
        };
        if let (Some(mean), Some(sigma)) = (mean, sigma) {
            populations.push(Population { effect, mean, sigma });
        }
    }
    // in the order of the catalogue, whatever the order in the file; laws by their names after them
    populations.sort_by_key(|population| {
        let name = population.effect.name();
        (known().position(|effect| effect.name() == name).unwrap_or(usize::MAX), name)
    });
    populations
}
