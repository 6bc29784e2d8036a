//! Expected force of a programme or a motion, to choose a load cell.

use std::f64::consts::TAU;

use mesh_damper::sine::Programme;

use crate::drive::Motion;
use crate::specimen::DamperForce;

/// Steps per cycle.
const STEPS: u32 = 1000;

/// Peak and RMS of a force, kN.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Expected {
    pub(super) peak: f64,
    pub(super) rms: f64,
}

/// The largest over the programme's blocks. A copy of the specimen is moved through two cycles of each block, as a sine at the
/// block's first frequency, and the second cycle counts.
pub(super) fn expected<S: DamperForce + Clone, const B: usize>(
    specimen: &S,
    programme: &Programme<B>,
) -> Expected {
    let mut largest = Expected::default();
    for block in programme.blocks() {
        let mut copy = specimen.clone();
        let w = TAU * block.from();
        let dt = 1.0 / (block.from() * f64::from(STEPS));
        let mut square = 0.0;
        for step in 0..2 * STEPS {
            let time = dt * f64::from(step);
            let (sin, cos) = (w * time).sin_cos();
            let a = block.amplitude();
            let force = copy.force(time, a * sin, a * w * cos, -a * w * w * sin, dt);
            if step >= STEPS {
                square += force * force;
                largest.peak = largest.peak.max(force.abs());
            }
        }
        largest.rms = largest.rms.max((square / f64::from(STEPS)).sqrt());
    }
    largest
}

/// The same along a motion, through which a copy of the specimen is moved. The RMS is that of the second with the largest RMS, as
/// for a programme it is that of the largest block: a load cell does not have less noise because the motion rests for long.
pub(super) fn expected_along<S: DamperForce + Clone>(specimen: &S, motion: &Motion) -> Expected {
    let mut copy = specimen.clone();
    let step = motion.grid().step();
    let count = (motion.duration() / step).round() as usize + 1;
    let mut expected = Expected::default();
    let mut squares = Vec::with_capacity(count);
    for index in 0..count {
        let time = step * index as f64;
        let at = motion.at(time);
        let force = copy.force(time, at.displacement, at.velocity, at.acceleration, step);
        squares.push(force * force);
        expected.peak = expected.peak.max(force.abs());
    }
    let second = ((1.0 / step).round() as usize).clamp(1, count);
    for some in squares.chunks_exact(second) {
        let mean = some.iter().sum::<f64>() / second as f64;
        expected.rms = expected.rms.max(mean.sqrt());
    }
    expected
}
