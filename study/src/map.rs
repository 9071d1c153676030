//! Whether each effect that a filter takes in helps, by the sizes of the effects.

use serde::Serialize;

use crate::statistics::median;
use crate::{Plan, UnitResult};

/// Sizes of the three effects that the larger filters add, against those of the scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Sizes {
    /// Of the accelerometer delay.
    pub delay: f64,
    /// Of the temperature scale factors.
    pub temperature: f64,
    /// Of the dither's size effect: the square of the amplitudes.
    pub dither: f64,
}

impl Sizes {
    /// Every combination of these factors.
    pub fn grid(factors: &[f64]) -> Vec<Self> {
        let mut grid = Vec::new();
        for &delay in factors {
            for &temperature in factors {
                for &dither in factors {
                    grid.push(Self { delay, temperature, dither });
                }
            }
        }
        grid
    }
}

impl Plan {
    /// The same plan with effects of other sizes. A unit keeps its random numbers: only sizes differ.
    pub fn sized(&self, sizes: &Sizes) -> Self {
        let mut plan = self.clone();
        for population in &mut plan.scenario.population {
            let factor = match population.effect.name() {
                "accel-delay" => sizes.delay,
                "accel-temperature-scale" => sizes.temperature,
                _ => continue,
            };
            population.mean.iter_mut().chain(&mut population.sigma).for_each(|value| *value *= factor);
        }
        plan.scenario.dither.amplitude *= sizes.dither.sqrt();
        plan
    }
}

/// What came of one combination of sizes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cell {
    /// The combination.
    pub sizes: Sizes,
    /// Median over the units of each filter's largest horizontal error, m.
    pub median_m: Vec<f64>,
    /// Whether each filter is better than the one before.
    pub in_order: bool,
    /// Indices of filters that are worse than the one before.
    pub worse: Vec<usize>,
}

impl Cell {
    /// Summarises units that were put through the plan of these sizes.
    pub fn new(sizes: Sizes, results: &[UnitResult]) -> Self {
        let width = results.first().map_or(0, |result| result.filters.len());
        let errors = |f: usize| -> Vec<f64> {
            results.iter().filter_map(|result| result.filters.get(f)?.max_horizontal_m).collect()
        };
        let median_m: Vec<f64> = (0..width).map(|f| median(&errors(f))).collect();
        let worse: Vec<usize> = (1..width).filter(|f| median_m[*f] > median_m[f - 1]).collect();
        Self { sizes, median_m, in_order: worse.is_empty(), worse }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FilterResult;

    fn unit(unit: u64, errors: [f64; 3]) -> UnitResult {
        let filter = |error| FilterResult {
            filter: String::new(),
            nis_per_dof: 1.0,
            nees: 1.0,
            degrees_of_freedom: 1,
            parameters: Vec::new(),
            max_horizontal_m: Some(error),
            final_horizontal_m: None,
        };
        UnitResult { unit, filters: errors.map(filter).to_vec() }
    }

    #[test]
    fn a_step_that_makes_things_worse_is_named() {
        let sizes = Sizes { delay: 1.0, temperature: 1.0, dither: 1.0 };
        let results = [unit(1, [3.0, 5.0, 1.0]), unit(2, [4.0, 4.5, 2.0]), unit(3, [9.0, 4.0, 3.0])];
        let cell = Cell::new(sizes, &results);
        assert_eq!(cell.median_m, [4.0, 4.5, 2.0]);
        assert_eq!((cell.in_order, cell.worse.as_slice()), (false, &[1][..]));
        assert_eq!(Sizes::grid(&[0.5, 1.0]).len(), 8);
    }

    #[test]
    fn sizes_scale_a_population_and_leave_its_random_numbers() -> Result<(), Box<dyn std::error::Error>> {
        let plan = Plan {
            scenario: rig::Scenario::default(),
            filters: Vec::new(),
            passes: 1,
            hours: 0.0,
            alignment: 0.0,
            motion: Plan::paper_swing()?,
        };
        let sized = plan.sized(&Sizes { delay: 2.0, temperature: 0.5, dither: 4.0 });
        let (before, after) = (plan.scenario.unit(3), sized.scenario.unit(3));
        for (effect, factor) in [("accel-delay", 2.0), ("accel-temperature-scale", 0.5), ("gyro-scale", 1.0)]
        {
            let ratio = after.value(effect, 0) / before.value(effect, 0);
            assert!((ratio - factor).abs() < 1e-12, "{effect}: {ratio}");
        }
        let (before, after) = (plan.scenario.dither.amplitude, sized.scenario.dither.amplitude);
        assert!((after - before * 2.0).norm() < 1e-12);
        Ok(())
    }
}
