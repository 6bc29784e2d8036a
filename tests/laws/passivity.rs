//! Which laws supply more energy in a closed cycle than they absorb, and that the check finds these and no others.

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

/// The smallest value of this parameter for which the effect is passive, whatever its other parameters, as its source file states: 0
/// for a spring that slips, yields or fades, and for a dashpot.
fn least(description: &Description, parameter: usize) -> f64 {
    let parameter = &description.parameters[parameter];
    let low = parameter.range[0];
    match parameter.name {
        "stiffness" if description.name != "drift" => low.max(0.0),
        "c1" | "viscosity" => 0.0,
        _ => low,
    }
}

/// The value at the fraction `part` of the range from `low` to `high`, on a logarithmic scale on either side of 0.
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

/// An effect that is passive by construction. Its parameters are within a factor of 30 of the typical ones, or anywhere in their
/// ranges if `wide`.
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
        // Less than half of either force is lost from −60 °C to 200 °C.
        "temperature" => {
            let away = (values[1] + 60.0).abs().max((values[1] - 200.0).abs());
            values[0] = (values[0] / away).clamp(-0.4 / away, 0.4 / away);
            values[2] = (values[2] / away).clamp(-0.4 / away, 0.4 / away);
        }
        "control_input" => values[6] = (4.0 * parts[0]).floor().min(3.0),
        "gap" => values[1] = f64::from(parts[0] < 0.5),
        // Factors on the law's damping add up: together with a temperature that takes 0.4 of it, a drift may take half.
        "drift" => {
            for change in &mut values[2..] {
                *change = change.max(-0.5);
            }
        }
        _ => {}
    }
    Effect::from_parameters(description.number, &values, tick).ok()
}

/// At least 64 ticks in the fastest cycle of `range`: with fewer, the effects' own steps are as coarse as the loop.
fn tick_rate(range: &OperatingRange<f32>, times: f64) -> f64 {
    let [[low, high], [_, speed]] = [range.displacement(), range.velocity()];
    let fastest = f64::from(speed) / (TAU * 0.5 * f64::from(high - low));
    (10f64.powf(times) * 64.0 * fastest).clamp(10.0, 1e6)
}

/// A range of half a µm to 50 mm and 0.05 to 200 Hz, about any centre within the amplitude.
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

    /// Each effect alone, so that no other force hides the energy that it supplies.
    #[test]
    fn an_effect_that_is_passive_by_construction_passes(
        parts in prop::collection::vec(0.0..1.0f64, 12),
        wide: bool,
        range in range(),
        times in 0.0..3.0f64,
    ) {
        for description in DESCRIPTIONS {
            // If it stiffens much, its step of second order supplies some energy at a hundred ticks a cycle.
            let times = match description.name {
                "hardening_friction" => times.max(2.0),
                _ => times,
            };
            let rate = tick_rate(&range, times);
            let Some(effect) = effect(description, &parts, wide, 1.0 / rate) else {
                continue;
            };
            // An effect that scales the law's forces needs a law with forces.
            for law in [nothing(), mesh(), Law::new(1.0, 0.0, 0.0, 0.0).unwrap()] {
                let law = AugmentedLaw::<f32, 1>::new(law).with(effect).unwrap();
                let checked = Passivity::new(Some(&range), rate as f32).check(&FastLaw::new(law));
                prop_assert_eq!(checked, Ok(()), "{} {:?}", description.name, effect);
            }
        }
    }

    /// Several effects together with any law.
    #[test]
    fn a_law_of_passive_parts_passes(
        law in law(),
        chosen in prop::collection::btree_set(0..DESCRIPTIONS.len(), 0..=EFFECTS),
        parts in prop::collection::vec(0.0..1.0f64, 12),
        range in range(),
        times in 0.0..3.0f64,
    ) {
        let rate = tick_rate(&range, times);
        let effects = chosen
            .iter()
            .filter_map(|place| effect(&DESCRIPTIONS[*place], &parts, false, 1.0 / rate));
        let law = AugmentedLaw::<f32, EFFECTS>::new(law);
        let law = effects.clone().try_fold(law, AugmentedLaw::with).unwrap();
        let checked = Passivity::new(Some(&range), rate as f32).check(&FastLaw::new(law));
        prop_assert_eq!(checked, Ok(()), "{:?}", effects.collect::<Vec<_>>());
    }
}

