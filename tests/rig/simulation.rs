//! The simulation of a law at the lowest cost: its results agree with those of the generator, the law and the accumulator.

use mesh_damper::cycle::{Cycle, CycleAccumulator};
use mesh_damper::effects::{AugmentedLaw, Motion};
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::law::Law;
use mesh_damper::simulation::Simulation;
use mesh_damper::sine::{Block, Programme, SineGenerator};
use mesh_damper::table::PAPER;
use proptest::prelude::*;

const RATE: f64 = 10_000.0;

fn tabulated(law: Law<f32>) -> FastLaw<0> {
    FastLaw::new(AugmentedLaw::new(law))
}

fn paper(density: f32) -> FastLaw<0> {
    tabulated(PAPER.lookup(density, 0.1).law)
}

fn programme(blocks: &[Block]) -> Programme<4> {
    blocks
        .iter()
        .fold(Programme::new(RATE, 1).unwrap(), |programme, block| {
            programme.with(*block).unwrap()
        })
}

/// The results of a simulation: the force at every tick, with the cycles completed before it and the displacement, and each cycle's
/// results.
#[derive(Debug, Default, PartialEq)]
struct Given {
    forces: Vec<(f32, u32, f32)>,
    cycles: Vec<Cycle>,
}

/// `swap` is requested after that many ticks.
fn ticks(programme: &Programme<4>, law: &FastLaw<0>, swap: Option<(usize, &FastLaw<0>)>) -> Given {
    let mut test = Simulation::new(programme.clone(), law.clone()).unwrap();
    let mut given = Given::default();
    loop {
        if let Some((at, law)) = swap
            && given.forces.len() == at
        {
            test.swap_law(law.clone());
        }
        let force = test.tick();
        if test.results().0 as usize > given.cycles.len() {
            given.cycles.push(*test.results().1);
        }
        if test.done() {
            assert_eq!(force, 0.0);
            return given;
        }
        given
            .forces
            .push((force, test.cycle(), test.displacement()));
    }
}

/// The same from the separate parts, without a short cut.
fn parts(programme: &Programme<4>, law: &FastLaw<0>, swap: Option<(usize, &FastLaw<0>)>) -> Given {
    let mut generator = SineGenerator::new(programme.clone()).unwrap();
    let mut law = RunningLaw::new(law.clone());
    let mut accumulator = CycleAccumulator::new();
    let mut given = Given::default();
    loop {
        if let Some((at, other)) = swap
            && given.forces.len() == at
        {
            law.swap(other.clone());
        }
        let now = generator.tick();
        if now.cycle_end {
            law.boundary();
        }
        let force = law.force(&Motion::at(now.displacement, now.velocity));
        given.cycles.extend(
            accumulator
                .update(now.displacement, [force], now.phase)
                .into_iter()
                .flatten(),
        );
        if now.done {
            return given;
        }
        given.forces.push((force, now.cycle, now.displacement));
    }
}

/// The number of ticks and cycles is the same, and the forces agree within the effect of two roundings of the same sine: sin and cos
/// within 3e-7 and the rotation's cubic within 2.2e-7 of the peak, times the steepest α·|v|^α and 3·k·y.
fn forces_agree(given: &Given, expected: &Given) {
    assert_eq!(given.forces.len(), expected.forces.len());
    let peak = expected
        .forces
        .iter()
        .fold(0.0f32, |m, (f, ..)| m.max(f.abs()));
    let amplitude = expected
        .forces
        .iter()
        .fold(0.0f32, |m, (.., y)| m.max(y.abs()));
    for (n, (is, should)) in given.forces.iter().zip(&expected.forces).enumerate() {
        assert_eq!(is.1, should.1, "cycles before tick {n}");
        assert!(
            (is.0 - should.0).abs() < 1.2e-6 * peak,
            "tick {n}: {} is not {}",
            is.0,
            should.0
        );
        assert!(
            (is.2 - should.2).abs() < 6e-7 * amplitude,
            "tick {n}: {} mm is not {} mm",
            is.2,
            should.2
        );
    }
}

#[test]
fn a_programme_of_all_kinds_is_what_its_parts_make_of_it() {
    let programme = programme(&[
        Block::sine(0.1, 9.7, 4).unwrap(),
        Block::sweep(0.1, 5.0, 20.0, 6).unwrap(),
        Block::sine(0.05, 23.1, 5).unwrap(),
        // Fewer ticks per cycle than the short cut needs.
        Block::sine(0.02, 1234.5, 9).unwrap(),
    ]);
    let law = paper(3.0);
    let (given, expected) = (ticks(&programme, &law, None), parts(&programme, &law, None));
    forces_agree(&given, &expected);
    assert_eq!(given.cycles.len(), expected.cycles.len());
    for (is, should) in given.cycles[1..5].iter().zip(&expected.cycles[1..5]) {
        // At 1031 ticks to the cycle: extremes within (π/1031)²/2 of the true ones, trapezoids within (2π/1031)²/6.
        let close = |a: f32, b: f32, tolerance: f32| {
            assert!((a / b - 1.0).abs() < tolerance, "{a} is not {b}")
        };
        close(is.stiffness, should.stiffness, 1e-5);
        close(is.energy, should.energy, 1e-5);
        close(is.energy_harmonic, should.energy_harmonic, 1e-5);
        close(is.loss_factor, should.loss_factor, 2e-5);
        close(is.amplitude, should.amplitude, 1e-5);
        close(is.elastic_energy, should.elastic_energy, 2e-5);
        close(is.ticks, should.ticks, 1e-6);
        close(is.force_min, should.force_min, 1e-5);
    }
}

