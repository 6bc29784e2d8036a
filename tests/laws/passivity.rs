//! A law is refused if a part of it can supply energy, by the name of that part; and a law that is not refused gives out no energy in
//! any drawn motion.

use std::f64::consts::TAU;

use mesh_damper::effects::description::{Description, Energy};
use mesh_damper::effects::residual_table::{CELLS, Memory, ResidualTableParts, part_of_speed};
use mesh_damper::effects::{
    AugmentedLaw, Compliance, DESCRIPTIONS, Directional, Drift, Effect, Gap, Inertia,
    ResidualTable, StickSlip, Temperature, Viscous,
};
use mesh_damper::fast_law::FastLaw;
use mesh_damper::law::Law;
use mesh_damper::operating_range::OperatingRange;
use mesh_damper::passivity::{self, Active, damping_beside_table};
use proptest::prelude::*;

use crate::drawn::{Draw, Drawn, judged};

const TICK: f64 = 1e-4;
const EFFECTS: usize = 8;
/// Energy that counts as none, as a part of the work moved: the trapezoids of 1000 ticks.
const NONE: f64 = -2e-4;

fn with(law: Law<f32>, effects: &[Effect<f32>]) -> AugmentedLaw<f32, EFFECTS> {
    let mut effects = effects.iter().copied();
    effects
        .try_fold(AugmentedLaw::new(law), AugmentedLaw::with)
        .unwrap()
}

/// The effect and the parameter with which eq 13 and these effects are refused.
fn refused(law: Law<f32>, effects: &[Effect<f32>]) -> Option<(&'static str, &'static str)> {
    let checked = passivity::check(&with(law, effects));
    checked.err().map(|active| (active.effect, active.field))
}

/// The smallest value of this parameter with which the effect cannot supply energy.
fn least(description: &Description, parameter: usize) -> f64 {
    let parameter = &description.parameters[parameter];
    match description.energy {
        Energy::Below0(names) if names.contains(&parameter.name) => 0.0,
        _ => parameter.range[0],
    }
}

/// A mesh, in kN and mm.
fn mesh() -> Law<f32> {
    Law::new(1.6, 20.0, 0.3, 0.2).unwrap()
}

fn nothing() -> Law<f32> {
    Law::new(0.0, 0.0, 0.0, 0.0).unwrap()
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
            // Of a change that takes longer, 1 − e^(−n/N) in f32 shows steps within the test, at which a spring's energy changes.
            values[0] = values[0].min(1e3);
            for change in &mut values[2..] {
                *change = change.max(-0.5);
            }
        }
        _ => {}
    }
    Effect::from_parameters(description.number, &values, tick).ok()
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

/// The largest energy that `law` gives out in a few motions within `range`, as a part of the work moved, at 1000 ticks and more of the
/// fastest cycle.
fn given(law: AugmentedLaw<f32, EFFECTS>, range: &OperatingRange<f32>, seed: u64) -> f64 {
    let law = judged(&FastLaw::new(law));
    let mut draw = Draw(seed);
    let ends = range.displacement().map(f64::from);
    let speed = f64::from(range.velocity()[1]);
    (0..3)
        .map(|_| {
            Drawn::new(&mut draw, ends, speed)
                .run(&law, rate(range))
                .energy
        })
        .fold(0.0, f64::min)
}

/// Ticks per second with which the fastest sine of `range` has 1000 ticks, Hz.
fn rate(range: &OperatingRange<f32>) -> f64 {
    let [[low, high], [_, speed]] = [range.displacement(), range.velocity()];
    1000.0 * f64::from(speed) / (TAU * 0.5 * f64::from(high - low))
}

