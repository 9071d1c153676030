//! Steps and bursts: a bias that is there for a stretch of the log only, sought over all beginnings and ends by the generalised
//! likelihood ratio (Willsky and Jones, IEEE Transactions on Automatic Control 21(1), 1976).

use nalgebra::{DMatrix, Matrix3, Vector3};

use crate::chi2::ln_survival;
use crate::prices::SEEN;

/// The log is cut into so many cells; a stretch begins and ends between two of them.
pub(crate) const CELLS: usize = 24;
/// So many times finer is the second look at where it begins and ends.
const FINER: usize = 8;

/// A stretch of the log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stretch {
    pub(crate) start: f64,
    pub(crate) end: f64,
    /// Whether it lasts to the end of the log.
    pub(crate) lasts: bool,
}

impl Stretch {
    /// In words.
    pub(crate) fn name(&self, triad: &str) -> String {
        if self.lasts {
            format!("step of the bias at {:.0} s in the {triad}s", self.start)
        } else {
            format!("burst of the bias from {:.0} s to {:.0} s in the {triad}s", self.start, self.end)
        }
    }

    /// Bounds of cells for a second look: finer about its beginning and its end.
    pub(crate) fn finer(&self, span: (f64, f64)) -> Vec<f64> {
        let cell = (span.1 - span.0) / CELLS as f64;
        let about = |t: f64| (0..=2 * FINER).map(move |i| t + cell * (i as f64 / FINER as f64 - 1.0));
        let mut bounds: Vec<f64> = about(self.start).collect();
        if self.lasts {
            bounds.push(span.1);
        } else {
            bounds.extend(about(self.end));
        }
        bounds.retain(|t| *t >= span.0 && *t <= span.1);
        bounds.sort_unstable_by(f64::total_cmp);
        bounds.dedup_by(|b, a| *b - *a < 0.01 * cell);
        bounds
    }
}

/// Bounds of the cells of a log.
pub(crate) fn cells(span: (f64, f64)) -> Vec<f64> {
    (0..=CELLS).map(|i| span.0 + (span.1 - span.0) * i as f64 / CELLS as f64).collect()
}

/// One stretch as a test: its directions that can be seen, each scaled to unit variance.
struct Test {
    from: usize,
    to: usize,
    directions: Vec<Vector3<f64>>,
}

/// The tests of all stretches of one triad.
pub(crate) struct Scan {
    tests: Vec<Test>,
    cells: usize,
}

impl Scan {
    /// From the information about the biases of each cell: cell by cell, axis by axis. A stretch from the first bound of the
    /// log on is left out: to a filter that has the bias it is the rest of the log with the other sign.
    pub(crate) fn new(lambda: &DMatrix<f64>, first: usize) -> Self {
        let cells = lambda.nrows() / 3;
        let block =
            |i: usize, j: usize| -> Matrix3<f64> { lambda.fixed_view::<3, 3>(3 * i, 3 * j).into_owned() };
        let mut tests = Vec::new();
        for from in first..cells {
            let mut sum = Matrix3::zeros();
            for to in from + 1..=cells {
                let last = to - 1;
                sum += block(last, last);
                for k in from..last {
                    sum += block(k, last) + block(last, k);
                }
                let eigen = sum.symmetric_eigen();
                let seen = (0..3).filter(|k| eigen.eigenvalues[*k] > SEEN);
                let directions: Vec<Vector3<f64>> =
                    seen.map(|k| eigen.eigenvectors.column(k) / eigen.eigenvalues[k].sqrt()).collect();
                if !directions.is_empty() {
                    tests.push(Test { from, to, directions });
                }
            }
        }
        Self { tests, cells }
    }

    /// How many stretches there are to choose from.
    pub(crate) fn count(&self) -> usize {
        self.tests.len()
    }

    /// The most significant stretch for the score `b` of the cells, as numbers of bounds, and the logarithm of its p-value.
    pub(crate) fn most(&self, b: &[f64]) -> Option<((usize, usize), f64)> {
        let mut sums = vec![Vector3::zeros()];
        for k in 0..self.cells {
            sums.push(sums[k] + Vector3::from_column_slice(&b[3 * k..3 * k + 3]));
        }
        // the p-value falls with the statistic: the largest one of each number of directions will do
        let mut largest: [Option<(f64, &Test)>; 3] = [None; 3];
        for test in &self.tests {
            let score = sums[test.to] - sums[test.from];
            let t: f64 = test.directions.iter().map(|d| d.dot(&score).powi(2)).sum();
            let best = &mut largest[test.directions.len() - 1];
            if best.is_none_or(|(most, _)| t > most) {
                *best = Some((t, test));
            }
        }
        let found = largest.into_iter().flatten();
        found
            .map(|(t, test)| ((test.from, test.to), ln_survival(t, test.directions.len())))
            .min_by(|a, b| a.1.total_cmp(&b.1))
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::{CELLS, Scan, Stretch, cells};

    #[test]
    fn a_stretch_is_found_among_the_cells() {
        // ten cells of three axes, each seen by itself with a standard deviation of a tenth
        let lambda = DMatrix::<f64>::identity(30, 30) * 100.0;
        let mut truth = DVector::zeros(30);
        for cell in 4..7 {
            truth[3 * cell + 1] = 0.5;
        }
        let scan = Scan::new(&lambda, 1);
        let b = &lambda * truth;
        let ((from, to), ln_p) = scan.most(b.as_slice()).unwrap();
        assert_eq!((from, to), (4, 7));
        // chi-squared of 3 x 25 with three degrees of freedom
        assert!((ln_p - crate::ln_survival(75.0, 3)).abs() < 1e-9, "{ln_p}");
        assert_eq!(scan.count(), 45);
    }

    #[test]
    fn the_second_look_is_finer() {
        let span = (100.0, 100.0 + 10.0 * CELLS as f64);
        assert_eq!(cells(span).len(), CELLS + 1);
        let bounds = Stretch { start: 150.0, end: 160.0, lasts: false }.finer(span);
        assert!(bounds.windows(2).all(|w| w[1] > w[0] && w[1] - w[0] < 1.3), "{bounds:?}");
        assert_eq!((bounds[0], bounds[bounds.len() - 1]), (140.0, 170.0));
        let bounds = Stretch { start: 300.0, end: span.1, lasts: true }.finer(span);
        assert_eq!(bounds[bounds.len() - 1], span.1);
    }
}
