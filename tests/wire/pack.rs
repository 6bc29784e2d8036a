//! Coefficient packs: what goes in comes out, and nothing that is damaged does.

use mesh_damper::effects::description::Description;
use mesh_damper::effects::residual_table::{CELLS, Memory, ResidualTableParts};
use mesh_damper::effects::{
    AugmentedLaw, DESCRIPTIONS, Effect, MAX_STICK_SLIP_ELEMENTS, MAX_TONES, Motion, Periodic,
    ResidualTable, StickSlip,
};
use mesh_damper::error::ConfigError;
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::law::Law;
use mesh_damper::operating_range::OperatingRange;
use mesh_damper::pack::{self, Expectation, Identity, LARGEST, PackError, PackInfo, Stamp, Upload};
use mesh_damper::power::PowerSeed;
use proptest::prelude::*;

const EFFECTS: usize = 8;

/// Everything that a pack may say of itself, its name as long as one may be.
fn info() -> PackInfo {
    PackInfo {
        operating_range: Some(OperatingRange::new([-0.2, 0.25], [-6.0, 6.5]).unwrap()),
        density: Some(3.0),
        amplitude: Some(0.1),
        stamp: Stamp {
            tick_rate: 1e4,
            revision: 0x0403_0201,
            identity: Identity([1, 2, 3, 4, 5, 6, 7, 8]),
        },
        ..PackInfo::at(1e4)
            .named("a name of 32 bytes of a specimen")
            .unwrap()
    }
}

/// Bytes of that in a pack's body, before the law.
const INFO: usize = 77;

fn law() -> Law<f32> {
    Law::new(1.0539, 10.5, 0.1114, 0.3969).unwrap()
}

/// The effect by its own name, of parameters in the order of its description.
fn effect(name: &str, parameters: &[f64], tick: f64) -> Effect<f32> {
    let found = DESCRIPTIONS.iter().find(|each| each.name == name).unwrap();
    Effect::from_parameters(found.number, parameters, tick).unwrap()
}

/// Every effect of the crate, as many elements of it as there may be.
fn every_effect() -> Vec<Effect<f32>> {
    let most = |each: &Description| {
        let last = &each.typical[each.typical.len() - each.parameters.len()..];
        let missing = each.most - each.typical.len() / each.parameters.len();
        // No two elements alike.
        let more = (1..=missing).flat_map(|n| last.iter().map(move |x| x * (1.0 + 0.1 * n as f64)));
        let parameters: Vec<f64> = each.typical.iter().copied().chain(more).collect();
        Effect::from_parameters(each.number, &parameters, 1e-4).unwrap()
    };
    DESCRIPTIONS.iter().map(most).collect()
}

fn tabulated<const N: usize>(effects: &[Effect<f32>]) -> FastLaw<N> {
    let with = |law: AugmentedLaw<f32, N>, effect: &Effect<f32>| law.with(*effect).unwrap();
    FastLaw::new(effects.iter().fold(AugmentedLaw::new(law()), with))
}

fn pack(effects: &[Effect<f32>]) -> Vec<u8> {
    let mut buffer = [0; LARGEST];
    let law = tabulated::<EFFECTS>(effects);
    pack::encode(&law, &info(), &mut buffer).unwrap().to_vec()
}

fn decode(bytes: &[u8]) -> Result<FastLaw<EFFECTS>, PackError> {
    let mut law = FastLaw::EMPTY;
    pack::decode(bytes, &mut law, &Expectation::default()).map(|_| law)
}

fn refused(bytes: &[u8]) -> PackError {
    decode(bytes).unwrap_err()
}

#[test]
fn the_law_that_comes_out_is_the_one_that_went_in() {
    for effects in every_effect().chunks(EFFECTS) {
        let decoded = decode(&pack(effects)).unwrap();
        assert_eq!(decoded, tabulated(effects));
        assert_eq!(decoded.augmented().effects().count(), effects.len());
        let seed = PowerSeed::new(law().c().into(), law().alpha().into()).unwrap();
        assert_eq!(*decoded.damping(), seed);
    }
}

