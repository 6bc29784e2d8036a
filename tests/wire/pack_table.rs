//! Packs with a residual table: every kind survives, and removed kinds are refused with their name.

use mesh_damper::effects::residual_table::{CELLS, Memory, ResidualTableParts};
use mesh_damper::effects::{AugmentedLaw, ResidualTable};
use mesh_damper::fast_law::FastLaw;
use mesh_damper::pack::{self, Expectation, LARGEST, PackError};

use crate::support::{
    INFO, decode, info, law, pack, table_pack, tabulated, with_header, with_table, with_table_over,
};

/// Place of a residual table's kind in a pack's body: after [`INFO`], the 68 numbers of the law and its damping, the count of effects,
/// the flag of the table and four numbers of its own.
const KIND: usize = INFO + 4 * 72 + 2;

#[test]
fn a_residual_table_survives() {
    let over = |memory: Memory<f32>| {
        let law = with_table_over(memory).augmented().clone();
        let table = law.residual_table().unwrap().passive(|_| 0.0);
        let law = law.with_residual_table(table).unwrap();
        (Some(memory), FastLaw::new(law))
    };
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
    // It is removed together with its law.
    let mut slot = with_table();
    pack::decode(&pack(&[]), &mut slot, &Expectation::default()).unwrap();
    assert_eq!(slot.augmented().residual_table(), None);
}

/// A removed kind of table keeps its number, and the refusal contains its name.
#[test]
fn removed_tables_are_refused_by_name() {
    for (number, name) in [(8, "cycles"), (9, "level"), (12, "acceleration")] {
        let mut body = table_pack()[12..].to_vec();
        assert_eq!(body[KIND], 4, "it remembers a lag");
        body[KIND] = number;
        let refused = decode(&with_header(&body)).unwrap_err().to_string();
        assert_eq!(
            refused,
            format!("there is no residual table over {name} any more")
        );
    }
    let mut body = table_pack()[12..].to_vec();
    body[KIND] = 13;
    assert_eq!(decode(&with_header(&body)).unwrap_err(), PackError::Body);
}

/// The kind is followed by a number, and then by another one, which only a table over acceleration used.
#[test]
fn a_word_that_nothing_uses_is_0() {
    let mut body = table_pack()[12..].to_vec();
    let unused = KIND + 1 + 4..KIND + 1 + 8;
    assert_eq!(body[unused.clone()], [0; 4]);
    for byte in unused {
        body[byte] = 1;
        assert_eq!(decode(&with_header(&body)).unwrap_err(), PackError::Body);
        body[byte] = 0;
    }
}

/// A table with a unit of 0 is dropped: nothing of it remains in the law, including its memory.
#[test]
fn a_residual_table_without_a_unit_is_none() {
    // After the 68 numbers of the law and its damping, the count of effects, the flag of the table, and two numbers of its own.
    let unit = INFO + 4 * 70 + 2;
    let mut body = table_pack()[12..].to_vec();
    assert_eq!(body[unit..unit + 4], 1e-5f32.to_le_bytes());
    body[unit..unit + 4].fill(0);
    assert_eq!(decode(&with_header(&body)).unwrap(), tabulated(&[]));
}
