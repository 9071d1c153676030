//! Two different blocks that bear one name, as those of two crates may.
use sinscal::prelude::*;

macro_rules! block {
    ($name:ident, $dim:literal) => {
        struct $name;
        impl Block for $name {
            type Dynamics = Strapdown;
            type View<'a, T: Real> = BlockView<'a, Self, T>;
            const NAME: &'static str = "spin";
            const DIM: usize = $dim;
            fn states(_: &mut dyn FnMut(StateInfo)) {}
        }
    };
}

block!(OurSpin, 3);
block!(TheirSpin, 3);
block!(ThirdSpin, 1);

#[derive(StateBlocks)]
#[group]
struct Both {
    ours: OurSpin,
    theirs: TheirSpin,
}

#[derive(StateBlocks)]
#[group]
struct OfOtherSizes {
    ours: OurSpin,
    third: ThirdSpin,
}

fn main() {}
