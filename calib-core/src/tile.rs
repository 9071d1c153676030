//! The loops where the time goes, on tiles that fit into registers.
//!
//! The sums of a tile never leave the processor, and what it reads serves several of them. Each sum runs over k in order, so
//! that results do not depend on the tile they fall into.

use core::marker::PhantomData;

use crate::machine::Machine;
use crate::{Array, Real};

/// In the body of a loop: its rounds follow one another. Where they read or write a column the compiler would make lanes of
/// them, with AVX-512, and gather and scatter those, several times slower.
#[inline(always)]
pub(crate) fn in_turn() {
    core::hint::black_box(());
}

/// Adds to `sums`, columns `first..first + C` of rows `i..i + R` of a product: the sum over `ks` of `left(row, k)` times row k
/// of `right`.
#[inline(always)]
pub(crate) fn add_tile<M: Machine, T: Real, V: Array<T>, const R: usize, const C: usize>(
    mut sums: [[T; C]; R],
    left: &impl Fn(usize, usize) -> T,
    right: &[V],
    ks: impl Iterator<Item = usize>,
    (i, first): (usize, usize),
) -> [[T; C]; R] {
    for k in ks {
        if let Some(row) = right[k].as_slice()[first..].first_chunk::<C>() {
            for r in 0..R {
                let a = left(i + r, k);
                for c in 0..C {
                    sums[r][c] = M::add_product(sums[r][c], a, row[c]);
                }
            }
        }
    }
    sums
}

/// Columns `first..first + C` of rows `i..i + R` of a product, as [`add_tile`] sums it.
#[inline(always)]
pub(crate) fn tile<M: Machine, T: Real, V: Array<T>, const R: usize, const C: usize>(
    left: &impl Fn(usize, usize) -> T,
    right: &[V],
    ks: impl Iterator<Item = usize>,
    at: (usize, usize),
) -> [[T; C]; R] {
    add_tile::<M, T, V, R, C>([[T::zero(); C]; R], left, right, ks, at)
}

/// What is done with neighbouring columns of a matrix, some at a time.
pub(crate) trait Panel {
    /// Does it with columns `first..first + C`, but for so many at the beginning that are `done`.
    fn columns<const C: usize>(&mut self, first: usize, done: usize);
}

/// Does it with the first `width` of `length` columns, `C` at a time and fewer in the end.
#[inline(always)]
pub(crate) fn panels<const C: usize>((width, length): (usize, usize), panel: &mut impl Panel) {
    let mut next = 0;
    while next + C <= width {
        panel.columns::<C>(next, 0);
        next += C;
    }
    // a panel that would reach beyond the row begins earlier; where exactly the compiler shall not know, or it takes the tiles
    // apart for the sake of columns that are done
    let first = |size: usize| {
        let first = next.min(length - size);
        (first, core::hint::black_box(next - first))
    };
    match width - next {
        0 => {}
        ..=4 if length >= 4 => {
            let (first, done) = first(4);
            panel.columns::<4>(first, done);
        }
        ..=8 if length >= 8 => {
            let (first, done) = first(8);
            panel.columns::<8>(first, done);
        }
        _ if length >= C => {
            let (first, done) = first(C);
            panel.columns::<C>(first, done);
        }
        _ => {
            for c in next..width {
                panel.columns::<1>(c, 0);
            }
        }
    }
}

/// A product of `left`, of so many `rows`, and the first `width` columns of `right`, in tiles of `R` rows.
struct Product<'a, V, L, K, P, const R: usize, M, T> {
    rows: usize,
    width: usize,
    left: &'a L,
    right: &'a [V],
    ks: &'a K,
    put: &'a mut P,
    machine: PhantomData<(M, T)>,
}

