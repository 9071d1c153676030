//! A filter extended by a block that is in no group.
use sinscal::prelude::*;
use sinscal::{Extended, Sins36P};

struct Spin;

impl Block for Spin {
    type Dynamics = Strapdown;
    type View<'a, T: Real> = BlockView<'a, Self, T>;
    const NAME: &'static str = "spin";
    const DIM: usize = 3;
    fn states(_: &mut dyn FnMut(StateInfo)) {}
}

#[derive(StateBlocks)]
#[group]
struct Mine {
    spin: Spin,
}

fn filter<F: Filter>() {}

fn main() {
    filter::<Extended<Sins36P, Mine>>();
    filter::<Extended<Sins36P, AccelDelay>>();
    filter::<Extended<Extended<Sins36P, Mine>, AccelDelay>>();
    filter::<Extended<Sins36P, Spin>>();
}
