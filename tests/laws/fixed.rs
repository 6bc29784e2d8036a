//! The law in integers against f64: every force, saturation, and the refused settings.

mod cycles;
mod sine;

use std::f64::consts::TAU;

use mesh_damper::error::ConfigError;
use mesh_damper::fixed_point::{
    Cycle, CycleAccumulator, Law, Part, RAMP_CYCLES_MAX, Scales, Sine, SineGenerator,
};
use mesh_damper::law;
use mesh_damper_reference::law::Coefficients;
use mesh_damper_reference::tables;
use proptest::prelude::*;

use crate::largest::Largest;

/// Tolerances of the integers against f64.
mod tolerance {
    /// One rounding of 16 bits.
    const R: f64 = 1.0 / (1u32 << 17) as f64;

    /// sin and cos. Two terms of Taylor's series leave out (π/256)³/6 = 3.1e-7. The angle is rounded down twice, by less than 4.3e-7
    /// in all. The mean slope, rounded three times by less than 2⁻¹⁵, acts over at most π/256. Where an error of the angle counts in
    /// full, an error of the other's slope does not: √(4.3² + 11.2²)·1e-7 = 1.2e-6.
    pub const SINE: f64 = 1.6e-6;

    /// Position over amplitude: the sine, and the amplitude's 16 bits, rounded by at most one part in 2¹⁶.
    pub const POSITION: f64 = SINE + 2.0 * R;

    /// Force over full scale. Elastic: stiffness and y² each rounded to 16 bits. Damping: the quadratics are within
    /// α(1−α)(2−α)/6·(1/8)³·8^(−α)/32 = 2.5e-6 of it, their slope and curvature within 2⁻²¹ each, the place in a segment
    /// within 2⁻¹⁶ of 0.022, and below ⅛ the power of 8 is rounded to 16 bits. In all 3·R + 4e-6.
    pub const FORCE: f64 = 3.0 * R + 4e-6;

    /// Full scale of displacement and velocity over the amplitudes, in the tests of the paper's cells.
    pub const SCALE: f64 = 1.1;

    /// Full scale of force over the cycle's peak. The full scale is the sum of the largest elastic and the largest damping force at
    /// 1.1 times the amplitude, at most 1.1³ times those at the amplitude. Neither of these exceeds the peak.
    const OVER_PEAK: f64 = 2.0 * SCALE * SCALE * SCALE;

    /// Force of a tick over the cycle's peak: its own error; the position's times a slope of at most 3·F/y; the speed's 16 bits; and
    /// the cosine's error δ = 5e-7 within π/256 of its zero, where only the slope counts. At |cos| ≥ 0.001 this is α·δ·|cos|^(α−1),
    /// at most 0.145·δ·1000^0.855 = 2.7e-5.
    pub const TICK: f64 = FORCE * OVER_PEAK + 3.0 * POSITION + 2.0 * R + 2.7e-5;
    pub const TICK_FROM: f64 = 1e-3;

    /// K over itself: the force's error at the extremes, 7.2e-5 of the peak. The amplitude's 2·R is independent of it; it counts
    /// twice in the cubic term, less once in K. √(7.2² + 3²)·1e-5 = 8e-5. The requirement is 1e-4.
    pub const STIFFNESS: f64 = 1e-4;
    /// ΔW over itself. Every rounding that differs from tick to tick averages out. The amplitude's 2·R, α times the speed's, and the
    /// quadratics' 4e-6 remain, 2.8e-5. The trapezoids at 1000 ticks a cycle add (2π/1000)²/6 = 6.6e-6. The requirement is 1e-4.
    pub const ENERGY: f64 = 4e-5;
    /// Loss factor over itself: √(8² + 4²)·1e-5 = 9e-5 from the two above. The requirement is 1e-4.
    pub const LOSS_FACTOR: f64 = 1e-4;
}

/// Ticks a second.
const TICK_RATE: f64 = 10_000.0;

fn value(part: Part) -> f64 {
    part.to_num()
}

fn law_of(c: Coefficients) -> law::Law<f64> {
    law::Law::new(c.k1, c.k3, c.c, c.alpha).unwrap()
}

fn generator(sine: Sine, scales: &Scales) -> SineGenerator {
    SineGenerator::new(sine, TICK_RATE, scales).unwrap()
}

