//! The triangle of appended rows against a dense singular value decomposition.

use calib_core::{Dim, Triangle};
use nalgebra::DMatrix;
use proptest::prelude::*;

const N: usize = 12;
type Small = Dim<N, 3, 2>;

/// `rows` rows of rank `rank`, columns of sizes that span `decades` decades.
fn rows(numbers: &[f64], rows: usize, rank: usize, decades: f64) -> DMatrix<f64> {
    let mut next = numbers.iter().copied().cycle();
    let left = DMatrix::from_fn(rows, rank, |_, _| next.next().unwrap_or(0.0));
    let right = DMatrix::from_fn(rank, N, |_, j| {
        next.next().unwrap_or(0.0) * 10f64.powf(decades * (j as f64 / N as f64 - 0.5))
    });
    left * right
}

proptest! {
    #[test]
    fn singular_values_rank_and_directions_agree_with_a_dense_decomposition(
        numbers in prop::collection::vec(-1.0..1.0f64, 997),
        count in 5usize..60,
        rank in 1usize..=N,
        decades in 0.0..4.0f64,
    ) {
        let dense = rows(&numbers, count, rank, decades);
        let mut triangle = Triangle::<Small, f64>::default();
        for i in 0..count {
            triangle.append(&core::array::from_fn(|j| dense[(i, j)]));
        }
        let found = triangle.decompose();
        let mut expected: Vec<f64> = dense.clone().svd(false, false).singular_values.iter().copied().collect();
        expected.sort_by(|a, b| b.total_cmp(a));
        expected.resize(N, 0.0);
        let rounding = 1e-13 * expected[0];
        for (found, expected) in found.values().iter().zip(&expected) {
            prop_assert!((found - expected).abs() < rounding, "{found} {expected}");
        }
        let tolerance = 1e-11 * expected[0];
        let dense_rank = expected.iter().filter(|value| **value > tolerance).count();
        prop_assert_eq!(found.rank(tolerance), dense_rank);
        for i in 0..N {
            let v = DMatrix::from_row_slice(N, 1, found.direction(i));
            prop_assert!((v.norm() - 1.0).abs() < 1e-13);
            prop_assert!(((&dense * v).norm() - found.values()[i]).abs() < rounding);
        }
    }

    #[test]
    fn sigmas_are_those_of_the_normal_equations(numbers in prop::collection::vec(-1.0..1.0f64, 997)) {
        let dense = rows(&numbers, 40, N, 0.0);
        let Some(inverse) = (dense.transpose() * &dense).try_inverse() else { return Ok(()) };
        let (mut first, mut second) = (Triangle::<Small, f64>::default(), Triangle::default());
        for i in 0..40 {
            let row = core::array::from_fn(|j| dense[(i, j)]);
            if i % 3 == 0 { first.append(&row) } else { second.append(&row) }
        }
        first.join(&second);
        for (i, sigma) in first.sigmas().iter().enumerate() {
            prop_assert!((sigma / inverse[(i, i)].sqrt() - 1.0).abs() < 1e-6);
        }
    }
}

#[test]
fn a_state_that_no_row_knows_has_degree_zero() {
    let mut triangle = Triangle::<Small, f64>::default();
    for i in 0..N - 1 {
        let mut row = [0.0; N];
        row[i] = 1.0 + i as f64;
        triangle.append(&row);
    }
    let found = triangle.decompose();
    assert_eq!(found.rank(found.rounding()), N - 1);
    assert_eq!(found.degree(N - 1), 0.0);
    assert_eq!(found.degree(3), 4.0);
    assert!(triangle.sigmas()[N - 1].is_infinite());
    assert_eq!(triangle.sigmas()[3], 0.25);
}
