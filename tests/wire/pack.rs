//! Coefficient packs: the decoded law equals the encoded one.

use mesh_damper::effects::residual_table::CELLS;
use mesh_damper::effects::{
    AugmentedLaw, DESCRIPTIONS, Effect, MAX_STICK_SLIP_ELEMENTS, MAX_TONES, Periodic, StickSlip,
};
use mesh_damper::error::ConfigError;
use mesh_damper::fast_law::FastLaw;
use mesh_damper::law::Law;
use mesh_damper::pack::{self, Expectation, LARGEST, PackError, PackInfo};
use mesh_damper::power::PowerSeed;
use proptest::prelude::*;

use crate::support::{
    EFFECTS, INFO, decode, encoded, every_effect, info, law, pack, refused, table_pack, tabulated,
    with_header,
};

/// The effect with this name, with parameters in the order of its description.
fn effect(name: &str, parameters: &[f64], tick: f64) -> Effect<f32> {
    let found = DESCRIPTIONS.iter().find(|each| each.name == name).unwrap();
    Effect::from_parameters(found.number, parameters, tick).unwrap()
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

/// A law has the largest effect once. Every other effect takes at most as many bytes as the next largest.
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
    let table = table_pack().len() - pack(&[]).len();
    let most = pack(&[]).len() + largest + (EFFECTS - 1) * next + table;
    // The constant is derived in this way, and no byte is reserved without use.
    assert_eq!(most, LARGEST);
}

/// The rig accepts every effect that its constructor accepts, from the derived numbers alone.
#[test]
fn effects_at_the_ends_of_their_ranges_survive() {
    for description in DESCRIPTIONS {
        // Each parameter at either end, in all combinations, at each tick; and as it is typical, for an end that needs another.
        let places = 0..description.parameters.len();
        let mut taken = vec![[false; 2]; places.len()];
        for ends in 0..3_u32.pow(places.len() as u32) {
            let end = |place: usize| (ends / 3_u32.pow(place as u32) % 3) as usize;
            let value = |place: usize| match end(place) {
                2 => description.typical[place],
                end => description.parameters[place].range[end],
            };
            let parameters: Vec<f64> = places.clone().map(value).collect();
            for tick in [1e-7, 1e-6, 1e-4, 1.0, 1e3] {
                let number = description.number;
                let Ok(effect) = Effect::from_parameters(number, &parameters, tick) else {
                    continue;
                };
                survives(effect, tick);
                for place in places.clone().filter(|place| end(*place) < 2) {
                    taken[place][end(place)] = true;
                }
            }
        }
        assert!(
            taken.as_flattened().iter().all(|taken| *taken),
            "{}: {taken:?}",
            description.name
        );
    }
}

/// The pack of a law with `effect` at a tick in s is read as it was.
fn survives(effect: Effect<f32>, tick: f64) {
    // Springs of friction below 0 are active.
    let expected = Expectation {
        allow_active: true,
        ..Expectation::default()
    };
    let info = PackInfo::at((1.0 / tick) as f32);
    let mut decoded = FastLaw::<EFFECTS>::EMPTY;
    let pack = encoded(&tabulated::<EFFECTS>(&[effect]), &info);
    pack::decode(&pack, &mut decoded, &expected).unwrap();
    assert!(decoded.augmented().effects().eq([effect]), "{effect:?}");
}

/// The crate's own layout equals postcard's.
#[test]
fn the_body_is_postcard() {
    // Numbers of a residual table, the kind of its memory, the memory's numbers, the cells.
    type Table = ([f32; 4], u8, [[u8; 4]; 4], Vec<u8>);
    // Displacement and velocity.
    type Range = ([f32; 2], [f32; 2]);
    // Tick rate, revision (of fixed size, unlike an integer in postcard), identity; and the bytes that a load skips.
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
    let (numbers, kind, _, cells) = body(&table_pack()).5.unwrap();
    assert_eq!(numbers[2], 1e-5);
    assert_eq!(kind, 4);
    assert_eq!(cells.len(), 2 * CELLS);
    assert_eq!(cells[2..4], 7i16.to_le_bytes());
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

proptest! {
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