/// The complete cycles at full amplitude of law, generator and accumulator.
fn cycles_of(law: &law::Law<f64>, scales: &Scales, sine: Sine) -> Vec<Cycle> {
    let own = Law::new(law, scales).unwrap();
    let mut generator = generator(sine, scales);
    let mut accumulator = CycleAccumulator::new();
    let mut cycles = Vec::new();
    while let Some(now) = generator.tick() {
        let force = own.force(now.displacement, now.velocity);
        let cycle = accumulator.update(now.displacement, force, now.cycle_end);
        // A cycle is complete on the first tick after it.
        let after_ramp = sine.ramp_cycles + 1..=sine.ramp_cycles + sine.cycles;
        if let (Some(cycle), true) = (cycle, after_ramp.contains(&now.cycle)) {
            cycles.push(cycle.over(scales));
        }
    }
    cycles
}

#[test]
fn the_force_of_every_tick_is_f64s() {
    let [mut near, mut worst] = [const { Largest(0.0) }; 2];
    for (_, amplitude, exact) in tables::cells() {
        for frequency in [1.0, 1.37, 10.0] {
            let speed = TAU * frequency * amplitude;
            let law = law_of(exact);
            let scale = tolerance::SCALE;
            let scales = Scales::covering(&law, scale * amplitude, scale * speed).unwrap();
            let own = Law::new(&law, &scales).unwrap();
            let sine = Sine {
                amplitude,
                frequency,
                cycles: 3,
                ramp_cycles: 1,
            };
            let peak = (0..1000)
                .map(|i| (TAU * f64::from(i) / 1000.0).sin_cos())
                .map(|(sin, cos)| exact.force(amplitude * sin, speed * cos))
                .fold(0.0, f64::max);
            let mut generator = generator(sine, &scales);
            for n in 0.. {
                let Some(now) = generator.tick() else { break };
                if now.ramp {
                    continue;
                }
                let force = value(own.force(now.displacement, now.velocity)) * scales.force();
                let (sin, cos) = (TAU * (f64::from(n) * frequency / TICK_RATE).fract()).sin_cos();
                let error = (force - exact.force(amplitude * sin, speed * cos)) / peak;
                if cos.abs() >= tolerance::TICK_FROM {
                    worst.see(error);
                } else if cos.abs() > 1e-9 {
                    near.see(error);
                }
            }
        }
    }
    worst.check("force", tolerance::TICK);
    // δ^α: a tick within δ of a reversal would have an error of up to a tenth of the damping. These ticks are not that close.
    near.check("force next to a reversal", 1e-3);
}

#[test]
fn configurations_out_of_range_are_refused_by_name() {
    let law = law::Law::new(1.0, 10.0, 0.1, 0.3).unwrap();
    let refused = |error: ConfigError| match error {
        ConfigError::NonFinite(field) | ConfigError::OutOfRange { field, .. } => field,
        other => panic!("{other}"),
    };
    for bad in [f64::NAN, f64::INFINITY, 0.0, -1.0, 1e30] {
        for (field, scales) in [
            ("displacement", Scales::new(bad, 1.0, 1.0)),
            ("velocity", Scales::new(1.0, bad, 1.0)),
            ("force", Scales::new(1.0, 1.0, bad)),
            ("displacement", Scales::covering(&law, bad, 1.0)),
            ("velocity", Scales::covering(&law, 1.0, bad)),
        ] {
            assert_eq!(refused(scales.unwrap_err()), field);
        }
    }
    // Full scale exceeds |k1|·Y + |k3|·Y³ + c·V^α by the same factor for any law.
    let full = |k1, k3, c| {
        let law = law::Law::new(k1, k3, c, 0.5).unwrap();
        Scales::covering(&law, 0.5, 4.0).unwrap().force()
    };
    let headroom = full(2.0, 0.0, 0.0);
    for (force, largest) in [
        (full(0.0, -8.0, 0.0), 1.0),
        (full(0.0, 0.0, 3.0), 6.0),
        (full(-2.0, 16.0, 0.5), 4.0),
    ] {
        assert!((force / headroom - largest).abs() < 1e-12, "{force}");
    }
    let scales = Scales::covering(&law, 0.3, 2.0).unwrap();
    assert!(Law::new(&law, &scales).is_ok());
    let less = Scales::new(0.3, 2.0, scales.force() * 0.9999).unwrap();
    assert_eq!(refused(Law::new(&law, &less).unwrap_err()), "force");

    let good = Sine {
        amplitude: 0.1,
        frequency: 1.0,
        cycles: 1,
        ramp_cycles: 1,
    };
    let refusal = |sine| refused(SineGenerator::new(sine, TICK_RATE, &scales).unwrap_err());
    for amplitude in [f64::NAN, -0.1, 0.3] {
        assert_eq!(refusal(Sine { amplitude, ..good }), "amplitude");
    }
    for frequency in [f64::NAN, 0.0, 2501.0] {
        assert_eq!(refusal(Sine { frequency, ..good }), "frequency");
    }
    let fast = Sine {
        frequency: 4.0,
        ..good
    };
    assert_eq!(refusal(fast), "velocity");
    assert_eq!(refusal(Sine { cycles: 0, ..good }), "cycles");
    for ramp_cycles in [0, RAMP_CYCLES_MAX + 1] {
        let sine = Sine {
            ramp_cycles,
            ..good
        };
        assert_eq!(refusal(sine), "ramp_cycles");
    }
    for tick_rate in [f64::NAN, 0.5, 2e6] {
        let error = SineGenerator::new(good, tick_rate, &scales).unwrap_err();
        assert_eq!(refused(error), "tick_rate");
    }
}