/// The largest effect, of which a law has one, and the next beside it stand for more than any others would take.
#[test]
fn the_largest_effects_fit_often_enough() {
    let elements = [(1.0, 0.1); MAX_STICK_SLIP_ELEMENTS];
    let tones = [(0.1, 50.0, 0.0); MAX_TONES];
    let largest = Effect::Periodic(Periodic::new(&tones, 1e-4).unwrap());
    let next = Effect::StickSlip(StickSlip::new(&elements).unwrap());
    let [largest, next] = [largest, next].map(|effect| pack(&[effect]).len() - pack(&[]).len());
    for effect in every_effect() {
        let is_tones = matches!(effect, Effect::Periodic(_));
        let most = if is_tones { largest } else { next };
        assert!(pack(&[effect]).len() - pack(&[]).len() <= most);
    }
    let correction = corrected_pack().len() - pack(&[]).len();
    let most = pack(&[]).len() + largest + (EFFECTS - 1) * next + correction;
    // It is derived so, and no byte is kept for nothing.
    assert_eq!(most, LARGEST);
}

/// What a constructor takes, the rig takes too, though it sees only the numbers that were made of it.
#[test]
fn effects_at_the_ends_of_their_ranges_survive() {
    let ends: [(&str, &[f64], f64); 27] = [
        ("offset", &[1e9], 1e-4),
        ("drift", &[1e9, -1e9, 1e3, -1.0], 1e-4),
        ("drift", &[0.1, 1e9, -1.0, 1e3], 1e-4),
        ("relaxation", &[1e9, 1e6], 1e-7),
        ("relaxation", &[-1e9, 1.1e-6], 1e3),
        ("stick_slip", &[1e9, 1e4], 1e-4),
        ("stop", &[1e9, 1e4], 1e-4),
        ("stop", &[0.0, -1e-9], 1e-4),
        ("bouc_wen", &[-1e9, 1e-9, 8.0], 1e-4),
        ("hardening_friction", &[-1e9, 1e-9, 8.0, 100.0, 200.0], 1e-4),
        ("yielding", &[1e9, 0.0, 1e-9, 0.0], 1e-7),
        ("yielding", &[-1e9, 1e4, 1e6, 1e6], 1e3),
        ("yielding", &[1.0, 1e4, 1e-9, 0.0], 1e-7),
        ("control_input", &[1e9, 1e4, 1e6, 1e9, 1e6, 1e-9, 3.0], 1e-7),
        (
            "control_input",
            &[-1e9, 0.0, 1e-9, -1e9, 0.0, 1e12, 0.0],
            1e3,
        ),
        ("directional", &[-1.0], 1e-4),
        ("backlash", &[1e9, 1e-9, 1e4], 1e-4),
        ("backlash", &[-1e9, 1e4, 0.0], 1e-4),
        ("degradation", &[-1e9, 1e7, 1.0], 1e-4),
        ("weakening", &[1e9, 1e4, 1.0, 1e-9], 1e-4),
        ("periodic", &[1e9, 499_000.0, 1e3], 1e-6),
        ("gap", &[1e4, 0.0], 1e-4),
        ("compliance", &[1e-3], 1e-7),
        ("compliance", &[1e9], 1e3),
        ("delay", &[255.0], 1.0),
        ("force_filter", &[1.001], 1e-4),
        ("force_filter", &[0.999e3], 1.0),
    ];
    for (name, parameters, tick) in ends {
        let effect = effect(name, parameters, tick);
        // Springs of friction below 0 are active.
        let expected = Expectation {
            allow_active: true,
            ..Expectation::default()
        };
        let mut decoded = FastLaw::<EFFECTS>::EMPTY;
        pack::decode(&pack(&[effect]), &mut decoded, &expected).unwrap();
        assert!(decoded.augmented().effects().eq([effect]));
    }
}

