//! Products of dense matrices, row by row, for the linear runs.

/// `sum + a b`; fused where the kernel is compiled for a processor that can.
#[inline(always)]
fn add<const FUSED: bool>(sum: f64, a: f64, b: f64) -> f64 {
    if FUSED { a.mul_add(b, sum) } else { sum + a * b }
}

/// `out += a b`, a of `rows` x `inner`, b of `inner` x `cols`, two rows of b at a time.
#[inline(always)]
pub(crate) fn multiply<const FUSED: bool>(
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
pub(crate) fn subtract_outer<const FUSED: bool>(
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
pub(crate) fn add_products<const FUSED: bool>(rows: &[f64], cols: usize, out: &mut [f64]) {
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
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
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
pub(crate) fn whiten(
    s: &mut [f64],
    m: usize,
    yp: &mut [f64],
    n: usize,
    y: &mut [f64],
    nc: usize,
) -> Option<f64> {
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
