//! Every generated Jacobian against central differences of a model written by hand from the same physics, and
//! against its own list of inputs.
//!
//! Entries are compared one by one, relative to themselves, at 1e-6; below 1e-9 of the largest entry of the
//! same column they count as zero, since differences of double-precision numbers do not show them.

mod fields;
mod reference;
mod sensors;
mod strapdown;

use fields::{Inputs, Random};
use nalgebra::DMatrix;
use sinscal::tables::{ALL, EffectTable};
use sinscal::{AnyEffect, CATALOGUE, EFFECTS, Point, Signals};

/// Random points at which each Jacobian is checked.
const POINTS: usize = 120;

/// Entries of a Jacobian that are put, summed.
fn matrix(
    rows: usize,
    columns: usize,
    jacobian: impl FnOnce(&mut dyn FnMut(usize, usize, f64)),
) -> DMatrix<f64> {
    let mut j = DMatrix::zeros(rows, columns);
    jacobian(&mut |row, column, value| j[(row, column)] += value);
    j
}

fn input(effect: &dyn AnyEffect, signals: &Signals<f64>) -> DMatrix<f64> {
    matrix(6, effect.dim(), |put| effect.input_jacobian(signals, put))
}

fn measurement(effect: &dyn AnyEffect, at: &Point<f64>) -> DMatrix<f64> {
    matrix(9, effect.dim(), |put| effect.measurement_jacobian(at, put))
}

/// The table that an effect is generated from.
fn table(name: &str) -> &'static EffectTable {
    ALL.iter().find(|table| table.name == name).unwrap_or_else(|| panic!("{name} has no table"))
}

/// Derivative of `f` at zero, of fourth order in the steps.
fn differences(f: impl Fn(&[f64]) -> Vec<f64>, steps: &[f64]) -> DMatrix<f64> {
    let rows = f(&vec![0.0; steps.len()]).len();
    let mut jacobian = DMatrix::zeros(rows, steps.len());
    for (j, &step) in steps.iter().enumerate() {
        let slope = |h: f64| {
            let mut x = vec![0.0; steps.len()];
            x[j] = h;
            let up = f(&x);
            x[j] = -h;
            let down = f(&x);
            up.iter().zip(&down).map(|(a, b)| (a - b) / (2.0 * h)).collect::<Vec<_>>()
        };
        for (i, (coarse, fine)) in slope(step).iter().zip(slope(step / 2.0)).enumerate() {
            jacobian[(i, j)] = fine + (fine - coarse) / 3.0;
        }
    }
    jacobian
}

/// Compares entry by entry; `floor` is the part of a column's largest entry below which an entry counts as
/// zero.
fn compare(name: &str, found: &DMatrix<f64>, expected: &DMatrix<f64>, floor: f64) {
    assert_eq!(found.shape(), expected.shape(), "{name}");
    for j in 0..expected.ncols() {
        let scale = expected.column(j).amax();
        for i in 0..expected.nrows() {
            let (a, b) = (found[(i, j)], expected[(i, j)]);
            assert!(
                (a - b).abs() <= 1e-6 * b.abs() + floor * scale,
                "{name} ({i}, {j}): {a:e}, expected {b:e}"
            );
        }
    }
}

#[test]
fn sensor_effects_match_their_models() {
    let mut random = Random::new(1);
    for effect in CATALOGUE {
        let name = effect.name();
        for _ in 0..POINTS {
            let signals = Signals::random(&mut random);
            let model = |p: &[f64]| sensors::error(name, &signals, p);
            let expected = differences(model, &vec![1e-3; effect.dim()]);
            compare(name, &input(*effect, &signals), &expected, 1e-9);
        }
    }
}

#[test]
fn reference_effects_match_their_models() {
    let mut random = Random::new(2);
    for effect in CATALOGUE {
        let name = effect.name();
        for _ in 0..POINTS {
            let at = Point::random(&mut random);
            let model = |delta: &[f64]| reference::residuals(name, &at, delta);
            let expected = differences(model, &vec![1e-3; effect.dim()]);
            compare(name, &measurement(*effect, &at), &expected, 1e-9);
        }
    }
}

#[test]
fn effects_use_what_their_tables_list_and_nothing_else() {
    let mut random = Random::new(3);
    for effect in CATALOGUE {
        let name = effect.name();
        let table = table(name);
        if table.rows == 6 {
            fields::poison(name, table.inputs, &Signals::random(&mut random), |signals| {
                input(*effect, signals)
            });
            let still = measurement(*effect, &Point::all_nan());
            assert_eq!(still.amax(), 0.0, "{}: a sensor effect touches the measurement", name);
        } else {
            fields::poison(name, table.inputs, &Point::random(&mut random), |at| measurement(*effect, at));
            let still = input(*effect, &Signals::all_nan());
            assert_eq!(still.amax(), 0.0, "{}: a reference effect touches the sensors", name);
        }
    }
}

#[test]
fn tables_count_their_entries() {
    let mut random = Random::new(4);
    for effect in CATALOGUE {
        let name = effect.name();
        let table = table(name);
        let sum = |j: DMatrix<f64>| j.iter().filter(|v| **v != 0.0).count();
        let nonzeros = if table.rows == 6 {
            sum(input(*effect, &Signals::random(&mut random)))
        } else {
            sum(measurement(*effect, &Point::random(&mut random)))
        };
        assert_eq!((nonzeros, effect.dim()), (table.nonzeros, table.columns), "{}", name);
        assert_eq!(table.components.len(), effect.dim(), "{}", name);
    }
}

#[test]
fn blocks_describe_one_state_for_each_component() {
    for effect in EFFECTS {
        let mut components = Vec::new();
        effect.states(&mut |state| {
            assert_eq!((state.block, state.unit), (effect.name(), effect.unit()));
            assert!(state.prior_sigma > 0.0 && state.sheet_scale > 0.0, "{}", effect.name());
            let in_sheet_units = state.prior_sigma / state.sheet_scale;
            // a walk begins with what gathers in a second
            let least = if effect.name().ends_with("random-walk") { 1e-5 } else { 1e-2 };
            assert!((least..1e4).contains(&in_sheet_units), "{}: {in_sheet_units}", effect.name());
            components.push(state.component);
        });
        assert_eq!(components, effect.components());
    }
}