/// What the crate lays out by hand is postcard's own.
#[test]
fn the_body_is_postcard() {
    // Numbers of a correction, what it remembers, its numbers, its tables.
    type Table = ([f32; 4], u8, [[u8; 4]; 4], Vec<u8>);
    // Displacement and velocity.
    type Range = ([f32; 2], [f32; 2]);
    // Tick rate, revision, which is fixed as an integer of postcard's is not, identity; and what a load passes over.
    type Info = (f32, [u8; 4], [u8; 8], Vec<u8>);
    type Description = (Option<Range>, Option<f32>, Option<f32>, String);
    type Body = (
        Info,
        [f32; 4],
        [f32; 32],
        [f32; 32],
        Vec<(u8, Vec<f32>)>,
        Option<Table>,
    );
    let effects = &every_effect()[..EFFECTS];
    let body = |pack: &[u8]| postcard::from_bytes::<Body>(&pack[12..]).unwrap();
    let (said, eq13, octave, scale, packed, none) = body(&pack(effects));
    assert_eq!(none, None);
    let range = Some(([-0.2, 0.25], [-6.0, 6.5]));
    let identity = [1, 2, 3, 4, 5, 6, 7, 8];
    let name = "a name of 32 bytes of a specimen".to_owned();
    let (tick_rate, revision, of, description) = said;
    assert_eq!((tick_rate, revision, of), (1e4, [1, 2, 3, 4], identity));
    let description: Description = postcard::from_bytes(&description).unwrap();
    assert_eq!(description, (range, Some(3.0), Some(0.1), name));
    assert_eq!(eq13, [1.0539, 10.5, 0.1114, 0.3969]);
    let law = tabulated::<EFFECTS>(effects);
    assert_eq!(octave, law.damping().octave().as_flattened());
    assert_eq!(scale, *law.damping().scale());
    assert_eq!(packed.len(), EFFECTS);
    assert_eq!(packed[0], (0, vec![0.05]));
    let (numbers, kind, _, cells) = body(&corrected_pack()).5.unwrap();
    assert_eq!(numbers[2], 1e-5);
    assert_eq!(kind, 4);
    assert_eq!(cells.len(), 2 * CELLS);
    assert_eq!(cells[2..4], 7i16.to_le_bytes());
}

fn correction(memory: Memory<f32>) -> ResidualTable<f32> {
    let cells = |count: usize| -> Vec<i16> { (0..count).map(|n| 7 * n as i16).collect() };
    let parts = ResidualTableParts {
        reach: 0.2,
        speed: 6.0,
        unit: 1e-5,
        cells: &cells(CELLS),
        memory: Some((memory, [-0.1, 0.1])),
    };
    ResidualTable::new(&parts, 1e-4).unwrap()
}

/// A law with a correction.
fn corrected() -> FastLaw<EFFECTS> {
    corrected_over(Memory::Lag { time: 0.05 })
}

fn corrected_over(memory: Memory<f32>) -> FastLaw<EFFECTS> {
    let law = AugmentedLaw::new(law()).with_residual_table(correction(memory));
    FastLaw::new(law.unwrap())
}

fn corrected_pack() -> Vec<u8> {
    let mut buffer = [0; LARGEST];
    pack::encode(&corrected(), &info(), &mut buffer)
        .unwrap()
        .to_vec()
}

/// Where the kind of a correction stands in a pack's body: after what it says of itself, the law's and the damping's 68 numbers, the count of effects, that
/// there is one, and four numbers of its own.
const KIND: usize = INFO + 4 * 72 + 2;

