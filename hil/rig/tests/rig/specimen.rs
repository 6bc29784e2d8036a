//! The simulated specimen against closed forms, and the specimens drawn for the demonstration.

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

use mesh_damper::effects::DESCRIPTIONS;
use mesh_damper_reference::law::Coefficients;
use mesh_damper_reference::protocol::{PROTOCOL, motion};
use mesh_damper_reference::tables;
use mesh_damper_rig::specimen::{
    DamperForce, HiddenEffect, LARGEST_SHARE, SMALLEST_SHARE, SlipShape, Specimen, Unlisted, draw,
    force_share,
};
use proptest::prelude::*;
use serde_json::json;

/// No force of eq 13.
const NOTHING: Coefficients = Coefficients::new(0.0, 0.0, 0.0, 0.0);

/// The last of `cycles` cycles of X·sin ωt at `count` samples each: displacement and the force of `effect` alone.
fn last_cycle(
    effect: HiddenEffect,
    amplitude: f64,
    frequency: f64,
    cycles: usize,
    count: usize,
) -> (Vec<f64>, Vec<f64>) {
    let mut specimen = Specimen::new(NOTHING).with(effect);
    let omega = TAU * frequency;
    let dt = 1.0 / (frequency * count as f64);
    let all: Vec<(f64, f64)> = (0..=cycles * count)
        .map(|i| {
            let t = i as f64 * dt;
            let (sin, cos) = (TAU * (i % count) as f64 / count as f64).sin_cos();
            let y = amplitude * sin;
            let force = specimen.force(t, y, omega * amplitude * cos, -omega * omega * y, dt);
            (y, force)
        })
        .collect();
    all[(cycles - 1) * count..].iter().copied().unzip()
}

/// ∮F dy by the trapezoidal rule, J, over samples whose last is the first again.
fn energy(y: &[f64], force: &[f64]) -> f64 {
    (1..y.len())
        .map(|i| 0.5 * (force[i] + force[i - 1]) * (y[i] - y[i - 1]))
        .sum()
}

/// Storage and loss: the parts of the force's first harmonic in phase with displacement and with velocity, kN/mm.
fn moduli(force: &[f64], amplitude: f64) -> (f64, f64) {
    let count = force.len() - 1;
    let part = |f: fn(f64) -> f64| -> f64 {
        let sum: f64 = (0..count)
            .map(|i| force[i] * f(TAU * i as f64 / count as f64))
            .sum();
        2.0 * sum / (count as f64 * amplitude)
    };
    (part(f64::sin), part(f64::cos))
}

fn close(value: f64, expected: f64, relative: f64) {
    assert!(
        (value - expected).abs() <= relative * expected.abs(),
        "{value} is not within {relative} of {expected}"
    );
}

#[test]
fn elastic_and_inertial_effects_dissipate_nothing() {
    for effect in [
        HiddenEffect::Offset { force: 0.05 },
        HiddenEffect::Asymmetry { k2: 3.0 },
        HiddenEffect::Hardening { k5: 1500.0 },
        HiddenEffect::Inertia { mass: 120.0 },
    ] {
        let (y, force) = last_cycle(effect, 0.1, 2.0, 2, 1000);
        let largest = force.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
        assert!(largest > 1e-3, "{effect:?} has no force");
        // Rounding of 1000 terms, each at most largest·0.1 mm.
        let dissipated = energy(&y, &force);
        assert!(
            dissipated.abs() < 1000.0 * f64::EPSILON * largest * 0.1,
            "{effect:?}"
        );
    }
}

#[test]
fn elastic_and_inertial_forces_at_the_extremes() {
    let peak = |effect, i: usize| last_cycle(effect, 0.1, 2.0, 1, 1000).1[i];
    close(peak(HiddenEffect::Offset { force: -0.05 }, 700), -0.05, 0.0);
    close(peak(HiddenEffect::Asymmetry { k2: 3.0 }, 250), 0.03, 1e-12);
    close(peak(HiddenEffect::Asymmetry { k2: 3.0 }, 750), 0.03, 1e-12);
    close(
        peak(HiddenEffect::Hardening { k5: 1500.0 }, 250),
        0.015,
        1e-12,
    );
    close(
        peak(HiddenEffect::Hardening { k5: 1500.0 }, 750),
        -0.015,
        1e-12,
    );
    // −m·ω²·X with 120 kg, 4π 1/s, 1e-4 m: −1.895 N.
    let newtons = -120.0 * (4.0 * PI).powi(2) * 1e-4;
    close(
        peak(HiddenEffect::Inertia { mass: 120.0 }, 250),
        newtons * 1e-3,
        1e-12,
    );
}

