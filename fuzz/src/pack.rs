//! Coefficient packs, whole and in parts.

use std::sync::LazyLock;

use mesh_damper::effects::ResidualTable;
use mesh_damper::effects::residual_table::{CELLS, Memory, ResidualTableParts};
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::operating_range::OperatingRange;
use mesh_damper::pack::{
    self, Expectation, Identity, LARGEST, PackError, PackInfo, Stamp, Upload, VERSION,
};
use mesh_damper::passivity;

use crate::edit::edited;
use crate::feed::{Feed, Random};
use crate::law::{EFFECTS, law};
use crate::motion::forces_are_finite;

/// Numbers of a pack, as bytes.
const WORDS: [&str; 8] = [
    "\0\0\0\0",
    "\0\0\u{1}\0",
    "\u{1}",
    "\0",
    "\u{7f}",
    "\0\0\0@",
    "\0\0\0\u{3f}",
    "\u{10}",
];
/// Bytes before a pack's body.
const HEADER: usize = 12;

/// Whole packs; the last ones are one with a residual table and one of version 6.
pub static GOOD: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
    let mut random = Random::of(b"packs");
    let mut laws: Vec<_> = (0..12)
        .map(|_| {
            let bytes: Vec<u8> = (0..120).map(|_| random.next() as u8).collect();
            law(&mut Feed(&bytes), 1e-4)
        })
        .collect();
    let parts = ResidualTableParts {
        reach: 0.2,
        speed: 10.0,
        unit: 1e-5,
        cells: &[11; CELLS],
        memory: Some((Memory::Slip { limit: 0.01 }, [-0.01, 0.01])),
    };
    let correction = ResidualTable::new(&parts, 1e-4).expect("all are in range");
    let last = laws.pop().expect("there are twelve");
    laws.push(last.with_residual_table(correction).expect("it has none"));
    let packed = |(number, law)| {
        let mut buffer = [0; LARGEST];
        let bytes = pack::encode(&FastLaw::<EFFECTS>::new(law), &info(number), &mut buffer);
        bytes.expect("it fits").to_vec()
    };
    let old = include_bytes!("../../tests/wire/packs/version-6-effects.mdcp").to_vec();
    (0..).zip(laws).map(packed).chain([old]).collect()
});

/// The description in the pack `number`; a higher number has more fields.
fn info(number: u32) -> PackInfo {
    let range = OperatingRange::new([-0.2, 0.25], [-6.0, 6.5]).expect("they are in order");
    PackInfo {
        operating_range: (!number.is_multiple_of(2)).then_some(range),
        density: (!number.is_multiple_of(3)).then_some(3.0),
        amplitude: (!number.is_multiple_of(4)).then_some(0.1),
        stamp: Stamp {
            tick_rate: 1e4,
            revision: number,
            identity: Identity([number as u8; 8]),
        },
        ..PackInfo::at(1e4)
            .named(&"é".repeat(number as usize))
            .expect("it fits")
    }
}

static BODIES: LazyLock<Vec<Vec<u8>>> =
    LazyLock::new(|| GOOD.iter().map(|pack| pack[HEADER..].to_vec()).collect());

/// A pack that was damaged in transfer is refused, or is not damaged at all. Returns the received bytes if they were accepted.
pub fn damaged(script: &[u8]) -> Option<Vec<u8>> {
    let bytes = edited(&GOOD, &WORDS, script);
    is_a_law(&bytes).then_some(bytes)
}

/// The check of [`damaged`]. In addition, a body with a corrected checksum is refused or is a valid law.
pub fn check(script: &[u8]) -> bool {
    let taken = damaged(script).is_some();
    let mut body = edited(&BODIES, &WORDS, script);
    body.truncate(usize::from(u16::MAX));
    // The expectation for the pack with which the script begins.
    let which = script.first().copied().map_or(0, usize::from);
    let version = GOOD
        .get(which % (GOOD.len() + 1))
        .map_or(VERSION, |pack| version_of(pack));
    let stamp = [version.to_le_bytes(), (body.len() as u16).to_le_bytes()].concat();
    let mut crc = flate2::Crc::new();
    crc.update(&stamp);
    crc.update(&body);
    let sum = crc.sum().to_le_bytes();
    is_a_law(&[b"MDCP", &stamp[..], &sum, &body].concat()) || taken
}