/// −c1·v together with c·|v|^α·sgn v: for a sine, 4·A·c·(Aω)^α·∫₀^(π/2) cos^(1+α) against π·A·c1·Aω. The check reports the motion at
/// which the sum falls below 0.
#[test]
fn a_dashpot_below_0_is_found_where_it_outweighs_the_friction() {
    let dashpot = |c1: f32| [Effect::Viscous(Viscous::new(c1).unwrap())];
    assert_eq!(checked(mesh(), &dashpot(0.5)), Ok(()));
    let active = checked(mesh(), &dashpot(-0.5)).unwrap_err();
    assert_eq!(active.amplitude, 0.3);
    assert!((active.frequency - 20.0).abs() < 1e-3, "{active}");
    // ∫ cos^1.2 from 0 to π/2 by the midpoint rule.
    let steps = 1000;
    let power: f64 = (0..steps)
        .map(|n| {
            ((f64::from(n) + 0.5) * TAU / 4.0 / f64::from(steps))
                .cos()
                .powf(1.2)
        })
        .sum::<f64>()
        * TAU
        / 4.0
        / f64::from(steps);
    let speed = 0.3 * TAU * 20.0;
    let balance = 4.0 * 0.3 * speed.powf(0.2) * power / (TAU / 2.0 * speed);
    for (part, passes) in [(0.97, true), (1.03, false)] {
        let checked = checked(mesh(), &dashpot((-part * balance) as f32));
        assert_eq!(checked.is_ok(), passes, "{part}");
    }
    // Without friction it is active everywhere, for any negative value.
    for c1 in [-1e-6, -1e3] {
        assert!(checked(nothing(), &dashpot(c1)).is_err(), "{c1}");
    }
}

#[test]
fn friction_and_branches_below_0_are_refused() {
    let effects = [
        Effect::StickSlip(StickSlip::new(&[(1.0, 0.02), (-2.0, 0.02)]).unwrap()),
        Effect::Relaxation(Relaxation::new(&[(-1.0, 0.05)], TICK as f32).unwrap()),
        Effect::Yielding(Yielding::new(-1.0, 0.04, 0.3, 0.02, TICK as f32).unwrap()),
    ];
    let elastic = Law::new(1.6, 20.0, 0.0, 0.2).unwrap();
    for effect in effects {
        assert!(checked(elastic, &[effect]).is_err(), "{effect:?}");
    }
}

/// A branch of −k with a time of 0.05 s supplies π·k·A²·ωτ/(1 + (ωτ)²) a cycle, with a maximum at 3.2 Hz. There, the ticks for which
/// it was made would be a hundredth of the interval between a cycle's points: the check requests the effect for longer ticks.
#[test]
fn memory_passes_as_the_motion_says() {
    let branch = |k: f32| {
        [Effect::Relaxation(
            Relaxation::new(&[(k, 0.05)], TICK as f32).unwrap(),
        )]
    };
    // A dashpot absorbs π·c1·ω·A²: as much as a branch of k at c1 = k·τ/(1 + (ωτ)²).
    let omega = TAU * 20.0 * 0.158;
    let balance = 0.05 / (1.0 + (omega * 0.05f64).powi(2));
    let with = |part: f64| {
        let dashpot = Effect::Viscous(Viscous::new((part * balance) as f32).unwrap());
        let slow = OperatingRange::new(
            [-0.3, 0.3],
            [-1.0, 1.0].map(|side| side * (0.3 * omega) as f32),
        );
        let law = AugmentedLaw::<f32, 2>::new(nothing()).with(branch(-1.0)[0]);
        let law = FastLaw::new(law.and_then(|law| law.with(dashpot)).unwrap());
        Passivity::new(Some(&slow.unwrap()), TICK_RATE).check(&law)
    };
    // At a tenth of the frequency the branch supplies nearly as much as c1 = k·τ.
    let slowest = (1.0 + (omega * 0.05f64).powi(2)) / (1.0 + (0.025 * omega * 0.05f64).powi(2));
    assert_eq!(with(1.05 * slowest), Ok(()));
    let active = with(0.95 * slowest).unwrap_err();
    assert!(
        (f64::from(active.frequency) * TAU / omega - 0.025).abs() < 1e-3,
        "{active}"
    );
    let active = with(0.95).unwrap_err();
    assert!(
        (f64::from(active.frequency) * TAU / omega - 1.0).abs() < 1e-3,
        "{active}"
    );
}

