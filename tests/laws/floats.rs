//! The permitted difference between the crate's f32 and the paper's equations in f64: one table, with a derivation of each entry.
//!
//! The oracle is `mesh_damper_reference`, which shares no code with the crate.

use std::f64::consts::TAU;

use mesh_damper::cycle::CycleAccumulator;
use mesh_damper::effects::AugmentedLaw;
use mesh_damper::fast_law::FastLaw;
use mesh_damper::law::Law;
use mesh_damper::simulation::Simulation;
use mesh_damper::sine::{Block, Programme, SineGenerator};
use mesh_damper::table::PAPER;
use mesh_damper_reference::law::Coefficients;
use mesh_damper_reference::turn::sin_cos_of_turn;
use mesh_damper_reference::{dynamic_test, tables};

use crate::largest::Largest;

/// The table. `U` = 2⁻²⁴ is the largest relative error of one rounding to f32; between ½ and 1 it is at most ½·U.
mod tolerance {
    pub const U: f64 = 1.0 / (1u64 << 24) as f64;

    /// Position over amplitude. The generator's sine: a node and a sum, each rounded by ½·U, and a correction of
    /// at most π/512 with a few U of its own, 0.05·U. Then the amplitude's rounding and the product's.
    pub const POSITION: f64 = 3.05 * U;

    /// Velocity over ω·amplitude: the cosine as above; amplitude, ω, their product and the product with the cosine.
    pub const VELOCITY: f64 = 5.05 * U;

    /// Velocity over itself, wherever it is not 0. Near its zero the cosine is the rotation alone, 4·U. Around the next node it is up
    /// to 2·U of the node, 4·U of the rotation and the sum's 1·U; and 4·U for the scale as in [`VELOCITY`]. From |cos| = 0.02 on, a
    /// node and its rotation are at least 4:1, so that 1.33 + 1.33 + 1 + 4 = 7.7·U remains.
    pub const VELOCITY_RELATIVE: f64 = 11.0 * U;

    /// Acceleration over ω²·amplitude: the sine; amplitude, ω twice, three products.
    pub const ACCELERATION: f64 = 7.05 * U;

    /// Velocity in a sweep over the current ω·amplitude. f is a sum of positive terms: the chirp, the cycles to the lower end (2·U)
    /// and their product make 4·U, the sum 5·U. 2π (½·U) and its product make ω 6.5·U instead of the 1·U of [`VELOCITY`].
    pub const SWEEP_VELOCITY: f64 = VELOCITY + 5.5 * U;

    /// Acceleration in a sweep over the current √(ω⁴ + ω̇²)·amplitude. ω² sin: twice ω's 6.5·U, amplitude and three products, 17·U;
    /// ω̇ cos has less. By Cauchy–Schwarz their sum is within 17·U; sine and cosine add 1.05·√2·U, the sum 1·U.
    pub const SWEEP_ACCELERATION: f64 = 19.5 * U;

    /// Phase in units of 2⁻³² cycle: half a unit of rounding, and the remainder of n ticks with an error of 2⁻¹²⁸ a tick.
    pub const PHASE: f64 = 0.5 + 1e-9;

    /// |v|^α over itself, 5.04·U: `power::abs_pow` documents 4e-7, in which the logarithm counts α times, here at most 0.557.
    pub const POWER: f64 = 3e-7;

    /// A table's coefficient at a node over itself: one rounding of the printed decimal.
    pub const NODE: f64 = U;

    /// A coefficient between nodes over the largest of the four surrounding cells of its table. A density is rounded by 4·U, an
    /// amplitude by 0.25·U, and so is the node below. In units of a step (0.5 g/cm³, 0.05 mm) this is 16·U and 10·U, and a
    /// coefficient changes across a step by at most its largest cell. 6·U for the arithmetic.
    pub const INTERPOLATION: f64 = 32.0 * U;

    /// Force of a tick over the cycle's peak.
    ///
    /// Elastic part E: a displacement error of (2·|sin| + 1.05)·U amplitudes (see [`POSITION`]) times a slope of at most 3·E/y gives
    /// 6·U·E + 3.15·U·E(A); coefficients and arithmetic add 5·U·E. Damping part D: α ≤ 0.557 times 7.7·U (nearer to v = 0,
    /// α·11·U·0.02^α of its peak is less), [`POWER`], and a rounding each of c, α and the product give 12.34·U·D. The sum is rounded
    /// once. On every tick E + D is the force of that tick or of its mirror image, and E(A) is a force too. None of these exceeds the
    /// peak, so the bound is 12.34 + 3.15 + 1, which is 9.83e-7.
    pub const FORCE: f64 = 16.49 * U;

