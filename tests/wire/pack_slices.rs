//! A pack that is checked slice by slice, between ticks that continue with the running law.

use mesh_damper::effects::residual_table::{CELLS, ResidualTableParts};
use mesh_damper::effects::{AugmentedLaw, DESCRIPTIONS, Effect, Motion, ResidualTable};
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::law::Law;
use mesh_damper::pack::{Expectation, PackError, PackInfo, Stamp, Upload};
use proptest::prelude::*;

use crate::support::{EFFECTS, encoded};

const RATE: f32 = 1e4;

/// A law of stiffness `k1` with effects from `first` on, and a residual table.
fn law(k1: f32, first: usize) -> FastLaw<EFFECTS> {
    let effects = DESCRIPTIONS.iter().cycle().skip(first).take(EFFECTS);
    let effect = |each: &mesh_damper::effects::description::Description| {
        Effect::from_parameters(each.number, each.typical, 1.0 / f64::from(RATE)).unwrap()
    };
    let eq_13 = AugmentedLaw::new(Law::new(k1, 10.5, 0.11, 0.4).unwrap());
    let law: AugmentedLaw<f32, EFFECTS> = effects
        .map(effect)
        .fold(eq_13, |law, effect| law.with(effect).unwrap());
    let parts = ResidualTableParts {
        reach: 0.2,
        speed: 6.0,
        unit: 1e-5,
        cells: &[7; CELLS],
        memory: None,
    };
    let table = ResidualTable::new(&parts, 1.0 / RATE).unwrap();
    FastLaw::new(law.with_residual_table(table).unwrap())
}

fn packed(law: &FastLaw<EFFECTS>) -> Vec<u8> {
    encoded(law, &PackInfo::at(RATE))
}

fn upload(pack: &[u8]) -> Upload {
    let mut upload = Upload::new();
    upload.part(0, pack).unwrap();
    upload
}

/// One slice for the pending law, next to the running law.
fn slice(
    running: &mut RunningLaw<EFFECTS>,
    upload: &mut Upload,
) -> Result<Option<Option<Stamp>>, PackError> {
    let expected = Expectation::at(RATE);
    running.swap_in_slices(|slot| upload.finish_slice(slot, &expected))
}

fn motion(tick: usize) -> Motion<f32> {
    let phase = 0.01 * tick as f32;
    Motion {
        acceleration: -1000.0 * phase.sin(),
        ..Motion::at(0.1 * phase.sin(), 10.0 * phase.cos())
    }
}

/// Every cycle that ends before the last slice finds no pending law, and every force is that of the running law.
#[test]
fn no_law_waits_before_it_is_complete() {
    let (old, new) = (law(1.0, 0), law(2.0, 5));
    let mut running = RunningLaw::new(old.clone());
    let mut alone = RunningLaw::new(old);
    let mut upload = upload(&packed(&new));
    let mut slices = 1;
    while slice(&mut running, &mut upload).unwrap().is_none() {
        assert!(!running.boundary(), "after slice {slices}");
        assert_eq!(
            running.force(&motion(slices)),
            alone.force(&motion(slices)),
            "after slice {slices}"
        );
        slices += 1;
    }
    assert!(slices > 50, "{slices}");
    assert!(running.boundary());
    assert_eq!(*running.law(), new);
    // The upload is empty.
    let again = slice(&mut running, &mut upload);
    assert!(
        matches!(again, Err(PackError::Length { found: 0, .. })),
        "{again:?}"
    );
}

/// The first slice for another law removes a pending law and takes its place.
#[test]
fn a_check_that_begins_drops_the_law_that_waited() {
    let (old, new) = (law(1.0, 0), law(2.0, 5));
    let mut running = RunningLaw::new(old.clone());
    running.swap(law(3.0, 9));
    let mut upload = upload(&packed(&new));
    assert_eq!(slice(&mut running, &mut upload), Ok(None));
    assert!(!running.boundary());
    assert_eq!(*running.law(), old);
}

/// A check that a new upload aborts, or a damaged upload, leaves nothing behind.
#[test]
fn a_check_that_is_broken_off_leaves_the_law_in_force() {
    let (old, new) = (law(1.0, 0), law(2.0, 5));
    let good = packed(&new);
    let mut bad = good.clone();
    *bad.last_mut().unwrap() ^= 1;
    let mut running = RunningLaw::new(old.clone());
    let mut upload = upload(&good);
    for done in [10, 60] {
        for _ in 0..done {
            assert_eq!(slice(&mut running, &mut upload), Ok(None));
        }
        upload.part(0, &bad).unwrap();
        let refused = loop {
            match slice(&mut running, &mut upload) {
                Ok(none) => assert_eq!(none, None),
                Err(refused) => break refused,
            }
        };
        assert_eq!(refused, PackError::Checksum);
        assert!(!running.boundary());
        assert_eq!(*running.law(), old);
        upload.part(0, &good).unwrap();
    }
}

proptest! {
    /// For any order of checks in slices, swaps of whole laws, and ends of cycles: the running law is always a law that was swapped
    /// in whole, or that of the pack.
    #[test]
    fn what_comes_into_force_is_a_whole_law(steps in prop::collection::vec(0..20u8, 1..600)) {
        let (whole, sent) = ([law(1.0, 0), law(3.0, 9)], law(2.0, 5));
        let good = packed(&sent);
        let mut running = RunningLaw::new(whole[0].clone());
            let mut upload = upload(&good);
        for step in steps {
            match step {
                0 => running.swap(whole[1].clone()),
                1 | 2 => {
                    running.boundary();
                }
                3 => upload.part(0, &good).unwrap(),
                _ => {
                    let slice = slice(&mut running, &mut upload);
                    let is_empty = matches!(slice, Err(PackError::Length { found: 0, .. }));
                    prop_assert!(slice.is_ok() || is_empty, "{slice:?}");
                }
            }
            let law = running.law();
            prop_assert!(whole.contains(law) || *law == sent);
        }
    }
}
