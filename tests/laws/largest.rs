//! What the tests of tolerances hold against their tables.

/// The largest value that it was shown.
#[derive(Default)]
pub struct Largest(pub f64);

impl Largest {
    /// Shows it one.
    pub fn see(&mut self, error: f64) {
        // A NaN stays, and no check lets it pass.
        if error.is_nan() || error.abs() > self.0 {
            self.0 = error.abs();
        }
    }

    /// Fails where it exceeds `tolerance`.
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
