//! Effects of size one, to be scaled: the hidden effects before their size is known, each a row.

use std::f64::consts::TAU;

use mesh_damper_reference::protocol::TestBlock;
use mesh_damper_rig::specimen::{HiddenEffect, Schedule, SlipShape, Unlisted};
use rand::{Rng, RngExt};
use rand_chacha::ChaCha8Rng;

use super::programme::TestShape;

/// Version of the draw. An effect that is added to the listed ones changes what a seed hides. It makes a new version, so that a
/// figure that was measured with an older one stays what it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Version(u32);

impl Version {
    /// The newest one.
    pub const NEWEST: Self = Self(LISTED.len() as u32);

    /// The version with this number, 1 for the first; `None` if there is none.
    pub fn new(number: u32) -> Option<Self> {
        (1..=Self::NEWEST.0)
            .contains(&number)
            .then_some(Self(number))
    }

    /// Its number.
    pub fn number(self) -> u32 {
        self.0
    }

    /// The listed effects that it may hide, each equally likely.
    fn rows(self) -> impl Iterator<Item = (bool, &'static Row)> {
        let versions = LISTED.iter().take(self.0 as usize).enumerate();
        versions.flat_map(|(version, rows)| rows.iter().map(move |row| (version == 0, row)))
    }

    /// The number of them.
    pub fn listed(self) -> usize {
        self.rows().count()
    }

    /// Numbers of those of them that any motion shows.
    pub fn in_any_motion(self) -> Vec<usize> {
        let rows = self.rows().enumerate();
        let shown = rows.filter(|(_, (_, row))| row.is_in_any_motion);
        shown.map(|(which, _)| which).collect()
    }

    /// Whether it may hide a force that a control input sets, and thus record an input on which nothing depends.
    pub fn has_control_input(self) -> bool {
        self.0 >= 3
    }

    /// Listed effect number `which`, for a test whose largest amplitude is `largest` mm.
    pub fn effect(self, which: usize, largest: f64, rng: &mut ChaCha8Rng) -> Option<Unsized> {
        let (is_first, row) = self.rows().nth(which)?;
        let mut dice = Dice::new(largest, rng);
        if is_first {
            dice.toss();
            dice.slip_limit = dice.part(0.1, 0.4);
        }
        Some(row.cast(&mut dice))
    }
}

/// Unlisted effect number `which`, counted around, for a test whose largest amplitude is `largest` mm.
pub fn unlisted(which: usize, largest: f64, rng: &mut ChaCha8Rng) -> Unsized {
    let mut dice = Dice::new(largest, rng);
    dice.toss();
    UNLISTED[which % UNLISTED.len()].cast(&mut dice)
}

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

/// What a row draws from.
struct Dice<'r> {
    /// The largest amplitude, mm.
    largest: f64,
    /// The last sign that was tossed; 1 before.
    sign: f64,
    /// mm; drawn for the effects of the first version.
    slip_limit: f64,
    rng: &'r mut ChaCha8Rng,
}

impl<'r> Dice<'r> {
    fn new(largest: f64, rng: &'r mut ChaCha8Rng) -> Self {
        Self {
            largest,
            sign: 1.0,
            slip_limit: 0.0,
            rng,
        }
    }

    fn toss(&mut self) -> f64 {
        self.sign = if self.rng.random::<bool>() { 1.0 } else { -1.0 };
        self.sign
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.rng.random_range(low..high)
    }

    /// Between these parts of the largest amplitude, mm.
    fn part(&mut self, low: f64, high: f64) -> f64 {
        self.largest * self.between(low, high)
    }

    fn log(&mut self, low: f64, high: f64) -> f64 {
        log_uniform(low, high, self.rng)
    }

    fn friction(&self, shape: SlipShape) -> HiddenEffect {
        HiddenEffect::StickSlip {
            stiffness: 1.0,
            slip_limit: self.slip_limit,
            shape,
        }
    }

