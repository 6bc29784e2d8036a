//! Packs that are damaged, forged, out of order or active are refused.

use mesh_damper::effects::{Effect, Motion, Periodic};
use mesh_damper::error::ConfigError;
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::pack::{self, Expectation, LARGEST, PackError, Upload};
use mesh_damper::passivity::Active;
use proptest::prelude::*;

use crate::support::{
    EFFECTS, INFO, decode, every_effect, info, pack, refused, table_pack, tabulated, with_header,
};

#[test]
fn a_pack_with_any_one_bit_changed_is_refused() {
    let good = pack(&every_effect()[..EFFECTS]);
    for bit in 0..8 * good.len() {
        let mut bad = good.clone();
        bad[bit / 8] ^= 1 << (bit % 8);
        refused(&bad);
    }
}

#[test]
fn each_damage_is_named() {
    let good = pack(&[]);
    let changed = |index: usize, value: u8| {
        let mut bad = good.clone();
        bad[index] = value;
        bad
    };
    assert_eq!(refused(&changed(0, b'X')), PackError::Magic);
    assert_eq!(refused(&changed(4, 8)), PackError::Version { found: 8 });
    assert_eq!(refused(&changed(4, 5)), PackError::Version { found: 5 });
    assert_eq!(refused(&changed(8, !good[8])), PackError::Checksum);
    assert_eq!(refused(&changed(20, !good[20])), PackError::Checksum);
    for length in 0..good.len() {
        assert!(
            matches!(refused(&good[..length]), PackError::Length { found, .. } if found == length)
        );
    }
    let mut longer = good.clone();
    longer.push(0);
    assert!(matches!(refused(&longer), PackError::Length { .. }));
}

/// A pack with a correct checksum can still contain invalid data.
#[test]
fn a_sound_checksum_does_not_make_a_sound_law() {
    let good = pack(&every_effect()[..1]);
    let body = good[12..].to_vec();
    assert_eq!(with_header(&body), good);
    let with_float = |index: usize, value: f32| {
        let mut body = body.clone();
        let place = INFO + 4 * index;
        body[place..place + 4].copy_from_slice(&value.to_le_bytes());
        with_header(&body)
    };
    let non_finite = |field| PackError::Refused(ConfigError::NonFinite(field));
    assert_eq!(refused(&with_float(0, f32::NAN)), non_finite("k1"));
    assert!(matches!(
        refused(&with_float(2, -1.0)),
        PackError::Refused(ConfigError::OutOfRange { field: "c", .. })
    ));
    for index in 4..68 {
        let error = refused(&with_float(index, f32::INFINITY));
        assert!(matches!(error, PackError::Refused(_)), "{index}: {error:?}");
    }
    for length in [0, 3, 20, 40, INFO - 1, INFO, INFO + 24, INFO + 100] {
        let cut = with_header(&body[..length]);
        assert_eq!(refused(&cut), PackError::Body, "{length}");
    }
    let mut longer = body.clone();
    longer.push(0);
    assert_eq!(refused(&with_header(&longer)), PackError::Body);
    // More effects than the law can hold.
    let mut buffer = [0; LARGEST];
    let nine = &every_effect()[..EFFECTS + 1];
    let nine = pack::encode(&tabulated::<9>(nine), &info(), &mut buffer).unwrap();
    let full = ConfigError::Full {
        field: "effects",
        capacity: EFFECTS,
    };
    assert_eq!(refused(nine), PackError::Refused(full));
    // An effect with numbers that its constructor never gives: the offset's force is at the end of the body, before the last byte.
    let mut infinite = body.clone();
    let end = infinite.len() - 5;
    infinite[end..end + 4].copy_from_slice(&f32::INFINITY.to_le_bytes());
    assert_eq!(refused(&with_header(&infinite)), non_finite("force"));
    // No tones, four tones, and three tones without one number. The numbers follow the kind and the count of tones.
    let tones = Periodic::new(&[(0.1, 50.0, 0.0)], 1e-4).unwrap();
    let body = pack(&[Effect::Periodic(tones)])[12..].to_vec();
    let (count, end) = (body.len() - 22, body.len() - 1);
    assert_eq!(body[count], 5);
    for (numbers, error) in [
        (0, PackError::Refused(ConfigError::Empty("tones"))),
        (20, PackError::Body),
        (14, PackError::Body),
    ] {
        let mut forged = body[..count].to_vec();
        forged.push(numbers);
        forged.resize(forged.len() + 4 * usize::from(numbers), 0);
        forged.extend_from_slice(&body[end..]);
        assert_eq!(refused(&with_header(&forged)), error, "{numbers}");
    }
}

