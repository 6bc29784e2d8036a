//! Models of one specimen over time: a change is found, and none is found if nothing changed.

use mesh_damper_batch::compare::{Comparison, Conclusion, Moment, compare};
use mesh_damper_identify::trace::trace;
use mesh_damper_output::error::InputError;
use mesh_damper_recording::Recording;
use mesh_damper_reference::law::Coefficients;
use mesh_damper_reference::tables;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rayon::iter::{IntoParallelIterator as _, ParallelIterator as _};

use crate::simulated::{drawn_again, plain};
use crate::varied::Varied;

/// Number of unchanged specimens in the gate.
const UNCHANGED: u64 = 20;

fn moment(time: f64, recording: &Recording) -> Moment {
    let found = trace(std::slice::from_ref(recording), &[], &|_| ()).unwrap();
    Moment {
        name: recording.name.clone(),
        time,
        model: found.model_file(),
        trace: Some(found.result),
    }
}

fn at_first(seed: u64) -> Coefficients {
    tables::interpolate([2.0, 2.5, 3.0, 3.5][(seed % 4) as usize], 0.1)
}

/// The specimen of a seed at three times: its k1 grows by a fraction from time to time.
fn drifting(seed: u64, part: f64) -> Comparison {
    let at_first = at_first(seed);
    let moments = (0..3).map(|time| {
        let grown = Coefficients {
            k1: at_first.k1 * (1.0 + part * f64::from(time)),
            ..at_first
        };
        moment(f64::from(time), &plain(grown, 100 * seed + time as u64))
    });
    compare(moments.collect()).unwrap()
}

#[test]
fn a_stiffness_that_drifts_is_found_with_its_size() {
    for seed in 0..3 {
        let found = drifting(seed, 0.03);
        assert!(found.changed && found.effects.is_empty(), "{found:?}");
        assert_eq!(found.conclusion, Conclusion::Changed);
        let last = &found.forces[1];
        assert!(last.changed && last.p.unwrap() < 1e-4, "{last:?}");
        // The largest difference of the forces corresponds to the growth of k1.
        let grown = 0.06 * at_first(seed).k1 * last.largest.displacement_mm;
        assert!(
            (last.largest.difference / grown - 1.0).abs() < 0.25,
            "{last:?}"
        );
        let k1 = found
            .parameters
            .iter()
            .find(|one| one.parameter == "k1")
            .unwrap();
        assert!(k1.changed, "{k1:?}");
        assert!((k1.change.unwrap() - 0.06).abs() < 0.015, "{k1:?}");
        let alpha = found
            .parameters
            .iter()
            .find(|one| one.parameter == "alpha")
            .unwrap();
        assert!(!alpha.changed, "{alpha:?}");
    }
}

#[test]
fn a_force_of_another_size_is_noted_as_a_possible_wrong_unit() {
    let first = plain(at_first(0), 1);
    let times = |factor: f64| {
        let mut recording = first.clone();
        recording.name = "another".into();
        recording
            .force
            .iter_mut()
            .for_each(|force| *force *= factor);
        compare(vec![moment(0.0, &first), moment(1.0, &recording)]).unwrap()
    };
    for factor in [1e3, 1e-3] {
        let found = times(factor);
        let ratio = found.forces[0].ratio;
        assert!((ratio / factor - 1.0).abs() < 0.01, "{ratio}");
        let noted = found.notes.iter().any(|note| {
            note.starts_with("the force of another is") && note.contains("check the units")
        });
        assert!(noted, "{:?}", found.notes);
    }
    let halved = times(0.5);
    assert!(halved.changed && halved.notes.iter().all(|note| !note.contains("units")));
}

fn compared<const COUNT: usize>(tests: [Varied; COUNT]) -> Result<Comparison, InputError> {
    let moments = tests
        .iter()
        .enumerate()
        .map(|(time, test)| moment(time as f64, &test.recording()));
    compare(moments.collect())
}

