//! Statistics over units.

use serde::Serialize;

use crate::statistics::{
    chi_square_band, coverage, mean, median, median_interval_95, percentile, ratio_of_medians, rms,
};
use crate::{FilterResult, UnitResult};

/// What many units say together.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Number of units.
    pub units: usize,
    /// By filter, in the order of the plan.
    pub filters: Vec<FilterSummary>,
    /// Names of the filters, smallest median of the largest horizontal error first; empty without navigation.
    pub order: Vec<String>,
}

/// One filter over all units.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FilterSummary {
    /// Name of the filter.
    pub filter: String,
    /// Mean normalised innovation squared per scalar measurement.
    pub nis_per_dof: f64,
    /// Mean normalised estimation error squared per parameter.
    pub nees_per_dof: f64,
    /// Where that lies in 99 % of such campaigns if the filter knows its errors.
    pub nees_band_99: [f64; 2],
    /// Whether it does.
    pub consistent: bool,
    /// Largest horizontal error of each unit, m.
    pub max_horizontal_m: Option<Percentiles>,
    /// 95 % confidence interval of its median, m; none of fewer than six units.
    pub median_interval_95_m: Option<[f64; 2]>,
    /// Horizontal error at the end, m.
    pub final_horizontal_m: Option<Percentiles>,
    /// Median of the largest horizontal error against that of the first filter.
    pub ratio_to_first: Option<f64>,
    /// Its 95 % confidence interval.
    pub ratio_interval_95: Option<[f64; 2]>,
    /// Part of the units for which this filter navigates best.
    pub best: Option<f64>,
    /// By parameter.
    pub parameters: Vec<ParameterSummary>,
}

/// Percentiles over units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[allow(missing_docs, reason = "the names say it")]
pub struct Percentiles {
    pub p05: f64,
    pub p25: f64,
    pub p50: f64,
    pub p75: f64,
    pub p95: f64,
}

/// One parameter of a filter over all units, SI.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParameterSummary {
    /// Name of the effect.
    pub name: String,
    /// Component.
    pub component: String,
    /// Unit of data sheets.
    pub sheet_unit: String,
    /// Size of one of them, SI.
    pub sheet_scale: f64,
    /// Mean error.
    pub bias: f64,
    /// Root mean square error.
    pub rms: f64,
    /// Root mean square of what the filter says of its error.
    pub sigma: f64,
    /// Mean square of error over sigma.
    pub nees: f64,
    /// Where that lies in 99 % of such campaigns if the filter knows this error.
    pub nees_band_99: [f64; 2],
    /// Part of the units within one, two and three sigma.
    pub coverage: [f64; 3],
    /// Median of the times of convergence, s.
    pub converged_s: f64,
}

impl Summary {
    /// Summarises units, whatever their order.
    pub fn new(results: &[UnitResult]) -> Self {
        let mut results: Vec<&UnitResult> = results.iter().collect();
        results.sort_by_key(|result| result.unit);
        let width = results.first().map_or(0, |result| result.filters.len());
        let of = |f: usize| results.iter().filter_map(|result| result.filters.get(f)).collect::<Vec<_>>();
        let first: Vec<f64> = largest(&of(0));
        let best = |f: usize| {
            let wins = results.iter().filter(|result| {
                let error = |g: usize| result.filters[g].max_horizontal_m.unwrap_or(f64::INFINITY);
                (0..width).all(|g| g == f || error(f) < error(g))
            });
            wins.count() as f64 / results.len() as f64
        };
        let filters: Vec<FilterSummary> = (0..width)
            .map(|f| {
                let mut summary = FilterSummary::new(&of(f));
                let errors = largest(&of(f));
                if !errors.is_empty() {
                    let (ratio, interval) = ratio_of_medians(&errors, &first);
                    summary.ratio_to_first = Some(ratio);
                    summary.ratio_interval_95 = Some(interval);
                    summary.best = Some(best(f));
                }
                summary
            })
            .collect();
        let mut order: Vec<(f64, String)> = filters
            .iter()
            .filter_map(|filter| Some((filter.max_horizontal_m?.p50, filter.filter.clone())))
            .collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self { units: results.len(), filters, order: order.into_iter().map(|(_, name)| name).collect() }
    }
}

