//! The growth of forces outside the operating range: as in each description and in the page.

use std::collections::BTreeSet;
use std::f64::consts::TAU;

use mesh_damper::effects::description::{Description, EffectKind, Growth};
use mesh_damper::effects::residual_table::{CELLS, ResidualTableParts};
use mesh_damper::effects::{
    AugmentedLaw, DESCRIPTIONS, Drift, Effect, ForceFilter, Motion, ResidualTable, Temperature,
};
use mesh_damper::law::Law;

use crate::loops::{TICKS, close, nothing, sine};

/// The largest displacement of the operating range, mm.
const RANGE: f64 = 0.1;
const FREQUENCY: f64 = 1.0;
const TICK: f64 = 1.0 / (FREQUENCY * TICKS as f64);
/// The size of the motion in multiples of the range.
const TIMES: [f64; 5] = [1.0, 3.0, 10.0, 30.0, 100.0];
const ALPHA: f64 = 0.4;

fn law(k1: f64, k3: f64, c: f64) -> Law<f64> {
    Law::new(k1, k3, c, ALPHA).unwrap()
}

fn effect(description: &Description) -> Effect<f64> {
    Effect::from_parameters(description.number, description.typical, TICK).unwrap()
}

/// The largest difference of both forces over three cycles of a sine up to `times` the range, at 60 °C.
fn peak(law: &AugmentedLaw<f64, 1>, other: &AugmentedLaw<f64, 1>, times: f64) -> f64 {
    let (mut state, mut others) = (law.at_rest(), other.at_rest());
    (0..3 * TICKS)
        .map(|n| Motion {
            temperature: 60.0,
            ..sine(times * RANGE, FREQUENCY, n)
        })
        .map(|motion| law.force(&mut state, &motion) - other.force(&mut others, &motion))
        .fold(0.0, |most: f64, force| most.max(force.abs()))
}

/// The force that an effect adds to `law` at each of [`TIMES`], or the output of a stage: kN.
fn peaks(description: &Description, law: Law<f64>) -> [f64; 5] {
    let with = AugmentedLaw::new(law).with(effect(description)).unwrap();
    let without = match description.kind {
        EffectKind::Stage => AugmentedLaw::new(nothing()),
        _ => AugmentedLaw::new(law),
    };
    TIMES.map(|times| peak(&with, &without, times))
}

fn of_law_alone(law: Law<f64>) -> [f64; 5] {
    TIMES.map(|times| {
        peak(
            &AugmentedLaw::new(law),
            &AugmentedLaw::new(nothing()),
            times,
        )
    })
}

/// The exponent of the growth from 30 to 100 times the range.
fn exponent(peaks: [f64; 5]) -> f64 {
    (peaks[4] / peaks[3]).ln() / (TIMES[4] / TIMES[3]).ln()
}

fn is_power(peaks: [f64; 5], exponent: f64) {
    assert!(peaks[0] > 0.0);
    for (peak, times) in peaks.into_iter().zip(TIMES) {
        close(peak, peaks[0] * times.powf(exponent), 1e-9);
    }
}

/// The limit of friction: the force of its springs at their limits, Σ k·x. The first two parameters are k and x, or all parameters
/// are pairs of them.
fn friction_limit(description: &Description) -> f64 {
    let used = match description.most {
        1 => 2,
        _ => description.typical.len(),
    };
    let pairs = description.typical[..used].chunks(2);
    pairs.map(|pair| pair[0] * pair[1]).sum()
}

