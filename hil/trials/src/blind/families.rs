//! Effects of size one, to be scaled: the hidden effects before their size is known.

use std::f64::consts::TAU;

use mesh_damper_reference::protocol::TestBlock;
use mesh_damper_rig::specimen::{HiddenEffect, Schedule, SlipShape, Unlisted};
use rand::{Rng, RngExt};

use super::programme::TestShape;

/// Listed effects, by the shapes that a family may have; each is equally likely.
pub const LISTED: usize = 18;
/// Unlisted ones.
pub const UNLISTED: usize = 14;
/// Numbers of listed effects that were added later, each with the first seed of the trial that may draw it: draws below that seed
/// are as they were when their figures were published. The effects are a dashpot that yields, a force set by a control input,
/// damping that differs between the directions, play that travels, and stiffness that is lost.
pub const LATER: [(usize, u64); 5] = [
    (LISTED + UNLISTED, 500),
    (CONTROL_INPUT, FIRST_WITH_CONTROL),
    (LISTED + UNLISTED + 2, FIRST_WITH_CONTROL),
    (LISTED + UNLISTED + 3, FIRST_WITH_CONTROL),
    (LISTED + UNLISTED + 4, FIRST_WITH_CONTROL),
];
/// Number of the force set by a control input.
const CONTROL_INPUT: usize = LISTED + UNLISTED + 1;
/// The first seed of any trial that may draw it, or a test with an input on which nothing depends.
pub const FIRST_WITH_CONTROL: u64 = 2000;

/// Sliders of an Iwan element.
const SLIDERS: usize = 12;

/// An effect to be scaled, with the largest possible factor.
#[derive(Clone, Copy, Debug)]
pub struct Unsized {
    /// With size one, or another initial size.
    pub effect: HiddenEffect,
    /// Range of its size.
    pub factors: (f64, f64),
    /// Shapes of programme in which it is visible; one of them is drawn.
    pub shapes: &'static [TestShape],
}

const ANY: &[TestShape] = &[
    TestShape::Amplitudes,
    TestShape::Frequencies,
    TestShape::Amplitudes,
];
const FREQUENCIES: &[TestShape] = &[TestShape::Frequencies];
const AMPLITUDES: &[TestShape] = &[TestShape::Amplitudes];
const LONG: &[TestShape] = &[TestShape::Long];
const ALL: &[TestShape] = &[
    TestShape::Amplitudes,
    TestShape::Frequencies,
    TestShape::Amplitudes,
    TestShape::Long,
    TestShape::Single,
];
const WITH_LONG: &[TestShape] = &[
    TestShape::Amplitudes,
    TestShape::Frequencies,
    TestShape::Long,
];

/// Effect number `which`, the [`LISTED`] before the [`UNLISTED`] before the [`LATER`], for a test whose largest amplitude is
/// `largest` mm.
pub fn effect(which: usize, largest: f64, rng: &mut impl Rng) -> Unsized {
    match which.checked_sub(LISTED + UNLISTED) {
        None if which < LISTED => listed(which, largest, rng),
        None => unlisted(which - LISTED, largest, rng),
        Some(0) => yielding(largest, rng),
        Some(later) => measured(later, largest, rng),
    }
}

/// Effects of real dampers.
fn measured(which: usize, largest: f64, rng: &mut impl Rng) -> Unsized {
    let any_size = (1e-6, 1e6);
    let (effect, factors, shapes) = match which {
        1 => (control_input(largest, rng), any_size, WITH_LONG),
        2 => {
            let sign = if rng.random::<bool>() { 1.0 } else { -1.0 };
            let difference = 0.1 * sign;
            (HiddenEffect::Directional { difference }, (1e-3, 8.0), ANY)
        }
        3 => (
            HiddenEffect::Backlash {
                stiffness: 1.0,
                slip_limit: largest * rng.random_range(0.05..0.2),
                slack: largest * rng.random_range(0.2..0.6),
            },
            any_size,
            AMPLITUDES,
        ),
        _ => (
            HiddenEffect::Degradation {
                stiffness: 1.0,
                softening: largest * rng.random_range(0.2..1.0),
            },
            any_size,
            AMPLITUDES,
        ),
    };
    Unsized {
        effect,
        factors,
        shapes,
    }
}