#[test]
fn a_correction_survives() {
    let over = |memory: Memory<f32>| (Some(memory), corrected_over(memory));
    let speed = ResidualTable::new(
        &ResidualTableParts {
            reach: 0.2,
            speed: 6.0,
            unit: 1e-5,
            cells: &[3; CELLS],
            memory: None,
        },
        1e-4,
    );
    let over_speed = AugmentedLaw::new(law()).with_residual_table(speed.unwrap());
    for (number, (memory, law)) in [
        (0, (None, FastLaw::new(over_speed.unwrap()))),
        (1, over(Memory::Place)),
        (
            2,
            over(Memory::Sides {
                below: -0.1,
                above: 0.2,
            }),
        ),
        (3, over(Memory::Slip { limit: 0.05 })),
        (4, over(Memory::Lag { time: 0.05 })),
        (5, over(Memory::Travel { time: 0.05 })),
        (6, over(Memory::Largest)),
        (7, over(Memory::Age { time: 0.05 })),
        (10, over(Memory::Temperature)),
        (11, over(Memory::Frequency { time: 0.05 })),
    ] {
        let mut buffer = [0; LARGEST];
        let pack = pack::encode(&law, &info(), &mut buffer).unwrap();
        assert_eq!(pack[12 + KIND], number, "{memory:?}");
        assert_eq!(decode(pack).unwrap(), law, "{memory:?}");
    }
    // It leaves with the law that had it.
    let mut slot = corrected();
    pack::decode(&pack(&[]), &mut slot, &Expectation::default()).unwrap();
    assert_eq!(slot.augmented().residual_table(), None);
}

/// A table over what no table is over any more has its number still, and its name is said.
#[test]
fn what_was_removed_is_refused_by_name() {
    for (number, name) in [(8, "cycles"), (9, "level"), (12, "acceleration")] {
        let mut body = corrected_pack()[12..].to_vec();
        assert_eq!(body[KIND], 4, "it remembers a lag");
        body[KIND] = number;
        let refused = decode(&with_header(&body)).unwrap_err().to_string();
        assert_eq!(
            refused,
            format!("there is no residual table over {name} any more")
        );
    }
    let mut body = corrected_pack()[12..].to_vec();
    body[KIND] = 13;
    assert_eq!(decode(&with_header(&body)).unwrap_err(), PackError::Body);
}

/// After the kind and a number comes one that a table over acceleration had.
#[test]
fn a_word_that_nothing_uses_is_0() {
    let mut body = corrected_pack()[12..].to_vec();
    let unused = KIND + 1 + 4..KIND + 1 + 8;
    assert_eq!(body[unused.clone()], [0; 4]);
    for byte in unused {
        body[byte] = 1;
        assert_eq!(decode(&with_header(&body)).unwrap_err(), PackError::Body);
        body[byte] = 0;
    }
}

/// One whose cells count for nothing is none: nothing of it stays in the law, not even what it would remember.
#[test]
fn a_correction_without_a_unit_is_none() {
    // After the law's and the damping's 68 numbers, the count of effects, that there is one, and two numbers of its own.
    let unit = INFO + 4 * 70 + 2;
    let mut body = corrected_pack()[12..].to_vec();
    assert_eq!(body[unit..unit + 4], 1e-5f32.to_le_bytes());
    body[unit..unit + 4].fill(0);
    assert_eq!(decode(&with_header(&body)).unwrap(), tabulated(&[]));
}

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

/// A body as bytes with the header that a pack has.
fn with_header(body: &[u8]) -> Vec<u8> {
    let mut stamped = pack::VERSION.to_le_bytes().to_vec();
    stamped.extend((body.len() as u16).to_le_bytes());
    let mut crc = !0u32;
    for byte in stamped.iter().chain(body) {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = (crc >> 1) ^ (0xEDB8_8320 & (crc & 1).wrapping_neg());
        }
    }
    let mut pack = b"MDCP".to_vec();
    pack.extend(&stamped);
    pack.extend((!crc).to_le_bytes());
    pack.extend(body);
    pack
}

