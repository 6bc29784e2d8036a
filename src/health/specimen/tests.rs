//! Cycles without noise, whose statistics are known in closed form.

use super::super::HealthSettings;
use super::super::cause::{Channel, HealthCause};
use super::super::sums::Sample;
use super::*;

/// A specimen's force relative to its law, and its position.
#[derive(Clone, Copy)]
struct Specimen {
    elastic: f32,
    friction: f32,
    /// Mean force, as a part of the law's amplitude in phase with displacement.
    mean: f32,
    /// Half width of a gap, mm.
    gap: f32,
    temperature: f32,
}

const WHOLE: Specimen = Specimen {
    elastic: 1.0,
    friction: 1.0,
    mean: 0.0,
    gap: 0.0,
    temperature: 20.0,
};

/// y = sin φ, law 1·y + 0.4·y³ + 0.3·sgn v: its first harmonic in phase is 1.3.
fn cycle(specimen: &Specimen, number: u32) -> (CycleSums, CycleNumbers) {
    let mut sums = CycleSums::default();
    for look in 0..32u16 {
        // Like the looks of the monitor: late by a quarter and three quarters of a part in turn.
        let late = 0.25 + 0.5 * (number % 2) as f32;
        let phase = core::f32::consts::TAU * (f32::from(look) + late) / 32.0;
        let (y, v) = (libm::sinf(phase), libm::cosf(phase));
        let (elastic, friction) = (y + 0.4 * y * y * y, 0.3 * v.signum());
        sums.add(&Sample {
            displacement: y,
            velocity: v,
            measured: specimen.elastic * elastic
                + specimen.friction * friction
                + 1.3 * specimen.mean
                // The loss of the elastic force, to first order.
                - specimen.gap * (1.0 + 1.2 * y * y) * y.signum(),
            given: elastic + friction,
            share: 0.0,
        });
    }
    let numbers = CycleNumbers {
        energy: specimen.friction * 1.2,
        law_energy: 1.2,
        mean: 1.3 * specimen.mean,
        command: 0.0,
        temperature: specimen.temperature,
        cycle: number,
    };
    (sums, numbers)
}

/// Causes named over `cycles` of the specimen that `at` gives for each, with their cycles.
fn watched(
    settings: &HealthSettings,
    cycles: u32,
    at: impl Fn(u32) -> Specimen,
) -> std::vec::Vec<(u32, Event)> {
    let config = settings.config().unwrap();
    let mut watch = SpecimenWatch::new();
    let mut named = std::vec::Vec::new();
    for number in 0..cycles {
        let (sums, numbers) = cycle(&at(number), number);
        watch.cycle(sums, numbers);
        while watch.has_work() {
            named.extend(watch.work(&config).map(|event| (number, event)));
        }
    }
    named
}

/// The first cause named, and the change of its statistic.
fn first(
    settings: &HealthSettings,
    cycles: u32,
    at: impl Fn(u32) -> Specimen,
) -> (u32, HealthCause, f32) {
    let named = watched(settings, cycles, at);
    let (number, event) = named.first().expect("nothing was named");
    (*number, event.cause, event.value)
}

/// Cycles after which the specimen changes: the learning is over by then.
const THEN: u32 = 30;

fn from_then(changed: Specimen) -> impl Fn(u32) -> Specimen {
    move |number| if number < THEN { WHOLE } else { changed }
}

#[test]
fn a_sudden_change_is_named_with_its_size_three_cycles_on() {
    let settings = HealthSettings::default();
    let (wire, friction) = (HealthCause::WireBreakage, HealthCause::FrictionWear);
    for (elastic, of_friction, mean, cause, value) in [
        (0.9, 0.9, 0.0, wire, -0.1f32),
        (0.95, 0.95, 0.0, wire, -0.05),
        (1.0, 0.8, 0.0, friction, -0.2),
        (1.0, 1.0, 0.1, HealthCause::PreloadShift, 0.1),
        (1.0, 1.0, -0.1, HealthCause::PreloadShift, -0.1),
        (1.1, 1.1, 0.0, HealthCause::Stiffening, 0.1),
    ] {
        let changed = Specimen {
            elastic,
            friction: of_friction,
            mean,
            ..WHOLE
        };
        let (number, named, moved) = first(&settings, 60, from_then(changed));
        assert_eq!(named, cause);
        assert!((moved - value).abs() < 2e-3, "{cause:?}: {moved}");
        // The alarm, and two cycles until it is classified; one more if the change has the smallest size that can be asked for.
        let after = number - THEN;
        assert!(
            (JUDGED_AFTER..=JUDGED_AFTER + 2).contains(&after),
            "{after}"
        );
    }
}

