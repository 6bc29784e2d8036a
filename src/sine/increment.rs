//! An integer increment advances the phase by a part of a cycle on each tick.

/// `part` of a cycle, below 1, in units of 2⁻¹²⁸, rounded down, with the last bit cleared. Computed in two digits of 64 bits, each
/// exact, because a direct cast from f64 to u128 is a function that the C libraries of 32-bit targets lack.
pub(super) fn fraction(part: f64) -> u128 {
    const DIGIT: f64 = (1u128 << 64) as f64;
    let scaled = part * DIGIT;
    let high = scaled as u64;
    let low = ((scaled - high as f64) * DIGIT) as u64;
    (u128::from(high) << 64 | u128::from(low)) & !1
}

/// frequency/tick_rate · 2¹²⁸, rounded down from the exact quotient of the two floats. Needs frequency < tick_rate/2.
pub(crate) fn increment(frequency: f64, tick_rate: f64) -> u128 {
    // Both are normal and positive: mantissa · 2^exponent.
    let split = |value: f64| {
        let bits = value.to_bits();
        let mantissa = (bits & ((1 << 52) - 1)) | (1 << 52);
        (u128::from(mantissa), (bits >> 52) as u32)
    };
    let ((n, n_exponent), (d, d_exponent)) = (split(frequency), split(tick_rate));
    let divide = |value: u128| {
        (
            value.checked_div(d).unwrap_or(0),
            value.checked_rem(d).unwrap_or(0),
        )
    };
    // Long division with digits of 64 bits: n·2¹²⁷/d.
    let (high, rest) = divide(n << 63);
    let (low, _) = divide(rest << 64);
    let quotient = (high << 64) | low;
    let shift = d_exponent.saturating_sub(n_exponent).saturating_sub(1);
    quotient.checked_shr(shift).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// A fraction of a cycle equals the direct cast of the whole, from the smallest step to the largest.
        #[test]
        fn a_fraction_is_the_cast_of_the_whole(mantissa in 1.0..2.0f64, exponent in -80..-1i32) {
            let part = mantissa * libm::exp2(f64::from(exponent));
            let cast = ((part * (1u128 << 127) as f64) as u128) << 1;
            prop_assert_eq!(fraction(part), cast);
        }
    }
}