    /// Force, rate and viscosity of a dashpot behind a spring of stiffness 1. It yields between a tenth and a half of the largest
    /// amplitude, at a rate that a test of some Hz exceeds, and its viscosity adds up to about as much again.
    fn dashpot(&mut self) -> [f64; 3] {
        let force = self.part(0.1, 0.4);
        let rate = self.largest * self.log(3.0, 20.0);
        [force, rate, force / rate * self.log(0.02, 0.3)]
    }
}

/// An effect of a seed.
struct Row {
    shapes: &'static [TestShape],
    is_in_any_motion: bool,
    /// Range of its size, for a largest amplitude in mm.
    factors: fn(f64) -> (f64, f64),
    effect: fn(&mut Dice) -> HiddenEffect,
}

impl Row {
    fn cast(&self, dice: &mut Dice) -> Unsized {
        Unsized {
            effect: (self.effect)(dice),
            factors: (self.factors)(dice.largest),
            shapes: self.shapes,
        }
    }

    /// For an effect that needs a long test or several amplitudes.
    const fn not_in_any_motion(self) -> Self {
        Self {
            is_in_any_motion: false,
            ..self
        }
    }

    const fn within(self, factors: fn(f64) -> (f64, f64)) -> Self {
        Self { factors, ..self }
    }
}

/// An effect of any size.
const fn row(shapes: &'static [TestShape], effect: fn(&mut Dice) -> HiddenEffect) -> Row {
    Row {
        shapes,
        is_in_any_motion: true,
        factors: |_| (1e-6, 1e6),
        effect,
    }
}

use HiddenEffect as E;
use TestShape::{Amplitudes, Frequencies, Long, Single};
use Unlisted as U;

const ANY: &[TestShape] = &[Amplitudes, Frequencies, Amplitudes];
const FREQUENCIES: &[TestShape] = &[Frequencies];
const AMPLITUDES: &[TestShape] = &[Amplitudes];
const LONG: &[TestShape] = &[Long];
const ALL: &[TestShape] = &[Amplitudes, Frequencies, Amplitudes, Long, Single];
const WITH_LONG: &[TestShape] = &[Amplitudes, Frequencies, Long];

/// Sliders of an Iwan element.
const SLIDERS: usize = 12;

/// Listed effects that each version of the draw adds: first by the shapes that a family may have, then a dashpot that yields, then
/// effects of real dampers.
#[rustfmt::skip]
const LISTED: [&[Row]; 3] = [
    &[
        row(ALL, |d| E::Offset { force: d.sign }),
        row(ALL, |d| E::Asymmetry { k2: d.sign }),
        row(AMPLITUDES, |_| E::Hardening { k5: 1.0 }),
        row(AMPLITUDES, |d| E::Stop { stiffness: 1.0, gap: d.sign * d.part(0.45, 0.9) }),
        row(AMPLITUDES, |_| E::Gap { half_width: 0.01, loose: false }).within(|y| (0.3, 0.5 * y / 0.01)).not_in_any_motion(),
        row(AMPLITUDES, |_| E::Gap { half_width: 0.01, loose: true }).within(|y| (0.3, 0.5 * y / 0.01)).not_in_any_motion(),
        row(ANY, |d| d.friction(SlipShape::Sharp)),
        row(ANY, |d| d.friction(SlipShape::Sharp)),
        row(ANY, |d| d.friction(SlipShape::Spread { sliders: SLIDERS })),
        row(ANY, |d| { let exponent = d.between(1.0, 4.0); d.friction(SlipShape::Smooth { exponent }) }),
        row(FREQUENCIES, |_| E::Viscous { c: 1.0 }),
        row(FREQUENCIES, |d| E::Relaxation { stiffness: 1.0, time: d.log(0.01, 0.15) }),
        row(FREQUENCIES, |_| E::Inertia { mass: 1.0 }).within(|_| (1.0, 500.0)),
        row(FREQUENCIES, |_| E::Delay { time: 1e-3 }).within(|_| (0.5, 8.0)),
        row(ANY, |_| E::Compliance { compliance: 0.01 }).within(|_| (0.3, 100.0)),
        row(LONG, |d| E::Drift { stiffness: d.sign, cycles: d.between(10.0, 40.0) }).not_in_any_motion(),
        row(LONG, |d| E::Temperature { beta: 1.0, rise: d.between(15.0, 40.0), time: d.between(8.0, 40.0) })
            .within(|_| (1e-5, 0.015)).not_in_any_motion(),
        row(WITH_LONG, |d| E::Periodic { force: 1.0, frequency: d.between(7.0, 80.0), phase: d.between(0.0, TAU) }),
    ],
    &[
        row(FREQUENCIES, |d| { let [force, rate, c] = d.dashpot(); E::Yielding { stiffness: 1.0, force, rate, c } }),
    ],
    &[
        // A current of up to an ampere that is changed now and then. At one ampere the branch is one that yields.
        row(WITH_LONG, |d| {
            let [force, rate, c] = d.dashpot();
            E::ControlInput { stiffness: 1.0, force, rate, c, lag: d.log(0.02, 0.2), schedule: schedule(d.rng) }
        }),
        row(ANY, |d| E::Directional { difference: 0.1 * d.toss() }).within(|_| (1e-3, 8.0)),
        row(AMPLITUDES, |d| E::Backlash { stiffness: 1.0, slip_limit: d.part(0.05, 0.2), slack: d.part(0.2, 0.6) }),
        row(AMPLITUDES, |d| E::Degradation { stiffness: 1.0, softening: d.part(0.2, 1.0) }),
    ],
];