fn largest(results: &[&FilterResult]) -> Vec<f64> {
    results.iter().filter_map(|result| result.max_horizontal_m).collect()
}

impl FilterSummary {
    fn new(results: &[&FilterResult]) -> Self {
        let total: usize = results.iter().map(|result| result.degrees_of_freedom).sum();
        let nees_per_dof = results.iter().map(|result| result.nees).sum::<f64>() / total as f64;
        let band = chi_square_band(total, 0.99).unwrap_or((f64::NAN, f64::NAN));
        let nis: Vec<f64> = results.iter().map(|result| result.nis_per_dof).collect();
        let finals: Vec<f64> = results.iter().filter_map(|result| result.final_horizontal_m).collect();
        let parameters = results.first().map_or(0, |result| result.parameters.len());
        Self {
            filter: results.first().map_or_else(String::new, |result| result.filter.clone()),
            nis_per_dof: mean(&nis),
            nees_per_dof,
            nees_band_99: [band.0, band.1],
            consistent: (band.0..=band.1).contains(&nees_per_dof),
            max_horizontal_m: Percentiles::new(&largest(results)),
            median_interval_95_m: median_interval_95(&largest(results)),
            final_horizontal_m: Percentiles::new(&finals),
            ratio_to_first: None,
            ratio_interval_95: None,
            best: None,
            parameters: (0..parameters).map(|i| ParameterSummary::new(results, i)).collect(),
        }
    }
}

impl Percentiles {
    fn new(values: &[f64]) -> Option<Self> {
        let at = |p| percentile(values, p);
        (!values.is_empty()).then(|| Self {
            p05: at(0.05),
            p25: at(0.25),
            p50: at(0.5),
            p75: at(0.75),
            p95: at(0.95),
        })
    }
}

