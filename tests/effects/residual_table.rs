//! The residual table: its force between its nodes and outside, and its memory.

use mesh_damper::effects::residual_table::{
    CELLS, DISPLACEMENTS, FINE, Memory, NODES, ResidualTableParts, ResidualTableState,
    part_of_speed,
};
use mesh_damper::effects::{AugmentedLaw, AugmentedState, Motion, ResidualTable};
use mesh_damper::error::ConfigError;
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::law::Law;
use mesh_damper::real::Real;
use proptest::prelude::*;

const REACH: f64 = 0.2;
const SPEED: f64 = 6.0;
/// kN
const UNIT: f64 = 2e-4;
const TICK: f64 = 1e-3;

/// Cells from a function of displacement mm and velocity mm/s, in kN.
fn table(force: impl Fn(f64, f64) -> f64) -> Vec<i16> {
    let node = |cell: usize| {
        let (i, j) = (cell % DISPLACEMENTS, cell / DISPLACEMENTS);
        let y = REACH * (i as f64 / 4.0 - 1.0);
        let speed = SPEED * part_of_speed(j % NODES);
        (y, if j < NODES { speed } else { -speed })
    };
    let count = |cell| {
        let (y, v) = node(cell);
        (force(y, v) / UNIT).round() as i16
    };
    (0..CELLS).map(count).collect()
}

/// Cells that give the position of the second coordinate along its range, in 4000ths, for any displacement.
fn ramp() -> Vec<i16> {
    let node = |cell: usize| cell / DISPLACEMENTS % NODES;
    (0..CELLS).map(|cell| 250 * node(cell) as i16).collect()
}

fn correction<R: Real>(
    cells: &[i16],
    memory: Option<(Memory<R>, [R; 2])>,
) -> Result<ResidualTable<R>, ConfigError> {
    let parts = ResidualTableParts {
        reach: R::from_f64(REACH),
        speed: R::from_f64(SPEED),
        unit: R::from_f64(UNIT),
        cells,
        memory,
    };
    ResidualTable::new(&parts, R::from_f64(TICK))
}

struct Alone<R: Real> {
    law: AugmentedLaw<R, 1>,
    state: AugmentedState<R>,
}

impl<R: Real> Alone<R> {
    fn new(correction: ResidualTable<R>) -> Self {
        let none = Law::new(R::ZERO, R::ZERO, R::ZERO, R::ZERO).unwrap();
        let law = AugmentedLaw::new(none)
            .with_residual_table(correction)
            .unwrap();
        Self {
            state: law.at_rest(),
            law,
        }
    }

    fn force(&mut self, displacement: f64, velocity: f64, cycles: f64) -> f64 {
        self.force_at(20.0, displacement, velocity, cycles)
    }

    fn force_at(&mut self, temperature: f64, displacement: f64, velocity: f64, cycles: f64) -> f64 {
        let motion = Motion {
            temperature: R::from_f64(temperature),
            cycles: R::from_f64(cycles),
            ..Motion::at(R::from_f64(displacement), R::from_f64(velocity))
        };
        self.law.force(&mut self.state, &motion).to_f64()
    }
}

/// The remembered value, which is in `range`, after each displacement and velocity.
fn remembered_of(
    memory: Memory<f64>,
    range: [f64; 2],
    motion: impl Iterator<Item = (f64, f64)>,
) -> Vec<f64> {
    let mut alone = Alone::new(correction(&ramp(), Some((memory, range))).unwrap());
    let mut part = |(y, v)| alone.force(y, v, 0.0) / (4000.0 * UNIT);
    motion
        .map(|moved| range[0] + (range[1] - range[0]) * part(moved))
        .collect()
}

/// The same for a memory that does not depend on the velocity, with every third tick at rest.
fn remembered(memory: Memory<f64>, range: [f64; 2], motion: impl Iterator<Item = f64>) -> Vec<f64> {
    let speeds = [0.3, 0.0, -5.0].into_iter().cycle();
    remembered_of(memory, range, motion.zip(speeds))
}

fn close(value: f64, expected: f64, within: f64) {
    assert!(
        (value - expected).abs() <= within,
        "{value}, not {expected}"
    );
}