/// A simulated specimen can hide every effect of the crate, with physics of its own; load friction is among those that it shares with no
/// family.
#[test]
fn every_family_has_physics_of_its_own() {
    for effect in DESCRIPTIONS {
        let family = effect.family;
        let known =
            HiddenEffect::FAMILIES.contains(&family) || Unlisted::FAMILIES.contains(&family);
        assert!(
            known,
            "hil/rig/src/specimen/hidden.rs has no effect `{family}`"
        );
    }
}

/// The effect of a family, with sizes of 0.05; what else it has, its error says.
fn of_family(family: &str) -> HiddenEffect {
    let mut fields = json!({"family": family});
    loop {
        let error = match serde_json::from_value(fields.clone()) {
            Ok(effect) => return effect,
            Err(error) => error.to_string(),
        };
        let missing = error.strip_prefix("missing field `");
        let missing = missing.and_then(|field| field.strip_suffix('`'));
        let field = missing.unwrap_or_else(|| panic!("{family}: {error}"));
        fields[field] = match field {
            "shape" => json!("sharp"),
            "loose" => json!(true),
            "schedule" => json!({"most": 1.0, "hold": 0.1, "seed": 1}),
            _ => json!(0.05),
        };
    }
}

#[test]
fn every_hidden_effect_changes_the_force() {
    let law = tables::interpolate(3.0, 0.1);
    for family in HiddenEffect::FAMILIES {
        assert!(force_share(law, of_family(family)) > 1e-9, "{family}");
    }
}

#[test]
fn a_dashpot_dissipates_pi_c_omega_x_squared() {
    for (amplitude, frequency) in [(0.1, 1.0), (0.1, 5.0), (0.05, 5.0)] {
        let (y, force) = last_cycle(
            HiddenEffect::Viscous { c: 0.006 },
            amplitude,
            frequency,
            1,
            2000,
        );
        let expected = PI * 0.006 * TAU * frequency * amplitude * amplitude;
        // The trapezoids of a smooth loop: (2π/N)²/6.
        close(energy(&y, &force), expected, 2e-6);
    }
}

fn friction(shape: SlipShape) -> HiddenEffect {
    HiddenEffect::StickSlip {
        stiffness: 1.2,
        slip_limit: 0.03,
        shape,
    }
}

/// One Jenkins element: 4·kt·xs·(X − xs) when X > xs, else 0, at any frequency.
#[test]
fn sharp_friction_dissipates_its_parallelogram() {
    for (amplitude, frequency) in [(0.05, 1.0), (0.1, 1.0), (0.1, 10.0), (0.2, 3.0)] {
        let (y, force) = last_cycle(friction(SlipShape::Sharp), amplitude, frequency, 2, 4000);
        // A corner falls within a sample: kt·(step)²/2 at each of two, step ≤ 2πX/N.
        close(
            energy(&y, &force),
            4.0 * 1.2 * 0.03 * (amplitude - 0.03),
            1e-4,
        );
    }
    let (y, force) = last_cycle(friction(SlipShape::Sharp), 0.029, 1.0, 2, 1000);
    assert!(energy(&y, &force).abs() < 1e-15);
}

/// Sliders with limits xᵢ evenly up to 2·xs: the sum of their parallelograms, without those that do not slip.
#[test]
fn spread_friction_dissipates_the_sum_of_its_sliders() {
    let sliders = 12;
    for amplitude in [0.02, 0.05, 0.1] {
        let (y, force) = last_cycle(
            friction(SlipShape::Spread { sliders }),
            amplitude,
            1.0,
            2,
            8000,
        );
        let expected: f64 = (0..sliders)
            .map(|i| {
                let limit = 0.06 * (i as f64 + 0.5) / sliders as f64;
                4.0 * 1.2 / sliders as f64 * limit * (amplitude - limit).max(0.0)
            })
            .sum();
        close(energy(&y, &force), expected, 1e-4);
    }
}

/// Bouc–Wen: n = 1 from rest is F = kt·xs·(1 − e^(−y/xs)); the larger n, the nearer to Jenkins. The frequency has no influence.
#[test]
fn smooth_friction_follows_bouc_and_wen() {
    let mut specimen = Specimen::new(NOTHING).with(friction(SlipShape::Smooth { exponent: 1.0 }));
    for i in 1..=100 {
        let y = 0.001 * f64::from(i);
        let force = specimen.force(0.01 * f64::from(i), y, 0.1, 0.0, 0.01);
        // Midpoint rule at steps of h ≤ xs/50: (h/xs)²/6 of the remaining slope.
        close(force, 1.2 * 0.03 * (1.0 - (-y / 0.03).exp()), 1e-4);
    }
    let loss = |exponent, frequency| {
        let (y, force) = last_cycle(
            friction(SlipShape::Smooth { exponent }),
            0.1,
            frequency,
            3,
            2000,
        );
        energy(&y, &force)
    };
    let jenkins = 4.0 * 1.2 * 0.03 * 0.07;
    let distance = |exponent| (loss(exponent, 1.0) - jenkins).abs() / jenkins;
    assert!(distance(8.0) < distance(2.0) && distance(2.0) < distance(1.0));
    assert!(distance(30.0) < 0.01);
    close(loss(2.0, 7.0), loss(2.0, 1.0), 1e-12);
}