#[rustfmt::skip]
const UNLISTED: [Row; 14] = [
    row(ANY, |_| E::Unlisted(U::LoadFriction { mu: 1.0 })),
    row(ANY, |d| E::Unlisted(U::VelocityWeakening { force: 1.0, velocity: d.log(0.2, 2.0) })),
    row(ANY, |d| E::Unlisted(U::CrossLinear { a: d.sign })),
    row(ANY, |_| E::Unlisted(U::CrossSquare { a: 1.0 })),
    row(WITH_LONG, |d| E::Unlisted(U::Creep { force: d.sign, time: d.log(0.5, 10.0) })),
    row(AMPLITUDES, |d| E::Unlisted(U::Mullins { stiffness: 1.0, stretch: d.part(0.3, 0.8) })),
    row(ANY, |_| E::Unlisted(U::QuadraticDrag { c: 1.0 })),
    row(ANY, |_| E::Unlisted(U::OneWayDamping { c: 1.0 })),
    row(ANY, |_| E::Unlisted(U::OneSidedDamping { c: 1.0 })),
    row(FREQUENCIES, |d| E::Unlisted(U::Fractional { stiffness: 1.0, order: d.between(0.2, 0.6) })),
    row(FREQUENCIES, |_| E::Unlisted(U::FrequencyStiffness { stiffness: 1.0 })),
    row(AMPLITUDES, |d| E::Unlisted(U::PlaceFriction { force: 1.0, place: d.sign * d.part(0.2, 0.5), width: d.part(0.1, 0.3) })),
    row(WITH_LONG, |d| E::Unlisted(U::RandomWalk { force: 1.0, seed: d.rng.random() })),
    row(FREQUENCIES, |d| E::Unlisted(U::Resonance { mass: 1.0, frequency: d.between(11.0, 40.0), damping: d.between(0.02, 0.1) }))
        .within(|_| (0.1, 100.0)),
];

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

/// The largest amplitude of `blocks`, mm.
pub fn largest_amplitude(blocks: &[TestBlock]) -> f64 {
    blocks.iter().fold(0.0, |x, block| x.max(block.amplitude))
}

/// Evenly distributed over the logarithm between `low` and `high`.
pub fn log_uniform(low: f64, high: f64, rng: &mut impl Rng) -> f64 {
    rng.random_range(low.ln()..high.ln()).exp()
}
