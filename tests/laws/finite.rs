//! All code that runs every tick gives finite values for any input, including NaN and infinities.

use mesh_damper::converter::Scale;
use mesh_damper::crossing::{CrossingAccumulator, CrossingDetector};
use mesh_damper::cycle::{Cycle, CycleAccumulator};
use mesh_damper::law::Law;
use mesh_damper::power::{PowerSeed, PowerTable, abs_pow};
use mesh_damper::sine::sin_cos;
use mesh_damper::table::PAPER;
use mesh_damper::{amplitude_independent, limits};
use proptest::prelude::*;

fn any_float() -> impl Strategy<Value = f32> {
    prop_oneof![
        any::<f32>(),
        -1.0..1.0f32,
        prop::sample::select(vec![
            f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::MAX,
            f32::MIN,
            f32::MIN_POSITIVE,
            1e-45,
            -1e-45,
            -0.0,
        ]),
    ]
}

fn is_finite(cycle: &Cycle) -> bool {
    cycle.values().iter().all(|value| value.is_finite())
}

proptest! {
    #[test]
    fn a_force_is(k1 in -1e9..1e9f32, k3 in -1e9..1e9f32, c in 0.0..1e9f32, alpha in 0.0..=1.0f32, y in any_float(), v in any_float()) {
        let law = Law::new(k1, k3, c, alpha).unwrap();
        prop_assert!(law.force(y, v).is_finite());
        let double = law.cast::<f64>();
        prop_assert!(double.force(y.into(), v.into()).is_finite());
        // Beyond the limits, only the sign of the input affects the force.
        let edge = law.force(y.clamp(-limits::DISPLACEMENT as f32, limits::DISPLACEMENT as f32), v);
        if !y.is_nan() {
            prop_assert_eq!(law.force(y, v), edge);
        }
    }

    #[test]
    fn a_power_is(v in any_float(), alpha in 0.0..=1.0f32, c in 0.0..1e9f64) {
        prop_assert!(abs_pow(v, alpha).is_finite());
        let table = PowerTable::new(&PowerSeed::new(c, alpha.into()).unwrap());
        if v.abs() <= limits::VELOCITY as f32 {
            prop_assert!(table.damping_force(v).is_finite());
        }
    }

    #[test]
    fn a_sine_is_within_one(phase in any::<u64>()) {
        let (sin, cos) = sin_cos(phase);
        prop_assert!(sin.abs() <= 1.0 + 2e-7 && cos.abs() <= 1.0 + 2e-7);
        prop_assert!((sin * sin + cos * cos - 1.0).abs() < 4e-7);
    }

    #[test]
    fn a_cycle_is(samples in prop::collection::vec((any_float(), any_float(), any_float(), any::<u32>()), 1..80)) {
        let mut accumulator = CycleAccumulator::<2>::new();
        for (displacement, first, second, phase) in samples {
            for cycle in accumulator.update(displacement, [first, second], phase).iter().flatten() {
                prop_assert!(is_finite(cycle), "{cycle:?}");
            }
        }
    }

    #[test]
    fn a_cycle_that_finds_itself_is(
        hysteresis in 1e-9..1.0f32,
        samples in prop::collection::vec((any_float(), any_float()), 1..200),
    ) {
        let mut accumulator = CrossingAccumulator::new(hysteresis).unwrap();
        let mut detector = CrossingDetector::new(hysteresis).unwrap();
        for (displacement, force) in samples {
            if let Some(cycle) = accumulator.update(displacement, force) {
                prop_assert!(is_finite(&cycle), "{cycle:?}");
                prop_assert!(cycle.ticks > 0.0);
            }
            if let Some(part) = detector.update(displacement).boundary {
                prop_assert!((0.0..=1.0).contains(&part), "{part}");
            }
        }
    }

    #[test]
    fn a_law_of_the_table_is(density in any_float(), amplitude in any_float(), y in any_float(), v in any_float()) {
        prop_assert!(PAPER.lookup(density, amplitude).law.force(y, v).is_finite());
        if let Ok(law) = amplitude_independent::law(density) {
            prop_assert!(law.augmented().law().force(y, v).is_finite());
        }
    }

    #[test]
    fn a_code_stands_for_what_was_asked_or_is_clipped(full_scale in 1e-6..1e6f64, value in any_float(), code in any::<u16>()) {
        let scale = Scale::new(full_scale, 0.0).unwrap();
        prop_assert!(scale.decode(code).value.is_finite());
        let encoded = scale.encode(value);
        let back = scale.decode(encoded.code).value;
        let beyond = full_scale as f32 * 1.0001;
        prop_assert!(encoded.clipped || (back - value).abs() <= scale.step());
        if value.is_nan() {
            prop_assert!(encoded.clipped && back == 0.0);
        } else if value.abs() > beyond {
            prop_assert!(encoded.clipped && back.signum() == value.signum());
        }
    }
}
