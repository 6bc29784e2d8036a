//! The description in a pack, the requirements that a load may set for it, and packs of the previous version.

use std::f64::consts::PI;
use std::rc::Rc;

use mesh_damper::adc::Ads8688;
use mesh_damper::converter::Scale;
use mesh_damper::dac::Ad5761;
use mesh_damper::effects::residual_table::Memory;
use mesh_damper::effects::{AugmentedLaw, CONTROLS, Compliance, Delay, Effect, Motion, StickSlip};
use mesh_damper::error::ConfigError;
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::operating_range::OperatingRange;
use mesh_damper::pack::{
    self, Expectation, Identity, LARGEST, NAME, OLDEST, PackError, PackInfo, Stamp, Upload, VERSION,
};
use mesh_damper::rig::{Rig, RigSettings};
use mesh_damper::sine::{Block, Programme};
use mesh_damper_rig::actuator::{SimulatedAd5761, SimulatedAds8688, enable_line};

use crate::support::{self, encoded, law, of_version, residual_table, with_table};

/// A pack, and its law.
type Stored = (&'static [u8], fn() -> FastLaw<8>);

/// Written by the encoder of version 6, before there was a version 7.
const OLD: [Stored; 2] = [
    (include_bytes!("packs/version-6-effects.mdcp"), with_effects),
    (include_bytes!("packs/version-6-table.mdcp"), with_table),
];

fn alone() -> AugmentedLaw<f32, 8> {
    AugmentedLaw::new(law())
}

fn with_effects() -> FastLaw<8> {
    let slider = StickSlip::new(&[(0.5, 0.02), (0.3, 0.05)]).unwrap();
    let delay = Delay::new(1.23e-3, 1e-4).unwrap();
    let law = alone().with(Effect::StickSlip(slider));
    FastLaw::new(law.and_then(|law| law.with(Effect::Delay(delay))).unwrap())
}

const MODEL: Identity = Identity([0xde, 0xad, 0xbe, 0xef, 0, 1, 2, 3]);

fn info() -> PackInfo {
    PackInfo {
        operating_range: Some(OperatingRange::new([-0.2, 0.25], [-6.0, 6.5]).unwrap()),
        stamp: Stamp {
            tick_rate: 1e4,
            revision: 7,
            identity: MODEL,
        },
        ..PackInfo::at(1e4).named("mount 4").unwrap()
    }
}

fn packed(info: &PackInfo) -> Vec<u8> {
    encoded(&with_effects(), info)
}

fn load(pack: &[u8], expected: &Expectation) -> Result<Option<Stamp>, PackError> {
    let mut slot = FastLaw::<8>::EMPTY;
    pack::decode(pack, &mut slot, expected)
}

fn identity(identity: Identity) -> Expectation {
    Expectation {
        identity: Some(identity),
        ..Expectation::default()
    }
}

fn newer_than(revision: u32) -> Expectation {
    Expectation {
        newer_than: Some(revision),
        ..Expectation::default()
    }
}

#[test]
fn what_a_pack_says_of_itself_comes_back() {
    let nameless = PackInfo::at(512.0);
    let published = PackInfo {
        density: Some(2.5),
        amplitude: Some(0.15),
        ..PackInfo::at(1e-3).named("Dämpfer ?? \"1\"").unwrap()
    };
    let empty = PackInfo::at(1e7);
    for info in [info(), nameless, published, empty] {
        let pack = encoded(&FastLaw::<8>::new(alone()), &info);
        let loaded = load(&pack, &Expectation::at(info.stamp.tick_rate));
        assert_eq!(loaded, Ok(Some(info.stamp)));
        assert_eq!(PackInfo::of(&pack), Ok(Some(info)));
    }
}

/// The tables of these tests drive.
fn any() -> Expectation {
    Expectation {
        allow_active: true,
        ..Expectation::default()
    }
}

#[test]
fn a_pack_of_version_6_is_read_and_does_not_know_its_rate() {
    for (pack, law) in OLD {
        let mut slot = FastLaw::EMPTY;
        let info = pack::decode(pack, &mut slot, &any());
        assert_eq!((info, slot), (Ok(None), law()));
        assert_eq!(PackInfo::of(pack), Ok(None));
        let mut slot = FastLaw::<8>::EMPTY;
        let refused = |expected: &Expectation| load(pack, expected).unwrap_err().to_string();
        assert_eq!(
            refused(&Expectation::at(1e4)),
            "tick_rate: the pack is of version 6 and does not say its rate, and 10000 Hz is required: export the model for that rate"
        );
        assert_eq!(
            refused(&identity(MODEL)),
            "identity: the pack is of version 6 and does not say its model, and deadbeef00010203 is required: give the pack of that model"
        );
        assert_eq!(
            refused(&newer_than(0)),
            "revision: the pack is of version 6 and has none, and one above 0 is required: export the model with a higher one"
        );
        let cut = pack::decode(&pack[..pack.len() - 1], &mut slot, &Expectation::default());
        assert!(matches!(cut, Err(PackError::Length { .. })));
    }
}

/// Packs that commit 3f3244e2 wrote: all of its effects with their typical parameters, and a table. With each the force of its law at
/// some ticks of [`swept`], kN.
const WRITTEN: [(&[u8], [f32; 5]); 4] = [
    (
        include_bytes!("packs/version-7-effects-1.mdcp"),
        [
            0.17316346,
            -0.20604435,
            0.33281264,
            0.023495678,
            -0.14085427,
        ],
    ),
    (
        include_bytes!("packs/version-7-effects-2.mdcp"),
        [0.66049176, -0.76404715, 0.30365306, 0.51042354, -0.49415332],
    ),
    (
        include_bytes!("packs/version-7-effects-3.mdcp"),
        [0.33333844, -0.31774002, 0.13323927, 0.22745061, -0.2008774],
    ),
    (
        include_bytes!("packs/version-7-table.mdcp"),
        [0.12409, -0.21361311, 0.14540301, 0.018006705, -0.16138902],
    ),
];

/// 0.1 mm at 5 Hz, warm, with control inputs.
fn swept(tick: u16) -> Motion<f32> {
    let omega = 10.0 * PI;
    let time = f64::from(tick) / 1e4;
    let (sin, cos) = (omega * time).sin_cos();
    Motion {
        displacement: (0.1 * sin) as f32,
        velocity: (0.1 * omega * cos) as f32,
        acceleration: (-0.1 * omega * omega * sin) as f32,
        cycles: (5.0 * time) as f32,
        temperature: 35.0,
        controls: [0.5; CONTROLS],
    }
}

#[test]
fn packs_that_an_earlier_program_wrote_give_the_force_that_they_gave() {
    for (pack, expected) in WRITTEN {
        assert_eq!(PackInfo::of(pack), Ok(Some(support::info())));
        let mut law = FastLaw::<8>::EMPTY;
        pack::decode(pack, &mut law, &any()).unwrap();
        let mut law = RunningLaw::new(law);
        let forces: Vec<f32> = (0..3000).map(|tick| law.force(&swept(tick))).collect();
        for (tick, expected) in [500, 1200, 1900, 2600, 2999].into_iter().zip(expected) {
            let error = forces[tick] - expected;
            assert!(error.abs() < 1e-6, "{tick}: {error} of {expected}");
        }
    }
}

/// It does not say its rate, so that numbers of any tick are right.
#[test]
fn a_pack_of_version_6_may_be_for_any_rate() {
    let spring = Effect::Compliance(Compliance::new(20.0, 5e-4).unwrap());
    let table = residual_table(Memory::Frequency { time: 0.1 });
    let law = alone().with(spring).unwrap();
    let law = FastLaw::<8>::new(law.with_residual_table(table).unwrap());
    let pack = encoded(&law, &info());
    // The law comes after the rate, 12 bytes and the description with its length.
    let body = &pack[12 + 17 + usize::from(pack[12 + 16])..];
    let mut slot = FastLaw::EMPTY;
    let read = pack::decode(&of_version(OLDEST, body), &mut slot, &any());
    assert_eq!((read, slot), (Ok(None), law));
}

#[test]
fn each_refusal_names_the_field_and_both_values() {
    let good = packed(&info());
    let mut newer = good.clone();
    newer[4] = VERSION as u8 + 1;
    for (pack, expected, said) in [
        (
            &good[..],
            Expectation::at(2e3),
            "tick_rate: the pack is for 10000 Hz, and 2000 Hz is required: export the model for that rate",
        ),
        (
            &good,
            identity(Identity([0; 8])),
            "identity: the pack is of the model deadbeef00010203, and 0000000000000000 is required: give the pack of that model",
        ),
        (
            &good,
            newer_than(7),
            "revision: the pack has 7, and one above 7 is required: export the model with a higher one",
        ),
        (
            &good,
            newer_than(8),
            "revision: the pack has 7, and one above 8 is required: export the model with a higher one",
        ),
        (
            &good[..good.len() - 1],
            Expectation::default(),
            "the pack has 357 bytes instead of 358: copy or export it again",
        ),
        (
            &newer,
            Expectation::default(),
            "the pack is of version 8, and versions 6 to 7 are read: export the model for this one",
        ),
    ] {
        assert_eq!(load(pack, &expected).unwrap_err().to_string(), said);
    }
    let all = Expectation {
        identity: Some(MODEL),
        newer_than: Some(6),
        ..Expectation::at(1e4)
    };
    assert_eq!(load(&good, &all), Ok(Some(info().stamp)));
}

/// A rate that was rounded to f32 in two ways is still the same. A rate that differs by a crystal's tolerance is a different rate.
#[test]
fn a_rate_is_the_same_within_rounding() {
    let good = packed(&info());
    let rate = |part: f64| Expectation::at((1e4 * (1.0 + part)) as f32);
    for part in [0.0, 5e-7, -5e-7] {
        assert!(load(&good, &rate(part)).is_ok(), "{part}");
    }
    for part in [1e-5, -1e-5] {
        assert!(load(&good, &rate(part)).is_err(), "{part}");
    }
    assert!(load(&good, &Expectation::at(f32::NAN)).is_err());
}

#[test]
fn what_is_out_of_range_is_neither_written_nor_read() {
    let mut buffer = [0; LARGEST];
    let nan = f32::NAN;
    let with = |change: fn(&mut PackInfo, f32), value| {
        let mut info = info();
        change(&mut info, value);
        info
    };
    for (info, field) in [
        (
            with(|info, rate| info.stamp.tick_rate = rate, nan),
            "tick_rate",
        ),
        (
            with(|info, rate| info.stamp.tick_rate = rate, 0.0),
            "tick_rate",
        ),
        (
            with(|info, rate| info.stamp.tick_rate = rate, 1.1e7),
            "tick_rate",
        ),
        (with(|info, of| info.density = Some(of), -1.0), "density"),
        (with(|info, of| info.density = Some(of), 26.0), "density"),
        (with(|info, of| info.amplitude = Some(of), nan), "amplitude"),
        (
            with(|info, of| info.amplitude = Some(of), -0.1),
            "amplitude",
        ),
    ] {
        let refused = pack::encode(&with_effects(), &info, &mut buffer).unwrap_err();
        assert!(matches!(refused, PackError::Refused(_)));
        let said = refused.to_string();
        assert!(said.starts_with(field), "{field}: {said}");
    }
    assert_eq!(
        PackInfo::at(1e4).named(&"x".repeat(NAME + 1)),
        Err(ConfigError::Full {
            field: "name",
            capacity: NAME
        })
    );
}

/// A rig in this process refuses a pack for another rate, and its law stays.
#[test]
fn a_rig_refuses_an_upload_for_another_rate() {
    let one = Scale::new(1.0, 0.0).unwrap();
    let adc = Ads8688::new(SimulatedAds8688::new(Rc::default()), one, one).unwrap();
    let dac = Ad5761::new(SimulatedAd5761::new(Rc::default()), one).unwrap();
    let programme = Programme::<1>::new(1e4, 1)
        .and_then(|programme| programme.with(Block::sine(0.1, 5.0, 2)?))
        .unwrap();
    let expected = Expectation::at(programme.tick_rate() as f32);
    let law = RunningLaw::new(FastLaw::<8>::new(alone()));
    let settings = RigSettings::default();
    let mut rig = Rig::new(adc, dac, enable_line().0, &settings, programme, law).unwrap();
    let mut upload = Upload::new();
    for (clock, (rate, taken)) in (0..).zip([(2e3, false), (1e4, true)]) {
        let pack = packed(&PackInfo::at(rate));
        upload.part(0, &pack).unwrap();
        let swapped = rig.swap_law_with(|slot| upload.finish(slot, &expected).map(|_| ()));
        let refused = PackError::TickRate {
            expected: 1e4,
            found: Some(rate),
        };
        assert_eq!(swapped, if taken { Ok(()) } else { Err(refused) });
        // A pending law takes over at the start.
        rig.start().unwrap();
        rig.tick(clock);
        let in_force = if taken {
            with_effects()
        } else {
            FastLaw::new(alone())
        };
        assert_eq!(*rig.law(), in_force);
        rig.stop();
    }
}

/// A pack with a correct checksum can still contain an invalid description. A load examines all of it but the name.
#[test]
fn nonsense_that_a_pack_says_of_itself_is_refused() {
    let good = packed(&info());
    let name = good.len() - law_alone() - 7;
    assert_eq!(&good[name..name + 7], b"mount 4");
    let body = "the pack's body cannot be read: export the model again";
    // Header, stamp and length are 29 bytes. The last two bytes of a NaN are 0xc0 and 0x7f.
    for (place, value, said) in [
        (name, &[0xff][..], body),
        (name - 1, &[6], body),
        (name - 1, &[8], body),
        (29, &[2], body),
        (29, &[0], body),
        (32, &[0xc0, 0x7f], "displacement is not a finite number"),
        (46, &[2], body),
        (14, &[0xc0, 0x7f], "tick_rate is not a finite number"),
    ] {
        let mut bad = good.clone();
        bad[place..place + value.len()].copy_from_slice(value);
        seal(&mut bad);
        let refused = PackInfo::of(&bad).unwrap_err().to_string();
        assert_eq!(refused, said, "{place}");
        let loaded = load(&bad, &Expectation::default());
        if place >= name - 1 {
            assert!(loaded.is_ok(), "{place}");
        } else {
            assert_eq!(loaded.unwrap_err().to_string(), said, "{place}");
        }
    }
    // The last two bytes of each number, behind those of the operating range.
    let published = packed(&PackInfo {
        density: Some(3.0),
        amplitude: Some(0.1),
        ..info()
    });
    for (place, said) in [
        (49, "density is not a finite number"),
        (54, "amplitude is not a finite number"),
    ] {
        let mut bad = published.clone();
        bad[place..place + 2].copy_from_slice(&[0xc0, 0x7f]);
        seal(&mut bad);
        assert_eq!(PackInfo::of(&bad).unwrap_err().to_string(), said);
        let loaded = load(&bad, &Expectation::default());
        assert_eq!(loaded.unwrap_err().to_string(), said);
    }
    // A pack that ends within the stamp, or before the description ends.
    for length in [12, 20, 28, 40] {
        let mut cut = good[..length].to_vec();
        seal(&mut cut);
        assert_eq!(PackInfo::of(&cut), Err(PackError::Body), "{length}");
        assert_eq!(load(&cut, &Expectation::default()), Err(PackError::Body));
    }
}

/// Number of bytes of the law in the pack. A pack of version 6 contains nothing else behind its header.
fn law_alone() -> usize {
    let [(pack, _), _] = OLD;
    pack.len() - 12
}

/// Corrects length and checksum.
fn seal(pack: &mut [u8]) {
    let length = (pack.len() - 12) as u16;
    pack[6..8].copy_from_slice(&length.to_le_bytes());
    let mut crc = !0u32;
    for byte in pack[4..8].iter().chain(&pack[12..]) {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = (crc >> 1) ^ (0xEDB8_8320 & (crc & 1).wrapping_neg());
        }
    }
    pack[8..12].copy_from_slice(&(!crc).to_le_bytes());
}
