//! The smallest and the largest of some values.

use std::borrow::Borrow;

/// The smallest and the largest of `values`; +∞ and −∞ for no values. NaN is ignored.
pub fn least_and_largest(values: impl IntoIterator<Item: Borrow<f64>>) -> (f64, f64) {
    values
        .into_iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            let value = *value.borrow();
            (low.min(value), high.max(value))
        })
}