proptest! {
    // All effects in each case.
    #![proptest_config(ProptestConfig { cases: 10, ..ProptestConfig::default() })]

    /// Each effect alone, so that no other force hides the energy that it supplies.
    #[test]
    fn an_effect_that_is_passive_by_its_parameters_gives_no_energy(
        parts in prop::collection::vec(0.0..1.0f64, 12),
        wide: bool,
        range in range(),
        seed: u64,
    ) {
        for description in DESCRIPTIONS {
            let Some(effect) = effect(description, &parts, wide, 1.0 / rate(&range)) else {
                continue;
            };
            // An effect that scales the law's forces needs a law with forces.
            for law in [nothing(), mesh(), Law::new(1.0, 0.0, 0.0, 0.0).unwrap()] {
                prop_assert_eq!(refused(law, &[effect]), None, "{} {:?}", description.name, effect);
                let given = given(with(law, &[effect]), &range, seed);
                prop_assert!(given > NONE, "{} {:?}: {}", description.name, effect, given);
            }
        }
    }

}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    /// Several effects together with any law.
    #[test]
    fn a_law_of_passive_parts_gives_no_energy(
        law in law(),
        chosen in prop::collection::btree_set(0..DESCRIPTIONS.len(), 0..=EFFECTS),
        parts in prop::collection::vec(0.0..1.0f64, 12),
        range in range(),
        seed: u64,
    ) {
        let effects: Vec<Effect<f32>> = chosen
            .iter()
            .filter_map(|place| effect(&DESCRIPTIONS[*place], &parts, false, 1.0 / rate(&range)))
            .collect();
        match refused(law, &effects) {
            None => {
                let given = given(with(law, &effects), &range, seed);
                prop_assert!(given > NONE, "{:?}: {}", effects, given);
            }
            // Each is passive alone.
            Some((by, _)) => prop_assert!(
                ["directional", "temperature", "drift", "compliance"].contains(&by),
                "{}", by
            ),
        }
    }
}

/// The descriptions are right: with a parameter that they name below 0 an effect is refused by that name, and with none of the others.
#[test]
fn each_effect_is_refused_with_the_parameters_that_its_description_names() {
    for description in DESCRIPTIONS {
        for (place, parameter) in description.parameters.iter().enumerate() {
            let mut parameters = description.typical.to_vec();
            for element in 0..parameters.len() / description.parameters.len() {
                let place = place + element * description.parameters.len();
                let typical = parameters[place];
                // Either end, as far as the crate accepts it.
                for value in [parameter.range[0], -typical, -1e-6, parameter.range[1]] {
                    parameters[place] = value;
                    let made = Effect::from_parameters(description.number, &parameters, TICK);
                    let Ok(effect) = made else { continue };
                    let is_named = match description.energy {
                        Energy::Below0(names) => value < 0.0 && names.contains(&parameter.name),
                        _ => false,
                    };
                    let by = is_named.then_some((description.name, parameter.name));
                    // Without damping there is none to scale.
                    assert_eq!(refused(nothing(), &[effect]), by, "{parameter:?} {value}");
                    // Nothing else of the law makes up for it.
                    if description.energy != Energy::ScalesDamping {
                        assert_eq!(refused(mesh(), &[effect]), by, "{parameter:?} {value}");
                    }
                }
                parameters[place] = typical;
            }
        }
    }
}

/// A dashpot below 0 outweighs c·|v|^α from |v|^(1 − α) = c/|c1| on. It is refused though it is passive where it is slow: a rig may
/// command more.
#[test]
fn no_range_makes_a_law_passive() {
    let law = with(mesh(), &[Effect::Viscous(Viscous::new(-0.5).unwrap())]);
    let active = passivity::check(&law).unwrap_err();
    assert_eq!(
        (active.effect, active.field, active.value),
        ("viscous", "c1", -0.5)
    );
    let (slow, fast) = (0.01, 10.0);
    // It is indeed passive in the one, and active in the other.
    for (speed, is_passive) in [(slow, true), (fast, false)] {
        let range = OperatingRange::new([-1e-3, 1e-3], [-speed, speed]).unwrap();
        assert_eq!(given(law.clone(), &range, 1) > NONE, is_passive, "{speed}");
    }
    assert_eq!(
        Active {
            effect: "viscous",
            field: "c1",
            value: -0.5
        }
        .to_string(),
        "with c1 = -0.5, viscous can give more energy than it takes"
    );
}