/// y·|v| and v are linear between the nodes, and a jump at rest is represented exactly.
#[test]
fn what_is_straight_between_the_nodes_is_exact() {
    let force = |y: f64, v: f64| 0.5 + 2.0 * y + 0.1 * v + 1.5 * y * v.abs() + 0.3 * v.signum();
    let mut alone = Alone::new(correction::<f64>(&table(force), None).unwrap());
    for y in [-0.199, -0.13, 0.0, 0.01, 0.077, 0.2] {
        for v in [-5.9, -1.0, -0.02, -1e-6, 1e-6, 0.3, 2.2, 6.0] {
            // A count, and a 4096th of a cell.
            close(alone.force(y, v, 0.0), force(y, v), 1.5 * UNIT + 1e-3);
        }
    }
}

#[test]
fn outside_the_edge_holds() {
    let force = |y: f64, v: f64| 4.0 * y + 0.2 * v;
    let mut alone = Alone::new(correction::<f64>(&table(force), None).unwrap());
    for (y, v, edge) in [
        (5.0, 1e9, force(REACH, SPEED)),
        (-0.21, 60.0, force(-REACH, SPEED)),
        (1e30, -7.0, force(REACH, -SPEED)),
        (f64::INFINITY, f64::NEG_INFINITY, force(REACH, -SPEED)),
    ] {
        close(alone.force(y, v, 0.0), edge, 2e-3);
    }
    close(alone.force(f64::NAN, f64::NAN, f64::NAN), 0.0, 2e-3);
}

/// The stop operator: it follows the displacement up to the limit, and reverses with the motion.
#[test]
fn slip_is_a_stop() {
    let motion = [0.0, 0.02, 0.15, 0.14, 0.08, -0.1, -0.08];
    let z = remembered(
        Memory::Slip { limit: 0.05 },
        [-0.05, 0.05],
        motion.into_iter(),
    );
    for (z, expected) in z.iter().zip([0.0, 0.02, 0.05, 0.04, -0.02, -0.05, -0.03]) {
        close(*z, expected, 1e-4);
    }
}

/// After a step of 0.1 mm it is 0.1·e^(−t/τ).
#[test]
fn lag_fades_with_its_time() {
    let motion = std::iter::once(0.0).chain(std::iter::repeat_n(0.1, 200));
    let z = remembered(Memory::Lag { time: 0.05 }, [0.0, 0.1], motion);
    for ticks in [1, 20, 50, 150] {
        close(z[ticks], 0.1 * (-(ticks as f64) * TICK / 0.05).exp(), 2e-4);
    }
}

/// A triangle of 2 mm/s, long after its start.
#[test]
fn travel_is_the_mean_speed() {
    let motion = |tick: i32| (0.0, if tick % 100 < 50 { 2.0 } else { -2.0 });
    let z = remembered_of(
        Memory::Travel { time: 0.1 },
        [0.0, 4.0],
        (0..2000).map(motion),
    );
    close(z[50], 2.0 * (1.0 - f64::exp(-0.51)), 4e-3);
    close(z[1999], 2.0, 4e-3);
}

/// Over 300,000 ticks, in which an average in a few counts would not change.
#[test]
fn a_slow_motion_is_averaged_over_a_long_time() {
    let time = 300.0;
    for (memory, moved, mean, high) in [
        (Memory::Travel { time }, (0.1, 0.2), 0.2, 4.0),
        (Memory::Lag { time }, (0.1, 1.0), 0.0, 0.2),
    ] {
        let motion = std::iter::repeat_n(moved, 600_000);
        let z = remembered_of(memory, [0.0, high], motion);
        close(z[599_999], mean * (1.0 - f64::exp(-2.0)), 1e-3 * high);
    }
}

#[test]
fn the_largest_displacement_stays() {
    let motion = [0.01, -0.06, 0.05, 0.1, -0.02, 0.0];
    let z = remembered(Memory::Largest, [0.0, 0.2], motion.into_iter());
    for (z, expected) in z.iter().zip([0.01, 0.06, 0.06, 0.1, 0.1, 0.1]) {
        close(*z, expected, 2e-4);
    }
}

