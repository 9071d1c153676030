//! Blocks and filters as wholes: what can be checked without knowing what they model.

use core::any::TypeId;
use core::fmt;

use super::{Model, compare, dual_jacobian};
use crate::{Block, BlockVisitor, Dynamics, Filter, Leaf, Shape, StateInfo, faults, leaves};

/// Sensor signals of the dynamics of a block.
type Signals<B> = <<B as Block>::Dynamics as Dynamics>::Signals<f64>;
/// Where the dynamics of a block are linearised.
type Point<B> = <<B as Block>::Dynamics as Dynamics>::Point<f64>;

/// What a check has seen of a block or a filter that has no fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Report {
    /// [`Block::NAME`].
    pub name: &'static str,
    /// Blocks that it is made of.
    pub blocks: usize,
    /// Number of states.
    pub states: usize,
    /// Entries that its input Jacobians put.
    pub inputs: usize,
    /// Entries that its measurement Jacobians put.
    pub channels: usize,
    /// States that forget.
    pub relaxing: usize,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, blocks, states, inputs, channels, relaxing } = self;
        let many = |count: &usize| if *count == 1 { "" } else { "s" };
        write!(f, "{name}: {states} state{} in {blocks} block{}, ", many(states), many(blocks))?;
        write!(f, "Jacobian entries: {inputs} by inputs, {channels} by channels, ")?;
        write!(f, "{relaxing} relaxing state{}", many(relaxing))
    }
}

/// All that a check found to be wrong, one line each.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Faults(Vec<String>);

impl Faults {
    /// The lines.
    pub fn lines(&self) -> &[String] {
        &self.0
    }

    /// `report` when nothing is wrong.
    fn or<R>(self, report: R) -> Result<R, Self> {
        if self.0.is_empty() { Ok(report) } else { Err(self) }
    }
}

impl fmt::Display for Faults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.join("\n"))
    }
}

impl core::error::Error for Faults {}

/// Checks a block, or every block of a group.
///
/// - What [`probe`](crate::probe()) looks at: number and name of the states, range of every entry of the Jacobians, relaxations.
/// - Every state has a unit and a unit of data sheets with a size, and a prior that is a number; no two of a block have one name.
///
/// ```
/// # use calib_core::{Block, BlockView, Dynamics, Need, Real, StateInfo, check};
/// # struct Rail;
/// # impl Dynamics for Rail {
/// #     const CORE: usize = 1;
/// #     const INPUTS: usize = 1;
/// #     const CHANNELS: usize = 0;
/// #     const NEEDS: &'static [Need] = &[];
/// #     type Signals<T: Real> = ();
/// #     type Point<T: Real> = ();
/// #     fn core_jacobian<T: Real>(_: &(), _: &mut impl FnMut(usize, usize, T)) {}
/// #     fn inject<T: Real>(_: &(), _: usize, _: T, _: &mut impl FnMut(usize, T)) {}
/// #     fn measurement_jacobian<T: Real>(_: &(), _: &mut impl FnMut(usize, usize, T)) {}
/// # }
/// struct Bias;
/// impl Block for Bias {
///     type Dynamics = Rail;
///     type View<'a, T: Real> = BlockView<'a, Self, T>;
///     const NAME: &'static str = "bias";
///     const DIM: usize = 1;
///     fn states(visit: &mut dyn FnMut(StateInfo)) {
///         visit(StateInfo {
///             block: Self::NAME,
///             component: "x",
///             unit: "m/s^2",
///             prior_sigma: 0.01,
///             sheet_unit: "ug",
///             sheet_scale: 9.80665e-6,
///         });
///     }
///     fn input_jacobian<T: Real>(_: &(), put: &mut impl FnMut(usize, usize, T)) {
///         put(1, 0, T::one()); // there is one input, number 0
///     }
/// }
/// let wrong = check::block::<Bias>().unwrap_err();
/// assert_eq!(
///     wrong.to_string(),
///     "block `bias`: `input_jacobian` puts input 1, inputs are counted from 0 and there are 1"
/// );
/// ```
///
/// # Errors
/// Every fault, each with the name of its block.
pub fn block<B: Block>() -> Result<Report, Faults>
where
    Signals<B>: Default,
    Point<B>: Default,
{
    let (at, signals) = (Point::<B>::default(), Signals::<B>::default());
    let mut found = Vec::new();
    faults::<B>(&at, &signals, &mut |fault| found.push(fault.to_string()));
    let mut descriptions = Descriptions { found };
    B::blocks(0, &mut descriptions);
    let mut report = Report { name: B::NAME, blocks: 0, states: B::DIM, inputs: 0, channels: 0, relaxing: 0 };
    leaves::<B>(|_| report.blocks += 1);
    B::input_jacobian(&signals, &mut |_, _, _: f64| report.inputs += 1);
    B::measurement_jacobian(&at, &mut |_, _, _: f64| report.channels += 1);
    crate::relaxations::<B, f64>(|_, _| report.relaxing += 1);
    Faults(descriptions.found).or(report)
}

/// What the states say of themselves.
struct Descriptions {
    found: Vec<String>,
}

