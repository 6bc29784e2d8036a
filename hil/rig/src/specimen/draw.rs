//! A specimen with an undeclared effect.

use mesh_damper_reference::law::Coefficients;
use mesh_damper_reference::protocol::{PROTOCOL, motion};
use mesh_damper_reference::tables;
use rand::seq::SliceRandom;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::Serialize;

use super::{DamperForce, HiddenEffect, SlipShape, Specimen};

/// Smallest RMS force of a drawn effect relative to the RMS force of eq 13, under [`PROTOCOL`].
pub const SMALLEST_SHARE: f64 = 0.05;
/// Largest RMS force, in the same way.
pub const LARGEST_SHARE: f64 = 0.30;

/// Amplitude of the tables' row that a drawn specimen varies, mm: that of the paper's own tests.
const REFERENCE_AMPLITUDE: f64 = 0.1;
/// Rate at which a share is computed, Hz: 100 points in the shortest period.
const SHARE_RATE: f64 = 1000.0;
/// Mass of fixture and piston above which a machine for these specimens cannot move them at 10 Hz, kg.
const LARGEST_MASS: f64 = 500.0;

/// The effect that [`draw`] hides.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DrawnEffect {
    /// Density, g/cm³.
    pub density: f64,
    /// The effect.
    pub effect: HiddenEffect,
    /// RMS of its force over that of eq 13, under [`PROTOCOL`].
    pub share: f64,
}

/// A specimen and its one hidden effect, the same for the same seed.
///
/// The density is one of the table's five. The coefficients are those of 0.1 mm, each varied by ±15 %. The family is any of the
/// nine, each once among seeds 9n…9n + 8. The size is such that the effect's RMS force is between [`SMALLEST_SHARE`] and
/// [`LARGEST_SHARE`] of the law's under [`PROTOCOL`]. An impossible specimen is drawn again: a stiffness that becomes negative in
/// the protocol's range, or a mass of more than 500 kg.
pub fn draw(seed: u64) -> (Specimen, DrawnEffect) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let family = family(seed);
    loop {
        let density = tables::DENSITIES[rng.random_range(0..tables::DENSITIES.len())];
        let coefficients = varied(tables::interpolate(density, REFERENCE_AMPLITUDE), &mut rng);
        let unit = unit_effect(family, &mut rng);
        let share = rng.random_range(SMALLEST_SHARE..LARGEST_SHARE);
        let effect = unit.scaled(share / force_share(coefficients, unit));
        if possible(coefficients, effect) {
            let drawn = DrawnEffect {
                density,
                effect,
                share,
            };
            return (Specimen::new(coefficients).with(effect), drawn);
        }
    }
}

/// The family's number, 0…8: the nine of a group of nine seeds, each once, in an order drawn for the group.
fn family(seed: u64) -> usize {
    let mut order: [usize; 9] = std::array::from_fn(|i| i);
    order.shuffle(&mut ChaCha8Rng::seed_from_u64(seed / 9));
    order[(seed % 9) as usize]
}

/// RMS force of `effect` relative to the RMS force of eq 13 with `coefficients`, under [`PROTOCOL`].
pub fn force_share(coefficients: Coefficients, effect: HiddenEffect) -> f64 {
    let mut specimen = Specimen::new(coefficients).with(effect);
    let (mut law, mut added) = (0.0, 0.0);
    for m in motion(&PROTOCOL, SHARE_RATE) {
        let total = specimen.force(
            m.time,
            m.displacement,
            m.velocity,
            m.acceleration,
            1.0 / SHARE_RATE,
        );
        let alone = coefficients.force(m.displacement, m.velocity);
        law += alone * alone;
        added += (total - alone).powi(2);
    }
    (added / law).sqrt()
}

/// Each coefficient times 0.85…1.15.
fn varied(nominal: Coefficients, rng: &mut impl Rng) -> Coefficients {
    let mut vary = |value: f64| value * rng.random_range(0.85..1.15);
    Coefficients {
        k1: vary(nominal.k1),
        k3: vary(nominal.k3),
        c: vary(nominal.c),
        alpha: vary(nominal.alpha),
    }
}

/// Family number `family`, 0…8, with size ±1 and its other parameters drawn from a range that the protocol can show.
fn unit_effect(family: usize, rng: &mut impl Rng) -> HiddenEffect {
    let sign = if rng.random::<bool>() { 1.0 } else { -1.0 };
    match family {
        0 => HiddenEffect::Offset { force: sign },
        1 => HiddenEffect::Asymmetry { k2: sign },
        2 => HiddenEffect::Hardening { k5: 1.0 },
        3 => HiddenEffect::StickSlip {
            stiffness: 1.0,
            slip_limit: rng.random_range(0.02..0.05),
            shape: match rng.random_range(0..3) {
                0 => SlipShape::Sharp,
                1 => SlipShape::Smooth {
                    exponent: rng.random_range(1.5..4.0),
                },
                _ => SlipShape::Spread { sliders: 12 },
            },
        },
        4 => HiddenEffect::Viscous { c: 1.0 },
        5 => HiddenEffect::Relaxation {
            stiffness: 1.0,
            time: rng.random_range(0.02..0.08),
        },
        6 => HiddenEffect::Inertia { mass: 1.0 },
        7 => HiddenEffect::Drift {
            stiffness: sign,
            cycles: rng.random_range(8.0..20.0),
        },
        _ => HiddenEffect::Temperature {
            beta: 1.0,
            rise: rng.random_range(20.0..40.0),
            time: rng.random_range(4.0..10.0),
        },
    }
}

/// Whether the elastic force rises with displacement everywhere in the protocol's range, the heat leaves some force, and the mass
/// can be moved.
fn possible(law: Coefficients, effect: HiddenEffect) -> bool {
    let reach = PROTOCOL.iter().fold(0.0_f64, |x, b| x.max(b.amplitude));
    let rises_throughout = |slope: &dyn Fn(f64) -> f64| {
        (-100..=100).all(|i| slope(reach * f64::from(i) / 100.0) > 0.0)
    };
    let law_slope = |y: f64| law.k1 + 3.0 * law.k3 * y * y;
    match effect {
        HiddenEffect::Asymmetry { k2 } => rises_throughout(&|y| law_slope(y) + 2.0 * k2 * y),
        HiddenEffect::Drift { stiffness, .. } => rises_throughout(&|y| law_slope(y) + stiffness),
        HiddenEffect::Inertia { mass } => mass <= LARGEST_MASS,
        HiddenEffect::Temperature { beta, rise, .. } => beta * rise < 0.8,
        _ => true,
    }
}