impl<V, L, K, P, const R: usize, M, T> Panel for Product<'_, V, L, K, P, R, M, T>
where
    V: Array<T>,
    L: Fn(usize, usize) -> T,
    K: Iterator<Item = usize> + Clone,
    P: FnMut(usize, usize, &[T]),
    M: Machine,
    T: Real,
{
    #[inline(always)]
    fn columns<const C: usize>(&mut self, first: usize, _: usize) {
        let keep = C.min(self.width - first);
        let whole = self.rows / R * R;
        for i in (0..whole).step_by(R) {
            let sums = tile::<M, T, V, R, C>(self.left, self.right, self.ks.clone(), (i, first));
            for r in 0..R {
                (self.put)(i + r, first, &sums[r][..keep]);
            }
        }
        for i in whole..self.rows {
            let sums = tile::<M, T, V, 1, C>(self.left, self.right, self.ks.clone(), (i, first));
            (self.put)(i, first, &sums[0][..keep]);
        }
    }
}

/// Calls `put(row, first column, values)` for pieces of the product of `left`, of so many `rows`, and the first `width`
/// columns of `right`; k runs over `ks`, where `left` is not zero. Some columns come twice, with the same bits.
#[inline(always)]
pub(crate) fn product<M: Machine, T: Real, V: Array<T>>(
    _: M,
    size: (usize, usize),
    left: impl Fn(usize, usize) -> T,
    right: &[V],
    ks: impl Iterator<Item = usize> + Clone,
    mut put: impl FnMut(usize, usize, &[T]),
) {
    if M::WIDE {
        blocks::<M, T, V, 3, 12>(size, &left, right, &ks, &mut put);
    } else {
        blocks::<M, T, V, 2, 8>(size, &left, right, &ks, &mut put);
    }
}

/// [`product`] in tiles of `R` x `C`, the last of each row narrower.
#[inline(always)]
pub(crate) fn blocks<M: Machine, T: Real, V: Array<T>, const R: usize, const C: usize>(
    (rows, width): (usize, usize),
    left: &impl Fn(usize, usize) -> T,
    right: &[V],
    ks: &(impl Iterator<Item = usize> + Clone),
    put: &mut impl FnMut(usize, usize, &[T]),
) {
    let length = right.first().map_or(0, |row| row.as_slice().len());
    let mut product =
        Product::<_, _, _, _, R, M, T> { rows, width, left, right, ks, put, machine: PhantomData };
    panels::<C>((width, length), &mut product);
}

/// The sums over `ks` of `left(r, k)` times `right(c, k)`.
#[inline(always)]
pub(crate) fn small_product<M: Machine, T: Real, const R: usize, const C: usize>(
    _: M,
    left: impl Fn(usize, usize) -> T,
    right: impl Fn(usize, usize) -> T,
    ks: impl Iterator<Item = usize>,
) -> [[T; C]; R] {
    let mut sums = [[T::zero(); C]; R];
    for k in ks {
        for r in 0..R {
            for c in 0..C {
                sums[r][c] = M::add_product(sums[r][c], left(r, k), right(c, k));
            }
        }
    }
    sums
}

/// Partial sums of a scalar product.
const LANES: usize = 8;

/// `left . right`.
#[inline(always)]
pub(crate) fn dot<M: Machine, T: Real>(_: M, left: &[T], right: &[T]) -> T {
    let (left, left_rest) = left.as_chunks::<LANES>();
    let (right, right_rest) = right.as_chunks::<LANES>();
    let mut lanes = [T::zero(); LANES];
    for (left, right) in left.iter().zip(right) {
        for l in 0..LANES {
            lanes[l] = M::add_product(lanes[l], left[l], right[l]);
        }
    }
    let mut sum = T::zero();
    for (a, b) in left_rest.iter().zip(right_rest) {
        sum = M::add_product(sum, *a, *b);
    }
    let mut half = LANES / 2;
    while half > 0 {
        for l in 0..half {
            let other = lanes[l + half];
            lanes[l] += other;
        }
        half /= 2;
    }
    lanes[0] + sum
}
