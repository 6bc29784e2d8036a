//! The excitation against closed forms.

use core::f64::consts::TAU;
use mesh_damper::error::ConfigError;
use mesh_damper::sine::{Block, Excitation, Programme, SineGenerator, sin_cos};
use proptest::prelude::*;

fn generator<const N: usize>(tick_rate: f64, ramp: u32, blocks: [Block; N]) -> SineGenerator<N> {
    let programme = blocks
        .into_iter()
        .try_fold(Programme::new(tick_rate, ramp).unwrap(), Programme::with)
        .unwrap();
    SineGenerator::new(programme).unwrap()
}

fn whole_run<const N: usize>(generator: &mut SineGenerator<N>) -> Vec<Excitation> {
    let mut ticks = Vec::new();
    loop {
        let tick = generator.tick();
        ticks.push(tick);
        if tick.done {
            return ticks;
        }
    }
}

fn three_blocks() -> [Block; 3] {
    [
        Block::sine(0.1, 5.0, 3).unwrap(),
        Block::sine(0.25, 2.0, 2).unwrap(),
        Block::sine(0.05, 17.3, 4).unwrap(),
    ]
}

#[test]
fn sine_and_cosine_are_within_1e_7_everywhere() {
    let step = (1u64 << 44) + 0x9_1234_5678;
    let mut phase = 0u64;
    loop {
        let (sin, cos) = sin_cos(phase);
        // A cycle has 2⁶⁴ units of phase; f64 resolves 2⁻⁵³ of it.
        let angle = phase as f64 / 2f64.powi(64) * TAU;
        assert!((f64::from(sin) - angle.sin()).abs() < 1e-7, "sin {phase}");
        assert!((f64::from(cos) - angle.cos()).abs() < 1e-7, "cos {phase}");
        let Some(next) = phase.checked_add(step) else {
            break;
        };
        phase = next;
    }
}

#[test]
fn sine_and_cosine_keep_their_relative_accuracy_at_the_zero_crossings() {
    for quarter in 0..4u64 {
        let zero = quarter << 62;
        for shift in 24..54 {
            for offset in [3u64 << shift, (3u64 << shift).wrapping_neg()] {
                let (sin, cos) = sin_cos(zero.wrapping_add(offset));
                let small = if quarter % 2 == 0 { sin } else { cos };
                let sign = if quarter % 2 == 1 { -1.0 } else { 1.0 }
                    * if quarter >= 2 { -1.0 } else { 1.0 };
                let exact = sign * (offset as i64 as f64 / 2f64.powi(64) * TAU).sin();
                let error = (f64::from(small) - exact).abs();
                assert!(
                    error < (2e-7 * exact.abs()).max(1e-11),
                    "{quarter} {shift}: {small} for {exact}"
                );
            }
        }
        let (sin, cos) = sin_cos(zero);
        let exact = [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)][quarter as usize];
        assert_eq!((sin, cos), exact);
    }
}

/// Phase after n ticks of p/q cycles each, in units of 2⁻³² cycle, rounded to nearest.
fn exact_phase(n: u128, p: u128, q: u128) -> u32 {
    ((((n * p % q) << 33) / q).div_ceil(2)) as u32
}

#[test]
fn the_phase_stays_on_the_exact_rational_for_a_million_cycles() {
    // (frequency, tick rate) that floats represent exactly, and their quotient p/q.
    for (frequency, tick_rate, p, q) in [(1234.5, 10_007.0, 2469, 20_014), (7.0, 64.0, 7, 64)] {
        let cycles = 1_000_000;
        let mut generator = generator(tick_rate, 1, [Block::sine(1.0, frequency, cycles).unwrap()]);
        let mut n = 0u128;
        loop {
            let tick = generator.tick();
            if tick.done {
                break;
            }
            // One frequency throughout: the ramps count as well. Rounding to nearest leaves half a unit, and the increment 2⁻³² of a
            // unit.
            let exact = exact_phase(n, p, q);
            assert!(
                tick.phase.wrapping_sub(exact).wrapping_add(1) <= 2,
                "tick {n}: {} {exact}",
                tick.phase
            );
            n += 1;
        }
        // Exactly the cycles and two ramps of one cycle each.
        assert_eq!(
            n,
            (u128::from(cycles) + 2) * q / p + u128::from((u128::from(cycles) + 2) * q % p != 0)
        );
    }
}

