//! Models of one specimen over time: a change is found, and none where there is none.

use mesh_damper_batch::compare::{Comparison, Moment, compare};
use mesh_damper_identify::trace::trace;
use mesh_damper_recording::Recording;
use mesh_damper_reference::law::Coefficients;
use mesh_damper_reference::tables;
use rayon::iter::{IntoParallelIterator as _, ParallelIterator as _};

use crate::simulated::{drawn_again, plain};

/// Specimens of which nothing changes, in the gate.
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

/// The specimen of a seed at three times: its k1 grows by a part from time to time.
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
        let last = &found.forces[1];
        assert!(last.changed && last.p.unwrap() < 1e-4, "{last:?}");
        // Where the forces differ most they do by what k1 grew by.
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

/// Of a specimen with a hidden effect that does not change, recorded three times.
fn unchanged(seed: u64) -> Comparison {
    let moments =
        (0..3).map(|time| moment(time as f64, &drawn_again(seed, 1000 + 100 * seed + time)));
    compare(moments.collect()).unwrap()
}

fn claims(seeds: std::ops::Range<u64>) -> Vec<(u64, Comparison)> {
    let all = seeds.into_par_iter().map(|seed| match seed % 2 {
        0 => (seed, drifting(seed, 0.0)),
        _ => (seed, unchanged(seed)),
    });
    let claimed: Vec<_> = all.filter(|(_, comparison)| comparison.changed).collect();
    for (seed, comparison) in &claimed {
        println!("seed {seed}:");
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
fn of_a_specimen_that_stays_as_it_is_nothing_is_claimed() {
    let claimed = claims(0..UNCHANGED);
    // With 5 % each, more than four of 20 would be claimed once in 390.
    assert!(claimed.len() <= 4, "{} of {UNCHANGED}", claimed.len());
}

#[test]
#[ignore = "minutes: 400 specimens, each traced three times"]
fn claims_are_made_of_unchanged_specimens_about_as_often_as_they_say() {
    // Others than those that the widening was tuned on.
    let claimed = claims(400..800);
    println!("{} of 400", claimed.len());
    // 5 % of 400 are 20; more than 32 once in 200.
    assert!(claimed.len() <= 32, "{} of 400", claimed.len());
}
