//! Every generated Jacobian against central differences of a model written by hand from the same physics, and
//! against its own list of inputs.
//!
//! Entries are compared one by one, relative to themselves, at 1e-6; below 1e-9 of the largest entry of the
//! same column they count as zero, since differences of double-precision numbers do not show them.

mod fields;
mod reference;
mod sensors;
mod strapdown;

use calib_core::Block;
use fields::{Inputs, Random};
use nalgebra::DMatrix;
use sinscal::{EFFECTS, Effect, Point, Signals};

/// Random points at which each Jacobian is checked.
const POINTS: usize = 120;

/// A block of the catalogue with its Jacobians as functions.
struct Case {
    name: &'static str,
    dim: usize,
    input: fn(&Signals<f64>) -> DMatrix<f64>,
    measurement: fn(&Point<f64>) -> DMatrix<f64>,
}

fn case<B: Effect + Block<Dynamics = sinscal::Strapdown>>() -> Case {
    Case {
        name: B::EFFECT.name(),
        dim: B::DIM,
        input: |signals| {
            let mut j = DMatrix::zeros(6, B::DIM);
            B::input_jacobian(signals, &mut |row, column, value| j[(row, column)] += value);
            j
        },
        measurement: |at| {
            let mut j = DMatrix::zeros(9, B::DIM);
            B::measurement_jacobian(at, &mut |row, column, value| j[(row, column)] += value);
            j
        },
    }
}

fn cases() -> Vec<Case> {
    macro_rules! cases {
        ($($name:ident)*) => { vec![$(case::<sinscal::$name>()),*] };
    }
    let cases = cases! {
        GyroScale GyroMisalignment GyroBias AccelScale AccelMisalignment AccelBias AccelQuadratic OuterLeverArm
        InnerLeverArm DitherSizeEffect AccelDelay AccelTemperatureScale AccelTemperatureBias AccelTemperatureRate
        GyroTemperatureBias GyroGSensitivity AccelScaleAsymmetry GyroScaleAsymmetry AccelCubic AccelCrossCoupling
        GyroRateNonlinearity AccelBiasDrift GyroBiasDrift InnerLeverArmTangential ReferenceDelay ReferenceMisalignment
        ReferenceTilt
    };
    let mut names: Vec<_> = cases.iter().map(|c| c.name).collect();
    let mut known: Vec<_> = EFFECTS.iter().map(|e| e.name()).collect();
    names.sort_unstable();
    known.sort_unstable();
    assert_eq!(names, known, "this test must go through the whole catalogue");
    cases
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
    for case in cases() {
        for _ in 0..POINTS {
            let signals = Signals::random(&mut random);
            let model = |p: &[f64]| sensors::error(case.name, &signals, p);
            let expected = differences(model, &vec![1e-3; case.dim]);
            compare(case.name, &(case.input)(&signals), &expected, 1e-9);
        }
    }
}

#[test]
fn reference_effects_match_their_models() {
    let mut random = Random::new(2);
    for case in cases() {
        for _ in 0..POINTS {
            let at = Point::random(&mut random);
            let model = |delta: &[f64]| reference::residuals(case.name, &at, delta);
            let expected = differences(model, &vec![1e-3; case.dim]);
            compare(case.name, &(case.measurement)(&at), &expected, 1e-9);
        }
    }
}

#[test]
fn effects_use_what_their_tables_list_and_nothing_else() {
    let mut random = Random::new(3);
    for (case, effect) in cases().iter().zip(cases().iter().map(|c| sinscal::effect(c.name).unwrap())) {
        if effect.table.rows == 6 {
            fields::poison(case.name, effect.table.inputs, &Signals::random(&mut random), case.input);
            let still = (case.measurement)(&Point::all_nan());
            assert_eq!(still.amax(), 0.0, "{}: a sensor effect touches the measurement", case.name);
        } else {
            fields::poison(case.name, effect.table.inputs, &Point::random(&mut random), case.measurement);
            let still = (case.input)(&Signals::all_nan());
            assert_eq!(still.amax(), 0.0, "{}: a reference effect touches the sensors", case.name);
        }
    }
}

#[test]
fn tables_count_their_entries() {
    let mut random = Random::new(4);
    for case in cases() {
        let table = sinscal::effect(case.name).unwrap().table;
        let sum = |j: DMatrix<f64>| j.iter().filter(|v| **v != 0.0).count();
        let nonzeros = if table.rows == 6 {
            sum((case.input)(&Signals::random(&mut random)))
        } else {
            sum((case.measurement)(&Point::random(&mut random)))
        };
        assert_eq!((nonzeros, case.dim), (table.nonzeros, table.columns), "{}", case.name);
        assert_eq!(table.components.len(), case.dim, "{}", case.name);
    }
}

#[test]
fn blocks_describe_one_state_for_each_component() {
    for effect in &EFFECTS {
        let mut components = Vec::new();
        effect.states(&mut |state| {
            assert_eq!((state.block, state.unit), (effect.name(), effect.unit()));
            assert!(state.prior_sigma > 0.0 && state.sheet_scale > 0.0, "{}", effect.name());
            let in_sheet_units = state.prior_sigma / state.sheet_scale;
            assert!((1e-2..1e4).contains(&in_sheet_units), "{}: {in_sheet_units}", effect.name());
            components.push(state.component);
        });
        assert_eq!(components, effect.components());
    }
}