#[test]
fn a_change_that_reverts_in_time_or_is_too_small_is_no_event() {
    let settings = HealthSettings::default();
    let short = |number: u32| Specimen {
        friction: if number == THEN { 0.7 } else { 1.0 },
        ..WHOLE
    };
    assert!(watched(&settings, 100, short).is_empty());
    let small = Specimen {
        elastic: 0.98,
        friction: 0.98,
        ..WHOLE
    };
    assert!(watched(&settings, 100, from_then(small)).is_empty());
    // Nor one that is present while learning.
    assert!(watched(&settings, 100, |_| small).is_empty());
}

/// A change by 0.05 % per cycle, once the run-in is over.
fn slowly(number: u32, changed: fn(f32) -> Specimen) -> Specimen {
    changed(5e-4 * number.saturating_sub(230) as f32)
}

#[test]
fn a_slow_change_is_named_at_its_limit() {
    let friction: fn(f32) -> Specimen = |part| Specimen {
        friction: 1.0 - part,
        ..WHOLE
    };
    let all: fn(f32) -> Specimen = |part| Specimen {
        elastic: 1.0 - part,
        friction: 1.0 - part,
        ..WHOLE
    };
    let mean: fn(f32) -> Specimen = |part| Specimen {
        mean: part,
        ..WHOLE
    };
    let drifting = HealthCause::SensorDrifting(Channel::Force);
    // A mean of 1 is 1.341 of the residual, because the force has an RMS of 0.9695 and an amplitude in phase of 1.3. A change that
    // exceeds the adaptation shows there first.
    for (follow, limit, of_mean) in [
        (0.0, 0.04, 0.04 / 1.341),
        (0.02, 0.04, 0.04 / 1.341),
        (0.1, 0.1, 0.04),
    ] {
        let settings = HealthSettings {
            follow,
            ..HealthSettings::default()
        };
        for (changed, cause, limit) in [
            (friction, HealthCause::FrictionWear, limit),
            (all, HealthCause::WireBreakage, limit),
            (mean, drifting, of_mean),
        ] {
            let (number, named, moved) = first(&settings, 600, |n| slowly(n, changed));
            assert_eq!(named, cause, "{follow}");
            let least = if cause == drifting { 0.04 } else { limit };
            assert!((moved.abs() - least).abs() < 2e-3, "{cause:?}: {moved}");
            let come_to = 5e-4 * (number - 230) as f32;
            assert!((come_to - limit).abs() < 2e-3, "{cause:?}: {come_to}");
        }
    }
}

#[test]
fn a_run_in_and_a_temperature_are_said_and_are_no_faults() {
    let settings = HealthSettings::default();
    let warmed = |number: u32| {
        let settled = 1.0 - 0.1 * (1.0 - libm::expf(-(number as f32) / 30.0));
        let rise = 20.0 * (number.saturating_sub(300) as f32 / 400.0).min(1.0);
        let left = settled * (1.0 - 0.004 * rise);
        Specimen {
            elastic: left,
            friction: left,
            temperature: 20.0 + rise,
            ..WHOLE
        }
    };
    let causes = |named: &[(u32, Event)]| {
        let mut causes: std::vec::Vec<HealthCause> =
            named.iter().map(|(_, event)| event.cause).collect();
        causes.dedup();
        causes
    };
    let named = watched(&settings, 900, warmed);
    assert_eq!(
        causes(&named),
        [HealthCause::RunIn, HealthCause::Temperature]
    );
    // Two cycles are left out of the count at the start.
    assert_eq!(named[0].0, settings.run_in_cycles + SETTLING - 1);
    // The same without a visible reason.
    let unexplained = |number| Specimen {
        temperature: 20.0,
        ..warmed(number)
    };
    let named = watched(&settings, 900, unexplained);
    assert_eq!(
        causes(&named),
        [HealthCause::RunIn, HealthCause::WireBreakage]
    );
}

#[test]
fn a_cycle_is_sound_once_learned_and_as_long_as_nothing_is_suspected() {
    let config = HealthSettings::default().config().unwrap();
    let mut watch = SpecimenWatch::new();
    for number in 0..50 {
        let broken = Specimen {
            elastic: 0.9,
            ..WHOLE
        };
        let specimen = if number < 40 { WHOLE } else { broken };
        let (sums, numbers) = cycle(&specimen, number);
        watch.cycle(sums, numbers);
        while watch.has_work() {
            watch.work(&config);
        }
        let learned = number + 1 >= SETTLING + config.learning_cycles;
        assert_eq!(watch.is_sound(&config), learned && number < 40, "{number}");
    }
    // Without a law nothing can be normal.
    let (sums, numbers) = cycle(&WHOLE, 50);
    let no_law = CycleNumbers {
        law_energy: 0.0,
        ..numbers
    };
    watch.relearn();
    for _ in 0..40 {
        watch.cycle(sums, no_law);
        while watch.has_work() {
            assert!(watch.work(&config).is_none());
        }
    }
    assert!(!watch.is_sound(&config));
}