impl ParameterSummary {
    fn new(results: &[&FilterResult], i: usize) -> Self {
        let all: Vec<_> = results.iter().filter_map(|result| result.parameters.get(i)).collect();
        let errors: Vec<f64> = all.iter().map(|parameter| parameter.value - parameter.truth).collect();
        let sigmas: Vec<f64> = all.iter().map(|parameter| parameter.sigma).collect();
        let scaled: Vec<f64> = errors.iter().zip(&sigmas).map(|(error, sigma)| error / sigma).collect();
        let converged: Vec<f64> = all.iter().map(|parameter| parameter.converged_s).collect();
        let named = |text: fn(&crate::ParameterResult) -> &String| {
            all.first().map_or_else(String::new, |p| text(p).clone())
        };
        Self {
            name: named(|parameter| &parameter.name),
            component: named(|parameter| &parameter.component),
            sheet_unit: named(|parameter| &parameter.sheet_unit),
            sheet_scale: all.first().map_or(1.0, |parameter| parameter.sheet_scale),
            bias: mean(&errors),
            rms: rms(&errors),
            sigma: rms(&sigmas),
            nees: rms(&scaled).powi(2),
            nees_band_99: chi_square_band(scaled.len(), 0.99).unwrap_or((f64::NAN, f64::NAN)).into(),
            coverage: [1.0, 2.0, 3.0].map(|limit| coverage(&scaled, limit)),
            converged_s: median(&converged),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ParameterResult;

    /// One filter of one parameter, with its error in sigmas of 2, and a navigation error.
    fn filter(name: &str, error: f64, nis: f64, navigation: f64) -> FilterResult {
        let parameter = ParameterResult {
            name: "gyro-bias".into(),
            component: "x".into(),
            truth: 10.0,
            value: 10.0 + 2.0 * error,
            sigma: 2.0,
            converged_s: 100.0 * navigation,
            sheet_unit: "deg/h".into(),
            sheet_scale: 1.0,
        };
        FilterResult {
            filter: name.into(),
            nis_per_dof: nis,
            nees: error * error,
            degrees_of_freedom: 1,
            parameters: vec![parameter],
            max_horizontal_m: Some(navigation),
            final_horizontal_m: Some(0.5 * navigation),
        }
    }

    fn units() -> Vec<UnitResult> {
        let of = |unit: u64, error: f64, navigation: [f64; 2]| UnitResult {
            unit,
            filters: vec![
                filter("a", error, 1.0, navigation[0]),
                filter("b", 3.0 * error, 2.0, navigation[1]),
            ],
        };
        // out of order: a summary does not depend on it
        vec![
            of(3, -1.5, [30.0, 15.0]),
            of(1, 0.5, [10.0, 5.0]),
            of(2, 0.5, [20.0, 40.0]),
            of(4, 2.5, [40.0, 20.0]),
        ]
    }

    #[test]
    fn errors_of_a_parameter_as_worked_out_by_hand() {
        let summary = Summary::new(&units());
        let one = &summary.filters[0].parameters[0];
        // errors 1, 1, -3, 5
        assert_eq!((one.bias, one.rms, one.sigma), (1.0, 3.0, 2.0));
        // sigmas 0.5, 0.5, -1.5, 2.5: squares 0.25, 0.25, 2.25, 6.25
        assert!((one.nees - 2.25).abs() < 1e-12);
        assert_eq!(one.coverage, [0.5, 0.75, 1.0]);
        assert_eq!(one.converged_s, 2500.0);
        assert_eq!((one.name.as_str(), one.component.as_str()), ("gyro-bias", "x"));
        // chi-square of four at 0.5 % and 99.5 %, over four: 0.20699 and 14.860
        assert!((one.nees_band_99[0] - 0.20699 / 4.0).abs() < 1e-5);
        assert!((one.nees_band_99[1] - 14.86026 / 4.0).abs() < 1e-5);
    }

    #[test]
    fn filters_are_compared_unit_by_unit() {
        let summary = Summary::new(&units());
        let [a, b] = summary.filters.as_slice() else { panic!("two filters") };
        assert_eq!((summary.units, a.filter.as_str(), b.filter.as_str()), (4, "a", "b"));
        assert_eq!((a.nis_per_dof, b.nis_per_dof), (1.0, 2.0));
        assert!((a.nees_per_dof - 2.25).abs() < 1e-12 && a.consistent);
        // nine times 2.25 is beyond 3.7
        assert!((b.nees_per_dof - 20.25).abs() < 1e-12 && !b.consistent);
        // largest errors 10 20 30 40 and 5 15 20 40
        let quartiles = |p: Percentiles| [p.p05, p.p25, p.p50, p.p75, p.p95];
        let hand = |found: [f64; 5], by_hand: [f64; 5]| {
            found
                .iter()
                .zip(by_hand)
                .for_each(|(f, h)| assert!((f - h).abs() < 1e-12, "{found:?} {by_hand:?}"));
        };
        hand(quartiles(a.max_horizontal_m.unwrap()), [11.5, 17.5, 25.0, 32.5, 38.5]);
        hand(quartiles(b.max_horizontal_m.unwrap()), [6.5, 12.5, 17.5, 25.0, 37.0]);
        hand(quartiles(a.final_horizontal_m.unwrap()), [5.75, 8.75, 12.5, 16.25, 19.25]);
        assert_eq!((a.best, b.best), (Some(0.25), Some(0.75)));
        assert_eq!((a.ratio_to_first, b.ratio_to_first), (Some(1.0), Some(17.5 / 25.0)));
        assert_eq!(summary.order, ["b", "a"]);
        // of four values no interval of the median holds with 95 %
        assert_eq!(a.median_interval_95_m, None);
    }

    #[test]
    fn a_unit_without_a_number_spoils_the_percentiles_and_not_unseen() {
        let mut units = units();
        units[0].filters[0].max_horizontal_m = Some(f64::NAN);
        let summary = Summary::new(&units);
        assert!(summary.filters[0].max_horizontal_m.is_some_and(|p| p.p50.is_nan() && p.p95.is_nan()));
    }
}
