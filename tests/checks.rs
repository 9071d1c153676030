//! The checks for people who declare, on all that is declared here; and on what is wrong.

mod common;

use common::{Numbers, point, signals};
use sinscal::check::{self, Model};
use sinscal::prelude::*;
use sinscal::{FORCE, FilterVisitor, Signals, Sins36P, Sins43B, visit_filter};

struct Checked;

impl FilterVisitor for Checked {
    type Output = ();

    fn visit<F: Filter<Dynamics = Strapdown>>(self) {
        sinscal::probe::<F>().expect("no block contradicts itself");
        let report = check::filter::<F>().unwrap_or_else(|faults| panic!("{faults}"));
        assert_eq!((report.name, report.states), (F::NAME, F::DIM));
        // every cycle is compared with dense matrices before a benchmark runs it
        let mut timed = Vec::new();
        check::bench::<F>(&point(&mut Numbers(7)), &signals(3.0), &mut |name, routine| {
            (0..120).for_each(|_| routine());
            timed.push(name.to_owned());
        })
        .unwrap_or_else(|mismatch| panic!("{}: {mismatch}", F::NAME));
        assert_eq!(timed, ["conventional", "UD", "nalgebra, dynamic, (I - K H) P"]);
    }
}

#[test]
fn declared_filters_have_no_fault() {
    for filter in sinscal::FILTERS {
        visit_filter(filter.name, Checked).expect("a declared filter");
    }
}

#[test]
fn a_report_counts() {
    let report = check::filter::<Sins43B>().unwrap();
    assert_eq!((report.blocks, report.relaxing), (15, 0));
    let report = check::block::<AccelDelay>().unwrap();
    assert_eq!(
        report.to_string(),
        "accel-delay: 1 state in 1 block, Jacobian entries: 3 by inputs, 0 by channels, 0 relaxing states"
    );
}

/// `d_f_i = k_i |omega|`, wandering.
struct Spin;

const WANDER: Relaxation<f64> = Relaxation { rate: 0.01, density: 1e-6 };

impl Block for Spin {
    type Dynamics = Strapdown;
    type View<'a, T: Real> = BlockView<'a, Self, T>;
    const NAME: &'static str = "spin";
    const DIM: usize = 3;
    const RELAXATIONS: &'static [(usize, Relaxation<f64>)] = &[(0, WANDER), (1, WANDER), (2, WANDER)];
    fn states(visit: &mut dyn FnMut(StateInfo)) {
        for component in ["x", "y", "z"] {
            visit(StateInfo {
                block: Self::NAME,
                component,
                unit: "m/s",
                prior_sigma: 1e-2,
                sheet_unit: "mm/s",
                sheet_scale: 1e-3,
            });
        }
    }
    fn input_jacobian<T: Real>(signals: &Signals<T>, put: &mut impl FnMut(usize, usize, T)) {
        for i in 0..3 {
            put(FORCE + i, i, signals.rate.norm());
        }
    }
}

struct Reading {
    rate: [f64; 3],
    factor: f64,
}

impl Model<3, 6> for Reading {
    fn value<T: Real>(&self, k: &[T; 3]) -> [T; 6] {
        let [x, y, z] = self.rate.map(T::of);
        let spin = (x * x + y * y + z * z).sqrt() * T::of(self.factor);
        [T::zero(), T::zero(), T::zero(), k[0] * spin, k[1] * spin, k[2] * spin]
    }
}

#[test]
fn a_jacobian_is_held_against_a_model() {
    let signals = signals(3.0);
    let rate = signals.rate.into();
    check::inputs::<Spin, 3, 6>(&signals, &Reading { rate, factor: 1.0 }, 1e-12).unwrap();
    let wrong = check::inputs::<Spin, 3, 6>(&signals, &Reading { rate, factor: 1.01 }, 1e-12).unwrap_err();
    assert!(
        wrong.to_string().starts_with("block `spin`: `input_jacobian`: Jacobian entry (3, 0)"),
        "{wrong}"
    );
    let wrong =
        check::inputs::<AccelDelay, 3, 6>(&signals, &Reading { rate, factor: 1.0 }, 1e-12).unwrap_err();
    assert!(wrong.to_string().contains("the model takes 3 states, `DIM` is 1"), "{wrong}");
}

#[derive(StateBlocks)]
#[filter(measures(velocity, position))]
struct Spun {
    #[base]
    sins: Sins36P,
    spin: Spin,
}

#[derive(StateBlocks)]
#[group]
struct Again {
    lever: OuterLeverArm,
    spin: Spin,
}

#[test]
fn a_filter_of_ones_own_is_checked_and_timed() {
    assert_eq!(check::filter::<Spun>().unwrap().relaxing, 3);
    check::bench::<Spun>(&point(&mut Numbers(7)), &signals(3.0), &mut |_, routine| routine()).unwrap();
    // an extended filter may have a block twice, which no declaration may
    let twice = check::filter::<sinscal::Extended<Spun, Again>>().unwrap_err();
    assert_eq!(
        twice.lines(),
        ["block `outer-lever-arm` stands there twice", "block `spin` stands there twice"]
    );
}

/// Four states described for three.
struct Counted;

impl Block for Counted {
    type Dynamics = Strapdown;
    type View<'a, T: Real> = BlockView<'a, Self, T>;
    const NAME: &'static str = "counted";
    const DIM: usize = 3;
    fn states(visit: &mut dyn FnMut(StateInfo)) {
        Spin::states(&mut |info| visit(StateInfo { block: Self::NAME, unit: "", ..info }));
        visit(StateInfo {
            block: Self::NAME,
            component: "x",
            unit: "1",
            prior_sigma: f64::NAN,
            sheet_unit: "ppm",
            sheet_scale: 0.0,
        });
    }
    fn input_jacobian<T: Real>(_: &Signals<T>, put: &mut impl FnMut(usize, usize, T)) {
        put(6, 3, T::one());
    }
}

#[derive(StateBlocks)]
#[filter(measures(velocity, position))]
struct Miscounted {
    #[base]
    sins: Sins36P,
    counted: Counted,
}

#[test]
fn every_fault_is_told_with_its_block() {
    let faults = check::filter::<Miscounted>().unwrap_err();
    let without_name: Vec<&str> =
        faults.lines().iter().map(|line| line.strip_prefix("block `counted`: ").expect(line)).collect();
    assert_eq!(
        without_name,
        [
            "`states` describes 4 states where `DIM` is 3",
            "`input_jacobian` is given for state 3, states are counted from 0 and `DIM` is 3",
            "`input_jacobian` puts input 6, inputs are counted from 0 and there are 6",
            "state `x` lacks a unit: a state without one has the unit `1`",
            "state `y` lacks a unit: a state without one has the unit `1`",
            "state `z` lacks a unit: a state without one has the unit `1`",
            "two states are called `x`",
            "state `x`: one ppm is 0 1",
            "state `x`: its prior standard deviation is NaN",
        ]
    );
}

#[test]
fn a_run_names_the_block_that_it_cannot_have() {
    let error = Calibration::<Miscounted>::new(&common::setup()).err().map(|error| error.to_string());
    let expected = "block `counted`: `states` describes 4 states where `DIM` is 3";
    assert!(error.as_ref().is_some_and(|error| error.contains(expected)), "{error:?}");
}
