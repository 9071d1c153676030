//! Products of dense matrices, row by row, for linear runs about a recorded trajectory.

/// `sum + a b`; fused where the kernel is compiled for a processor that can.
#[inline(always)]
fn add<const FUSED: bool>(sum: f64, a: f64, b: f64) -> f64 {
    if FUSED { a.mul_add(b, sum) } else { sum + a * b }
}

/// `out += a b`, a of `rows` x `inner`, b of `inner` x `cols`, four rows of b at a time.
#[inline(always)]
pub fn multiply<const FUSED: bool>(
    a: &[f64],
    b: &[f64],
    rows: usize,
    inner: usize,
    cols: usize,
    out: &mut [f64],
) {
    for i in 0..rows {
        let out = &mut out[i * cols..(i + 1) * cols];
        let a = &a[i * inner..(i + 1) * inner];
        let mut k = 0;
        while k + 4 <= inner {
            let (a0, a1, a2, a3) = (a[k], a[k + 1], a[k + 2], a[k + 3]);
            if a0 != 0.0 || a1 != 0.0 || a2 != 0.0 || a3 != 0.0 {
                let b0 = &b[k * cols..(k + 1) * cols];
                let b1 = &b[(k + 1) * cols..(k + 2) * cols];
                let b2 = &b[(k + 2) * cols..(k + 3) * cols];
                let b3 = &b[(k + 3) * cols..(k + 4) * cols];
                for j in 0..cols {
                    let sum = add::<FUSED>(add::<FUSED>(out[j], a0, b0[j]), a1, b1[j]);
                    out[j] = add::<FUSED>(add::<FUSED>(sum, a2, b2[j]), a3, b3[j]);
                }
            }
            k += 4;
        }
        while k < inner {
            for (o, b) in out.iter_mut().zip(&b[k * cols..(k + 1) * cols]) {
                *o = add::<FUSED>(*o, a[k], *b);
            }
            k += 1;
        }
    }
}

/// `out -= a' b`, a of `rows` x `n`, b of `rows` x `cols`.
#[inline(always)]
pub fn subtract_outer<const FUSED: bool>(
    a: &[f64],
    b: &[f64],
    rows: usize,
    n: usize,
    cols: usize,
    out: &mut [f64],
) {
    for i in 0..n {
        let out = &mut out[i * cols..(i + 1) * cols];
        let mut m = 0;
        while m + 3 <= rows {
            let (a0, a1, a2) = (-a[m * n + i], -a[(m + 1) * n + i], -a[(m + 2) * n + i]);
            let b0 = &b[m * cols..(m + 1) * cols];
            let b1 = &b[(m + 1) * cols..(m + 2) * cols];
            let b2 = &b[(m + 2) * cols..(m + 3) * cols];
            for j in 0..cols {
                out[j] = add::<FUSED>(add::<FUSED>(add::<FUSED>(out[j], a0, b0[j]), a1, b1[j]), a2, b2[j]);
            }
            m += 3;
        }
        while m < rows {
            let v = a[m * n + i];
            for (o, b) in out.iter_mut().zip(&b[m * cols..(m + 1) * cols]) {
                *o -= v * b;
            }
            m += 1;
        }
    }
}

/// `out += rows' rows`, its upper triangle, rows of `cols`, four at a time.
#[inline(always)]
pub fn add_products<const FUSED: bool>(rows: &[f64], cols: usize, out: &mut [f64]) {
    for i in 0..cols {
        let out = &mut out[i * cols + i..(i + 1) * cols];
        let mut four = rows.chunks_exact(4 * cols);
        for four in &mut four {
            let [a, b, c, d] = core::array::from_fn(|k| &four[k * cols + i..(k + 1) * cols]);
            let (a0, b0, c0, d0) = (a[0], b[0], c[0], d[0]);
            for ((((out, a), b), c), d) in out.iter_mut().zip(a).zip(b).zip(c).zip(d) {
                let sum = add::<FUSED>(add::<FUSED>(*out, a0, *a), b0, *b);
                *out = add::<FUSED>(add::<FUSED>(sum, c0, *c), d0, *d);
            }
        }
        for row in four.remainder().chunks_exact(cols) {
            let v = row[i];
            out.iter_mut().zip(&row[i..]).for_each(|(out, r)| *out += v * r);
        }
    }
}

