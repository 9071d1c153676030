//! What a motion that is known beforehand will show.

use calib_core::{Array, Filter, Shape};
use sinscal::{Calibration, Conventional, Point, Reference, Setup, Signals, StateInfo, Strapdown};

use crate::Error;
use crate::compiled::{Selection, boxed};

/// A piece of a motion that is known beforehand.
#[derive(Clone, Debug)]
pub enum Piece {
    /// The unit moves.
    Moves {
        /// Where it is in the middle.
        at: Point<f64>,
        /// What its sensors feel there.
        signals: Signals<f64>,
        /// For so long, s.
        dt: f64,
    },
    /// The reference is read.
    Read {
        /// When, s.
        time: f64,
        /// Where the unit is.
        at: Point<f64>,
        /// What its sensors feel.
        signals: Signals<f64>,
        /// What is read, and how well; the values do not matter.
        reference: Box<Reference>,
        /// So many times, about here.
        readings: f64,
    },
}

/// Standard deviations of the parameters that take part, as filter `F` will state them after a pass.
pub(crate) fn foresee<F: Filter<Dynamics = Strapdown>>(
    ahead: &mut dyn Iterator<Item = Piece>,
    setup: &Setup,
    selection: &Selection,
) -> Result<Vec<f64>, Error> {
    let setup = Setup { open: selection.open, ..*setup };
    let takes_part = |state| state < F::Shape::CORE || selection.place(state).is_some();
    let prior = |state, _: &StateInfo, sigma| if takes_part(state) { sigma } else { 0.0 };
    let mut run = boxed(|| Calibration::<F, Conventional>::with_prior(&setup, prior));
    for piece in ahead {
        match piece {
            Piece::Moves { at, signals, dt } => run.foresee(&at, &signals, dt),
            Piece::Read { time, at, signals, reference, readings } => run
                .foresee_readings(time, &at, &signals, &reference, readings)
                .map_err(|diverged| Error::Diverged { filter: F::NAME.to_owned(), diverged })?,
        }
    }
    run.foresee_end();
    let covariance = run.covariance();
    Ok(selection.states.iter().map(|state| covariance[*state].as_slice()[*state].sqrt()).collect())
}