#[test]
fn a_decimal_frequency_ends_its_cycles_on_the_ticks_it_says() {
    // 0.7 Hz has no exact binary representation: its cycles still end on the ticks of the decimal number.
    let mut generator = generator(70.0, 1, [Block::sine(1.0, 0.7, 20_000).unwrap()]);
    let mut ends = 0u64;
    for n in 0u64.. {
        let tick = generator.tick();
        if tick.cycle_end {
            ends += 1;
            assert_eq!(n, ends * 100);
        }
        if tick.done {
            assert_eq!(ends, 20_002);
            break;
        }
    }
}

#[test]
fn a_steady_block_is_the_exact_sine() {
    let (amplitude, frequency, rate) = (0.2, 7.3, 10_000.0);
    let mut generator = generator(rate, 2, [Block::sine(amplitude, frequency, 50).unwrap()]);
    let omega = TAU * frequency;
    for (n, tick) in whole_run(&mut generator).iter().enumerate() {
        if tick.ramp || tick.done {
            continue;
        }
        let angle = (n as f64 * frequency / rate).fract() * TAU;
        let near = |value: f32, exact: f64, peak: f64| {
            // 1e-7 of the sine, and two roundings of the factors.
            assert!(
                (f64::from(value) - exact).abs() < 3e-7 * peak,
                "tick {n}: {value} {exact}"
            );
        };
        near(tick.displacement, amplitude * angle.sin(), amplitude);
        near(
            tick.velocity,
            amplitude * omega * angle.cos(),
            amplitude * omega,
        );
        near(
            tick.acceleration,
            -amplitude * omega * omega * angle.sin(),
            amplitude * omega * omega,
        );
    }
}

#[test]
fn a_block_gives_its_cycles_at_full_amplitude_between_ramps_of_whole_cycles() {
    let blocks = three_blocks();
    let ticks = whole_run(&mut generator(10_000.0, 2, blocks));
    for (index, block) in blocks.iter().enumerate() {
        let steady: Vec<_> = ticks
            .iter()
            .filter(|t| t.block == index && !t.ramp && !t.done)
            .collect();
        let seconds = f64::from(block.cycles()) / block.from();
        assert!((steady.len() as f64 - seconds * 10_000.0).abs() <= 1.0);
        let first = steady.first().unwrap().cycle;
        let last = steady.last().unwrap().cycle;
        assert_eq!(last - first + 1, block.cycles());
        for cycle in first..=last {
            let of_cycle = steady.iter().filter(|t| t.cycle == cycle);
            let peak = of_cycle.map(|t| t.displacement.abs()).fold(0.0, f32::max);
            // The extreme lies within half a tick of a sample: (π·17.3/10⁴)²/2 = 1.5e-5.
            assert!(
                (f64::from(peak) / block.amplitude() - 1.0).abs() < 2e-5,
                "{peak}"
            );
        }
    }
    let (ramps, cycles) = (4 * 2, 3 + 2 + 4);
    let last = ticks.last().unwrap();
    assert!(last.done && last.cycle_end);
    assert_eq!(last.cycle, ramps + cycles);
    assert_eq!(
        ticks.iter().filter(|t| t.cycle_end).count() as u32,
        ramps + cycles
    );
}

#[test]
fn duration_is_the_time_that_it_takes() {
    let blocks = [
        Block::sine(0.1, 5.0, 3).unwrap(),
        Block::sweep(0.1, 2.0, 40.0, 60).unwrap(),
        Block::sweep(0.3, 30.0, 3.0, 20).unwrap(),
    ];
    let mut generator = generator(10_000.0, 2, blocks);
    let seconds = generator.programme().duration();
    let ticks = whole_run(&mut generator).len() - 1;
    assert!(
        (ticks as f64 / 10_000.0 - seconds).abs() <= 1e-4,
        "{ticks} {seconds}"
    );
}

#[test]
fn the_cycle_ends_where_the_phase_wraps() {
    let ticks = whole_run(&mut generator(1_000.0, 1, three_blocks()));
    for pair in ticks.windows(2) {
        assert_eq!(pair[1].cycle_end, pair[1].phase < pair[0].phase);
        assert_eq!(pair[1].cycle - pair[0].cycle, u32::from(pair[1].cycle_end));
    }
}