/// A current of up to an ampere that is changed now and then. At one ampere the branch has a stiffness of 1 and yields like
/// [`yielding`].
fn control_input(largest: f64, rng: &mut impl Rng) -> HiddenEffect {
    let force = largest * rng.random_range(0.1..0.4);
    let rate = largest * log_uniform(3.0, 20.0, rng);
    HiddenEffect::ControlInput {
        stiffness: 1.0,
        force,
        rate,
        c: force / rate * log_uniform(0.02, 0.3, rng),
        lag: log_uniform(0.02, 0.2, rng),
        schedule: schedule(rng),
    }
}

/// An input on which no force depends.
pub fn idle(schedule: Schedule) -> HiddenEffect {
    HiddenEffect::ControlInput {
        stiffness: 0.0,
        force: 0.0,
        rate: 1.0,
        c: 0.0,
        lag: 0.0,
        schedule,
    }
}

/// A current of up to an ampere, each level held for some cycles.
pub fn schedule(rng: &mut impl Rng) -> Schedule {
    Schedule {
        most: 1.0,
        hold: log_uniform(0.7, 3.0, rng),
        seed: rng.random(),
    }
}

fn listed(which: usize, largest: f64, rng: &mut impl Rng) -> Unsized {
    let sign = if rng.random::<bool>() { 1.0 } else { -1.0 };
    let slip_limit = largest * rng.random_range(0.1..0.4);
    let friction = |shape| HiddenEffect::StickSlip {
        stiffness: 1.0,
        slip_limit,
        shape,
    };
    let any_size = (1e-6, 1e6);
    let (effect, factors, shapes) = match which {
        0 => (HiddenEffect::Offset { force: sign }, any_size, ALL),
        1 => (HiddenEffect::Asymmetry { k2: sign }, any_size, ALL),
        2 => (HiddenEffect::Hardening { k5: 1.0 }, any_size, AMPLITUDES),
        3 => (
            HiddenEffect::Stop {
                stiffness: 1.0,
                gap: sign * largest * rng.random_range(0.45..0.9),
            },
            any_size,
            AMPLITUDES,
        ),
        4 | 5 => (
            HiddenEffect::Gap {
                half_width: 0.01,
                loose: which == 5,
            },
            (0.3, 0.5 * largest / 0.01),
            AMPLITUDES,
        ),
        6 | 7 => (friction(SlipShape::Sharp), any_size, ANY),
        8 => (
            friction(SlipShape::Spread { sliders: SLIDERS }),
            any_size,
            ANY,
        ),
        9 => (
            friction(SlipShape::Smooth {
                exponent: rng.random_range(1.0..4.0),
            }),
            any_size,
            ANY,
        ),
        10 => (HiddenEffect::Viscous { c: 1.0 }, any_size, FREQUENCIES),
        11 => (
            HiddenEffect::Relaxation {
                stiffness: 1.0,
                time: log_uniform(0.01, 0.15, rng),
            },
            any_size,
            FREQUENCIES,
        ),
        12 => (
            HiddenEffect::Inertia { mass: 1.0 },
            (1.0, 500.0),
            FREQUENCIES,
        ),
        13 => (HiddenEffect::Delay { time: 1e-3 }, (0.5, 8.0), FREQUENCIES),
        14 => (
            HiddenEffect::Compliance { compliance: 0.01 },
            (0.3, 100.0),
            ANY,
        ),
        15 => (
            HiddenEffect::Drift {
                stiffness: sign,
                cycles: rng.random_range(10.0..40.0),
            },
            any_size,
            LONG,
        ),
        16 => (
            HiddenEffect::Temperature {
                beta: 1.0,
                rise: rng.random_range(15.0..40.0),
                time: rng.random_range(8.0..40.0),
            },
            (1e-5, 0.015),
            LONG,
        ),
        _ => (
            HiddenEffect::Periodic {
                force: 1.0,
                frequency: rng.random_range(7.0..80.0),
                phase: rng.random_range(0.0..TAU),
            },
            any_size,
            WITH_LONG,
        ),
    };
    Unsized {
        effect,
        factors,
        shapes,
    }
}