#[test]
fn each_force_grows_as_its_description_says() {
    for description in DESCRIPTIONS {
        let alone = || peaks(description, nothing());
        match description.outside {
            Growth::Constant => is_power(alone(), 0.0),
            Growth::Linear => is_power(alone(), 1.0),
            Growth::Quadratic => is_power(alone(), 2.0),
            Growth::FifthPower => is_power(alone(), 5.0),
            Growth::Saturates => {
                let (peaks, limit) = (alone(), friction_limit(description));
                for peak in peaks {
                    assert!(
                        peak <= limit * (1.0 + 1e-9),
                        "{}: a force of {peak} kN exceeds the limit of {limit} kN by `friction_limit`",
                        description.name
                    );
                }
                // A spring that softens approaches its limit as 1/|y|, the others reach it within the motion.
                let reached = match description.name {
                    "degradation" => {
                        let [thirty, hundred] = [3, 4].map(|place| TIMES[place] / peaks[place]);
                        let at_infinity = (TIMES[4] - TIMES[3]) / (hundred - thirty);
                        [at_infinity; 2]
                    }
                    _ => [peaks[3], peaks[4]],
                };
                for reached in reached {
                    close(reached, limit, 1e-3);
                }
            }
            Growth::LinearBeyondGap => {
                let [_, three, ten, thirty, _] = alone();
                close((thirty - ten) / (ten - three), 20.0 / 7.0, 1e-9);
                // Not in proportion to the motion: the gap is missing.
                assert!(ten / three > 1.01 * 10.0 / 3.0);
            }
            Growth::AtMostLinear => {
                let stiff = law(1.0, 1e4, 0.1);
                let of = match description.kind {
                    EffectKind::Stage => stiff,
                    _ => nothing(),
                };
                let found = exponent(peaks(description, of));
                assert!(found > 0.5 && found < 1.05, "{}: {found}", description.name);
            }
            Growth::LinearTimesDamping => {
                is_power(peaks(description, law(0.0, 0.0, 0.1)), 1.0 + ALPHA);
            }
            Growth::OfDamping => is_power(peaks(description, law(0.0, 0.0, 0.1)), ALPHA),
            Growth::OfLaw => {
                for (of, power) in [
                    (law(1.7, 0.0, 0.0), 1.0),
                    (law(0.0, 30.0, 0.0), 3.0),
                    (law(0.0, 0.0, 0.1), ALPHA),
                ] {
                    // A stiffness next to the law's forces is linear, and may hide a force that grows less.
                    let most = f64::max(power, 1.0);
                    let found = exponent(peaks(description, of));
                    assert!(
                        found > power - 0.01 && found < most + 0.01,
                        "{}: {found} of {power}",
                        description.name
                    );
                }
            }
            Growth::OfForceBehind => {
                let of = law(1.7, 30.0, 0.1);
                let (shown, behind) = (peaks(description, of), of_law_alone(of));
                for (shown, behind) in shown.into_iter().zip(behind) {
                    assert!(
                        shown > 0.1 * behind && shown < 1.01 * behind,
                        "{}: {shown} of {behind}",
                        description.name
                    );
                }
                close(exponent(shown), exponent(behind), 0.01);
            }
            other => panic!("{}: no effect grows {}", description.name, other.words()),
        }
    }
}

#[test]
fn the_mixed_damping_law_grows_with_its_cubic_part() {
    assert_eq!(Law::<f64>::OUTSIDE, Growth::Cubic);
    let all = exponent(of_law_alone(law(1.7, 30.0, 0.1)));
    assert!((all - 3.0).abs() < 0.02, "{all}");
    is_power(of_law_alone(law(0.0, 0.0, 0.1)), ALPHA);
}

/// Beyond its reach and its speed a residual table gives its value at the edge.
#[test]
fn a_residual_table_holds_its_edge() {
    assert_eq!(ResidualTable::<f64>::OUTSIDE, Growth::Held);
    let cells: Vec<i16> = (0..CELLS).map(|cell| (cell * 37 % 1000) as i16).collect();
    let parts = ResidualTableParts {
        reach: RANGE,
        speed: 6.0,
        unit: 1e-3,
        cells: &cells,
        memory: None,
    };
    let table = ResidualTable::new(&parts, TICK).unwrap();
    let law: AugmentedLaw<f64, 1> = AugmentedLaw::new(nothing())
        .with_residual_table(table)
        .unwrap();
    let force = |times: f64, side: f64, direction: f64| {
        let motion = Motion::at(side * times * RANGE, direction * times * 6.0);
        law.force(&mut law.at_rest(), &motion)
    };
    for (side, direction) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
        let edge = force(1.0, side, direction);
        assert!(edge > 0.0);
        for times in [3.0, 10.0, 1e6] {
            assert_eq!(force(times, side, direction), edge);
        }
        assert_ne!(force(0.5, side, direction), edge);
    }
}

/// k·x + k·τ·v for a dashpot that yields, 2·k·Y for a Maxwell branch, 2·K·Y for a spring in series; Y is the largest displacement.
#[test]
fn what_is_at_most_linear_or_linear_stays_below_what_the_page_says() {
    let named = |name: &str| DESCRIPTIONS.iter().find(|d| d.name == name).unwrap();
    let yielding = named("yielding");
    let relaxation = named("relaxation");
    let compliance = named("compliance");
    let [stiffness, stretch, _, time] = *yielding.typical else {
        panic!("of four parameters");
    };
    let law = law(1.0, 1e4, 0.1);
    let forces = [
        peaks(yielding, nothing()),
        peaks(relaxation, nothing()),
        peaks(compliance, law),
    ];
    for (place, times) in TIMES.into_iter().enumerate() {
        let (y, v) = (times * RANGE, times * RANGE * TAU * FREQUENCY);
        let limits = [
            stiffness * (stretch + time * v),
            2.0 * relaxation.typical[0] * y,
            2.0 * compliance.typical[0] * y,
        ];
        for (forces, limit) in forces.iter().zip(limits) {
            let force = forces[place];
            assert!(force > 0.0 && force <= limit, "{force} of {limit}");
        }
    }
    // Without the spring the law's force is more than a hundred times as large.
    assert!(of_law_alone(law)[4] > 100.0 * forces[2][4]);
}

