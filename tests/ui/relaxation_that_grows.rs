//! Relaxations of states that are not there, and of states that grow.
use sinscal::prelude::*;

macro_rules! block {
    ($name:ident, $relaxation:expr) => {
        struct $name;
        impl Block for $name {
            type Dynamics = Strapdown;
            type View<'a, T: Real> = BlockView<'a, Self, T>;
            const NAME: &'static str = stringify!($name);
            const DIM: usize = 1;
            const RELAXATIONS: &'static [(usize, Relaxation<f64>)] = &[$relaxation];
            fn states(_: &mut dyn FnMut(StateInfo)) {}
        }
    };
}

block!(Beyond, (1, Relaxation { rate: 0.0, density: 1e-6 }));
block!(Growing, (0, Relaxation { rate: -0.1, density: 1e-6 }));
block!(Undefined, (0, Relaxation { rate: 0.1, density: f64::NAN }));

#[derive(StateBlocks)]
#[filter(measures(velocity))]
struct Nav {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    beyond: Beyond,
    growing: Growing,
}

#[derive(StateBlocks)]
#[group]
struct Group {
    undefined: Undefined,
}

fn main() {}
