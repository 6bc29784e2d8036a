//! Shared by the tests of this program: motions, their cycles, and the tolerance of sampling.

use core::f64::consts::TAU;

use mesh_damper::cycle::{Cycle, CycleAccumulator};

/// One motion: displacement and velocity in mm and mm/s at a phase in cycles, for a frequency of 1 Hz.
pub type MotionAt = fn(f64) -> (f64, f64);

pub fn sine(phase: f64) -> (f64, f64) {
    let (sin, cos) = (TAU * phase).sin_cos();
    (0.1 * sin, 0.1 * TAU * cos)
}

/// Sine and third harmonic.
pub fn two_harmonics(phase: f64) -> (f64, f64) {
    let (sin, cos) = (TAU * phase).sin_cos();
    let (sin3, cos3) = (3.0 * TAU * phase).sin_cos();
    (0.1 * sin + 0.03 * sin3, TAU * (0.1 * cos + 0.09 * cos3))
}

/// A motion that lags the generator by 40° and has an offset.
pub fn lagging(phase: f64) -> (f64, f64) {
    let (y, v) = sine(phase - 40.0 / 360.0);
    (y + 0.5, v)
}

pub fn u32_phase(cycles: f64) -> u32 {
    (cycles.fract() * 2f64.powi(32)) as u32
}

/// `cycles` whole cycles at `per_cycle` ticks each (not necessarily an integer), from phase 0 on.
pub fn run(
    motion: MotionAt,
    force: impl Fn(f64, f64) -> f64,
    per_cycle: f64,
    cycles: usize,
) -> Vec<Cycle> {
    let mut accumulator = CycleAccumulator::new();
    let ticks = (per_cycle * cycles as f64).ceil() as usize;
    let found: Vec<_> = (0..=ticks)
        .filter_map(|n| {
            let phase = n as f64 / per_cycle;
            let (y, v) = motion(phase);
            update(
                &mut accumulator,
                y as f32,
                force(y, v) as f32,
                u32_phase(phase),
            )
        })
        .collect();
    assert_eq!(found.len(), cycles);
    found
}

/// [`CycleAccumulator::update`] with one force.
pub fn update(
    accumulator: &mut CycleAccumulator<1>,
    displacement: f32,
    force: f32,
    phase: u32,
) -> Option<Cycle> {
    let cycles = accumulator.update(displacement, [force], phase);
    cycles.map(|[cycle]| cycle)
}

pub fn near(is: f32, exact: f64, tolerance: f64, what: &str) {
    assert!(
        (f64::from(is) - exact).abs() <= tolerance,
        "{what}: {is} instead of {exact} ± {tolerance:e}"
    );
}

/// Tolerance for a smooth motion at n ticks a cycle: (2π/n)²/6 of the trapezoids, (π/n)²/2 of the extremes, and (2π/n)²/8 at both
/// ends, where the tick is split. For f32: 6e-8 of rounding in each sample, 2.4e-7 for sixteen terms. The tolerance is twice the sum.
pub fn tolerance(per_cycle: f64) -> f64 {
    let step = TAU / per_cycle;
    2.0 * (step * step * (1.0 / 6.0 + 1.0 / 8.0 + 1.0 / 4.0) + 3e-7)
}
