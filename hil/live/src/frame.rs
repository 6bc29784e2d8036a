//! The binary messages of the page's WebSocket. `docs/live.md` describes them for authors of other readers.
//!
//! All numbers are little-endian.
//!
//! | at | type | what |
//! | at | type | content |
//! | 0 | 2 bytes | `MD` |
//! | 2 | u8 | [`VERSION`] |
//! | 3 | u8 | kind: 1 samples, 2 cycles |
//! | 4 | u32 | rows |
//! | 8 | u32 | columns |
//! | 12 | u32 | samples dropped for this viewer so far |
//! | 16 | f64 | s; the first column counts from here |
//! | 24 | f32 | the columns one after the other, each with all its rows |
//!
//! A reader uses the columns that it knows. A later version may append columns without a new version number.

use crate::values::{CycleResult, Sample};

/// Version of the messages; it rises when an existing part changes its place or meaning.
pub const VERSION: u8 = 1;
/// Bytes before the columns.
pub const HEADER: usize = 24;

/// The message with `samples`: time in s, displacement in mm, force in kN, the law's force in kN; for a viewer that has missed `missed`
/// samples.
pub fn of_samples(samples: &[Sample], missed: u64) -> Vec<u8> {
    let start = samples.first().map_or(0.0, |sample| sample.time);
    message(1, samples, missed, start, |sample| {
        [
            (sample.time - start) as f32,
            sample.displacement,
            sample.force,
            sample.law_force,
        ]
    })
}

/// The message with `cycles`.
pub fn of_cycles(cycles: &[CycleResult], missed: u64) -> Vec<u8> {
    let start = cycles.first().map_or(0.0, |cycle| cycle.time);
    message(2, cycles, missed, start, |cycle| {
        [
            (cycle.time - start) as f32,
            cycle.block as f32,
            cycle.cycle as f32,
            f32::from(u8::from(cycle.ramp)),
            cycle.amplitude,
            cycle.frequency,
            cycle.stiffness,
            cycle.loss_factor,
            cycle.energy,
            cycle.law_stiffness,
            cycle.law_loss_factor,
            cycle.error,
            cycle.temperature,
        ]
    })
}

fn message<T, const C: usize>(
    kind: u8,
    rows: &[T],
    missed: u64,
    start: f64,
    values: impl Fn(&T) -> [f32; C],
) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(HEADER + 4 * C * rows.len());
    bytes.extend([b'M', b'D', VERSION, kind]);
    bytes.extend((rows.len() as u32).to_le_bytes());
    bytes.extend((C as u32).to_le_bytes());
    bytes.extend(u32::try_from(missed).unwrap_or(u32::MAX).to_le_bytes());
    bytes.extend(start.to_le_bytes());
    for column in 0..C {
        for row in rows {
            bytes.extend(values(row)[column].to_le_bytes());
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns of cycles, as the page has them.
    fn columns_of_cycles() -> Vec<&'static str> {
        let (_, cycles) = include_str!("../page/js/frames.js")
            .split_once("name: \"cycles\"")
            .unwrap();
        let (_, list) = cycles.split_once('[').unwrap();
        let (list, _) = list.split_once(']').unwrap();
        list.split('"').skip(1).step_by(2).collect()
    }

    fn float(bytes: &[u8], at: usize) -> f32 {
        f32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
    }

    #[test]
    fn samples_stand_where_the_page_looks_for_them() {
        let sample = |time, displacement| Sample {
            time,
            displacement,
            force: 2.0,
            law_force: 3.0,
        };
        let bytes = of_samples(&[sample(1e6, 0.5), sample(1e6 + 1e-4, -0.5)], 7);
        assert_eq!(bytes[..4], *b"MD\x01\x01");
        assert_eq!(bytes[4..16], [2, 0, 0, 0, 4, 0, 0, 0, 7, 0, 0, 0]);
        assert_eq!(bytes[16..24], 1e6_f64.to_le_bytes());
        let values: Vec<f32> = (HEADER..bytes.len())
            .step_by(4)
            .map(|at| float(&bytes, at))
            .collect();
        // A million seconds after the start, a tick is still at its place, within 1e-5 of its length.
        assert!((values[1] - 1e-4).abs() < 1e-9, "{values:?}");
        assert_eq!(values[0], 0.0);
        assert_eq!(values[2..], [0.5, -0.5, 2.0, 2.0, 3.0, 3.0]);
    }

    #[test]
    fn cycles_have_a_column_for_each_name() {
        let cycle = CycleResult {
            time: 2.0,
            cycle: 3,
            ramp: true,
            temperature: 21.0,
            ..CycleResult::default()
        };
        let bytes = of_cycles(&[cycle], 0);
        let columns = columns_of_cycles();
        assert_eq!(bytes.len(), HEADER + 4 * columns.len());
        assert_eq!(bytes[8], columns.len() as u8);
        let column = |name: &str| {
            let place = columns.iter().position(|column| *column == name);
            float(&bytes, HEADER + 4 * place.unwrap())
        };
        assert_eq!(column("cycle"), 3.0);
        assert_eq!(column("ramp"), 1.0);
        assert_eq!(column("temperature_degC"), 21.0);
    }
}
