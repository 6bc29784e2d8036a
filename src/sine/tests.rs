//! The fraction of a cycle in 2¹²⁸ steps.

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