/// The specimen is held away from its rest position at two places, as in a test without adjustment of the preload.
fn held_elsewhere(seed: u64, later: Coefficients) -> Comparison {
    let test = |coefficients, preload, largest, seed| Varied {
        preload,
        largest,
        ..Varied::of(coefficients, seed)
    };
    compared([
        test(at_first(seed), 0.134, 0.12, 10 * seed),
        test(later, 0.119, 0.09, 10 * seed + 1),
    ])
    .unwrap()
}

#[test]
#[ignore = "half a minute: in the full tier"]
fn a_specimen_that_is_held_elsewhere_did_not_change() {
    for seed in 0..3 {
        let found = held_elsewhere(seed, at_first(seed));
        assert!(!found.changed, "{found:?}");
        assert!(found.forces[0].difference < 0.01, "{found:?}");
        // In the recording's displacement, within the motion of both.
        let [low, high] = found.common_motion.displacement_mm;
        assert!(
            (0.0..0.05).contains(&low) && (0.18..0.25).contains(&high),
            "{found:?}"
        );
        assert!(
            found
                .notes
                .iter()
                .any(|note| note.contains("has its zero at 0.1"))
        );
        assert!(found.parameters.iter().all(|one| one.p.is_none()));
        let grown = Coefficients {
            k1: 1.1 * at_first(seed).k1,
            ..at_first(seed)
        };
        let found = held_elsewhere(seed, grown);
        assert!(found.changed, "{found:?}");
    }
}

#[test]
fn a_sensor_whose_zero_moved_is_no_specimen_that_changed() {
    let test = |sensor, seed| Varied {
        sensor,
        ..Varied::of(at_first(1), seed)
    };
    for seed in 0..3 {
        let found = compared([test(0.3, 2 * seed), test(0.33, 2 * seed + 1)]).unwrap();
        assert!(!found.changed, "{found:?}");
    }
    let refused = compared([test(0.0, 7), test(0.5, 8)])
        .unwrap_err()
        .to_string();
    assert!(
        refused.contains("cannot be compared: they share no displacement")
            && refused.contains("if the sensor's zero moved"),
        "{refused}"
    );
}

#[test]
fn a_trace_that_does_not_keep_its_zero_is_refused_where_one_was_taken_off() {
    let test = Varied {
        preload: 0.15,
        largest: 0.12,
        ..Varied::of(at_first(0), 1)
    };
    let new = moment(0.0, &test.recording());
    let mut old = new.clone();
    old.trace.as_mut().unwrap().operating_conditions = None;
    let refused = compare(vec![new, old]).unwrap_err().to_string();
    assert!(
        refused.contains("its trace.json does not state it"),
        "{refused}"
    );
}

#[test]
fn without_intervals_nothing_is_decided() {
    let first = moment(0.0, &plain(at_first(0), 1));
    let mut second = Moment {
        time: 1.0,
        ..first.clone()
    };
    let same = compare(vec![first.clone(), second.clone()]).unwrap();
    assert_eq!(same.conclusion, Conclusion::NoChange);
    second.trace = None;
    let found = compare(vec![first, second]).unwrap();
    assert_eq!(found.conclusion, Conclusion::UndecidedForce);
    assert!(!found.changed && found.undecided.is_empty(), "{found:?}");
}

fn warm(seed: u64, loss: f64, temperature: [f64; 2]) -> Varied {
    Varied {
        loss,
        temperature,
        ..Varied::of(at_first(seed), 50 * seed + temperature[1] as u64)
    }
}

#[test]
fn what_no_common_temperature_shows_is_not_decided() {
    for seed in 0..2 {
        let tests = [[20.0, 20.0], [20.0, 42.0]].map(|range| warm(seed, 0.005, range));
        let found = compared(tests).unwrap();
        assert!(!found.changed, "{found:?}");
        let [undecided] = &found.undecided[..] else {
            panic!("{found:?}");
        };
        assert_eq!(found.conclusion, Conclusion::UndecidedEffect);
        assert!(
            undecided.family == "temperature"
                && undecided.would_show.contains("at 20.0 to 42.0 °C"),
            "{undecided:?}"
        );
        let [low, high] = found.common_motion.temperature.unwrap();
        assert!(low == high && (low - 20.0).abs() < 0.01, "{found:?}");
    }
}