/// With a stiffness of 1. It yields between a tenth and a half of the largest amplitude, at a rate that a test of some Hz exceeds,
/// and its viscosity adds up to about as much again.
fn yielding(largest: f64, rng: &mut impl Rng) -> Unsized {
    let force = largest * rng.random_range(0.1..0.4);
    let rate = largest * log_uniform(3.0, 20.0, rng);
    Unsized {
        effect: HiddenEffect::Yielding {
            stiffness: 1.0,
            force,
            rate,
            c: force / rate * log_uniform(0.02, 0.3, rng),
        },
        factors: (1e-6, 1e6),
        shapes: FREQUENCIES,
    }
}

fn unlisted(which: usize, largest: f64, rng: &mut impl Rng) -> Unsized {
    let sign = if rng.random::<bool>() { 1.0 } else { -1.0 };
    let any_size = (1e-6, 1e6);
    let (effect, factors, shapes) = match which {
        0 => (Unlisted::LoadFriction { mu: 1.0 }, any_size, ANY),
        1 => (
            Unlisted::VelocityWeakening {
                force: 1.0,
                velocity: log_uniform(0.2, 2.0, rng),
            },
            any_size,
            ANY,
        ),
        2 => (Unlisted::CrossLinear { a: sign }, any_size, ANY),
        3 => (Unlisted::CrossSquare { a: 1.0 }, any_size, ANY),
        4 => (
            Unlisted::Creep {
                force: sign,
                time: log_uniform(0.5, 10.0, rng),
            },
            any_size,
            WITH_LONG,
        ),
        5 => (
            Unlisted::Mullins {
                stiffness: 1.0,
                stretch: largest * rng.random_range(0.3..0.8),
            },
            any_size,
            AMPLITUDES,
        ),
        6 => (Unlisted::QuadraticDrag { c: 1.0 }, any_size, ANY),
        7 => (Unlisted::OneWayDamping { c: 1.0 }, any_size, ANY),
        8 => (Unlisted::OneSidedDamping { c: 1.0 }, any_size, ANY),
        9 => (
            Unlisted::Fractional {
                stiffness: 1.0,
                order: rng.random_range(0.2..0.6),
            },
            any_size,
            FREQUENCIES,
        ),
        10 => (
            Unlisted::FrequencyStiffness { stiffness: 1.0 },
            any_size,
            FREQUENCIES,
        ),
        11 => (
            Unlisted::PlaceFriction {
                force: 1.0,
                place: sign * largest * rng.random_range(0.2..0.5),
                width: largest * rng.random_range(0.1..0.3),
            },
            any_size,
            AMPLITUDES,
        ),
        12 => (
            Unlisted::RandomWalk {
                force: 1.0,
                seed: rng.random(),
            },
            any_size,
            WITH_LONG,
        ),
        _ => (
            Unlisted::Resonance {
                mass: 1.0,
                frequency: rng.random_range(11.0..40.0),
                damping: rng.random_range(0.02..0.1),
            },
            (0.1, 100.0),
            FREQUENCIES,
        ),
    };
    Unsized {
        effect: HiddenEffect::Unlisted(effect),
        factors,
        shapes,
    }
}

/// The largest amplitude of `blocks`, mm.
pub fn largest_amplitude(blocks: &[TestBlock]) -> f64 {
    blocks.iter().fold(0.0, |x, block| x.max(block.amplitude))
}

/// Evenly distributed over the logarithm between `low` and `high`.
pub fn log_uniform(low: f64, high: f64, rng: &mut impl Rng) -> f64 {
    rng.random_range(low.ln()..high.ln()).exp()
}