/// Whoever computes the checksum right can still send nonsense.
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
    // More effects than there is room for.
    let mut buffer = [0; LARGEST];
    let nine = &every_effect()[..EFFECTS + 1];
    let nine = pack::encode(&tabulated::<9>(nine), &info(), &mut buffer).unwrap();
    let full = ConfigError::Full {
        field: "effects",
        capacity: EFFECTS,
    };
    assert_eq!(refused(nine), PackError::Refused(full));
    // An effect whose numbers its constructor never gives: the offset's force is the last of the body but for one byte.
    let mut infinite = body.clone();
    let end = infinite.len() - 5;
    infinite[end..end + 4].copy_from_slice(&f32::INFINITY.to_le_bytes());
    assert_eq!(refused(&with_header(&infinite)), non_finite("force"));
    // No tones, four, and three but for a number; its numbers follow the kind and how many they are.
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
fn load_friction_comes_out_as_it_went_in_and_is_never_below_0() {
    let effects = [effect("load_friction", &[7.5], 1e-4)];
    let good = pack(&effects);
    assert_eq!(decode(&good).unwrap(), tabulated(&effects));
    let mut negative = good[12..].to_vec();
    let end = negative.len() - 4;
    negative[end..].copy_from_slice(&(-7.5f32).to_le_bytes());
    assert!(matches!(
        refused(&with_header(&negative)),
        PackError::Refused(ConfigError::OutOfRange { field: "load", .. })
    ));
}

#[test]
fn a_pack_that_does_not_fit_is_not_made() {
    let mut buffer = [0; LARGEST];
    for length in [0, 5, 12, 12 + INFO, 100, 283, 283 + INFO] {
        assert!(matches!(
            pack::encode(&tabulated::<EFFECTS>(&[]), &info(), &mut buffer[..length]),
            Err(PackError::Length { .. })
        ));
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
    // One that broke off is begun anew.
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

    /// A body changed by whoever computes the checksum anew is refused, or is a law whose force is finite.
    #[test]
    fn what_is_not_refused_is_a_law(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
        first in 0..=8_usize,
        amplitude in 1e-3f32..1e4,
        frequency in 0.1f32..100.0,
    ) {
        let every = every_effect();
        // The last is a law with a correction.
        let pack = match every.get(first..first + EFFECTS) {
            Some(effects) => pack(effects),
            None => corrected_pack(),
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
                    displacement: amplitude * sin,
                    velocity: amplitude * angular * cos,
                    acceleration: -amplitude * angular * angular * sin,
                    cycles,
                    temperature: 20.0 + cycles,
..Motion::default()
});
                prop_assert!(force.is_finite());
            }
        }
    }

    #[test]
    fn any_law_survives(
        k1 in -1e9f32..1e9, k3 in -1e9f32..1e9, c in 0f32..1e9, alpha in 0f32..=1.0,
    ) {
        let law = Law::new(k1, k3, c, alpha).unwrap();
        let mut buffer = [0; LARGEST];
        let law = FastLaw::new(AugmentedLaw::new(law));
        let pack = pack::encode(&law, &info(), &mut buffer).unwrap();
        prop_assert_eq!(decode(pack).unwrap(), law);
    }
}

/// Negative damping, as the issue has it.
#[test]
fn an_active_law_is_refused_unless_it_is_allowed() {
    let active = pack(&[Effect::Viscous(
        mesh_damper::effects::Viscous::new(-0.5).unwrap(),
    )]);
    let error = refused(&active);
    assert!(matches!(error, PackError::Active { amplitude, .. } if amplitude > 0.0));
    let said = error.to_string();
    assert!(
        said.starts_with("law: it gives more energy than it takes in a cycle of "),
        "{said}"
    );
    assert!(said.ends_with("or allow an active law"), "{said}");
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
    let contents = pack::read(&active, &mut law, &Expectation::default()).unwrap();
    let mut check = contents.passivity();
    let verdict = core::iter::from_fn(|| Some(check.step(&law))).find_map(|verdict| verdict);
    assert_eq!(verdict.unwrap().map_err(PackError::from), Err(error));
}