#[test]
#[ignore = "half a minute: in the full tier"]
fn a_law_that_took_a_little_warmth_in_did_not_change() {
    for seed in 0..4 {
        for narrow in [22.0, 24.4, 25.0] {
            let tests = [[20.0, narrow], [20.0, 60.0]].map(|range| warm(seed, 0.005, range));
            let found = compared(tests).unwrap();
            assert!(!found.changed, "{narrow} °C: {found:?}");
            // For a law over more amplitudes than the motion has, the chance is not known, and nothing is claimed. Some traces find
            // the effect within the narrow range: then both have it, and no law hides it.
            let is_found = found.models[0].effects.contains(&"temperature".to_owned());
            if found.forces[0].p.is_none() || is_found {
                continue;
            }
            let mut notes = found.notes.iter();
            assert!(
                notes.any(|note| note.contains("may include effects")),
                "{found:?}"
            );
            let undecided = found.undecided.first().unwrap();
            assert_eq!(undecided.family, "temperature");
        }
        // No model includes the temperature, and one was recorded warmer.
        let tests = [[20.0, 22.0], [21.0, 23.0]].map(|range| warm(seed, 0.005, range));
        let found = compared(tests).unwrap();
        assert!(!found.changed, "{found:?}");
    }
}

/// A law over amplitude has absorbed the warming, and its remainder is above the noise.
#[test]
#[ignore = "half a minute: in the full tier"]
fn a_trace_that_found_no_effect_of_much_warmth_bounds_nothing() {
    for seed in [465, 513] {
        let found = under_others(seed);
        assert!(!found.changed, "{found:?}");
    }
}

#[test]
fn what_changed_with_the_temperature_is_found_at_its_end() {
    let tests = [warm(0, 0.0, [20.0, 42.0]), warm(0, 0.005, [20.0, 42.5])];
    let found = compared(tests).unwrap();
    assert!(found.changed, "{found:?}");
    let largest = found.forces[0].largest;
    assert!(
        largest.temperature > 40.0 && largest.part.abs() > 0.1,
        "{found:?}"
    );
}

#[test]
fn models_without_a_common_temperature_are_refused() {
    let tests = [[20.0, 21.0], [40.0, 45.0]].map(|range| warm(0, 0.0, range));
    let refused = compared(tests).unwrap_err().to_string();
    assert!(
        refused.contains("cannot be compared: they share no temperature")
            && refused.contains("has 20.0000 to ")
            && refused.contains("has 40.0000 to "),
        "{refused}"
    );
}

#[test]
fn what_settles_with_the_cycles_is_compared_at_both_ends_of_them() {
    let test = |rounds, seed| Varied {
        gain: 0.2,
        rounds,
        ..Varied::of(at_first(seed), seed)
    };
    let found = compared([test(1, 1), test(3, 1)]).unwrap();
    assert!(!found.changed, "{found:?}");
    let [low, high] = found.common_motion.cycles.unwrap();
    assert!(low < 1.0 && (20.0..28.0).contains(&high), "{found:?}");
}

#[test]
fn the_model_that_is_off_is_named_though_the_last_is_as_the_first() {
    let first = at_first(0);
    let grown = Coefficients {
        k1: 1.05 * first.k1,
        ..first
    };
    let moments = [first, grown, first].into_iter().enumerate();
    let moments =
        moments.map(|(time, coefficients)| moment(time as f64, &plain(coefficients, time as u64)));
    let found = compare(moments.collect()).unwrap();
    let mut parameters = found.parameters.iter();
    let k1 = parameters.find(|one| one.parameter == "k1").unwrap();
    assert!(k1.changed && k1.most_in == Some(1), "{k1:?}");
    assert!((k1.change.unwrap() - 0.05).abs() < 0.01, "{k1:?}");
}

/// A specimen with a hidden effect that does not change, recorded three times.
fn unchanged(seed: u64) -> Comparison {
    let moments =
        (0..3).map(|time| moment(time as f64, &drawn_again(seed, 1000 + 100 * seed + time)));
    compare(moments.collect()).unwrap()
}

fn about_rest(seed: u64) -> Comparison {
    match seed % 2 {
        0 => drifting(seed, 0.0),
        _ => unchanged(seed),
    }
}