/// In partial sums: one sum would wait for each product before the next.
#[inline(always)]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (a, a_rest) = a.as_chunks::<8>();
    let (b, b_rest) = b.as_chunks::<8>();
    let mut lanes = [0.0; 8];
    for (a, b) in a.iter().zip(b) {
        for l in 0..8 {
            lanes[l] += a[l] * b[l];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    lanes.iter().sum::<f64>() + rest
}

/// Cholesky factor of `s`, applied to the rows of `yp` and `y`; `ln det s`, or nothing when it is not positive definite.
#[inline(always)]
pub fn whiten(s: &mut [f64], m: usize, yp: &mut [f64], n: usize, y: &mut [f64], nc: usize) -> Option<f64> {
    let mut log_det = 0.0;
    for i in 0..m {
        for j in 0..=i {
            let mut sum = s[i * m + j];
            for k in 0..j {
                sum -= s[i * m + k] * s[j * m + k];
            }
            if i == j {
                if !(sum > 0.0) {
                    return None;
                }
                s[i * m + i] = sum.sqrt();
                log_det += sum.ln();
            } else {
                s[i * m + j] = sum / s[j * m + j];
            }
        }
    }
    for (matrix, cols) in [(yp, n), (y, nc)] {
        for i in 0..m {
            let (done, rest) = matrix.split_at_mut(i * cols);
            let row = &mut rest[..cols];
            for k in 0..i {
                let factor = s[i * m + k];
                for (r, d) in row.iter_mut().zip(&done[k * cols..(k + 1) * cols]) {
                    *r -= factor * d;
                }
            }
            let inverse = 1.0 / s[i * m + i];
            for r in row {
                *r *= inverse;
            }
        }
    }
    Some(log_det)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(length: usize, seed: usize) -> Vec<f64> {
        (0..length).map(|i| ((i * 31 + seed * 17) as f64).sin()).collect()
    }

    fn assert_close(got: &[f64], want: &[f64]) {
        assert!(got.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-13), "{got:?}, {want:?}");
    }

    /// Fused or not, with and without what is left over where rows are taken several at a time.
    fn follows_the_definition<const FUSED: bool>() {
        for (rows, inner, cols) in [(6, 9, 11), (3, 8, 5), (1, 2, 1), (5, 7, 8)] {
            let (mut a, b) = (wave(rows * inner, 1), wave(inner * cols, 2));
            a[..inner.min(4)].fill(0.0);
            let mut out = wave(rows * cols, 3);
            let mut want = out.clone();
            for (i, j, k) in (0..rows * cols * inner).map(|n| (n / inner / cols, n / inner % cols, n % inner))
            {
                want[i * cols + j] += a[i * inner + k] * b[k * cols + j];
            }
            multiply::<FUSED>(&a, &b, rows, inner, cols, &mut out);
            assert_close(&out, &want);

            // `out -= a' b` of as many rows
            let (a, b) = (wave(rows * inner, 4), wave(rows * cols, 5));
            let mut out = wave(inner * cols, 6);
            let mut want = out.clone();
            for (i, j, k) in (0..inner * cols * rows).map(|n| (n / rows / cols, n / rows % cols, n % rows)) {
                want[i * cols + j] -= a[k * inner + i] * b[k * cols + j];
            }
            subtract_outer::<FUSED>(&a, &b, rows, inner, cols, &mut out);
            assert_close(&out, &want);

            // `out += a' a`, the upper triangle
            let a = wave(rows * inner, 9);
            let mut out = wave(inner * inner, 10);
            let mut want = out.clone();
            for (i, j, k) in (0..inner * inner * rows).map(|n| (n / rows / inner, n / rows % inner, n % rows))
            {
                want[i * inner + j] += if j < i { 0.0 } else { a[k * inner + i] * a[k * inner + j] };
            }
            add_products::<FUSED>(&a, inner, &mut out);
            for i in 0..inner {
                assert_close(&out[i * inner + i..(i + 1) * inner], &want[i * inner + i..(i + 1) * inner]);
            }

            let (a, b) = (wave(inner, 7), wave(inner, 8));
            assert_close(&[dot(&a, &b)], &[(0..inner).map(|k| a[k] * b[k]).sum()]);
        }
    }

    #[test]
    fn products_follow_their_definition() {
        follows_the_definition::<false>();
        follows_the_definition::<true>();
    }
}