    /// Force over the cycle's peak, K, ΔW and the loss factor over themselves in a simulation: the requirement, and an observation
    /// over the 25 cells. If all parts were at their bounds, the sum would be larger: as in [`FORCE`], with the table's 4e-7 and the
    /// rotation's 2.2e-7 near v = 0.
    pub const SHORT: f64 = 6e-7;

    /// K over itself. Its extremes are forces, and their parts are independent: √(4.3² + 5.04² + 3.15² + 6) = 7.7·U. The amplitude
    /// and three operations make it √(7.7² + 3.05² + 3) = 8.5·U = 5.1e-7, with every part at its bound. The requirement is 1e-6.
    pub const STIFFNESS: f64 = 1e-6;

    /// Loss factor over itself. In ΔW every rounding that differs from tick to tick averages out. c, α, the power, the velocity's
    /// scale, the amplitude and the trapezoids, (2π/10⁴)²/6 = 1.1·U, remain: √(1 + 1 + 5.04² + 1.7² + 2² + 1.1²) = 6·U. W contains K
    /// and X0 squared, √(8.5² + 3.05²) = 9·U. Together √(6² + 9²) = 10.8·U = 6.4e-7. The requirement is 1e-6.
    pub const LOSS_FACTOR: f64 = 1e-6;

    /// ΔW over itself, by ∮F dy and by eq 5: twice the 6·U above.
    pub const ENERGY: f64 = 12.0 * U;
}

const _: () = assert!(tolerance::FORCE < 1e-6, "the figure that is asked for");

/// Ticks a second.
const TICK_RATE: f64 = 10_000.0;
/// Cycles a second over the table's cells, those of the paper's tests, and ticks for each cycle.
const FREQUENCY: f64 = 1.0;
const TICKS: usize = 10_000;

fn generator(amplitude: f64, frequency: f64, cycles: u32) -> SineGenerator<1> {
    let programme = Programme::new(TICK_RATE, 1)
        .and_then(|p| p.with(Block::sine(amplitude, frequency, cycles)?))
        .unwrap();
    SineGenerator::new(programme).unwrap()
}

/// Amplitude, the paper's law and the crate's, for every cell of Tables 6–9.
fn cells() -> impl Iterator<Item = (f64, Coefficients, Law<f32>)> {
    tables::cells().map(|(density, amplitude, law)| {
        let own = PAPER.lookup(density as f32, amplitude as f32);
        assert!(!own.clamped());
        (amplitude, law, own.law)
    })
}

/// Displacement and force of one cycle in f64, from phase 0 on.
fn exact_cycle(law: Coefficients, amplitude: f64) -> (Vec<f64>, Vec<f64>) {
    (0..TICKS as u64)
        .map(|n| {
            let (sin, cos) = sin_cos_of_turn(n, TICKS as u64);
            let y = amplitude * sin;
            (y, law.force(y, TAU * FREQUENCY * amplitude * cos))
        })
        .unzip()
}

#[test]
fn the_sine_stays_with_f64_over_a_million_cycles() {
    // 1234.5 cycles a second at 10 kHz: 2469/20000 of a cycle a tick, 20000 phases.
    let (amplitude, frequency) = (0.1, 1234.5);
    let omega = TAU * frequency;
    let mut generator = generator(amplitude, frequency, 1_000_000);
    let [
        mut position,
        mut velocity,
        mut relative,
        mut acceleration,
        mut phase,
    ] = [const { Largest(0.0) }; 5];
    let mut steady = 0_u64;
    for n in 0_u64.. {
        let excitation = generator.tick();
        if excitation.done {
            break;
        }
        if excitation.ramp {
            continue;
        }
        steady += 1;
        let turn = n * 2469;
        let (sin, cos) = sin_cos_of_turn(turn, 20_000);
        let v = f64::from(excitation.velocity) / (omega * amplitude);
        position.see(f64::from(excitation.displacement) / amplitude - sin);
        velocity.see(v - cos);
        if cos == 0.0 {
            assert_eq!(v, 0.0);
        } else {
            relative.see(v / cos - 1.0);
        }
        acceleration.see(f64::from(excitation.acceleration) / (omega * omega * amplitude) + sin);
        let units = (turn % 20_000) as f64 / 20_000.0 * 2_f64.powi(32);
        phase.see(f64::from(excitation.phase) - units);
    }
    // The ticks from cycle 1 to cycle 1,000,000, counted from 0.
    let first = |cycle: u64| (cycle * 20_000).div_ceil(2469);
    assert_eq!(steady, first(1_000_001) - first(1));
    position.check("position", tolerance::POSITION);
    velocity.check("velocity", tolerance::VELOCITY);
    relative.check("velocity over itself", tolerance::VELOCITY_RELATIVE);
    acceleration.check("acceleration", tolerance::ACCELERATION);
    phase.check("phase", tolerance::PHASE);
}

