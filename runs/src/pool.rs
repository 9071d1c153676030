//! The filters that others are composed of at run time: navigation and everything that can be estimated.

use sinscal::prelude::*;
use sinscal::{Catalogue, Open};

macro_rules! pool {
    ($($(#[$doc:meta])* $name:ident measures $($measured:ident),+;)+) => { $(
        $(#[$doc])*
        #[derive(Debug, StateBlocks)]
        #[filter(name = "pool", measures($($measured),+))]
        pub(crate) struct $name {
            attitude: Attitude,
            velocity: Velocity,
            position: Position,
            known: Catalogue,
            dither: Dither,
            open: Open,
        }
    )+ };
}

pool! {
    /// For filters of a turntable.
    OnTable measures velocity, position;
    /// For filters of a unit that is carried.
    Carried measures velocity;
    /// For filters of a unit that is tracked.
    Tracked measures position, attitude;
}