/// The derivatives against the positions, over every kind of segment and every boundary between them.
///
/// From tick to tick y grows by h/2·(v₀ + v₁) − h²/12·(a₁ − a₀), with an error of h⁵/720·y⁽⁵⁾ (Hermite's quadrature). At a boundary
/// within the tick, a jumps by up to a·2π·k·f, which leaves an error of at most h² of it in y, once.
fn check_derivatives<const N: usize>(tick_rate: f64, ramp: u32, blocks: [Block; N]) {
    let mut generator = generator(tick_rate, ramp, blocks);
    let ticks = whole_run(&mut generator);
    let h = 1.0 / tick_rate;
    let amplitude = blocks.iter().map(Block::amplitude).fold(0.0, f64::max);
    let top = blocks
        .iter()
        .map(|b| b.from().max(b.to()))
        .fold(0.0, f64::max);
    let omega = TAU * top;
    let fifth = h.powi(5) * omega.powi(5) * amplitude * 8.0 / 720.0;
    let mut position = 0.0;
    for (n, pair) in ticks.windows(2).enumerate() {
        let [a, b] = [&pair[0], &pair[1]];
        let v = |t: &Excitation| f64::from(t.velocity);
        let grown =
            h / 2.0 * (v(a) + v(b)) - h * h / 12.0 * f64::from(b.acceleration - a.acceleration);
        let is = f64::from(b.displacement) - f64::from(a.displacement);
        // Rounding: each position within 3e-7 of the amplitude, and the velocities to the same fraction.
        let rounding = amplitude * (6e-7 + 6e-7 * omega * h);
        let boundary = a.ramp != b.ramp || a.block != b.block || b.done;
        let jump = if boundary {
            amplitude * omega * top * h * h
        } else {
            0.0
        };
        assert!(
            (is - grown).abs() < rounding + fifth + jump,
            "tick {n}: {is} {grown} {a:?} {b:?}"
        );
        // The velocity by the trapezoidal rule, with an error of h³/12·y⁽⁴⁾, in a ramp up to 16 times the sine's; and at a boundary
        // the jump of the acceleration.
        let fourth = h.powi(3) / 12.0 * 16.0 * omega.powi(4) * amplitude;
        let jump = if boundary {
            amplitude * omega * 2.0 * top * h
        } else {
            0.0
        };
        let gained = h / 2.0 * (f64::from(a.acceleration) + f64::from(b.acceleration));
        let rounding = amplitude * omega * (6e-7 + 6e-7 * omega * h);
        assert!(
            (v(b) - v(a) - gained).abs() < rounding + fourth + jump,
            "tick {n}: {a:?} {b:?}"
        );
        position += grown;
        // Over the whole run: rounding errors of v accumulate at random, at worst n·h·ω·a·3e-7.
        let drift = (n + 1) as f64 * (h * omega * amplitude * 3e-7 + fifth);
        let jumps = amplitude * omega * top * h * h * (2 * N + 2) as f64;
        assert!((position - f64::from(b.displacement)).abs() < drift + jumps + 3e-7 * amplitude);
    }
    let last = ticks.last().unwrap();
    assert_eq!(
        (
            last.displacement,
            last.velocity,
            last.acceleration,
            last.phase
        ),
        (0.0, 0.0, 0.0, 0)
    );
    let first = ticks.first().unwrap();
    assert_eq!((first.displacement, first.velocity), (0.0, 0.0));
}