/// With k = (f₁ − f₀)/cycles: θ = f₀/k·(eᵏᵗ − 1), f = f₀·eᵏᵗ, y = A sin 2πθ. The ramp before it is one cycle of f₀, in whole ticks.
#[test]
fn a_sweep_stays_with_f64_up_and_down() {
    let amplitude = 0.1;
    for (low, high, cycles) in [(0.1, 100.0, 200), (1.0, 2500.0, 1000)] {
        for (from, to) in [(low, high), (high, low)] {
            let programme = Programme::<1>::new(TICK_RATE, 1)
                .and_then(|p| p.with(Block::sweep(amplitude, from, to, cycles)?))
                .unwrap();
            let mut generator = SineGenerator::new(programme).unwrap();
            let [mut position, mut velocity, mut acceleration] = [const { Largest(0.0) }; 3];
            let k = (to - from) / f64::from(cycles);
            let mut steady = 0_u64;
            for n in 0_u64.. {
                let excitation = generator.tick();
                if excitation.done {
                    break;
                }
                if excitation.ramp {
                    continue;
                }
                steady += 1;
                let time = (n as f64 - TICK_RATE / from) / TICK_RATE;
                let travelled = from / k * (k * time).exp_m1();
                let omega = TAU * from * (k * time).exp();
                let rate = k * omega;
                let (sin, cos) = (TAU * travelled.fract()).sin_cos();
                let [y, v, a] = [
                    excitation.displacement,
                    excitation.velocity,
                    excitation.acceleration,
                ]
                .map(|value| f64::from(value) / amplitude);
                position.see(y - sin);
                velocity.see(v / omega - cos);
                let peak = (omega * omega).hypot(rate);
                acceleration.see((a + omega * omega * sin - rate * cos) / peak);
            }
            let seconds = (to / from).ln() / k;
            assert!((steady as f64 - seconds * TICK_RATE).abs() <= 1.0);
            let name = |what| format!("{what} in {cycles} cycles from {from} to {to} Hz");
            position.check(&name("position"), tolerance::POSITION);
            velocity.check(&name("velocity"), tolerance::SWEEP_VELOCITY);
            acceleration.check(&name("acceleration"), tolerance::SWEEP_ACCELERATION);
        }
    }
}

#[test]
fn the_table_is_the_papers() {
    let parts = |law: Law<f32>| [law.k1(), law.k3(), law.c(), law.alpha()].map(f64::from);
    let exact = |law: Coefficients| [law.k1, law.k3, law.c, law.alpha];
    let mut node = Largest::default();
    for (_, law, own) in cells() {
        for (own, exact) in parts(own).into_iter().zip(exact(law)) {
            node.see(own / exact - 1.0);
        }
    }
    node.check("coefficient at a node", tolerance::NODE);

    let mut between = Largest::default();
    for (row, column) in (0..4).flat_map(|row| (0..4).map(move |column| (row, column))) {
        let corners = [(0, 0), (0, 1), (1, 0), (1, 1)]
            .map(|(down, across)| exact(tables::cell(row + down, column + across)));
        for step in 0..=256 {
            let density = tables::DENSITIES[column] + 0.5 * f64::from(step % 16) / 16.0;
            let amplitude = tables::AMPLITUDES[row] + 0.05 * f64::from(step / 16) / 16.0;
            let own = parts(PAPER.lookup(density as f32, amplitude as f32).law);
            let law = exact(tables::interpolate(density, amplitude));
            for k in 0..4 {
                let largest = corners.iter().fold(0.0_f64, |m, cell| m.max(cell[k]));
                between.see((own[k] - law[k]) / largest);
            }
        }
    }
    between.check("coefficient between nodes", tolerance::INTERPOLATION);
}

/// |v|^α with the α and over the speeds of the table's cells, 0.05…0.25 mm at 1 to 10 Hz.
#[test]
fn the_power_is_f64s() {
    let mut power = Largest::default();
    for (_, law, own) in cells() {
        let alpha = own.alpha();
        let unit = Law::new(0.0, 0.0, 1.0, alpha).unwrap();
        for i in 0..5000 {
            let v = (1e-6 * 1.6e7_f64.powf(f64::from(i) / 5000.0)) as f32;
            power.see(f64::from(unit.damping_force(v)) / f64::from(v).powf(f64::from(alpha)) - 1.0);
        }
        assert!((f64::from(alpha) / law.alpha - 1.0).abs() <= tolerance::NODE);
    }
    power.check("|v|^α", tolerance::POWER);
}

