//! The tests of a drawn specimen.

use mesh_damper_reference::protocol::TestBlock;
use mesh_damper_reference::tables;
use rand::seq::{IndexedRandom, SliceRandom};
use rand::{Rng, RngExt};
use serde::Serialize;

/// The shape of a test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum TestShape {
    /// Several amplitudes, each slowly and fast.
    Amplitudes,
    /// One amplitude at several frequencies, and a second amplitude.
    Frequencies,
    /// One long block, which continues in the held-out part.
    Long,
    /// One short block, which the held-out test repeats.
    Single,
}

/// A test to fit and a test to predict.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Programme {
    /// Shape of the tests.
    pub shape: TestShape,
    /// The fitted blocks.
    pub training: Vec<TestBlock>,
    /// The held-out blocks. For [`TestShape::Long`], the training block with more cycles.
    pub held_out: Vec<TestBlock>,
}

/// The tables' amplitudes, mm. Coefficients are linear between them. A test to be predicted at other amplitudes needs all of these
/// within its range, because otherwise no law could know how the coefficients continue.
const NODES: [f64; 5] = tables::AMPLITUDES;

/// A programme of `shape`, with its amplitudes on a grid of 5 µm and its frequencies on a grid of 0.1 Hz.
pub fn draw(shape: TestShape, rng: &mut impl Rng) -> Programme {
    let (training, held_out) = match shape {
        TestShape::Amplitudes => amplitudes(rng),
        TestShape::Frequencies => frequencies(rng),
        TestShape::Long => {
            let amplitude = grid(rng.random_range(0.08..0.16), 0.005);
            let frequency = grid(rng.random_range(1.5..3.0), 0.1);
            let cycles = rng.random_range(60..100);
            (
                vec![block(amplitude, frequency, cycles)],
                vec![block(amplitude, frequency, cycles + cycles / 3)],
            )
        }
        TestShape::Single => {
            let amplitude = grid(rng.random_range(0.08..0.16), 0.005);
            let frequency = grid(rng.random_range(0.8..2.0), 0.1);
            (
                vec![block(amplitude, frequency, 15)],
                vec![block(amplitude, frequency, 6)],
            )
        }
    };
    Programme {
        shape,
        training,
        held_out,
    }
}

/// For example 0.05, 0.1, 0.2 mm at 1 and 5 Hz each and 0.15 mm at 2 Hz, in this order or another, sometimes with a block that
/// returns. Held out are two amplitudes between these at two frequencies between these.
fn amplitudes(rng: &mut impl Rng) -> (Vec<TestBlock>, Vec<TestBlock>) {
    let mut nodes = if rng.random_bool(0.25) {
        NODES.to_vec()
    } else {
        NODES[..4].to_vec()
    };
    let (least, largest) = (nodes[0], nodes[nodes.len() - 1]);
    let slow = grid(rng.random_range(0.5..1.5), 0.1);
    let fast = grid(rng.random_range(4.0..8.0), 0.1);
    // One amplitude runs at a separate frequency, such as 0.15 mm at 2 Hz.
    let alone = nodes.remove(rng.random_range(1..nodes.len()));
    let mut training: Vec<TestBlock> = nodes
        .iter()
        .flat_map(|&amplitude| [(amplitude, slow, 5..8), (amplitude, fast, 8..13)])
        .map(|(amplitude, frequency, cycles)| block(amplitude, frequency, rng.random_range(cycles)))
        .collect();
    training.push(block(alone, grid(rng.random_range(1.6..3.0), 0.1), 8));
    if rng.random_bool(0.3) {
        training.shuffle(rng);
    }
    if rng.random_bool(0.3) {
        let first = training[0];
        training.push(first);
    }
    let between = |part: f64| grid(least + part * (largest - least), 0.005);
    let held_out = vec![
        block(
            between(rng.random_range(0.3..0.55)),
            grid(rng.random_range(2.5..3.5), 0.1),
            8,
        ),
        block(
            between(rng.random_range(0.75..0.95)),
            grid(rng.random_range(1.2..2.0), 0.1),
            6,
        ),
    ];
    (training, held_out)
}

/// For example 0.1 mm at 0.5, 1, 2, 5 and 10 Hz and 0.15 mm at 3 Hz; held out are an amplitude in between and another frequency.
fn frequencies(rng: &mut impl Rng) -> (Vec<TestBlock>, Vec<TestBlock>) {
    let node = *[0, 1, 1, 1, 2].choose(rng).unwrap_or(&1);
    let (amplitude, other) = (NODES[node], NODES[node + 1]);
    let mut training: Vec<TestBlock> = [(0.5, 4), (1.0, 6), (2.0, 8), (5.0, 12), (10.0, 20)]
        .into_iter()
        .map(|(nominal, cycles)| {
            let frequency = grid(nominal * rng.random_range(0.85..1.15), 0.1);
            block(amplitude, frequency, cycles)
        })
        .collect();
    training.push(block(other, grid(rng.random_range(2.5..3.5), 0.1), 10));
    if rng.random_bool(0.3) {
        training.shuffle(rng);
    }
    let held_out = vec![
        block(
            grid(0.5 * (amplitude + other), 0.005),
            grid(rng.random_range(3.5..4.5), 0.1),
            10,
        ),
        block(amplitude, grid(rng.random_range(6.5..8.0), 0.1), 12),
    ];
    (training, held_out)
}

fn block(amplitude: f64, frequency: f64, cycles: u32) -> TestBlock {
    TestBlock::new(amplitude, frequency, cycles)
}

fn grid(value: f64, step: f64) -> f64 {
    // Also rounded to decimals, so that 0.1 is 0.1.
    ((value / step).round() * step * 1e6).round() / 1e6
}