/// (1 + e^(−π))/(1 − e^(−π)), with a force that reverses at the worst times: after every half cycle of the low-pass's own
/// oscillation.
#[test]
fn a_low_pass_shows_at_most_nine_percent_more_than_there_is() {
    let (corner, tick) = (10.0, 1e-4);
    let filter = Effect::ForceFilter(ForceFilter::new(corner, tick).unwrap());
    let spring: AugmentedLaw<f64, 1> = AugmentedLaw::new(law(1.0, 0.0, 0.0)).with(filter).unwrap();
    // ω/√2 is the frequency of its oscillation.
    let half = (std::f64::consts::SQRT_2 * 0.5 / corner / tick).round() as usize;
    let mut state = spring.at_rest();
    let most = (0..40 * half).fold(0.0, |most: f64, n| {
        let motion = Motion {
            displacement: if (n / half).is_multiple_of(2) {
                1.0
            } else {
                -1.0
            },
            ..Motion::default()
        };
        most.max(spring.force(&mut state, &motion).abs())
    });
    let expected = 1.0 + 2.0 / (std::f64::consts::PI.exp() - 1.0);
    assert!(expected < 1.0904);
    close(most, expected, 1e-3);
}

/// The temperature reverses a force beyond 1/β; the number of cycles never causes more than the whole change.
#[test]
fn temperature_turns_a_force_round_and_cycles_do_not() {
    let alone = law(1.7, 30.0, 0.1);
    let beside = |effect| AugmentedLaw::<f64, 1>::new(alone).with(effect).unwrap();
    let hot = beside(Effect::Temperature(Temperature::new(0.005, 20.0).unwrap()));
    let worn = beside(Effect::Drift(
        Drift::new(0.2, 30.0)
            .and_then(|drift| drift.with_forces(0.5, -1.0))
            .unwrap(),
    ));
    let (y, v) = (0.1, 0.5);
    let motion = |temperature, cycles| Motion {
        temperature,
        cycles,
        ..Motion::at(y, v)
    };
    let force = alone.force(y, v);
    for (above, part) in [(200.0, 0.0), (400.0, -1.0), (2000.0, -9.0)] {
        let found = hot.force(&mut hot.at_rest(), &motion(20.0 + above, 0.0));
        assert!((found - part * force).abs() < 1e-9, "{above}: {found}");
    }
    let end = worn.force(&mut worn.at_rest(), &motion(20.0, 1e9));
    close(end, 0.2 * y + 1.5 * alone.elastic_force(y), 1e-9);
}

/// The cells of the rows of the page's table.
fn rows(page: &str) -> Vec<Vec<&str>> {
    let (_, section) = page.split_once("## Outside the operating range").unwrap();
    let section = section.split("\n## ").next().unwrap();
    let lines = section.lines().filter(|line| line.starts_with("| "));
    lines
        .skip(1)
        .map(|line| line.trim_matches('|').split(" | ").map(str::trim).collect())
        .collect()
}

#[test]
fn the_page_says_how_each_force_grows() {
    let rows = rows(include_str!("../../docs/effects.md"));
    let mut expected: BTreeSet<(String, &str)> = DESCRIPTIONS
        .iter()
        .map(|d| (format!("`{}`", d.family), d.outside.words()))
        .collect();
    expected.insert(("mixed damping law".to_owned(), Law::<f64>::OUTSIDE.words()));
    expected.insert((
        "residual table".to_owned(),
        ResidualTable::<f64>::OUTSIDE.words(),
    ));
    let said: BTreeSet<(String, &str)> =
        rows.iter().map(|row| (row[0].to_owned(), row[1])).collect();
    assert_eq!(said, expected);
    for row in rows {
        // Four columns, including the start of the growth and its bound.
        assert_eq!(row.len(), 4, "{row:?}");
        assert!(row.iter().all(|cell| !cell.is_empty()), "{row:?}");
    }
}