/// Storage k·(ωτ)²/(1 + (ωτ)²), loss k·ωτ/(1 + (ωτ)²).
#[test]
fn a_maxwell_branch_has_its_storage_and_loss_moduli() {
    let (stiffness, time) = (1.5, 0.05);
    for frequency in [0.5, 2.0, 10.0] {
        let effect = HiddenEffect::Relaxation { stiffness, time };
        let (y, force) = last_cycle(effect, 0.1, frequency, 20, 4000);
        let x = TAU * frequency * time;
        let (storage, loss) = moduli(&force, 0.1);
        // The trapezoidal rule changes ω by (ω·dt)²/12 = 2e-7.
        close(storage, stiffness * x * x / (1.0 + x * x), 1e-5);
        close(loss, stiffness * x / (1.0 + x * x), 1e-5);
        close(energy(&y, &force), PI * loss * 0.01, 1e-5);
    }
}

/// At a steady velocity the dashpot carries the force; a motion that is small compared with its rate has the moduli of a Maxwell
/// branch.
#[test]
fn a_dashpot_that_yields_has_its_closed_forms() {
    let (stiffness, yields, rate, c) = (1.5, 0.05, 2.0, 0.004);
    let effect = HiddenEffect::Yielding {
        stiffness,
        force: yields,
        rate,
        c,
    };
    let (_, force) = last_cycle(effect, 1e-4, 5.0, 20, 4000);
    let x = TAU * 5.0 * (yields / rate + c) / stiffness;
    let (storage, loss) = moduli(&force, 1e-4);
    // A first-order rule of 2e-5 s.
    close(storage, stiffness * x * x / (1.0 + x * x), 2e-3);
    close(loss, stiffness * x / (1.0 + x * x), 2e-3);
    for velocity in [-9.0, 0.5, 4.0] {
        let mut specimen = Specimen::new(NOTHING).with(effect);
        let dt = 1e-3;
        let held = (0..1000).fold(0.0, |_, n| {
            let time = f64::from(n) * dt;
            specimen.force(time, velocity * time, velocity, 0.0, dt)
        });
        close(held, yields * (velocity / rate).tanh() + c * velocity, 1e-6);
    }
}

/// k·(1 − e^(−n/N))·y: no dissipation, and the peak forces follow the count of half cycles.
#[test]
fn drift_follows_the_cycles_run() {
    let effect = HiddenEffect::Drift {
        stiffness: -0.5,
        cycles: 25.0,
    };
    for cycles in [1, 10, 50] {
        let (y, force) = last_cycle(effect, 0.1, 2.0, cycles, 1000);
        // Counted at a passage through 0: the first peak of a cycle has a whole number of cycles before it.
        let run = (cycles - 1) as f64;
        close(
            force[250],
            -0.5 * (1.0 - (-run / 25.0).exp()) * y[250],
            1e-12,
        );
        let run = run + 0.5;
        close(
            force[750],
            -0.5 * (1.0 - (-run / 25.0).exp()) * y[750],
            1e-12,
        );
    }
    // Half as many samples, twice the frequency, a tenth of the amplitude: only cycles count.
    let (y, force) = last_cycle(effect, 0.01, 4.0, 10, 500);
    close(
        force[125],
        -0.5 * (1.0 - (-9.0_f64 / 25.0).exp()) * y[125],
        1e-12,
    );
}

#[test]
fn warmth_takes_its_part_of_the_whole_law() {
    let law = tables::cell(1, 2);
    let mut specimen = Specimen::new(law).with(HiddenEffect::Temperature {
        beta: 0.004,
        rise: 40.0,
        time: 16.0,
    });
    assert_eq!(specimen.temperature(), 20.0);
    for (t, y, v) in [(0.0, 0.05, 0.3), (16.0, -0.02, 0.5), (160.0, 0.1, -0.1)] {
        let force = specimen.force(t, y, v, 0.0, 1e-3);
        let warmed = 40.0 * (1.0 - (-t / 16.0_f64).exp());
        close(specimen.temperature(), 20.0 + warmed, 1e-12);
        close(force, law.force(y, v) * (1.0 - 0.004 * warmed), 1e-12);
    }
}