impl<D: Dynamics> BlockVisitor<D> for Descriptions {
    fn visit<B: Block<Dynamics = D>>(&mut self, _: usize) {
        let mut components: Vec<&str> = Vec::new();
        let mut fault = |text: String| self.found.push(format!("block `{}`: {text}", B::NAME));
        if B::NAME.is_empty() {
            fault("it has no name".into());
        }
        B::states(&mut |info| {
            let StateInfo { component, unit, prior_sigma, sheet_unit, sheet_scale, .. } = info;
            if components.contains(&component) {
                fault(format!("two states are called `{component}`"));
            }
            components.push(component);
            if unit.is_empty() || sheet_unit.is_empty() {
                fault(format!("state `{component}` lacks a unit: a state without one has the unit `1`"));
            }
            if !(sheet_scale > 0.0 && sheet_scale.is_finite()) {
                fault(format!("state `{component}`: one {sheet_unit} is {sheet_scale} {unit}"));
            }
            if !(prior_sigma >= 0.0 && prior_sigma.is_finite()) {
                fault(format!("state `{component}`: its prior standard deviation is {prior_sigma}"));
            }
        });
    }
}

/// Checks a declared filter: its blocks as [`block`] does, that no two of them have one name, and that its sizes and
/// measurements are those of its dynamics.
///
/// # Errors
/// Every fault.
pub fn filter<F: Filter>() -> Result<Report, Faults>
where
    Signals<F>: Default,
    Point<F>: Default,
{
    let (report, mut found) = match block::<F>() {
        Ok(report) => (Some(report), Vec::new()),
        Err(Faults(found)) => (None, found),
    };
    let mut seen: Vec<Leaf> = Vec::new();
    leaves::<F>(|leaf| {
        let (id, name): (TypeId, _) = (leaf.id, leaf.name);
        match seen.iter().find(|earlier| earlier.name == name) {
            Some(earlier) if earlier.id == id => found.push(format!("block `{name}` stands there twice")),
            Some(_) => found.push(format!("two blocks are called `{name}`")),
            None => {}
        }
        seen.push(leaf);
    });
    let core = F::Dynamics::CORE;
    if (F::Shape::STATES, F::Shape::CORE) != (F::DIM, core) {
        let (states, leading) = (F::Shape::STATES, F::Shape::CORE);
        let dim = F::DIM;
        found.push(format!("its shape has {states} states, {leading} of them leading, for {dim} and {core}"));
    }
    let rows: usize = F::MEASURES.iter().map(|info| info.components.len()).sum();
    if rows != F::Shape::ROWS {
        found.push(format!("its shape has {} measurement rows for {rows}", F::Shape::ROWS));
    }
    match report {
        Some(report) => Faults(found).or(report),
        None => Err(Faults(found)),
    }
}

/// Compares the input Jacobian of `B` at `signals` with the derivative of a nonlinear `model` at states of zero: what the sensors
/// read, or their errors, by the N states of the block; one result for each input of the dynamics.
///
/// # Errors
/// The first entry that differs by more than `tolerance`, see [`compare`], or is out of range.
pub fn inputs<B: Block, const N: usize, const M: usize>(
    signals: &Signals<B>,
    model: &impl Model<N, M>,
    tolerance: f64,
) -> Result<(), Faults> {
    agree::<B, N, M>("input_jacobian", model, tolerance, |put| {
        B::input_jacobian(signals, &mut |input, state, value| put(input, state, value));
    })
}

/// Compares the measurement Jacobian of `B` at `at` with the derivative of a nonlinear `model` at states of zero: the residuals
/// `computed - measured` by the N states of the block, `truth - estimate`; one result for each channel of the dynamics.
///
/// # Errors
/// The first entry that differs by more than `tolerance`, see [`compare`], or is out of range.
pub fn channels<B: Block, const N: usize, const M: usize>(
    at: &Point<B>,
    model: &impl Model<N, M>,
    tolerance: f64,
) -> Result<(), Faults> {
    agree::<B, N, M>("measurement_jacobian", model, tolerance, |put| {
        B::measurement_jacobian(at, &mut |channel, state, value| put(channel, state, value));
    })
}

fn agree<B: Block, const N: usize, const M: usize>(
    what: &str,
    model: &impl Model<N, M>,
    tolerance: f64,
    fill: impl FnOnce(&mut dyn FnMut(usize, usize, f64)),
) -> Result<(), Faults> {
    let mut found = Vec::new();
    if N != B::DIM {
        found.push(format!("block `{}`: the model takes {N} states, `DIM` is {}", B::NAME, B::DIM));
    }
    let mut jacobian = [[0.0; N]; M];
    fill(&mut |row, state, value| match jacobian.get_mut(row).and_then(|row| row.get_mut(state)) {
        Some(entry) => *entry += value,
        None => {
            found.push(format!(
                "block `{}`: `{what}` puts ({row}, {state}), the model has {M} x {N}",
                B::NAME
            ));
        }
    });
    if let Err(mismatch) = compare(&jacobian, &dual_jacobian(model, &[0.0; N]), tolerance) {
        found.push(format!("block `{}`: `{what}`: {mismatch}", B::NAME));
    }
    Faults(found).or(())
}
