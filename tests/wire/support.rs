//! Shared by the tests of packs: laws, their packs, and packs that are forged.

use mesh_damper::effects::description::Description;
use mesh_damper::effects::residual_table::{CELLS, Memory, ResidualTableParts};
use mesh_damper::effects::{AugmentedLaw, DESCRIPTIONS, Effect, ResidualTable};
use mesh_damper::fast_law::FastLaw;
use mesh_damper::law::Law;
use mesh_damper::operating_range::OperatingRange;
use mesh_damper::pack::{self, Expectation, Identity, LARGEST, PackError, PackInfo, Stamp};

/// Largest number of effects in a law.
pub const EFFECTS: usize = 8;

/// All the information of a pack, with the longest name.
pub fn info() -> PackInfo {
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

/// Bytes of [`info`] in a pack's body, before the law.
pub const INFO: usize = 77;

pub fn law() -> Law<f32> {
    Law::new(1.0539, 10.5, 0.1114, 0.3969).unwrap()
}

/// Every effect of the crate, each with the most elements.
pub fn every_effect() -> Vec<Effect<f32>> {
    let most = |each: &Description| {
        let last = &each.typical[each.typical.len() - each.parameters.len()..];
        let missing = each.most - each.typical.len() / each.parameters.len();
        // All elements differ.
        let more = (1..=missing).flat_map(|n| last.iter().map(move |x| x * (1.0 + 0.1 * n as f64)));
        let parameters: Vec<f64> = each.typical.iter().copied().chain(more).collect();
        Effect::from_parameters(each.number, &parameters, 1e-4).unwrap()
    };
    DESCRIPTIONS.iter().map(most).collect()
}

/// [`law`] with `effects`, as the fast law.
pub fn tabulated<const N: usize>(effects: &[Effect<f32>]) -> FastLaw<N> {
    let with = |law: AugmentedLaw<f32, N>, effect: &Effect<f32>| law.with(*effect).unwrap();
    FastLaw::new(effects.iter().fold(AugmentedLaw::new(law()), with))
}

/// The pack of `law` with this information.
pub fn encoded<const N: usize>(law: &FastLaw<N>, info: &PackInfo) -> Vec<u8> {
    let mut buffer = [0; LARGEST];
    pack::encode(law, info, &mut buffer).unwrap().to_vec()
}

/// The pack of [`law`] with `effects`.
pub fn pack(effects: &[Effect<f32>]) -> Vec<u8> {
    encoded(&tabulated::<EFFECTS>(effects), &info())
}

pub fn decode(bytes: &[u8]) -> Result<FastLaw<EFFECTS>, PackError> {
    let mut law = FastLaw::EMPTY;
    pack::decode(bytes, &mut law, &Expectation::default()).map(|_| law)
}

pub fn refused(bytes: &[u8]) -> PackError {
    decode(bytes).unwrap_err()
}

pub fn residual_table(memory: Memory<f32>) -> ResidualTable<f32> {
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

/// [`law`] with a residual table.
pub fn with_table() -> FastLaw<EFFECTS> {
    with_table_over(Memory::Lag { time: 0.05 })
}

pub fn with_table_over(memory: Memory<f32>) -> FastLaw<EFFECTS> {
    let law = AugmentedLaw::new(law()).with_residual_table(residual_table(memory));
    FastLaw::new(law.unwrap())
}

pub fn table_pack() -> Vec<u8> {
    encoded(&with_table(), &info())
}

/// A body with the header of a pack.
pub fn with_header(body: &[u8]) -> Vec<u8> {
    of_version(pack::VERSION, body)
}

/// The same of a version.
pub fn of_version(version: u16, body: &[u8]) -> Vec<u8> {
    let mut stamped = version.to_le_bytes().to_vec();
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
