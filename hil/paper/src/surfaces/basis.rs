//! The basis functions of the surfaces. Each set is nonnegative and sums to 1.

use mesh_damper_reference::tables::{AMPLITUDES, DENSITIES};

/// Hat functions at `density` g/cm³, one for each density of the tables: 1 there, falling linearly to 0 at its neighbours; beyond
/// the ends their values at the ends.
pub fn hats(density: f64) -> [f64; 5] {
    let x = density.clamp(DENSITIES[0], DENSITIES[4]);
    let below = (0..4).rfind(|&i| x >= DENSITIES[i]).unwrap_or(0);
    let part = (x - DENSITIES[below]) / (DENSITIES[below + 1] - DENSITIES[below]);
    let mut values = [0.0; 5];
    values[below] = 1.0 - part;
    values[below + 1] = part;
    values
}

/// Bernstein polynomials of `degree` in ln(A/0.05)/ln 5 at `amplitude` mm; beyond the ends their values at the ends.
pub fn polynomials(amplitude: f64, degree: usize) -> Vec<f64> {
    let (low, high) = (AMPLITUDES[0], AMPLITUDES[4]);
    let x = ((amplitude / low).ln() / (high / low).ln()).clamp(0.0, 1.0);
    let mut values = vec![0.0; degree + 1];
    values[0] = 1.0;
    for highest in 1..=degree {
        for i in (0..=highest).rev() {
            let lower = if i > 0 { x * values[i - 1] } else { 0.0 };
            values[i] = (1.0 - x) * values[i] + lower;
        }
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn both_are_weights(density in 1.0..5.0f64, amplitude in 0.01..0.5f64, degree in 0usize..5) {
            for values in [hats(density).to_vec(), polynomials(amplitude, degree)] {
                prop_assert!(values.iter().all(|&v| v >= 0.0), "{values:?}");
                prop_assert!((values.iter().sum::<f64>() - 1.0).abs() < 1e-14, "{values:?}");
            }
        }

        #[test]
        fn hats_reproduce_a_straight_line(density in 2.0..4.0f64) {
            let found: f64 = hats(density).iter().zip(DENSITIES).map(|(n, d)| n * d).sum();
            prop_assert!((found - density).abs() < 1e-13, "{found}");
        }
    }

    #[test]
    fn the_ends_are_single_functions() {
        assert_eq!(hats(2.0), [1.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(hats(4.0), [0.0, 0.0, 0.0, 0.0, 1.0]);
        assert_eq!(polynomials(0.05, 2), [1.0, 0.0, 0.0]);
        assert_eq!(polynomials(0.3, 3), [0.0, 0.0, 0.0, 1.0]);
    }
}