fn version_of(pack: &[u8]) -> u16 {
    u16::from_le_bytes([pack[4], pack[5]])
}

/// An upload in slices, while a law runs, has the same result as an upload at once. No law is pending before the last slice.
fn in_slices(mut upload: Upload, whole: &Result<Option<Stamp>, PackError>, law: &FastLaw<EFFECTS>) {
    let passive = Expectation::default();
    let mut running = RunningLaw::<EFFECTS>::empty();
    let sliced = loop {
        let slice = |slot: &mut _| upload.finish_slice(slot, &passive);
        match running.swap_in_slices(slice) {
            Ok(None) => assert!(!running.boundary()),
            Ok(Some(stamp)) => break Ok(stamp),
            Err(error) => break Err(error),
        }
    };
    assert_eq!(sliced, *whole);
    assert_eq!(running.boundary(), whole.is_ok());
    assert!(whole.is_err() || running.law() == law);
}

/// Whether `bytes` are accepted. If they are, the law survives encoding and decoding, and gives forces. An upload in parts has the
/// same result.
fn is_a_law(bytes: &[u8]) -> bool {
    let mut slot = FastLaw::<EFFECTS>::EMPTY;
    // An active law also survives encoding and decoding.
    let any = Expectation {
        allow_active: true,
        ..Expectation::default()
    };
    let whole = pack::decode(bytes, &mut slot, &any);
    let mut upload = Upload::new();
    let mut parts = bytes.chunks(100).enumerate();
    let uploaded = parts.try_for_each(|(index, part)| upload.part(100 * index, part));
    let mut from_parts = FastLaw::EMPTY;
    let sliced = upload.clone();
    if uploaded.is_ok() {
        assert_eq!(upload.finish(&mut from_parts, &any), whole);
    } else {
        assert!(bytes.len() > LARGEST && whole.is_err());
    }
    let Ok(said) = whole else {
        if uploaded.is_ok() {
            in_slices(sliced, &whole, &slot);
        }
        return false;
    };
    // A load skips the bytes behind the stamp, which may be invalid.
    let Ok(described) = PackInfo::of(bytes) else {
        assert!(said.is_some());
        return false;
    };
    assert_eq!(described.as_ref().map(|info| info.stamp), said);
    let info = described.unwrap_or(PackInfo::at(1e4));
    let stamp = info.stamp;
    let mut own = Expectation {
        identity: Some(stamp.identity),
        newer_than: stamp.revision.checked_sub(1),
        allow_active: true,
        ..Expectation::at(stamp.tick_rate)
    };
    let mut unused = FastLaw::<EFFECTS>::EMPTY;
    // Without the expectation, the verdict is that of a check of the law alone.
    let passive = pack::decode(bytes, &mut unused, &Expectation::default());
    let checked = passivity::check(slot.augmented());
    assert_eq!(passive, checked.map(|()| said).map_err(PackError::from));
    in_slices(sliced, &passive, &slot);
    // A pack of version 6 contains none of the required information.
    assert_eq!(
        pack::decode(bytes, &mut unused, &own).is_ok(),
        said.is_some()
    );
    own.newer_than = Some(stamp.revision);
    assert!(pack::decode(bytes, &mut unused, &own).is_err());
    let mut buffer = [0; LARGEST];
    let packed = pack::encode(&slot, &info, &mut buffer).expect("it was one");
    let mut again = FastLaw::EMPTY;
    assert_eq!(pack::decode(packed, &mut again, &any), Ok(Some(stamp)));
    assert_eq!(PackInfo::of(packed), Ok(Some(info)));
    assert_eq!(again, slot);
    assert_eq!(from_parts, slot);
    forces_are_finite(slot.augmented());
    true
}
