//! Which laws give more energy in a closed cycle than they take, and that the check finds these and no others.

use std::collections::BTreeSet;
use std::f64::consts::TAU;

use mesh_damper::effects::description::Description;
use mesh_damper::effects::residual_table::{CELLS, Memory, ResidualTableParts};
use mesh_damper::effects::{
    AugmentedLaw, ControlInput, DESCRIPTIONS, Delay, Directional, Drift, Effect, ForceFilter,
    Periodic, Relaxation, ResidualTable, StickSlip, Temperature, Viscous, Yielding,
};
use mesh_damper::fast_law::FastLaw;
use mesh_damper::law::Law;
use mesh_damper::operating_range::OperatingRange;
use mesh_damper::passivity::{Active, Passivity};
use proptest::prelude::*;

const TICK_RATE: f32 = 1e4;
const TICK: f64 = 1e-4;
const EFFECTS: usize = 8;

type Checked = Result<(), Active>;

/// Eq 13 with effects, at 10 kHz over the paper's range.
fn checked(law: Law<f32>, effects: &[Effect<f32>]) -> Checked {
    let law = AugmentedLaw::<f32, EFFECTS>::new(law);
    let mut effects = effects.iter();
    let law = effects.try_fold(law, |law, effect| law.with(*effect));
    Passivity::new(None, TICK_RATE).check(&FastLaw::new(law.unwrap()))
}

/// A mesh, in kN and mm.
fn mesh() -> Law<f32> {
    Law::new(1.6, 20.0, 0.3, 0.2).unwrap()
}

fn nothing() -> Law<f32> {
    Law::new(0.0, 0.0, 0.0, 0.0).unwrap()
}

/// Whether an effect of these parameters is passive whatever their value, as its file says; of a spring that slips, yields or fades,
/// and of a dashpot, where it is no less than 0.
fn least(description: &Description, parameter: usize) -> f64 {
    let parameter = &description.parameters[parameter];
    let low = parameter.range[0];
    match parameter.name {
        "stiffness" if description.name != "drift" => low.max(0.0),
        "c1" | "viscosity" => 0.0,
        _ => low,
    }
}

/// `part` of the way from `low` to `high`, by powers of ten to either side of 0.
fn spread(low: f64, high: f64, part: f64) -> f64 {
    let floor = 1e-6_f64.min(high * 1e-3);
    if low > 0.0 {
        return low * (high / low).powf(part);
    }
    let (side, part) = match low < 0.0 {
        true => (part < 0.5, (2.0 * part).rem_euclid(1.0)),
        false => (false, part),
    };
    let most = if side { -low } else { high };
    let value = floor * (most / floor).powf(part);
    if side { -value } else { value }
}

/// An effect that is passive by construction: of parameters about the typical ones, up to 30 times of them either way, or from all of
/// their ranges where `wide`.
fn effect(description: &Description, parts: &[f64], wide: bool, tick: f64) -> Option<Effect<f32>> {
    let count = description.parameters.len();
    let mut values: Vec<f64> = description
        .typical
        .iter()
        .zip(parts.iter().cycle())
        .enumerate()
        .map(|(place, (typical, part))| {
            let parameter = &description.parameters[place % count];
            let (low, high) = (least(description, place % count), parameter.range[1]);
            match wide {
                true => spread(low, high, *part),
                false => (typical * 900_f64.powf(part - 0.5)).clamp(low, high),
            }
        })
        .collect();
    match description.name {
        // Less than all of either force is lost at 20 °C.
        "temperature" => {
            let away = (values[1] - 20.0).abs().max(1.0);
            values[0] = (values[0] / away).clamp(-0.9 / away, 0.9 / away);
            values[2] = (values[2] / away).clamp(-0.9 / away, 0.9 / away);
        }
        "control_input" => values[6] = (4.0 * parts[0]).floor().min(3.0),
        "gap" => values[1] = f64::from(parts[0] < 0.5),
        _ => {}
    }
    Effect::from_parameters(description.number, &values, tick).ok()
}

/// A range of half a µm to 50 mm and 0.05 to 200 Hz, about any middle within it.
fn range() -> impl Strategy<Value = OperatingRange<f32>> {
    (-3.3..1.7f64, -1.3..2.3f64, -1.0..1.0f64).prop_map(|(amplitude, frequency, middle)| {
        let (amplitude, frequency) = (10f64.powf(amplitude), 10f64.powf(frequency));
        let speed = (TAU * amplitude * frequency) as f32;
        let [low, high] = [-1.0, 1.0].map(|side| ((middle + side) * amplitude) as f32);
        OperatingRange::new([low, high], [-speed, speed]).unwrap()
    })
}

fn law() -> impl Strategy<Value = Law<f32>> {
    let sized = || prop_oneof![Just(0.0f32), (-3.0..2.0f32).prop_map(|e| 10f32.powf(e))];
    (-3.0..10.0f32, -50.0..500.0f32, sized(), 0.0..=1.0f32)
        .prop_map(|(k1, k3, c, alpha)| Law::new(k1, k3, c, alpha).unwrap())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    /// Each effect alone, where nothing beside it hides what it gives.
    #[test]
    fn an_effect_that_is_passive_by_construction_passes(
        parts in prop::collection::vec(0.0..1.0f64, 12),
        wide: bool,
        range in range(),
        rate in 2.7..5.0f64,
    ) {
        let rate = 10f64.powf(rate);
        for description in DESCRIPTIONS {
            let Some(effect) = effect(description, &parts, wide, 1.0 / rate) else {
                continue;
            };
            // What scales the law's forces needs some.
            for law in [nothing(), mesh(), Law::new(1.0, 0.0, 0.0, 0.0).unwrap()] {
                let law = AugmentedLaw::<f32, 1>::new(law).with(effect).unwrap();
                let checked = Passivity::new(Some(&range), rate as f32).check(&FastLaw::new(law));
                prop_assert_eq!(checked, Ok(()), "{} {:?}", description.name, effect);
            }
        }
    }

    /// Several of them beside any law.
    #[test]
    fn a_law_of_passive_parts_passes(
        law in law(),
        chosen in prop::collection::btree_set(0..DESCRIPTIONS.len(), 0..=EFFECTS),
        parts in prop::collection::vec(0.0..1.0f64, 12),
        range in range(),
        rate in 2.7..5.0f64,
    ) {
        let rate = 10f64.powf(rate);
        let effects = chosen
            .iter()
            .filter_map(|place| effect(&DESCRIPTIONS[*place], &parts, false, 1.0 / rate));
        let law = AugmentedLaw::<f32, EFFECTS>::new(law);
        let law = effects.clone().try_fold(law, AugmentedLaw::with).unwrap();
        let checked = Passivity::new(Some(&range), rate as f32).check(&FastLaw::new(law));
        prop_assert_eq!(checked, Ok(()), "{:?}", effects.collect::<Vec<_>>());
    }
}
