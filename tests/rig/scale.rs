//! Codes and values of a converter: conversion in both directions, the ends of the range, fewer bits.

use mesh_damper::converter::{MIDSCALE, Scale};
use mesh_damper::error::ConfigError;
use proptest::prelude::*;

use crate::support::{kilonewtons, unit};

#[test]
fn scale_refuses_what_it_cannot_hold() {
    let refused = |full_scale, zero| Scale::new(full_scale, zero).unwrap_err();
    assert_eq!(refused(f64::NAN, 0.0), ConfigError::NonFinite("full_scale"));
    assert_eq!(refused(1.0, f64::INFINITY), ConfigError::NonFinite("zero"));
    for full_scale in [0.0, 1e-7, -2e6] {
        assert!(matches!(
            refused(full_scale, 0.0),
            ConfigError::OutOfRange {
                field: "full_scale",
                ..
            }
        ));
    }
}

/// A converter with fewer bits has the same scale. It shows the ends of its range and zero voltage like one with 16 bits.
#[test]
fn a_narrow_converter_reads_as_one_with_16_bits() {
    let scale = kilonewtons();
    for code in 0..4096u16 {
        let sample = scale.decode_narrow::<12>(code);
        let whole = scale.decode(code << 4);
        assert_eq!(sample.value, whole.value);
        assert_eq!(sample.clipped(), code == 0 || code == 4095);
        assert_eq!(sample.code == MIDSCALE, code == 2048);
        assert_eq!(scale.decode_narrow::<16>(code), scale.decode(code));
    }
    // Bits that the converter lacks do not count.
    assert_eq!(
        scale.decode_narrow::<12>(0xFFFF),
        scale.decode_narrow::<12>(0x0FFF)
    );
    assert!(scale.decode_narrow::<1>(1).clipped());
    // Bit counts that are given at run time, and invalid ones.
    for code in [0, 1, 0x7FF, 0x800, 0xFFF, 0x9001] {
        // A step of 12 bits equals 16 steps of 16 bits; a code beyond 12 bits counts as the last one.
        let of_twelve = scale.decode(code.min(0xFFF) << 4);
        assert_eq!(scale.decode_bits(12, code).value, of_twelve.value);
        for bits in [0, 17, u32::MAX] {
            assert_eq!(scale.decode_bits(bits, code), scale.decode(code));
        }
    }
}

#[test]
fn the_end_of_the_range_is_half_a_step_beyond_its_last_code() {
    let clipped = |steps: f32| unit().encode(steps / 32768.0).clipped;
    assert!(!clipped(-32768.25) && clipped(-32768.75));
    assert!(!clipped(32767.25) && clipped(32767.75));
}

proptest! {
    #[test]
    fn every_code_survives_the_way_there_and_back(
        code: u16,
        full_scale in prop_oneof![1e-3..1e3f64, -1e3..-1e-3f64],
        zero in -0.1..0.1f64,
    ) {
        let scale = Scale::new(full_scale, zero * full_scale).unwrap();
        let back = scale.encode(scale.decode(code).value);
        prop_assert_eq!(back.code, code);
        prop_assert!(!back.clipped);
    }

    #[test]
    fn the_code_is_the_nearest_or_is_clipped(value in -3.0..3.0f32) {
        let scale = unit();
        let coded = scale.encode(value);
        let error = (scale.decode(coded.code).value - value).abs();
        // Half a step; the sum count + 32768.5 rounds to 2⁻⁸ of a step.
        let nearest = error <= (0.5 + 1.0 / 256.0) * scale.step();
        prop_assert_eq!(nearest, !coded.clipped);
    }

    #[test]
    fn any_float_gives_a_code(bits: u32) {
        let value = f32::from_bits(bits);
        let coded = unit().encode(value);
        prop_assert_eq!(coded.clipped && coded.code == MIDSCALE, value.is_nan());
    }
}