/// log₂(1 + t/τ) is exact where 1 + t/τ is a power of two.
#[test]
fn age_grows_with_the_logarithm_of_time() {
    let z = remembered(
        Memory::Age { time: 0.01 },
        [0.0, 8.0],
        std::iter::repeat_n(0.0, 701),
    );
    for (ticks, octaves) in [(0, 0.0), (10, 1.0), (30, 2.0), (70, 3.0), (630, 6.0)] {
        // The range is resolved to 2⁻¹⁰, and both the memory and its position are truncated.
        close(z[ticks], octaves, 2.0 * 8.0 / 1024.0);
    }
}

#[test]
fn temperature_stands_where_it_is_measured() {
    let force_at = |temperature, range| {
        let memory = (Memory::Temperature, range);
        let correction = correction::<f64>(&ramp(), Some(memory)).unwrap();
        let mut alone = Alone::new(correction);
        alone.force_at(temperature, 0.0, 0.0, 0.0) / (4000.0 * UNIT)
    };
    for (temperature, part) in [
        (-20.0, 0.0),
        (-5.0, 0.25),
        (40.0, 1.0),
        (400.0, 1.0),
        (-1e30, 0.0),
        (f64::NAN, 1.0 / 3.0),
    ] {
        // A gain of 170.7 readings is truncated to 170.
        close(force_at(temperature, [-20.0, 40.0]), part, 5e-3);
    }
    // A narrow range as well.
    close(force_at(60.5, [60.0, 62.0]), 0.25, 5e-3);
}

/// A tent half as wide as the resolution of another table, in the forward direction only.
#[test]
fn a_line_resolves_what_happens_at_one_place() {
    let width = 2.0 * REACH / (FINE - 1) as f64;
    let place = 3.0 * width;
    let tent = |y: f64| (1.0 - (y - place).abs() / width).max(0.0);
    let mut line = [0; CELLS];
    for (node, cell) in line.iter_mut().take(FINE).enumerate() {
        *cell = (4000.0 * tent(width * node as f64 - REACH)).round() as i16;
    }
    let parts = ResidualTableParts {
        reach: REACH,
        speed: SPEED,
        unit: UNIT,
        cells: &line,
        memory: Some((Memory::Place, [-REACH, REACH])),
    };
    let mut alone = Alone::<f64>::new(ResidualTable::new(&parts, TICK).unwrap());
    let high = 4000.0 * UNIT;
    for step in 0..=400 {
        let y = REACH * (f64::from(step) / 200.0 - 1.0);
        close(alone.force(y, 2.0, 0.0), high * tent(y), 4e-3);
        close(alone.force(y, -2.0, 0.0), 0.0, 1e-3);
        // At rest, the mean.
        close(alone.force(y, 0.0, 0.0), 0.5 * high * tent(y), 4e-3);
    }
    for outside in [-5.0, 0.3, f64::INFINITY] {
        close(alone.force(outside, 2.0, 0.0), 0.0, 1e-3);
    }
}

/// Friction and a dashpot above one edge, another pair below the other, nothing between: the jump is within a 4096th of a node.
#[test]
fn a_side_begins_at_its_edge() {
    let (below, above) = (-0.12, 0.05);
    let force = |y: f64, v: f64| match y {
        y if y > above => 0.1 * v + 0.05 * v.signum(),
        y if y < below => -0.2 * v,
        _ => 0.0,
    };
    let mut lines = [0; CELLS];
    for (way, sign) in [(0, 1.0), (CELLS / 2, -1.0)] {
        for (side, y) in [(0, REACH), (NODES, -REACH)] {
            for node in 0..NODES {
                // At rest the friction of this direction acts.
                let speed = (SPEED * part_of_speed(node)).max(f64::MIN_POSITIVE);
                lines[way + side + node] = (force(y, sign * speed) / UNIT).round() as i16;
            }
        }
    }
    let with = |below, above| {
        let parts = ResidualTableParts {
            reach: REACH,
            speed: SPEED,
            unit: UNIT,
            cells: &lines,
            memory: Some((Memory::Sides { below, above }, [-REACH, REACH])),
        };
        Alone::<f64>::new(ResidualTable::new(&parts, TICK).unwrap())
    };
    let mut both = with(below, above);
    let mut one = with(-REACH, above);
    for y in [-REACH, -0.1201, -0.1199, 0.0, 0.0499, 0.0501, REACH] {
        for v in [-6.0, -0.7, -1e-9, 1e-9, 0.7, 6.0] {
            close(both.force(y, v, 0.0), force(y, v), 1e-3);
            close(one.force(y, v, 0.0), force(y.max(below), v), 1e-3);
        }
        // At rest, the mean.
        close(both.force(y, 0.0, 0.0), 0.0, 1e-3);
    }
    close(both.force(50.0, 2.0, 0.0), 0.25, 1e-3);
    close(both.force(-50.0, 2.0, 0.0), -0.4, 1e-3);
    close(one.force(-50.0, 2.0, 0.0), 0.0, 1e-3);
}

