//! Blocks that contradict themselves, each named with what is wrong.

use calib_core::{
    Block, BlockView, BlockVisitor, Dynamics, Fault, Flaw, Need, Real, Relaxation, StateInfo, faults, probe,
};

/// One state, two inputs, one channel.
struct Rail;

impl Dynamics for Rail {
    const CORE: usize = 1;
    const INPUTS: usize = 2;
    const CHANNELS: usize = 1;
    const NEEDS: &'static [Need] = &[];
    type Signals<T: Real> = ();
    type Point<T: Real> = ();
    fn core_jacobian<T: Real>((): &(), _: &mut impl FnMut(usize, usize, T)) {}
    fn inject<T: Real>((): &(), _: usize, _: T, _: &mut impl FnMut(usize, T)) {}
    fn measurement_jacobian<T: Real>((): &(), _: &mut impl FnMut(usize, usize, T)) {}
}

const fn info(block: &'static str) -> StateInfo {
    StateInfo { block, component: "x", unit: "m", prior_sigma: 1.0, sheet_unit: "mm", sheet_scale: 1e-3 }
}

/// A block of two states that describes some, and puts some entries.
macro_rules! block {
    ($name:ident, $states:expr, $input:expr, $channel:expr, $relaxations:expr) => {
        struct $name;
        impl Block for $name {
            type Dynamics = Rail;
            type View<'a, T: Real> = BlockView<'a, Self, T>;
            const NAME: &'static str = stringify!($name);
            const DIM: usize = 2;
            const RELAXATIONS: &'static [(usize, Relaxation<f64>)] = $relaxations;
            fn states(visit: &mut dyn FnMut(StateInfo)) {
                for name in $states {
                    visit(info(name));
                }
            }
            fn input_jacobian<T: Real>((): &(), put: &mut impl FnMut(usize, usize, T)) {
                let (input, state) = $input;
                put(input, state, T::one());
            }
            fn measurement_jacobian<T: Real>((): &(), put: &mut impl FnMut(usize, usize, T)) {
                let (channel, state) = $channel;
                put(channel, state, T::one());
            }
        }
    };
}

const WALK: Relaxation<f64> = Relaxation { rate: 0.0, density: 1e-6 };

block!(Sound, ["Sound"; 2], (1, 1), (0, 1), &[(0, WALK), (1, WALK)]);
block!(Many, ["Many"; 3], (1, 1), (0, 1), &[]);
block!(Few, ["Few"; 1], (1, 1), (0, 1), &[]);
block!(Misnamed, ["Misnamed", "Other"], (1, 1), (0, 1), &[]);
block!(Beyond, ["Beyond"; 2], (1, 2), (0, 3), &[(2, WALK)]);
block!(NoInput, ["NoInput"; 2], (2, 0), (0, 1), &[]);
block!(NoChannel, ["NoChannel"; 2], (0, 0), (1, 1), &[]);
block!(
    Growing,
    ["Growing"; 2],
    (0, 0),
    (0, 1),
    &[(0, Relaxation { rate: -0.1, density: 0.0 }), (1, Relaxation { rate: f64::NAN, density: 0.0 })]
);

fn flaws<B: Block<Dynamics = Rail>>() -> Vec<Flaw> {
    let mut found = Vec::new();
    faults::<B>(&(), &(), &mut |fault| {
        assert_eq!(fault.block, B::NAME);
        found.push(fault.flaw);
    });
    assert_eq!(probe::<B>(&(), &()).err().map(|fault| fault.flaw), found.first().copied());
    found
}

#[test]
fn each_contradiction_is_found() {
    assert_eq!(flaws::<Sound>(), []);
    assert_eq!(flaws::<Many>(), [Flaw::Described { states: 3, dim: 2 }]);
    assert_eq!(flaws::<Few>(), [Flaw::Described { states: 1, dim: 2 }]);
    assert_eq!(flaws::<Misnamed>(), [Flaw::Named { state: 1, name: "Other" }]);
    let beyond = |within, state| Flaw::State { within, state, dim: 2 };
    let all = [beyond("input_jacobian", 2), beyond("measurement_jacobian", 3), beyond("RELAXATIONS", 2)];
    assert_eq!(flaws::<Beyond>(), all);
    assert_eq!(flaws::<NoInput>(), [Flaw::Input { input: 2, inputs: 2 }]);
    assert_eq!(flaws::<NoChannel>(), [Flaw::Channel { channel: 1, channels: 1 }]);
    assert!(matches!(
        flaws::<Growing>()[..],
        [Flaw::Relaxation { state: 0, .. }, Flaw::Relaxation { state: 1, .. }]
    ));
}

/// Two blocks in a row, as a declaration has them.
struct Pair;

impl Block for Pair {
    type Dynamics = Rail;
    type View<'a, T: Real> = BlockView<'a, Self, T>;
    const NAME: &'static str = "pair";
    const DIM: usize = 4;
    fn states(visit: &mut dyn FnMut(StateInfo)) {
        Sound::states(visit);
        NoInput::states(visit);
    }
    fn blocks(first: usize, visitor: &mut impl BlockVisitor<Rail>) {
        Sound::blocks(first, visitor);
        NoInput::blocks(first + 2, visitor);
    }
}

#[test]
fn the_block_is_named_and_not_what_it_is_in() {
    let fault: Fault = probe::<Pair>(&(), &()).expect_err("a fault");
    assert_eq!(
        fault.to_string(),
        "block `NoInput`: `input_jacobian` puts input 2, inputs are counted from 0 and there are 2"
    );
}