/// A used specimen put at rest behaves like a new one.
#[test]
fn at_rest_is_as_new() {
    let (new, _) = draw(3);
    let mut used = new.clone().with(friction(SlipShape::Sharp));
    let mut fresh = used.clone();
    for i in 0..100 {
        used.force(
            0.01 * f64::from(i),
            0.1 * f64::from(i).sin(),
            0.3,
            0.0,
            0.01,
        );
    }
    let mut again = used.at_rest();
    for i in 0..100 {
        let (t, y) = (0.01 * f64::from(i), 0.1 * f64::from(i).sin());
        assert_eq!(
            again.force(t, y, 0.3, 1.0, 0.01),
            fresh.force(t, y, 0.3, 1.0, 0.01)
        );
    }
}

#[test]
#[should_panic(expected = "no specimen can have")]
fn a_slip_limit_of_zero_is_refused() {
    let _ = Specimen::new(NOTHING).with(HiddenEffect::StickSlip {
        stiffness: 1.0,
        slip_limit: 0.0,
        shape: SlipShape::Sharp,
    });
}

/// The ideal motion agrees with its velocity and acceleration, except for the velocity's jump between two frequencies.
#[test]
fn the_protocols_motion_is_its_own_derivative() {
    let rate = 20_000.0;
    let all = motion(&PROTOCOL, rate);
    let ends: Vec<f64> = PROTOCOL
        .iter()
        .scan(0.0, |end, b| {
            *end += f64::from(b.cycles) / b.frequency;
            Some(*end)
        })
        .collect();
    assert_eq!(all.len(), (ends[ends.len() - 1] * rate).round() as usize);
    let dt = 1.0 / rate;
    let mut largest = 0.0_f64;
    for pair in all.windows(2) {
        if ends.iter().any(|end| (pair[1].time - end).abs() < 0.5 * dt) {
            assert!(pair[1].displacement.abs() < 1e-12);
            continue;
        }
        let moved = pair[1].displacement - pair[0].displacement;
        let mean = 0.5 * (pair[0].velocity + pair[1].velocity) * dt;
        // Trapezoids: dt³/12 of the third derivative, (2π·10 Hz)³·0.1 mm = 2.5e4 mm/s³ or a few times that in a ramp.
        assert!((moved - mean).abs() < 1e-9, "{pair:?}");
        let faster = pair[1].velocity - pair[0].velocity;
        let mean = 0.5 * (pair[0].acceleration + pair[1].acceleration) * dt;
        // The same of the fourth, 1.6e6 mm/s⁴.
        assert!((faster - mean).abs() < 1e-7, "{pair:?}");
        largest = largest.max(pair[1].displacement);
    }
    close(largest, 0.2, 1e-6);
}

/// 99 seeds: the size as stated, inside its band, the same when drawn again, and every family equally often.
#[test]
fn drawn_effects_keep_their_promises() {
    let mut families = BTreeMap::new();
    for seed in 0..99 {
        let (specimen, drawn) = draw(seed);
        let (again, drawn_again) = draw(seed);
        assert_eq!(drawn, drawn_again);
        assert_eq!(specimen.coefficients(), again.coefficients());
        assert_eq!(specimen.effects().collect::<Vec<_>>(), [drawn.effect]);
        let share = force_share(specimen.coefficients(), drawn.effect);
        close(share, drawn.share, 1e-9);
        assert!(
            (SMALLEST_SHARE..=LARGEST_SHARE).contains(&share),
            "seed {seed}: {share}"
        );
        let table = tables::interpolate(drawn.density, 0.1);
        let law = specimen.coefficients();
        for (value, nominal) in [
            (law.k1, table.k1),
            (law.k3, table.k3),
            (law.c, table.c),
            (law.alpha, table.alpha),
        ] {
            assert!((0.85..1.15).contains(&(value / nominal)), "seed {seed}");
        }
        *families.entry(drawn.effect.family()).or_insert(0) += 1;
    }
    assert_eq!(families.len(), 9, "{families:?}");
    assert!(families.values().all(|&n| n == 11), "{families:?}");
    assert_ne!(draw(1).1, draw(2).1);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Over closed cycles no drawn specimen returns more energy than it absorbed.
    #[test]
    fn a_drawn_specimen_generates_no_energy(
        seed in 0..1000_u64, amplitude in 0.02..0.2_f64, frequency in 0.5..10.0_f64,
    ) {
        let (mut specimen, _) = draw(seed);
        let count = 2000;
        let dt = 1.0 / (frequency * f64::from(count));
        let mut before: Option<(f64, f64)> = None;
        let mut taken = 0.0;
        for i in 0..=4 * count {
            let (sin, cos) = (TAU * f64::from(i % count) / f64::from(count)).sin_cos();
            let (omega, y) = (TAU * frequency, amplitude * sin);
            let force = specimen.force(f64::from(i) * dt, y, omega * amplitude * cos, -omega * omega * y, dt);
            if let Some((y0, f0)) = before
                && i > 2 * count
            {
                taken += 0.5 * (force + f0) * (y - y0);
            }
            before = Some((y, force));
        }
        prop_assert!(taken > 0.0);
    }
}