/// The fraction 1 + (T0 − T)·β_damping of the law's damping remains. With T0 = 120 °C it is 0 at T = 20 °C for −0.01, at the coldest
/// of −60 °C for −1/180, and at the hottest of 200 °C for 1/80.
#[test]
fn damping_that_temperature_turns_round_is_refused() {
    for (beta_damping, passes) in [
        (0.012, true),
        (0.013, false),
        (-0.0055, true),
        (-0.0056, false),
        (-0.02, false),
    ] {
        let temperature =
            Temperature::new(0.0, 120.0).and_then(|both| both.with_damping(beta_damping));
        let effects = [
            Effect::Temperature(temperature.unwrap()),
            Effect::Directional(Directional::new(0.5).unwrap()),
        ];
        assert_eq!(checked(mesh(), &effects).is_ok(), passes, "{beta_damping}");
    }
}

/// The check also covers a law after all cycles, and without its control input.
#[test]
fn both_states_of_a_law_are_looked_at() {
    let weak = Effect::Viscous(Viscous::new(-0.01).unwrap());
    let worn = |change: f32| {
        let drift = Drift::new(0.0, 100.0).and_then(|drift| drift.with_forces(0.0, change));
        checked(mesh(), &[weak, Effect::Drift(drift.unwrap())])
    };
    assert_eq!(worn(0.0), Ok(()));
    assert!(worn(-0.9).is_err());
    let branch = || Yielding::new(1.0, 0.1, 1.0, 0.0, TICK as f32).unwrap();
    let controlled = |viscosity: f32| {
        let effect = ControlInput::new(2, branch(), viscosity).unwrap();
        checked(nothing(), &[weak, Effect::ControlInput(effect)])
    };
    // With an input it is passive; without one, only the dashpot acts.
    assert!(controlled(1.0).is_err());
    let effect = ControlInput::new(2, branch(), -1.0).unwrap();
    assert!(checked(mesh(), &[Effect::ControlInput(effect)]).is_err());
}

/// By themselves a tone drives the motion, and a delayed force returns more energy than was stored.
#[test]
fn what_supplies_energy_by_its_description_is_left_out() {
    let elastic = Law::new(1.6, 20.0, 0.0, 0.2).unwrap();
    let effects = [
        Effect::Periodic(Periodic::new(&[(3.0, 50.0, 0.3)], TICK).unwrap()),
        Effect::Delay(Delay::new(0.0012, TICK as f32).unwrap()),
        Effect::ForceFilter(ForceFilter::new(200.0, TICK as f32).unwrap()),
    ];
    for effect in effects {
        assert!(effect.description().supplies_energy);
        for law in [elastic, mesh()] {
            assert_eq!(checked(law, &[effect]), Ok(()), "{effect:?}");
        }
        // They hide no other active effect.
        let weak = Effect::Viscous(Viscous::new(-0.5).unwrap());
        assert!(checked(mesh(), &[effect, weak]).is_err());
    }
    let others = DESCRIPTIONS.iter().filter(|each| each.supplies_energy);
    assert_eq!(others.count(), effects.len());
}

/// A loop of one sign beyond a slip: the absorbed energy is positive if the cells rise with the direction, and negative otherwise.
#[test]
fn a_residual_table_may_supply_energy() {
    let table = |sign: i16, memory: Option<Memory<f32>>| {
        let cells: Vec<i16> = (0..CELLS)
            .map(|cell| if cell < CELLS / 2 { sign } else { -sign })
            .collect();
        let parts = ResidualTableParts {
            reach: 0.3,
            speed: 40.0,
            unit: 0.1,
            cells: &cells,
            memory: memory.map(|memory| (memory, [-0.1, 0.1])),
        };
        let table = ResidualTable::new(&parts, TICK as f32).unwrap();
        let law = AugmentedLaw::<f32, 1>::new(nothing()).with_residual_table(table);
        Passivity::new(None, TICK_RATE).check(&FastLaw::new(law.unwrap()))
    };
    for memory in [
        None,
        Some(Memory::Slip { limit: 0.02 }),
        Some(Memory::Lag { time: 0.1 }),
    ] {
        let [forward, backward] = [1, -1].map(|sign| table(sign, memory).is_ok());
        assert_ne!(forward, backward, "{memory:?}");
    }
}

/// A slice is one force, so this is the number of ticks of a load in slices.
#[test]
fn it_takes_a_tenth_of_a_second_at_10_khz() {
    let all = AugmentedLaw::<f32, 1>::new(mesh());
    let drift = Effect::Drift(Drift::new(0.1, 10.0).unwrap());
    for (law, most) in [(all.clone(), 600), (all.with(drift).unwrap(), 1200)] {
        let law = FastLaw::new(law);
        let mut check = Passivity::new(None, TICK_RATE);
        let slices = (1..).find(|_| check.step(&law).is_some()).unwrap();
        assert!(slices > 300 && slices <= most, "{slices}");
        assert_eq!(check.step(&law), Some(Ok(())));
        println!("{slices} slices");
    }
}
