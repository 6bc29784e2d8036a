//! An effect that is converted to ticks twice as long equals the one that its constructor creates for these ticks.

use mesh_damper::effects::description::Description;
use mesh_damper::effects::{ControlInput, Equations, LawForce, Motion, Relaxation, Yielding};
use proptest::prelude::*;

/// s
const TICK: f64 = 1e-4;

/// Parameters from a hundredth to a hundred times the typical ones.
fn parameters(description: &Description, parts: &[f64]) -> Vec<f64> {
    let pairs = description.typical.iter().zip(parts).enumerate();
    let value = |(place, (typical, part)): (usize, (&f64, &f64))| {
        let parameter = &description.parameters[place % description.parameters.len()];
        let [low, high] = parameter.range;
        match parameter.name {
            "input" => 0.0,
            _ => (typical * 1e4f64.powf(part - 0.5)).clamp(low, high),
        }
    };
    pairs.map(value).collect()
}

/// Its forces along a sine of `ticks` a cycle, over four cycles.
fn forces<E: Equations<f32>>(effect: &E, amplitude: f64, ticks: u32, tick: f64) -> Vec<f32> {
    let mut state = E::AT_REST;
    let turn = std::f64::consts::TAU / f64::from(ticks);
    let force = |n: u32| {
        let (sin, cos) = (turn * f64::from(n)).sin_cos();
        let motion = Motion {
            displacement: (amplitude * sin) as f32,
            velocity: (amplitude * turn / tick * cos) as f32,
            controls: [1.0; 4],
            ..Motion::default()
        };
        effect.force(&mut state, &motion.clamped(), LawForce::default())
    };
    (0..4 * ticks).map(force).collect()
}

/// Converts `doublings` times, and compares with an effect that was constructed for the long tick. The start value of a search is
/// computed from the previous start value, within a thousandth of the search's own errors. Each step rounds a few times by 2⁻²⁴ of
/// the largest force.
fn holds<E: Equations<f32>>(
    parts: &[f64],
    amplitude: f64,
    ticks: u32,
    doublings: u32,
) -> Result<(), TestCaseError> {
    let parameters = parameters(&E::DESCRIPTION, parts);
    let long = TICK * f64::from(1u32 << doublings);
    let made = E::from_parameters(&parameters, long).unwrap();
    let mut doubled = E::from_parameters(&parameters, TICK).unwrap();
    for _ in 0..doublings {
        doubled = doubled.at_half_rate();
    }
    let [made, doubled] = [made, doubled].map(|effect| forces(&effect, amplitude, ticks, long));
    let largest = made
        .iter()
        .fold(0.0, |most: f32, force| most.max(force.abs()));
    for (made, doubled) in made.iter().zip(&doubled) {
        prop_assert!(
            (made - doubled).abs() <= 2e-5 * largest,
            "{} {parameters:?}: {doubled} is not {made}, of {largest}",
            E::DESCRIPTION.name
        );
    }
    Ok(())
}

proptest! {
    #[test]
    fn an_effect_for_longer_ticks_is_the_one_that_is_made_for_them(
        parts in prop::collection::vec(0.0..1.0f64, 8),
        amplitude in 0.01..1.0f64,
        ticks in 16..64u32,
        doublings in 1..12u32,
    ) {
        holds::<Relaxation<f32>>(&parts, amplitude, ticks, doublings)?;
        holds::<Yielding<f32>>(&parts, amplitude, ticks, doublings)?;
        holds::<ControlInput<f32>>(&parts, amplitude, ticks, doublings)?;
    }
}