/// An unchanged specimen with three different tests. They differ in the position and the range of the motion, in the temperature,
/// in the number of cycles, and in the sensor's zero.
fn under_others(seed: u64) -> Comparison {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let coefficients = at_first(seed);
    let loss = [0.0, 0.002, 0.005][rng.random_range(0..3)];
    let gain = [0.0, 0.05, 0.2][rng.random_range(0..3)];
    let tests = [0, 1, 2].map(|time| {
        let test = Varied::of(coefficients, 100 * seed + time);
        match seed % 4 {
            3 => Varied {
                sensor: rng.random_range(0.28..0.34),
                ..test
            },
            0 => Varied {
                preload: rng.random_range(0.12..0.16),
                largest: rng.random_range(0.08..0.12),
                ..test
            },
            1 => {
                let from = rng.random_range(19.0..21.0);
                Varied {
                    loss,
                    temperature: [from, 21.0 + rng.random_range(0.0..40.0)],
                    ..test
                }
            }
            _ => Varied {
                gain,
                rounds: rng.random_range(1..4),
                ..test
            },
        }
    });
    compared(tests).unwrap()
}

fn claims(seeds: std::ops::Range<u64>, of: fn(u64) -> Comparison) -> Vec<(u64, Comparison)> {
    let all = seeds.into_par_iter().map(|seed| (seed, of(seed)));
    let claimed: Vec<_> = all.filter(|(_, comparison)| comparison.changed).collect();
    for (seed, comparison) in &claimed {
        let effects: Vec<_> = comparison.models.iter().map(|one| &one.effects).collect();
        println!("seed {seed}: {effects:?}");
        for force in comparison.forces.iter().filter(|one| one.changed) {
            println!(
                "  force of model {}: {:.5} for {:.5}, p {:.1e}",
                force.model,
                force.difference,
                force.expected.unwrap(),
                force.p.unwrap()
            );
        }
        for one in comparison.parameters.iter().filter(|one| one.changed) {
            println!(
                "  {} {} {:?} by {:?}, p {:.1e}",
                one.of,
                one.parameter,
                one.amplitude_mm,
                one.change,
                one.p.unwrap()
            );
        }
    }
    claimed
}

#[test]
#[ignore = "half a minute: in the full tier"]
fn of_a_specimen_that_stays_as_it_is_nothing_is_claimed() {
    let claimed = claims(0..UNCHANGED, about_rest);
    // With 5 % each, more than four claims of 20 would occur once in 390.
    assert!(claimed.len() <= 4, "{} of {UNCHANGED}", claimed.len());
}

#[test]
#[ignore = "minutes: 400 specimens, each traced three times"]
fn claims_are_made_of_unchanged_specimens_about_as_often_as_they_say() {
    // Seeds other than those on which the widening was tuned.
    let claimed = claims(400..800, about_rest);
    println!("{} of 400", claimed.len());
    // 5 % of 400 are 20; more than 32 occur once in 200.
    assert!(claimed.len() <= 32, "{} of 400", claimed.len());
}

#[test]
#[ignore = "half a minute: in the full tier"]
fn of_a_specimen_that_is_tested_otherwise_nothing_is_claimed() {
    let claimed = claims(0..UNCHANGED, under_others);
    // With 5 % each, more than four claims of 20 would occur once in 390.
    assert!(claimed.len() <= 4, "{} of {UNCHANGED}", claimed.len());
}

#[test]
#[ignore = "minutes: 120 specimens, each traced three times"]
fn claims_are_as_rare_where_the_tests_differ() {
    let claimed = claims(400..520, under_others);
    let of = |kind| claimed.iter().filter(|(seed, _)| seed % 4 == kind).count();
    println!(
        "{} of 120: {} held elsewhere, {} at other temperatures, {} with other cycles, {} with another zero of the sensor",
        claimed.len(),
        of(0),
        of(1),
        of(2),
        of(3)
    );
    // 5 % of 120 are 6; more than 12 occur once in 160.
    assert!(claimed.len() <= 12, "{} of 120", claimed.len());
}
