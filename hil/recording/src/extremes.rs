//! The smallest, the largest, and the quantiles of some values.

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

/// The value below which `part` (0…1) of `values` lie; 0 for no values.
pub fn quantile(values: &mut [f64], part: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let place = place_of(part, values.len());
    *values.select_nth_unstable_by(place, f64::total_cmp).1
}

/// How many of `count` values come before the one below which `part` (0…1) of them lie.
pub(crate) fn place_of(part: f64, count: usize) -> usize {
    (count.saturating_sub(1) as f64 * part).round() as usize
}