/// The logarithm is exact for 2 and 8 Hz, also after more cycles than a counter with fractions could represent.
#[test]
fn frequency_is_that_of_the_cycles() {
    let range = [0.0, 4.0];
    for begun in [0.0, 3e6] {
        let memory = (Memory::Frequency { time: 0.05 }, range);
        let mut alone = Alone::new(correction::<f64>(&ramp(), Some(memory)).unwrap());
        let mut cycles = begun;
        let mut after = |frequency: f64, seconds: f64| {
            let ticks = (seconds / TICK).round() as usize;
            let forces = (0..ticks).map(|_| {
                cycles += frequency * TICK;
                alone.force(0.0, 0.0, cycles)
            });
            forces.last().unwrap() / (1000.0 * UNIT)
        };
        close(after(2.0, 1.0), 1.0, 1e-2);
        close(after(8.0, 1.0), 3.0, 1e-2);
        // Halfway back, at 5 Hz: a quarter of the octave from 4 Hz to 8 Hz, in which the logarithm is approximated by a line.
        close(after(2.0, 0.05 * f64::ln(2.0)), 2.25, 2e-2);
        // Without any cycles the value is that of the first node.
        close(after(0.0, 2.0), 0.0, 1e-2);
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let field = |error: ConfigError| match error {
        ConfigError::NonFinite(field) | ConfigError::OutOfRange { field, .. } => field,
        other => panic!("{other}"),
    };
    let refused = |cells: &[i16], memory| field(correction::<f64>(cells, memory).unwrap_err());
    let cells = [0; CELLS];
    assert_eq!(refused(&cells[1..], None), "cells");
    for (memory, range, said) in [
        (Memory::Slip { limit: 0.0 }, [0.0, 1.0], "limit"),
        (Memory::Lag { time: f64::NAN }, [0.0, 1.0], "time"),
        (Memory::Travel { time: -1.0 }, [0.0, 1.0], "time"),
        (Memory::Age { time: 1e7 }, [0.0, 1.0], "time"),
        (Memory::Frequency { time: 0.0 }, [0.0, 1.0], "time"),
        (
            Memory::Sides {
                below: f64::NAN,
                above: 0.0,
            },
            [0.0, 1.0],
            "below",
        ),
        (
            Memory::Sides {
                below: 0.1,
                above: 0.0,
            },
            [0.0, 1.0],
            "above",
        ),
        (Memory::Largest, [1.0, 1.0], "high"),
        (Memory::Largest, [f64::NAN, 1.0], "low"),
    ] {
        assert_eq!(refused(&cells, Some((memory, range))), said);
    }
    let law = AugmentedLaw::<f64, 0>::new(Law::new(1.0, 0.0, 0.0, 0.0).unwrap());
    assert!(
        law.with_residual_table(correction(&cells, None).unwrap())
            .is_err()
    );
}

proptest! {
    /// f32 agrees with f64, except for the rounding of a displacement or a speed.
    #[test]
    fn both_floats_give_the_same(
        motion in prop::collection::vec((-0.3f64..0.3, -8.0f64..8.0), 1..200),
        kind in 0usize..9,
    ) {
        fn memory<R: Real>(kind: usize) -> (Memory<R>, [R; 2]) {
            let real = R::from_f64;
            let memory = [
                Memory::Slip { limit: real(0.05) },
                Memory::Lag { time: real(0.05) },
                Memory::Travel { time: real(0.05) },
                Memory::Largest,
                Memory::Age { time: real(0.05) },
                Memory::Temperature,
                Memory::Place,
                Memory::Sides { below: real(-0.1), above: real(0.03) },
                Memory::Frequency { time: real(0.05) },
            ][kind];
            let low = [-0.05, -0.1, 0.0, 0.0, 0.0, -1.0, -0.2, -0.2, 0.0][kind];
            let high = [0.05, 0.1, 200.0, 0.2, 3.0, 30.0, 0.2, 0.2, 4.0][kind];
            (memory, [real(low), real(high)])
        }
        let cells = table(|y, v| 4.0 * y + 0.2 * v + v.signum());
        let mut double = Alone::new(correction::<f64>(&cells, Some(memory(kind))).unwrap());
        let mut single = Alone::new(correction::<f32>(&cells, Some(memory(kind))).unwrap());
        for (tick, (y, v)) in motion.into_iter().enumerate() {
            let cycles = 0.01 * tick as f64;
            // From below to above the range.
            let temperature = -5.0 + tick as f64;
            let forces = [
                double.force_at(temperature, y, v, cycles),
                single.force_at(temperature, y, v, cycles),
            ];
            let difference = forces[0] - forces[1];
            // Of a force of 2.4 kN.
            prop_assert!(difference.abs() < 5e-3, "{difference}");
        }
    }

    /// The cells and weights that an identification receives give the force.
    #[test]
    fn the_support_is_what_the_force_comes_from(
        motion in prop::collection::vec((-0.3f64..0.3, -8.0f64..8.0), 1..50),
        kind in 0usize..3,
    ) {
        let cells = table(|y, v| 4.0 * y + 0.2 * v + y * v + v.signum());
        let memory = [
            Memory::Slip { limit: 0.05 },
            Memory::Place,
            Memory::Sides { below: -0.1, above: 0.03 },
        ][kind];
        let correction = correction::<f64>(&cells, Some((memory, [-0.05, 0.05]))).unwrap();
        let mut alone = Alone::new(correction);
        let mut state = ResidualTableState::NEW;
        for (displacement, velocity) in motion {
            let moved = Motion { displacement, velocity, ..Motion::default() };
            let support = correction.support(&mut state, &moved.clamped());
            let weights = support.cells.iter();
            let expected: f64 = weights.map(|&(cell, weight)| weight * f64::from(cells[cell])).sum();
            // Three roundings down.
            prop_assert!((alone.force(displacement, velocity, 0.0) / UNIT - expected).abs() < 4.0);
        }
    }
}

/// The state of one kind of memory is not used for another kind, nor for the same kind with another reach. The same kind keeps its
/// state.
#[test]
fn a_law_that_takes_over_keeps_what_is_remembered_only_where_it_remembers_the_same() {
    let lag = (Memory::Lag { time: 0.05 }, [-0.2, 0.2]);
    let largest = (Memory::Largest, [0.0, 0.2]);
    let none = Law::new(0.0, 0.0, 0.0, 0.0).unwrap();
    let law_within = |reach, memory| {
        let parts = ResidualTableParts {
            reach,
            speed: SPEED as f32,
            unit: UNIT as f32,
            cells: &ramp(),
            memory: Some(memory),
        };
        let correction = ResidualTable::new(&parts, TICK as f32).unwrap();
        FastLaw::new(
            AugmentedLaw::<f32, 1>::new(none)
                .with_residual_table(correction)
                .unwrap(),
        )
    };
    let law = |memory| law_within(REACH as f32, memory);
    let at = |displacement| Motion::at(displacement, 0.0);
    // The force at 0.02 mm, after a motion to 0.15 mm under the first law and a swap to the second.
    let swapped = |first, second| {
        let mut running = RunningLaw::new(first);
        for _ in 0..300 {
            running.force(&at(0.15));
        }
        running.swap(second);
        assert!(running.boundary());
        running.force(&at(0.02))
    };
    let after = |first, second| swapped(law(first), law(second));
    let anew = |memory| RunningLaw::new(law(memory)).force(&at(0.02));
    let wider = || law_within(2.0 * REACH as f32, largest);
    assert_eq!(
        swapped(law(largest), wider()),
        RunningLaw::new(wider()).force(&at(0.02))
    );
    assert_eq!(after(lag, largest), anew(largest));
    assert_eq!(after(largest, lag), anew(lag));
    // 4000 counts over 0.2 mm.
    let kept = f64::from(after(largest, largest));
    close(kept, 0.75 * 4000.0 * UNIT, 1e-2);
    // About 0.13 mm of the 0.4 mm.
    assert!((after(lag, lag) - anew(lag)).abs() > 0.1);
}