/// A slider of any size beside it does not make up for one below 0: it may not slip where that does.
#[test]
fn a_slider_below_0_is_refused_beside_a_stronger_one() {
    let sliders = StickSlip::new(&[(5.0, 0.02), (-1e-3, 0.01)]).unwrap();
    assert_eq!(
        refused(mesh(), &[Effect::StickSlip(sliders)]),
        Some(("stick_slip", "stiffness"))
    );
}

/// The fraction 1 + (T0 − T)·β_damping of the law's damping remains. With T0 = 120 °C it is 0 at the coldest of −60 °C for −1/180, and
/// at the hottest of 200 °C for 1/80. A difference of 0.5 between the directions takes half of it, and a drift as much as it says.
#[test]
fn damping_that_is_turned_round_is_refused() {
    let temperature = |beta_damping: f32| {
        let both = Temperature::new(0.0, 120.0).and_then(|both| both.with_damping(beta_damping));
        Effect::Temperature(both.unwrap())
    };
    let directional = Effect::Directional(Directional::new(-0.5).unwrap());
    let drift = |change: f32| {
        let drift = Drift::new(0.7, 12.0).and_then(|drift| drift.with_forces(-0.9, change));
        Effect::Drift(drift.unwrap())
    };
    let by_temperature = Some(("temperature", "beta_damping"));
    for (beta_damping, alone, with_half) in [
        (0.006, None, None),
        (0.0064, None, by_temperature),
        (0.0126, by_temperature, by_temperature),
        (-0.0027, None, None),
        (-0.0028, None, by_temperature),
        (-0.0056, by_temperature, by_temperature),
    ] {
        let temperature = temperature(beta_damping);
        assert_eq!(refused(mesh(), &[temperature]), alone, "{beta_damping}");
        let both = [temperature, directional];
        assert_eq!(refused(mesh(), &both), with_half, "{beta_damping}");
        assert_eq!(refused(nothing(), &both), None, "{beta_damping}");
    }
    for (change, by) in [
        (-0.49, None),
        (-0.51, Some(("drift", "damping_change"))),
        (1e3, None),
    ] {
        assert_eq!(
            refused(mesh(), &[directional, drift(change)]),
            by,
            "{change}"
        );
    }
}

/// A drift that takes all of the damping leaves none, whatever the rounding of its sum in f32.
#[test]
fn a_drift_that_takes_all_damping_is_passive() {
    let mut draw = Draw(1);
    for _ in 0..1000 {
        let elastic = 10f64.powf(draw.between(-6.0, 3.0)) as f32;
        let drift = Drift::new(0.0, 12.0).and_then(|drift| drift.with_forces(elastic, -1.0));
        assert_eq!(refused(mesh(), &[Effect::Drift(drift.unwrap())]), None);
    }
}

/// A mass moves with the sensors. Behind a play it would be fast where nothing holds it, and slow beyond; behind a spring in series,
/// above the frequency at which the two resonate, the specimen's damping would act with the motion.
#[test]
fn a_mass_gives_no_energy_before_a_play_or_a_spring() {
    let gap = |damps_inside| Effect::Gap(Gap::new(0.05, damps_inside).unwrap());
    let range = OperatingRange::new([-0.2, 0.2], [-60.0, 60.0]).unwrap();
    let tick = 1.0 / rate(&range);
    let spring = Effect::Compliance(Compliance::new(0.7, tick as f32).unwrap());
    for mass in [-5e3, -2.0, 0.0, 2.0, 5e3] {
        let inertia = Effect::Inertia(Inertia::new(mass).unwrap());
        assert_eq!(refused(mesh(), &[inertia]), None);
        for stage in [gap(false), gap(true), spring] {
            let effects = [inertia, stage];
            for law in [nothing(), mesh()] {
                assert_eq!(refused(law, &effects), None);
                let each = (0..20).map(|seed| given(with(law, &effects), &range, seed));
                let given = each.fold(0.0, f64::min);
                assert!(given > NONE, "{effects:?}: {given}");
            }
        }
    }
}

