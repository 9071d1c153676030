//! A filter that extends itself. rustc has its own word on the struct.
use sinscal::prelude::*;

#[derive(StateBlocks)]
#[filter]
struct Nav {
    #[base]
    nav: Nav,
    delay: AccelDelay,
}

fn main() {}