#[test]
fn parts_must_follow_one_another() {
    let good = pack(&every_effect()[..EFFECTS]);
    let mut upload = Upload::default();
    assert_eq!(
        upload.part(4, &good[4..8]),
        Err(PackError::Order {
            expected: 0,
            found: 4
        })
    );
    upload.part(0, &good[..40]).unwrap();
    // Repeated, and one left out.
    assert_eq!(
        upload.part(20, &good[20..40]),
        Err(PackError::Order {
            expected: 40,
            found: 20
        })
    );
    assert_eq!(
        upload.part(80, &good[80..]),
        Err(PackError::Order {
            expected: 40,
            found: 80
        })
    );
    assert!(matches!(
        upload.part(40, &[0; LARGEST]),
        Err(PackError::Length { .. })
    ));
    upload.part(40, &good[40..]).unwrap();
    let mut law = FastLaw::EMPTY;
    let any = Expectation::default();
    assert_eq!(upload.finish(&mut law, &any), Ok(Some(info().stamp)));
    assert_eq!(Ok(law.clone()), decode(&good));
    // It is empty again.
    assert!(matches!(
        upload.finish::<EFFECTS>(&mut law, &any),
        Err(PackError::Length { found: 0, .. })
    ));
    // An upload that was aborted starts again.
    upload.part(0, &good[..40]).unwrap();
    for (number, part) in good.chunks(40).enumerate() {
        upload.part(40 * number, part).unwrap();
    }
    assert!(upload.finish::<EFFECTS>(&mut law, &any).is_ok());
}

proptest! {
    #[test]
    fn any_bytes_are_refused(bytes in prop::collection::vec(any::<u8>(), 0..LARGEST)) {
        prop_assert!(decode(&bytes).is_err());
    }

    /// A body that was changed together with its checksum is refused, or is a law whose force is finite.
    #[test]
    fn an_accepted_pack_has_finite_forces(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
        first in 0..=8_usize,
        amplitude in 1e-3f32..1e4,
        frequency in 0.1f32..100.0,
    ) {
        let every = every_effect();
        // The last one is a law with a residual table.
        let pack = match every.get(first..first + EFFECTS) {
            Some(effects) => pack(effects),
            None => table_pack(),
        };
        let mut body = pack[12..].to_vec();
        for (index, value) in changes {
            let index = index.index(body.len());
            body[index] = value;
        }
        if let Ok(law) = decode(&with_header(&body)) {
            let mut law = RunningLaw::new(law);
            let angular = core::f32::consts::TAU * frequency;
            for tick in 0..100 {
                let cycles = 0.03 * tick as f32;
                let (sin, cos) = (core::f32::consts::TAU * cycles).sin_cos();
                let force = law.force(&Motion {
                    acceleration: -amplitude * angular * angular * sin,
                    cycles,
                    temperature: 20.0 + cycles,
                    ..Motion::at(amplitude * sin, amplitude * angular * cos)
                });
                prop_assert!(force.is_finite());
            }
        }
    }
}

/// Negative damping.
#[test]
fn an_active_law_is_refused_unless_it_is_allowed() {
    let active = pack(&[Effect::Viscous(
        mesh_damper::effects::Viscous::new(-0.5).unwrap(),
    )]);
    let error = refused(&active);
    let by = Active {
        effect: "viscous",
        field: "c1",
        value: -0.5,
    };
    assert_eq!(error, PackError::Active(by));
    assert_eq!(
        error.to_string(),
        "law: with c1 = -0.5, viscous can give more energy than it takes, and a passive law is required: correct it, or allow an active \
         law"
    );
    let mut upload = Upload::new();
    let mut law = FastLaw::<EFFECTS>::EMPTY;
    for allow_active in [false, true] {
        for (index, part) in active.chunks(100).enumerate() {
            upload.part(100 * index, part).unwrap();
        }
        let expected = Expectation {
            allow_active,
            ..Expectation::default()
        };
        assert_eq!(upload.finish(&mut law, &expected).is_ok(), allow_active);
    }
    // In slices the verdict is the same.
    for (index, part) in active.chunks(100).enumerate() {
        upload.part(100 * index, part).unwrap();
    }
    let expected = Expectation::default();
    let verdict = loop {
        match upload.finish_slice(&mut law, &expected) {
            Ok(None) => {}
            verdict => break verdict,
        }
    };
    assert_eq!(verdict, Err(error));
}