/// The kinds of variables of a residual table.
fn memories() -> [Option<Memory<f32>>; 10] {
    [
        None,
        Some(Memory::Place),
        Some(Memory::Sides {
            below: -0.05,
            above: 0.05,
        }),
        Some(Memory::Slip { limit: 0.02 }),
        Some(Memory::Lag { time: 0.1 }),
        Some(Memory::Travel { time: 0.1 }),
        Some(Memory::Largest),
        Some(Memory::Age { time: 0.1 }),
        Some(Memory::Temperature),
        Some(Memory::Frequency { time: 0.1 }),
    ]
}

fn tabled(law: Law<f32>, cells: &[i16], memory: Option<Memory<f32>>) -> AugmentedLaw<f32, EFFECTS> {
    let parts = ResidualTableParts {
        reach: 0.2,
        speed: 6.0,
        unit: 1e-4,
        cells,
        memory: memory.map(|memory| (memory, [-0.1, 0.1])),
    };
    let table = ResidualTable::new(&parts, TICK as f32).unwrap();
    AugmentedLaw::new(law).with_residual_table(table).unwrap()
}

/// A force that depends on the place alone is elastic. One of 20 counts against the motion absorbs energy, and one with it supplies
/// some, as does one at a single place.
#[test]
fn a_residual_table_that_drives_is_refused() {
    let elastic = |cell: usize| (cell % 9) as i16 * 100 - 400;
    let line = |cell: usize| (cell % (CELLS / 2)) as i16 * 3 - 200;
    let against = |cell: usize| if cell < CELLS / 2 { 20 } else { -20 };
    for memory in memories() {
        let is_line = matches!(memory, Some(Memory::Place | Memory::Sides { .. }));
        let shape = |cell: usize| match (is_line, memory) {
            // On either side the speed alone counts, and a cycle may take any of them.
            (true, Some(Memory::Sides { .. })) => 0,
            (true, _) => line(cell),
            (false, _) => elastic(cell),
        };
        let made = |factor: i16| -> Vec<i16> {
            (0..CELLS)
                .map(|cell| shape(cell) + factor * against(cell))
                .collect()
        };
        let drives = |cells: &[i16]| {
            let checked = passivity::check(&tabled(nothing(), cells, memory));
            checked
                .err()
                .map(|active| (active.effect, active.field, active.value))
        };
        assert_eq!(drives(&made(0)), None, "{memory:?}");
        assert_eq!(drives(&made(1)), None, "{memory:?}");
        let (effect, field, value) = drives(&made(-1)).unwrap();
        assert_eq!((effect, field), ("residual_table", "cells"), "{memory:?}");
        assert!((value - 40.0 * 1e-4).abs() < 1e-6, "{memory:?}: {value}");
        // One cell more than is absorbed.
        let mut one = made(1);
        one[4] -= 41;
        assert!(drives(&one).is_some(), "{memory:?}");
    }
}

/// A cycle may rise at one speed and fall at another, or at two travels; it has one temperature, one frequency and one largest
/// displacement. A stretch is that of a spring, which may grow stiffer with it and not softer.
#[test]
fn a_table_over_a_variable_that_moves_is_refused_where_two_values_drive() {
    let grows: Vec<i16> = (0..CELLS).map(|cell| (cell / 9 % 17) as i16).collect();
    let fades: Vec<i16> = grows.iter().map(|cell| -cell).collect();
    for memory in memories() {
        let refused = match memory {
            None | Some(Memory::Sides { .. } | Memory::Travel { .. }) => [true, true],
            Some(Memory::Slip { .. } | Memory::Lag { .. }) => [false, true],
            Some(_) => [false, false],
        };
        let is_refused =
            |cells: &[i16]| passivity::check(&tabled(nothing(), cells, memory)).is_err();
        assert_eq!(
            [&grows, &fades].map(|cells| is_refused(cells)),
            refused,
            "{memory:?}"
        );
    }
}