/// A mean that has changed partly in the cycle before is a step; one that has changed for several cycles is a drift.
#[test]
fn a_mean_that_shifts_in_the_middle_of_a_cycle_does_not_drift() {
    let settings = HealthSettings::default();
    let named = |at: &dyn Fn(f32) -> f32| {
        let mean = |number: u32| Specimen {
            // The cycle's mean of a change at THEN, and of one a part of a cycle later.
            mean: at(number as f32 - THEN as f32),
            ..WHOLE
        };
        first(&settings, 80, mean).1
    };
    for size in [0.05f32, -0.05, 0.1, 0.2] {
        for part in 0..=10u8 {
            let part = f32::from(part) / 10.0;
            let step = |cycle: f32| size * (cycle + part).clamp(0.0, 1.0);
            assert_eq!(
                named(&step),
                HealthCause::PreloadShift,
                "{size} from {part} on"
            );
        }
    }
    for rate in [0.004f32, 0.008, -0.008] {
        let drift = |cycle: f32| rate * cycle.clamp(0.0, 1e3);
        let drifting = HealthCause::SensorDrifting(Channel::Force);
        assert_eq!(named(&drift), drifting, "{rate}");
    }
}

/// A change is relative to the learned state, for a law that is off by a tenth, and again in another block.
#[test]
fn a_law_that_is_off_is_normal_until_the_specimen_changes() {
    let settings = HealthSettings::default();
    let of = |part: f32| Specimen {
        elastic: part,
        friction: part,
        mean: 0.05,
        ..WHOLE
    };
    let (_, cause, moved) = first(&settings, 60, |n| of(if n < THEN { 1.1 } else { 1.0 }));
    assert_eq!(cause, HealthCause::WireBreakage);
    assert!((moved + 0.1).abs() < 2e-3, "{moved}");

    let config = settings.config().unwrap();
    let mut watch = SpecimenWatch::new();
    for number in 0..2 * THEN {
        if number == THEN {
            watch.relearn();
        }
        let part = if number < THEN { 1.1 } else { 1.0 };
        let (sums, numbers) = cycle(&of(part), number);
        watch.cycle(sums, numbers);
        while watch.has_work() {
            assert_eq!(watch.work(&config), None);
        }
        // The first cycles are left out, and the next ones are learned.
        let of_block = number % THEN + 1;
        let learned = SETTLING + config.learning_cycles;
        assert_eq!(watch.is_watching(&config), of_block >= learned);
    }
}

/// The level of temperature begins with that of the first cycle.
#[test]
fn a_specimen_that_is_hot_from_the_start_is_watched_as_any_other() {
    let settings = HealthSettings {
        learning_cycles: 8,
        ..HealthSettings::default()
    };
    let named_at = |temperature: f32| {
        let at = |number: u32| Specimen {
            elastic: if number < 11 { 1.0 } else { 0.93 },
            temperature,
            ..WHOLE
        };
        let (cycle, cause, _) = first(&settings, 60, at);
        (cycle, cause)
    };
    assert_eq!(named_at(300.0), named_at(20.0));
}

/// With a law whose own third harmonic is 0.3/4/1.3. The gap removes g·(k1 + 3·k3·y²)·sgn y.
#[test]
fn a_gap_is_loosening_and_its_limit_is_reported() {
    let loose = from_then(Specimen { gap: 0.05, ..WHOLE });
    let named = watched(&HealthSettings::default(), 60, loose);
    let (_, first) = named.first().expect("nothing was named");
    assert_eq!(first.cause, HealthCause::Loosening);
    // Half of the size to be found, and the point at which a sum of the excess is too large.
    assert!(
        first.limit >= 0.025 && first.limit < 0.05,
        "{}",
        first.limit
    );
}

#[test]
fn a_change_that_has_reverted_before_it_is_classified_is_no_event() {
    let at = |number: u32| Specimen {
        elastic: match number {
            n if n < THEN => 1.0,
            THEN => 0.85,
            _ => 0.99,
        },
        ..WHOLE
    };
    assert_eq!(watched(&HealthSettings::default(), 60, at), []);
}
