//! The largest error in a test, for comparison with a table of tolerances.

/// The largest value so far.
#[derive(Default)]
pub struct Largest(pub f64);

impl Largest {
    /// Takes one value into account.
    pub fn see(&mut self, error: f64) {
        // A NaN stays, and every check fails for it.
        if error.is_nan() || error.abs() > self.0 {
            self.0 = error.abs();
        }
    }

    /// Fails if the largest value exceeds `tolerance`.
    pub fn check(&self, name: &str, tolerance: f64) {
        println!(
            "{name}: {:.2e}, {:.0} % of its tolerance",
            self.0,
            100.0 * self.0 / tolerance
        );
        assert!(
            self.0 <= tolerance,
            "{name}: {:e} exceeds {tolerance:e}",
            self.0
        );
    }
}
