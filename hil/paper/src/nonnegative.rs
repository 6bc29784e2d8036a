//! Least squares with nonnegative unknowns.

use nalgebra::{Cholesky, DMatrix, DVector};

/// Slopes of the error, relative to the largest right-hand side, below which an unknown stays at 0.
const SLOPE: f64 = 1e-10;

/// Minimises xᵀ·G·x/2 − hᵀ·x with x[i] ≥ 0 from `free` on, by the active set method of Lawson and Hanson (1974); `None` if G is not
/// positive definite.
pub fn solve(gram: &DMatrix<f64>, right: &DVector<f64>, free: usize) -> Option<DVector<f64>> {
    let width = right.len();
    let mut used: Vec<bool> = (0..width).map(|i| i < free).collect();
    let mut x = part(gram, right, &used)?;
    let least = SLOPE * right.amax();
    // Every round adds one unknown; a set never occurs twice, and few rounds are needed.
    for _ in 0..10 * width {
        let slope = right - gram * &x;
        let entering = (free..width)
            .filter(|&i| !used[i] && slope[i] > least)
            .max_by(|&a, &b| slope[a].total_cmp(&slope[b]));
        let Some(entering) = entering else {
            break;
        };
        used[entering] = true;
        loop {
            let wanted = part(gram, right, &used)?;
            // As far towards it as all unknowns stay nonnegative.
            let blocking = (free..width)
                .filter(|&i| used[i] && wanted[i] <= 0.0)
                .map(|i| (i, x[i] / (x[i] - wanted[i])))
                .min_by(|a, b| a.1.total_cmp(&b.1));
            let Some((first, step)) = blocking else {
                x = wanted;
                break;
            };
            x += (wanted - &x) * step;
            for i in free..width {
                if used[i] && (i == first || x[i] <= 0.0) {
                    used[i] = false;
                    x[i] = 0.0;
                }
            }
        }
    }
    Some(x)
}

/// The minimum over the unknowns that are `used`, with the others at 0.
fn part(gram: &DMatrix<f64>, right: &DVector<f64>, used: &[bool]) -> Option<DVector<f64>> {
    let places: Vec<usize> = (0..used.len()).filter(|&i| used[i]).collect();
    let some = DMatrix::from_fn(places.len(), places.len(), |i, j| {
        gram[(places[i], places[j])]
    });
    let solved =
        Cholesky::new(some)?.solve(&DVector::from_fn(places.len(), |i, _| right[places[i]]));
    let mut x = DVector::zeros(used.len());
    for (&place, &value) in places.iter().zip(solved.iter()) {
        x[place] = value;
    }
    Some(x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Karush–Kuhn–Tucker conditions: an unknown above 0 has no slope, one at 0 has none upwards.
        #[test]
        fn no_step_that_is_allowed_makes_it_less(
            entries in prop::collection::vec(-1.0..1.0f64, 60),
            targets in prop::collection::vec(-1.0..1.0f64, 10),
            free in 0usize..3,
        ) {
            let a = DMatrix::from_vec(10, 6, entries);
            let gram = a.transpose() * &a + 1e-3 * DMatrix::identity(6, 6);
            let right = a.transpose() * DVector::from_vec(targets);
            let x = solve(&gram, &right, free).unwrap();
            let slope = &right - &gram * &x;
            for i in 0..6 {
                if i < free || x[i] > 0.0 {
                    prop_assert!(slope[i].abs() < 1e-8, "{i}: {}", slope[i]);
                } else {
                    prop_assert!(x[i] == 0.0 && slope[i] < 1e-8, "{i}: {}", slope[i]);
                }
            }
        }
    }

    #[test]
    fn no_minimum_is_found_where_there_is_none() {
        let gram = DMatrix::zeros(2, 2);
        assert_eq!(solve(&gram, &DVector::zeros(2), 2), None);
    }
}
