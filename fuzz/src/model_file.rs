//! The reader of model files, and the laws that are built from them.

use std::sync::LazyLock;

use mesh_damper::effects::DESCRIPTIONS;
use mesh_damper::effects::residual_table::CELLS;
use mesh_damper::fast_law::FastLaw;
use mesh_damper::pack;
use mesh_damper_model::correction::{CorrectionTable, MemoryAxis, Remembered};
use mesh_damper_model::file::{FittedRange, ModelFile};
use mesh_damper_model::{AddedEffect, Control, LawNode, MAX_EFFECTS, Model};

use crate::edit::edited;
use crate::law::EFFECTS;
use crate::motion::forces_are_finite;

const WORDS: [&str; 32] = [
    "null",
    "true",
    "{}",
    "[]",
    "[",
    "}",
    "\"",
    ",",
    ":",
    "-",
    "1e400",
    "1e308",
    "-1e9",
    "1e9",
    "1e-9",
    "1e-320",
    "0",
    "-0.0",
    "0.1",
    "1",
    "2.5",
    "1e4",
    "1000001",
    "\"stop\"",
    "\"gap\"",
    "\"delay\"",
    "\"periodic\"",
    "\"compliance\"",
    "\"sharpness\":2",
    "\"slip_limit_3\":1",
    "\"frequency\"",
    "\"half_width\"",
];

static GOOD: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
    let node = |amplitude| LawNode {
        amplitude,
        k1: 1.2,
        k3: 30.0,
        c: 0.1,
        alpha: 0.3,
    };
    let model = |effects: &[AddedEffect], correction| {
        let model = Model {
            law: vec![node(0.05), node(0.1 + 0.2)],
            effects: effects.to_vec(),
            correction,
            controls: vec![Control {
                name: "current_A".into(),
                range: [0.0, 1.5],
            }],
        };
        let range = FittedRange {
            displacement: [-0.2, 0.2],
            velocity: [-6.3, 6.3],
        };
        serde_json::to_vec(&ModelFile::new(model, range)).expect("every number is finite")
    };
    let correction = CorrectionTable {
        reach: 0.2,
        speed: 6.3,
        unit: 1e-6,
        cells: (0..CELLS as i16)
            .map(|cell| 100 * (cell % 300) - 15_000)
            .collect(),
        memory: Some(MemoryAxis {
            of: Remembered::Lag { time: 0.05 },
            range: [-0.1, 0.1],
        }),
    };
    // Every effect, each in a model with others, and the last of them beside a residual table.
    let parts = DESCRIPTIONS.chunks(MAX_EFFECTS).map(|chunk| {
        let effects: Vec<AddedEffect> = chunk.iter().map(AddedEffect::typical).collect();
        model(&effects, None)
    });
    let last: Vec<AddedEffect> = DESCRIPTIONS
        .last()
        .map(AddedEffect::typical)
        .into_iter()
        .collect();
    parts.chain([model(&last, Some(correction))]).collect()
});

/// A model that was read is unchanged after it is written and read again. It runs, and a coefficient pack keeps it unchanged.
pub fn check(script: &[u8]) -> bool {
    const TICK: f64 = 1e-4;
    let Ok(file) = ModelFile::from_bytes("fuzzed.json", &edited(&GOOD, &WORDS, script)) else {
        return false;
    };
    let written = serde_json::to_vec_pretty(&file).expect("what was JSON is");
    let again = ModelFile::from_bytes("fuzzed.json", &written);
    assert!(again.as_ref() == Ok(&file), "{file:?} is read as {again:?}");
    let (model, amplitude) = (file.model(), 0.1);
    let law = model
        .augmented::<f32>(amplitude, TICK)
        .expect("it was checked");
    forces_are_finite(&law);
    let bytes = model.pack(amplitude, TICK).expect("it was checked");
    let mut unpacked = FastLaw::<EFFECTS>::EMPTY;
    let expected = pack::Expectation {
        allow_active: true,
        ..pack::Expectation::at(1e4)
    };
    assert!(pack::decode(&bytes, &mut unpacked, &expected).is_ok());
    assert_eq!(unpacked, FastLaw::new(law));
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_model_from_which_fuzzing_starts_is_read() {
        for (index, bytes) in GOOD.iter().enumerate() {
            let read = ModelFile::from_bytes("start.json", bytes);
            assert!(read.is_ok(), "{index}: {read:?}");
        }
    }
}