#[test]
fn the_force_of_every_tick_is_f64s_within_a_millionth_of_its_peak() {
    let mut worst = Largest::default();
    for (amplitude, law, own) in cells() {
        let (_, exact) = exact_cycle(law, amplitude);
        let peak = exact.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
        let mut generator = generator(amplitude, FREQUENCY, 2);
        let mut steady = 0;
        // The ramp is one cycle: its ticks also count from phase 0.
        for n in 0.. {
            let excitation = generator.tick();
            if excitation.done {
                break;
            }
            if !excitation.ramp {
                let force = own.force(excitation.displacement, excitation.velocity);
                worst.see((f64::from(force) - exact[n % TICKS]) / peak);
                steady += 1;
            }
        }
        assert_eq!(steady, 2 * TICKS);
    }
    worst.check("force", tolerance::FORCE);
}

#[test]
fn stiffness_and_loss_factor_of_every_cycle_are_f64s_within_a_millionth() {
    let [mut stiffness, mut loss_factor, mut harmonic, mut energy] = [const { Largest(0.0) }; 4];
    for (amplitude, law, own) in cells() {
        let (y, force) = exact_cycle(law, amplitude);
        let exact = dynamic_test::characterize(&y, &force).unwrap();
        let mut generator = generator(amplitude, FREQUENCY, 3);
        let mut accumulator = CycleAccumulator::new();
        let mut cycles = 0;
        loop {
            let excitation = generator.tick();
            if excitation.done {
                break;
            }
            let force = own.force(excitation.displacement, excitation.velocity);
            let report = accumulator.update(excitation.displacement, [force], excitation.phase);
            // Complete on the first tick after it: cycle 0 is the ramp, 1 to 3 are the block's.
            if let (Some([cycle]), 2..=4) = (report, excitation.cycle) {
                stiffness.see(f64::from(cycle.stiffness) / exact.stiffness - 1.0);
                loss_factor.see(f64::from(cycle.loss_factor) / exact.loss_factor - 1.0);
                harmonic.see(f64::from(cycle.energy_harmonic) / exact.dissipated - 1.0);
                energy.see(f64::from(cycle.energy) / exact.dissipated - 1.0);
                cycles += 1;
            }
        }
        assert_eq!(cycles, 3);
    }
    stiffness.check("K", tolerance::STIFFNESS);
    loss_factor.check("loss factor", tolerance::LOSS_FACTOR);
    harmonic.check("ΔW by eq 5", tolerance::ENERGY);
    energy.check("ΔW by ∮F dy", tolerance::ENERGY);
}

/// The same by the simulation's short cut: the force of every tick, and K, ΔW and η of every cycle.
#[test]
fn the_virtual_test_is_f64s_within_six_tenths_of_a_millionth() {
    let [mut worst, mut stiffness, mut loss_factor, mut energy] = [const { Largest(0.0) }; 4];
    for (amplitude, law, own) in cells() {
        let (y, exact) = exact_cycle(law, amplitude);
        let peak = exact.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
        let cycle = dynamic_test::characterize(&y, &exact).unwrap();
        let programme = Programme::<1>::new(TICK_RATE, 1)
            .and_then(|p| p.with(Block::sine(amplitude, FREQUENCY, 3)?))
            .unwrap();
        let law = FastLaw::new(AugmentedLaw::new(own));
        let mut test = Simulation::new(programme, law).unwrap();
        for n in 0..=4 * TICKS {
            let force = f64::from(test.tick());
            if test.ramp() {
                continue;
            }
            worst.see((force - exact[n % TICKS]) / peak);
            // The first results are those of the ramp.
            if let (2.., own) = test.results() {
                stiffness.see(f64::from(own.stiffness) / cycle.stiffness - 1.0);
                loss_factor.see(f64::from(own.loss_factor) / cycle.loss_factor - 1.0);
                energy.see(f64::from(own.energy) / cycle.dissipated - 1.0);
            }
        }
        assert_eq!(test.results().0, 4);
    }
    worst.check("force", tolerance::SHORT);
    stiffness.check("K", tolerance::SHORT);
    energy.check("ΔW", tolerance::SHORT);
    loss_factor.check("loss factor", tolerance::SHORT);
}
