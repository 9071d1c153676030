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
                None => $crate::machine::apart(|| {
                    let $machine = $crate::machine::Portable;
                    $call
                }),
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

/// Calls `kernel` in a stack frame of its own: that of the kernel which is not taken would stand beside the other's.
#[cfg(all(feature = "std", target_arch = "x86_64"))]
#[inline(never)]
pub(crate) fn apart<R>(kernel: impl FnOnce() -> R) -> R {
    kernel()
}

#[cfg(all(test, feature = "std", target_arch = "x86_64"))]
mod tests {
    use super::{Fused, Portable};
    use crate::{Conventional, Dim, Form, Shape, Ud, conventional, ud};

    /// A cycle of either form, with the same machine or with another, from the same start.
    macro_rules! cycle {
        ($form:ident, $machine:expr, $p:expr, $case:expr) => {{
            let (rows, noise, h) = $case;
            let (mut x, r, z) = (S::vector(0.1), S::measurement(0.5), S::measurement(0.3));
            $form::propagate::<S, f64, _>($machine, $p, rows, noise);
            let whitened = $form::update::<S, f64, _>($machine, $p, &mut x, h, &r, &z);
            (x, whitened.expect("positive definite"))
        }};
    }

    fn dense<S: Shape, C: Form>(cov: &S::Matrix<f64>) -> S::Matrix<f64> {
        let mut p = S::matrix(0.0);
        C::dense::<S, f64>(cov, &mut p);
        p
    }

    /// Whether the machines give the same bits, which they need not; asserts that they agree within rounding.
    fn compare<S: Shape>() -> bool {
        let wave = |i: usize, j: usize| ((i * 31 + j * 17) as f64).sin();
        let mut rows = S::core_rows(0.0);
        let mut noise = S::core_matrix(0.0);
        let mut h = S::measurement_rows(0.0);
        for j in 0..S::STATES {
            for i in 0..S::CORE {
                rows[i][j] = 0.1 * wave(i, j) + if i == j { 1.0 } else { 0.0 };
            }
            for m in 0..S::ROWS {
                h[m][j] = if j % 3 == 0 { wave(m, j) } else { 0.0 };
            }
        }
        for i in 0..S::CORE {
            noise[i][i] = 0.1;
        }
        let case = (&rows, &noise, &h);
        let [mut a, mut b] = [S::matrix(0.0), S::matrix(0.0)];
        let [mut c, mut d] = [S::matrix(0.0), S::matrix(0.0)];
        for p in [&mut a, &mut b] {
            Conventional::set_diagonal::<S, f64>(p, &S::vector(2.0));
        }
        for p in [&mut c, &mut d] {
            Ud::set_diagonal::<S, f64>(p, &S::vector(2.0));
        }
        for _ in 0..10 {
            let one = cycle!(conventional, Portable, &mut a, case);
            // the pieces are in the same order: without fused products the bits would be the same
            let other = avx2(|| cycle!(conventional, Fused, &mut b, case));
            let third = cycle!(ud, Portable, &mut c, case);
            let fourth = avx2(|| cycle!(ud, Fused, &mut d, case));
            for found in [other, third, fourth] {
                assert!((found.1.nis - one.1.nis).abs() < 1e-11 * one.1.nis);
                for j in 0..S::STATES {
                    assert!((found.0[j] - one.0[j]).abs() < 1e-11);
                }
            }
        }
        let (c, d) = (dense::<S, Ud>(&c), dense::<S, Ud>(&d));
        let mut differ = false;
        for i in 0..S::STATES {
            for j in 0..S::STATES {
                for found in [&b, &c, &d] {
                    assert!((found[i][j] - a[i][j]).abs() < 1e-11, "({i}, {j})");
                }
                differ |= a[i][j].to_bits() != b[i][j].to_bits();
            }
        }
        !differ
    }

    #[test]
    fn results_do_not_depend_on_the_machine_beyond_rounding() {
        if fearless_simd::Level::new().as_avx2().is_none() {
            println!("skipped: this processor has no AVX2");
            return;
        }
        let same = compare::<Dim<43, 9, 6>>();
        assert!(!same || cfg!(target_feature = "fma"), "the machines computed with the same instructions");
        // where the portable tiles compute columns twice that begin among the leading ones
        compare::<Dim<11, 9, 3>>();
    }

    fn avx2<R>(kernel: impl FnOnce() -> R) -> R {
        let level = fearless_simd::Level::new().as_avx2().expect("checked above");
        fearless_simd::Simd::vectorize(level, kernel)
    }
}
