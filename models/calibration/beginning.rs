//! What a filter believes before the first sample.

use calib_core::{Filter, Relaxation, Shape, StateInfo, Vector, considered_in, first_state, relaxing};

use crate::{Open, Setup, Strapdown};

/// Standard deviation of the position at the first sample, m. Wide on purpose: the first position update then leaves
/// exactly the correlation between position and outer lever arm that `p = p_ref - C l` implies.
const POSITION_SIGMA: f64 = 10.0;

/// Prior standard deviations of the states of `F`, which of them are considered, and how they relax.
pub(crate) struct Beginning<F: Filter> {
    pub(crate) prior: Vector<F, f64>,
    pub(crate) considered: Vector<F, bool>,
    pub(crate) relaxing: Vector<F, Relaxation<f64>>,
}

impl<F: Filter<Dynamics = Strapdown>> Beginning<F> {
    /// Of a setup and, where it names none, of the blocks; standard deviations of parameters go through `adjust(state, info, sigma)`.
    pub(crate) fn new(setup: &Setup, adjust: &mut dyn FnMut(usize, &StateInfo, f64) -> f64) -> Self {
        let blocks = setup.open;
        let mut prior = F::Shape::vector(0.0);
        let mut relaxing = relaxing::<F, f64>();
        if let Some(first) = first_state::<F, Open>() {
            blocks.relaxations(|place, relaxation| relaxing[first + place] = relaxation);
        }
        let mut considered = F::Shape::vector(false);
        considered_in::<F>(|state| considered[state] = true);
        let mut i = 0;
        blocks.states_of::<F>(&mut |info| {
            considered[i] |= i >= F::Shape::CORE && setup.considered.contains(&info.block);
            prior[i] = setup.prior(info.block).unwrap_or(info.prior_sigma);
            prior[i] = adjust(i, &info, prior[i]);
            relaxing[i] = setup.relaxation(info.block, prior[i], relaxing[i]);
            i += 1;
        });
        let initial = &setup.initial;
        let start = [
            initial.level_sigma,
            initial.level_sigma,
            initial.heading_sigma,
            setup.velocity.sigma,
            setup.velocity.sigma,
            setup.velocity.sigma,
            POSITION_SIGMA,
            POSITION_SIGMA,
            POSITION_SIGMA,
        ];
        for i in 0..F::Shape::CORE {
            prior[i] = start[i];
        }
        Self { prior, considered, relaxing }
    }
}