/// Over speed it may lack what the law's damping has at the two speeds; as much as remains of it; none at rest, behind a play, or over
/// another variable. A law that passes gains nothing at any speed, and `passive` makes a table pass that does not.
#[test]
fn a_residual_table_may_lack_what_the_damping_takes_at_its_speeds() {
    let law = Law::new(1.0, 0.0, 0.1, 0.5).unwrap();
    let speed = |node: usize| 6.0 * part_of_speed(node);
    // Counts of 1e-4 kN, a part of the damping at each node.
    let cells = |part: f64| -> Vec<i16> {
        (0..CELLS)
            .map(|cell| {
                let counts = part * 1e3 * speed(cell / 9 % 17).sqrt();
                if cell < CELLS / 2 {
                    -counts as i16
                } else {
                    counts as i16
                }
            })
            .collect()
    };
    let with = |part: f64, effects: &[Effect<f32>], memory: Option<Memory<f32>>| {
        let law = tabled(law, &cells(part), memory);
        effects
            .iter()
            .fold(law, |law, effect| law.with(*effect).unwrap())
    };
    let half = [Effect::Directional(Directional::new(0.5).unwrap())];
    let gap = [Effect::Gap(Gap::new(0.01, true).unwrap())];
    let travel = Some(Memory::Travel { time: 0.1 });
    for (part, effects, memory, is_passive) in [
        (0.98, &[][..], None, true),
        (1.02, &[], None, false),
        (0.48, &half, None, true),
        (0.52, &half, None, false),
        (0.02, &gap, None, false),
        (0.02, &[], travel, false),
    ] {
        let law = with(part, effects, memory);
        let checked = passivity::check(&law).is_ok();
        assert_eq!(checked, is_passive, "{part} {effects:?} {memory:?}");
        let table = law.residual_table().unwrap();
        let table = table.passive(|speed| damping_beside_table(&law, speed));
        let mended = law.clone().with_residual_table(table).unwrap();
        assert_eq!(passivity::check(&mended), Ok(()));
        let is_as_before = mended == law;
        assert!(is_as_before || part > 0.98 || !is_passive, "{part}");
    }
    let law = with(0.98, &[], None);
    for seed in 0..50 {
        let fastest = 10_f32.powi(-(seed as i32 % 5));
        let range = OperatingRange::new([-0.2, 0.2], [-fastest, fastest]).unwrap();
        assert!(given(law.clone(), &range, seed) > NONE, "{seed}");
    }
    // Friction that is reversed at rest drives a motion that is slow enough.
    let mut reversed = cells(0.0);
    (0..9).for_each(|cell| reversed[cell] = -20);
    assert!(passivity::check(&tabled(law.law().to_owned(), &reversed, None)).is_err());
}

/// A law softer than the spring has no single state.
#[test]
fn a_spring_in_series_is_refused_before_what_it_cannot_hold() {
    let spring = Effect::Compliance(Compliance::new(2.0, 1e-3).unwrap());
    let soft = Some(("compliance", "stiffness"));
    for (k1, k3, by) in [
        (-1.9, 0.0, None),
        (-2.1, 0.0, soft),
        (1.0, 24.0, None),
        (1.0, -1e-3, soft),
    ] {
        let law = Law::new(k1, k3, 0.1, 0.3).unwrap();
        assert_eq!(refused(law, &[spring]), by, "{k1} {k3}");
        // Alone it gives back what it took.
        assert_eq!(refused(law, &[]), None);
    }
}

/// Their energy is that of a measurement or a drive: they are left out, and hide no other part.
#[test]
fn what_supplies_energy_by_its_nature_is_left_out() {
    let all = DESCRIPTIONS
        .iter()
        .filter(|each| each.energy == Energy::Active);
    let names: Vec<&str> = all.clone().map(|each| each.name).collect();
    assert_eq!(names, ["periodic", "delay", "force_filter"]);
    for each in all {
        let effect = Effect::from_parameters(each.number, each.typical, TICK).unwrap();
        assert_eq!(refused(mesh(), &[effect]), None, "{}", each.name);
        let weak = Effect::Viscous(Viscous::new(-0.5).unwrap());
        assert_eq!(refused(mesh(), &[effect, weak]), Some(("viscous", "c1")));
    }
}
