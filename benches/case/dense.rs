//! A cycle with nalgebra's matrices: the baselines of all ratios.

use nalgebra::SMatrix;

type M<const N: usize> = SMatrix<f64, N, N>;

/// An interval of `N` states, 9 of them leading, and its six measurements, in static matrices.
pub(crate) struct Dense<const N: usize> {
    pub(crate) f: M<N>,
    pub(crate) q: M<N>,
    pub(crate) h: SMatrix<f64, 6, N>,
    pub(crate) r: SMatrix<f64, 6, 6>,
}

impl<const N: usize> Dense<N> {
    /// From the leading rows of F, the leading block of the noise, H and the variances of its measurements.
    pub(crate) fn new(rows: &[[f64; N]], noise: &[[f64; 9]], h: &[[f64; N]], r: &[f64]) -> Self {
        Self {
            f: M::from_fn(|i, j| if i < 9 { rows[i][j] } else { f64::from(u8::from(i == j)) }),
            q: M::from_fn(|i, j| if i < 9 && j < 9 { noise[i][j] } else { 0.0 }),
            h: SMatrix::from_fn(|i, j| h[i][j]),
            r: SMatrix::from_fn(|i, j| if i == j { r[i] } else { 0.0 }),
        }
    }

    /// (I - K H) P.
    pub(crate) fn short(&self, p: &mut M<N>) {
        self.cycle(p, false);
    }

    /// Joseph's formula.
    pub(crate) fn joseph(&self, p: &mut M<N>) {
        self.cycle(p, true);
    }

    fn cycle(&self, p: &mut M<N>, joseph: bool) {
        *p = self.f * *p * self.f.transpose() + self.q;
        let pht = *p * self.h.transpose();
        let k = pht * (self.h * pht + self.r).try_inverse().expect("positive definite");
        let rest = M::identity() - k * self.h;
        *p = if joseph { rest * *p * rest.transpose() + k * self.r * k.transpose() } else { rest * *p };
    }

    /// What one writes by hand who knows that only nine rows of F are not trivial: P - K (P H')'.
    pub(crate) fn nine_rows(&self, p: &mut M<N>) {
        let rows = self.f.fixed_rows::<9>(0).into_owned();
        let moved = rows * *p;
        let corner = moved * rows.transpose() + self.q.fixed_view::<9, 9>(0, 0);
        p.fixed_rows_mut::<9>(0).copy_from(&moved);
        p.fixed_columns_mut::<9>(0).copy_from(&moved.transpose());
        p.fixed_view_mut::<9, 9>(0, 0).copy_from(&corner);
        let pht = *p * self.h.transpose();
        let k = pht * (self.h * pht + self.r).try_inverse().expect("positive definite");
        *p -= k * pht.transpose();
    }
}
