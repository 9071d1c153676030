//! The loop where the time goes, on tiles that fit into registers.
//!
//! The sums of a tile never leave the processor, and each row of the right-hand side is read once for all of them. Each sum
//! runs over k in order, so that results do not depend on the tile they fall into.

use crate::{Array, Real};

/// Three with 256-bit registers; with 128 bits the sums of a third row would not stay in registers.
const ROWS: usize = if cfg!(target_feature = "avx") { 3 } else { 2 };
const COLUMNS: usize = 8;

/// `sum + a * b`, fused where the target can.
#[inline(always)]
fn add_product<T: Real>(sum: T, a: T, b: T) -> T {
    if cfg!(all(feature = "std", target_feature = "fma")) { a.mul_add(b, sum) } else { sum + a * b }
}

/// Columns `first..first + COLUMNS` of `R` rows of the product of `left` and `right`.
#[inline(always)]
fn tile<T: Real, A: Array<T>, V: Array<T>, const R: usize>(
    left: &[A; R],
    right: &[V],
    first: usize,
) -> [[T; COLUMNS]; R] {
    let mut sums = [[T::zero(); COLUMNS]; R];
    for (k, row) in right.iter().enumerate() {
        if let Some(row) = row.as_slice()[first..].first_chunk::<COLUMNS>() {
            for r in 0..R {
                let a = left[r][k];
                for c in 0..COLUMNS {
                    sums[r][c] = add_product(sums[r][c], a, row[c]);
                }
            }
        }
    }
    sums
}

/// Calls `put(row, first column, values)` for pieces of the product of the matrices whose rows are `left` and `right`.
#[inline(always)]
pub(crate) fn product<T: Real, A: Array<T>, V: Array<T>>(
    left: &[A],
    right: &[V],
    mut put: impl FnMut(usize, usize, &[T]),
) {
    let width = right.first().map_or(0, |row| row.as_slice().len());
    let (groups, rest) = left.as_chunks::<ROWS>();
    if width < COLUMNS {
        for (r, left) in left.iter().enumerate() {
            for c in 0..width {
                let mut sum = T::zero();
                for (k, row) in right.iter().enumerate() {
                    sum = add_product(sum, left[k], row[c]);
                }
                put(r, c, &[sum]);
            }
        }
        return;
    }
    let mut done = 0;
    while done < width {
        // the last tile overlaps the one before and hands over only what is new
        let first = done.min(width - COLUMNS);
        for (i, left) in groups.iter().enumerate() {
            let sums = tile(left, right, first);
            for r in 0..ROWS {
                put(i * ROWS + r, done, &sums[r][done - first..]);
            }
        }
        for (i, left) in rest.iter().enumerate() {
            let sums = tile(core::array::from_ref(left), right, first);
            put(groups.len() * ROWS + i, done, &sums[0][done - first..]);
        }
        done = first + COLUMNS;
    }
}