#[test]
fn a_block_of_ticks_is_so_many_ticks() {
    let programme = programme(&[
        Block::sine(0.1, 9.7, 4).unwrap(),
        Block::sine(0.05, 170.0, 40).unwrap(),
    ]);
    let (law, other) = (paper(3.0), paper(2.0));
    for size in [1, 7, 64, 1000] {
        let mut single = Simulation::new(programme.clone(), law.clone()).unwrap();
        let mut many = single.clone();
        let mut forces = vec![0.0; size];
        let mut ticks = 0;
        while !single.done() {
            if (3000..3000 + size).contains(&ticks) {
                single.swap_law(other.clone());
                many.swap_law(other.clone());
            }
            many.block(&mut forces);
            for force in &forces {
                assert_eq!(single.tick(), *force, "blocks of {size} from tick {ticks}");
            }
            ticks += size;
            assert_eq!(single.results(), many.results());
            assert_eq!((single.cycle(), single.ramp()), (many.cycle(), many.ramp()));
        }
    }
}

#[test]
fn another_law_takes_over_at_the_cycles_end() {
    let programme = programme(&[Block::sine(0.1, 9.7, 6).unwrap()]);
    let (law, other) = (paper(3.0), paper(2.0));
    // In the ramp; in a steady cycle; in the last one.
    for at in [500, 2500, 6900] {
        let swap = Some((at, &other));
        let (given, expected) = (ticks(&programme, &law, swap), parts(&programme, &law, swap));
        forces_agree(&given, &expected);
        for (is, should) in given.cycles.iter().zip(&expected.cycles) {
            // The parts draw a straight line from the old law's last force to the new one's first: half a tick in 1031 of the jump,
            // which is as large as the force.
            assert!((is.energy / should.energy - 1.0).abs() < 1e-3);
        }
    }
}

/// A table of 256 rows: at least one of two ticks fills the next row in order.
#[test]
fn it_says_while_its_table_is_filled() {
    let programme = programme(&[Block::sine(0.1, 9.7, 6).unwrap()]);
    let mut test = Simulation::new(programme, paper(3.0)).unwrap();
    assert!(test.filling());
    let filled_after = |test: &mut Simulation<4>| {
        let ticks = (0..2000).take_while(|_| {
            test.tick();
            test.filling()
        });
        ticks.count()
    };
    let ticks = filled_after(&mut test);
    assert!((255..=512).contains(&ticks), "{ticks}");
    test.swap_law(paper(2.0));
    assert!(!test.filling());
    while !test.filling() {
        test.tick();
    }
    let ticks = filled_after(&mut test);
    assert!((255..=512).contains(&ticks), "{ticks}");
}

/// Over the cycle k·y does no work, and c·|v|^α·sgn v does c·(Aω)^α·A·∫|cos|^(1+α) dφ: for α = 1, π·c·ω·A².
#[test]
fn the_energy_is_closed_form_however_the_ticks_fall() {
    for frequency in [1.0, 9.7, 31.4, 77.7, 300.0] {
        let law = tabulated(Law::new(2.0, 5.0, 0.01, 1.0).unwrap());
        let programme = programme(&[Block::sine(0.1, frequency, 7).unwrap()]);
        let given = ticks(&programme, &law, None);
        let exact = std::f64::consts::PI * 0.01 * std::f64::consts::TAU * frequency * 0.01;
        for cycle in &given.cycles[1..8] {
            let error = f64::from(cycle.energy) / exact - 1.0;
            // The requirement for the whole force: the elastic force also rounds, and is k1/(c·ω) times the damping force. In
            // addition, the two fractions of a tick at the ends, of third order in the tick.
            let omega = std::f64::consts::TAU * frequency;
            let allowed = 6e-7 * (1.0 + 2.0 / (0.01 * omega)) + (omega / RATE).powi(3);
            assert!(
                error.abs() < allowed,
                "{frequency} Hz: {error:e}, allowed {allowed:e}"
            );
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn any_law_and_frequency_are_what_their_parts_make_of_them(
        k1 in 0.0f32..10.0, k3 in 0.0f32..200.0, c in 0.0f32..1.0, alpha in 0.2f32..1.0,
        frequency in 5.0..600.0, amplitude in 0.01..0.3,
    ) {
        let programme = programme(&[Block::sine(amplitude, frequency, 3).unwrap()]);
        let law = tabulated(Law::new(k1, k3, c, alpha).unwrap());
        forces_agree(&ticks(&programme, &law, None), &parts(&programme, &law, None));
    }
}