#[test]
fn a_value_beyond_full_scale_is_saturated() {
    let scales = Scales::new(0.5, 2.0, 8.0).unwrap();
    for beyond in [1e300, f64::INFINITY, 8.0] {
        assert_eq!(scales.displacement_part(beyond), Part::MAX);
        assert_eq!(scales.velocity_part(beyond), Part::MAX);
        assert_eq!(scales.force_part(beyond), Part::MAX);
        assert_eq!(scales.displacement_part(-beyond), Part::MIN);
    }
    assert_eq!(scales.force_part(f64::NAN), Part::ZERO);
    assert_eq!(scales.displacement_part(0.25).to_bits(), 1 << 30);
    assert_eq!(scales.velocity_part(-1.0).to_bits(), -1 << 30);
    assert_eq!(scales.force_part(1.0).to_bits(), 1 << 28);
}

/// Any permitted values, including the ends of the range and the smallest parts.
fn part() -> impl Strategy<Value = Part> {
    prop_oneof![
        any::<i32>(),
        (any::<i32>(), 0_u32..31).prop_map(|(bits, shift)| bits >> shift),
        prop::sample::select(vec![i32::MIN, i32::MIN + 1, -1, 0, 1, i32::MAX]),
    ]
    .prop_map(Part::from_bits)
}

/// Laws whose parts have different weights at full scale, with stiffnesses of either sign.
fn coefficients() -> impl Strategy<Value = law::Law<f64>> {
    (-10.0..10.0, -200.0..200.0, 0.0..1.0, 0.0..=1.0)
        .prop_map(|(k1, k3, c, alpha)| law::Law::new(k1, k3, c, alpha).unwrap())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Nothing overflows, which would panic in this profile, and nothing reaches full scale.
    #[test]
    fn every_force_is_f64s(
        law in coefficients(),
        displacement in 0.01..1.0,
        velocity in 0.01..100.0,
        y in part(),
        v in part(),
    ) {
        let scales = Scales::covering(&law, displacement, velocity).unwrap();
        let force = value(Law::new(&law, &scales).unwrap().force(y, v));
        let exact = Coefficients { k1: law.k1(), k3: law.k3(), c: law.c(), alpha: law.alpha() }
            .force(value(y) * displacement, value(v) * velocity)
            / scales.force();
        prop_assert!((force - exact).abs() <= tolerance::FORCE, "{force} for {exact}");
        prop_assert!(force.abs() < 1.0);
    }

    /// The damping never drives the motion, down to the smallest velocity.
    #[test]
    fn damping_opposes_every_motion(alpha in 0.0..=1.0, v in part()) {
        let law = law::Law::new(0.0, 0.0, 1.0, alpha).unwrap();
        let scales = Scales::covering(&law, 1.0, 1.0).unwrap();
        let force = Law::new(&law, &scales).unwrap().force(Part::ZERO, v);
        prop_assert!(value(force) * value(v) >= 0.0);
        prop_assert!(v != Part::ZERO || force == Part::ZERO);
    }
}
