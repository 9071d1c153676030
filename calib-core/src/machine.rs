//! Which instructions the kernels are compiled for.
//!
//! Each kernel is written once and compiled twice: for what every processor of the target can do, and for an x86-64 with
//! 256-bit vectors and fused multiply-add. [`on_this_machine!`] asks the processor, once per kernel. Which processor it is
//! decides the last bits of the results; the number of threads does not.

use crate::Real;

/// A set of instructions a kernel is compiled for.
pub(crate) trait Machine: Copy {
    /// Whether registers hold four `f64`: decides the size of the tiles.
    const WIDE: bool;

    /// `sum + a * b`.
    fn add_product<T: Real>(sum: T, a: T, b: T) -> T;
}

/// What the target promises.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Portable;

impl Machine for Portable {
    const WIDE: bool = cfg!(target_feature = "avx");

    #[inline(always)]
    fn add_product<T: Real>(sum: T, a: T, b: T) -> T {
        // where there is no such instruction `mul_add` is a slow call
        if cfg!(all(feature = "std", any(target_feature = "fma", target_arch = "aarch64"))) {
            a.mul_add(b, sum)
        } else {
            sum + a * b
        }
    }
}

/// An x86-64 with AVX2 and FMA.
#[cfg(all(feature = "std", target_arch = "x86_64"))]
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fused;

#[cfg(all(feature = "std", target_arch = "x86_64"))]
impl Machine for Fused {
    const WIDE: bool = true;

    #[inline(always)]
    fn add_product<T: Real>(sum: T, a: T, b: T) -> T {
        a.mul_add(b, sum)
    }
}

/// `on_this_machine!(m => kernel(m, ...))`: evaluates the call with `m` the best [`Machine`] there is. What is called must be
/// `#[inline(always)]` down to its loops, to be compiled with that machine's instructions.
macro_rules! on_this_machine {
    ($machine:ident => $call:expr) => {{
        #[cfg(all(feature = "std", target_arch = "x86_64"))]
        {
            match fearless_simd::Level::new().as_avx2() {
                Some(avx2) => fearless_simd::Simd::vectorize(
                    avx2,
                    #[inline(always)]
                    || {
                        let $machine = $crate::machine::Fused;
                        $call
                    },
                ),
                None => {
                    let $machine = $crate::machine::Portable;
                    $call
                }
            }
        }
        #[cfg(not(all(feature = "std", target_arch = "x86_64")))]
        {
            let $machine = $crate::machine::Portable;
            $call
        }
    }};
}
pub(crate) use on_this_machine;
