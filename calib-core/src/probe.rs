//! What a block says of itself against what it does, seen once before a filter is run.

use core::fmt;

use crate::{Block, BlockVisitor, Dynamics, Relaxation};

/// A block that contradicts itself: with it a filter would be wrong, or stop where nobody names the block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fault {
    /// [`Block::NAME`].
    pub block: &'static str,
    /// What is wrong with it.
    pub flaw: Flaw,
}

/// What is wrong with a block.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Flaw {
    /// `states` describes so many states, which are not [`Block::DIM`].
    Described {
        /// States that are described.
        states: usize,
        /// [`Block::DIM`].
        dim: usize,
    },
    /// `states` gives the state another block's name than [`Block::NAME`].
    Named {
        /// The state.
        state: usize,
        /// The name.
        name: &'static str,
    },
    /// A Jacobian or a relaxation is given for a state that the block has not: it would be that of the next block.
    State {
        /// Where it is given: `input_jacobian`, `measurement_jacobian` or `RELAXATIONS`.
        within: &'static str,
        /// The state.
        state: usize,
        /// [`Block::DIM`].
        dim: usize,
    },
    /// `input_jacobian` puts an entry for an input that the dynamics have not.
    Input {
        /// The input.
        input: usize,
        /// [`Dynamics::INPUTS`].
        inputs: usize,
    },
    /// `measurement_jacobian` puts an entry for a channel that the dynamics have not.
    Channel {
        /// The channel.
        channel: usize,
        /// Number of channels.
        channels: usize,
    },
    /// A rate or a density of `RELAXATIONS` is negative or no number.
    Relaxation {
        /// The state.
        state: usize,
        /// Its relaxation.
        relaxation: Relaxation<f64>,
    },
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "block `{}`: ", self.block)?;
        match self.flaw {
            Flaw::Described { states, dim } => {
                write!(f, "`states` describes {states} states where `DIM` is {dim}")
            }
            Flaw::Named { state, name } => {
                write!(f, "`states` calls the block of state {state} `{name}`: write `block: Self::NAME`")
            }
            Flaw::State { within, state, dim } => {
                write!(
                    f,
                    "`{within}` is given for state {state}, states are counted from 0 and `DIM` is {dim}"
                )
            }
            Flaw::Input { input, inputs } => {
                write!(
                    f,
                    "`input_jacobian` puts input {input}, inputs are counted from 0 and there are {inputs}"
                )
            }
            Flaw::Channel { channel, channels } => write!(
                f,
                "`measurement_jacobian` puts channel {channel}, channels are counted from 0 and there are {channels}"
            ),
            // without the numbers: a small program need not carry what prints them
            Flaw::Relaxation { state, .. } => write!(
                f,
                "`RELAXATIONS` gives state {state} a rate or a density that is negative or no number"
            ),
        }
    }
}

impl core::error::Error for Fault {}

/// Looks at every block of declaration `F` once: do `states`, the Jacobians and the relaxations keep to what the block and its
/// dynamics say of themselves? The Jacobians are taken at `at` and `signals`; which entries they put does not depend on where.
///
/// Cheap enough for whoever sets a filter up; `calib_core::check` says more of a block.
///
/// # Errors
/// The first fault.
pub fn probe<F: Block>(
    at: &<F::Dynamics as Dynamics>::Point<f64>,
    signals: &<F::Dynamics as Dynamics>::Signals<f64>,
) -> Result<(), Fault> {
    let mut first = Ok(());
    faults::<F>(at, signals, &mut |fault| {
        if first.is_ok() {
            first = Err(fault);
        }
    });
    first
}

/// [`probe`] that goes on after a fault: calls `report` with every one.
pub fn faults<F: Block>(
    at: &<F::Dynamics as Dynamics>::Point<f64>,
    signals: &<F::Dynamics as Dynamics>::Signals<f64>,
    report: &mut dyn FnMut(Fault),
) {
    F::blocks(0, &mut Probe::<F::Dynamics> { at, signals, report });
}

struct Probe<'a, D: Dynamics> {
    at: &'a D::Point<f64>,
    signals: &'a D::Signals<f64>,
    report: &'a mut dyn FnMut(Fault),
}

impl<D: Dynamics> BlockVisitor<D> for Probe<'_, D> {
    fn visit<B: Block<Dynamics = D>>(&mut self, _: usize) {
        let dim = B::DIM;
        let report = &mut *self.report;
        let mut fault = |flaw| report(Fault { block: B::NAME, flaw });
        let mut states = 0;
        B::states(&mut |info| {
            if info.block != B::NAME {
                fault(Flaw::Named { state: states, name: info.block });
            }
            states += 1;
        });
        if states != dim {
            fault(Flaw::Described { states, dim });
        }
        B::input_jacobian(self.signals, &mut |input, state, _| {
            if state >= dim {
                fault(Flaw::State { within: "input_jacobian", state, dim });
            }
            if input >= D::INPUTS {
                fault(Flaw::Input { input, inputs: D::INPUTS });
            }
        });
        let channels = D::CHANNELS;
        B::measurement_jacobian(self.at, &mut |channel, state, _| {
            if state >= dim {
                fault(Flaw::State { within: "measurement_jacobian", state, dim });
            }
            if channel >= channels {
                fault(Flaw::Channel { channel, channels });
            }
        });
        for &(state, relaxation) in B::RELAXATIONS {
            if state >= dim {
                fault(Flaw::State { within: "RELAXATIONS", state, dim });
            }
            if !(relaxation.rate >= 0.0 && relaxation.density >= 0.0) {
                fault(Flaw::Relaxation { state, relaxation });
            }
        }
    }
}
