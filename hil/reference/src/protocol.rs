//! Tests as blocks of sines, their ideal motion in closed form, and the standard test for a drawn specimen.
//!
//! It is in the same crate as the paper's equations because it needs nothing else. The simulated rig moves specimens by it, and a
//! trace uses it to plan the test that would distinguish candidates; neither has to know the other.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

/// Whole cycles of a sine that starts rising through 0.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TestBlock {
    /// Amplitude, mm.
    pub amplitude: f64,
    /// Frequency, Hz.
    pub frequency: f64,
    /// Number of cycles.
    pub cycles: u32,
}

impl TestBlock {
    /// `amplitude` in mm, `frequency` in Hz.
    pub const fn new(amplitude: f64, frequency: f64, cycles: u32) -> Self {
        Self {
            amplitude,
            frequency,
            cycles,
        }
    }
}

/// A test of 22 s that distinguishes effects.
///
/// Varying amplitude and frequency independently separates rate-dependent effects from rate-independent ones. Every amplitude but
/// one returns later in the test, so that a change with time cannot look like a dependence on amplitude.
pub const PROTOCOL: [TestBlock; 8] = [
    TestBlock::new(0.10, 1.0, 4),
    TestBlock::new(0.20, 5.0, 8),
    TestBlock::new(0.05, 1.0, 4),
    TestBlock::new(0.15, 2.0, 8),
    TestBlock::new(0.10, 10.0, 12),
    TestBlock::new(0.20, 1.0, 4),
    TestBlock::new(0.05, 5.0, 8),
    TestBlock::new(0.10, 5.0, 8),
];

/// One instant of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionSample {
    /// Time, s.
    pub time: f64,
    /// Displacement, mm.
    pub displacement: f64,
    /// Velocity, mm/s.
    pub velocity: f64,
    /// Acceleration, mm/s².
    pub acceleration: f64,
}

/// The ideal motion of `blocks`, sampled at `rate` Hz.
///
/// Over the first half cycle of a block the amplitude changes from the previous block's (0 at first) to its own as 3s² − 2s³. The
/// displacement is continuous; the velocity jumps where the frequency changes.
pub fn motion(blocks: &[TestBlock], rate: f64) -> Vec<MotionSample> {
    let mut all = Vec::new();
    let mut start = 0.0;
    let mut previous = 0.0;
    for block in blocks {
        let end = start + f64::from(block.cycles) / block.frequency;
        let change = block.amplitude - previous;
        let omega = TAU * block.frequency;
        while (all.len() as f64) / rate < end - 0.5 / rate {
            let time = all.len() as f64 / rate;
            let slope = 2.0 * block.frequency;
            let s = (time - start) * slope;
            let (amplitude, rising, bending) = if s < 1.0 {
                (
                    previous + change * s * s * (3.0 - 2.0 * s),
                    change * slope * 6.0 * s * (1.0 - s),
                    change * slope * slope * (6.0 - 12.0 * s),
                )
            } else {
                (block.amplitude, 0.0, 0.0)
            };
            let (sin, cos) = (omega * (time - start)).sin_cos();
            all.push(MotionSample {
                time,
                displacement: amplitude * sin,
                velocity: amplitude * omega * cos + rising * sin,
                acceleration: (bending - amplitude * omega * omega) * sin
                    + 2.0 * rising * omega * cos,
            });
        }
        start = end;
        previous = block.amplitude;
    }
    all
}
