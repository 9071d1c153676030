//! Items that declare nothing: each is reported once, not with its uses.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter(measures(velocity))]
struct Unit;

#[derive(StateBlocks)]
#[filter(measures(velocity))]
struct Tuple(Attitude, Velocity, Position);

#[derive(StateBlocks)]
#[filter(measures(velocity))]
struct Empty {}

#[derive(StateBlocks)]
#[filter(measures(velocity))]
enum Choice {
    Attitude(Attitude),
    Velocity(Velocity),
}

#[derive(StateBlocks)]
#[group]
union Overlap {
    scale: GyroScale,
    bias: GyroBias,
}

fn use_it<F: Filter>() -> usize {
    F::DIM
}

fn main() {
    use_it::<Unit>();
    use_it::<Tuple>();
    use_it::<Empty>();
    use_it::<Choice>();
    let _ = [Unit::DIM, Choice::DIM, Overlap::DIM];
}