#[test]
fn velocity_and_acceleration_are_the_derivatives() {
    check_derivatives(10_000.0, 1, three_blocks());
    check_derivatives(1_000.0, 3, three_blocks());
    check_derivatives(
        10_000.0,
        1,
        [
            Block::sweep(0.1, 1.0, 100.0, 200).unwrap(),
            Block::sine(0.3, 4.0, 2).unwrap(),
            Block::sweep(0.2, 50.0, 0.5, 30).unwrap(),
        ],
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn any_programme_is_smooth(
        blocks in prop::array::uniform3((0.01f64..1.0, 0.5f64..50.0, 0.5f64..50.0, 1u32..6, any::<bool>())),
        ramp in 1u32..4,
    ) {
        check_derivatives(5_000.0, ramp, blocks.map(|(amplitude, from, to, cycles, sweep)| {
            if sweep {
                Block::sweep(amplitude, from, to, cycles).unwrap()
            } else {
                Block::sine(amplitude, from, cycles).unwrap()
            }
        }));
    }
}

#[test]
fn a_sweep_is_logarithmic_in_time() {
    for (from, to, cycles, rate) in [
        (2.3, 60.0, 500, 10_000.0),
        (2.3, 20.0, 20, 100.0),
        (20.0, 2.3, 9, 100.0),
    ] {
        let ticks = whole_run(&mut generator(
            rate,
            1,
            [Block::sweep(0.1, from, to, cycles).unwrap()],
        ));
        let k = (to - from) / f64::from(cycles);
        for (n, tick) in ticks.iter().enumerate().filter(|(_, t)| !t.ramp && !t.done) {
            // One cycle of ramp at the first frequency comes before; the sweep begins within a tick.
            let time = n as f64 / rate - 1.0 / from;
            let theta = from / k * (k * time).exp_m1();
            let is = f64::from(tick.cycle - 1) + f64::from(tick.phase) / 2f64.powi(32);
            // The error of the step across the boundary, k²·f·h³/6 cycles, grows with the frequency. The phase is rounded to 2⁻³³,
            // e^(kh) − 1 to 2⁻⁶⁵.
            let third = k * k * from * rate.powi(-3) / 6.0 * (to / from).max(1.0);
            assert!((is - theta).abs() < third + 2e-10, "{n}: {is} {theta}");
        }
    }
}

#[test]
fn it_holds_at_zero_when_done_and_restarts_alike() {
    let mut generator = generator(1_000.0, 1, three_blocks());
    let first = whole_run(&mut generator);
    for _ in 0..10 {
        let held = generator.tick();
        let last = first.last().unwrap();
        assert_eq!(
            held,
            Excitation {
                cycle_end: false,
                ..*last
            }
        );
    }
    generator.restart();
    assert_eq!(whole_run(&mut generator), first);
}

#[test]
fn what_makes_no_sense_is_refused() {
    let field = |result: Result<Block, ConfigError>| match result {
        Err(ConfigError::NonFinite(field)) | Err(ConfigError::OutOfRange { field, .. }) => field,
        other => panic!("{other:?}"),
    };
    for bad in [0.0, -0.1, f64::NAN, f64::INFINITY, 1e5] {
        assert_eq!(field(Block::sine(bad, 1.0, 1)), "amplitude");
    }
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e7] {
        assert_eq!(field(Block::sine(0.1, bad, 1)), "frequency");
        assert_eq!(field(Block::sweep(0.1, bad, 1.0, 1)), "from");
        assert_eq!(field(Block::sweep(0.1, 1.0, bad, 1)), "to");
    }
    assert_eq!(field(Block::sine(0.1, 1.0, 0)), "cycles");
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e7] {
        assert!(Programme::<1>::new(bad, 1).is_err());
    }
    assert!(Programme::<1>::new(1_000.0, 0).is_err());
    let programme = Programme::<1>::new(1_000.0, 1).unwrap();
    let too_fast = programme.clone().with(Block::sine(0.1, 251.0, 1).unwrap());
    assert!(matches!(
        too_fast,
        Err(ConfigError::OutOfRange {
            field: "frequency",
            high: 250.0,
            ..
        })
    ));
    let too_fast = programme
        .clone()
        .with(Block::sweep(0.1, 1.0, 251.0, 1).unwrap());
    assert!(matches!(
        too_fast,
        Err(ConfigError::OutOfRange { field: "to", .. })
    ));
    assert_eq!(
        SineGenerator::new(programme.clone()).unwrap_err(),
        ConfigError::Empty("blocks")
    );
    let full = programme.with(Block::sine(0.1, 250.0, 1).unwrap()).unwrap();
    let over = full.with(Block::sine(0.1, 1.0, 1).unwrap());
    assert_eq!(
        over,
        Err(ConfigError::Full {
            field: "blocks",
            capacity: 1
        })
    );
}
