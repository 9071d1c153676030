//! Declarations with parameters: each is reported once, not with its uses.
use core::marker::PhantomData;

use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter(measures(velocity))]
struct Scalar<T> {
    attitude: Attitude,
    velocity: Velocity,
    position: Position,
    scalar: PhantomData<T>,
}

#[derive(StateBlocks)]
#[filter(measures(velocity))]
struct Borrowed<'a, const N: usize> {
    attitude: &'a Attitude,
    lengths: [u8; N],
}

#[derive(StateBlocks)]
#[group]
struct Bounded
where
    GyroBias: Block,
{
    bias: GyroBias,
}

fn use_it<F: Filter>() -> usize {
    F::DIM
}

fn main() {
    use_it::<Scalar<f64>>();
    use_it::<Borrowed<'static, 3>>();
    let _ = Bounded::DIM;
}
