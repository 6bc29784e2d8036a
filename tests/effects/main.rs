//! Every added effect against a closed form of another kind than its own recurrence.

mod backlash;
mod bouc_wen;
mod compliance;
mod control_input;
mod degradation;
mod directional;
mod force_filter;
mod half_rate;
mod hardening_friction;
mod load_friction;
mod loops;
mod outside;
mod residual_table;
mod stages;
mod stop_and_tone;
mod weakening;
mod yielding;

use std::f64::consts::{PI, TAU};

use loops::{TICKS, alone, close, energy, last_cycle, moduli, nothing, sine};
use mesh_damper::effects::{
    Asymmetry, AugmentedLaw, Backlash, BoucWen, Compliance, ControlInput, DESCRIPTIONS,
    Degradation, Delay, Directional, Drift, Effect, ForceFilter, Gap, Hardening, HardeningFriction,
    Inertia, LoadFriction, MAX_TONES, Motion, Offset, Periodic, Relaxation, StickSlip, Stop,
    Temperature, Viscous, Weakening, Yielding,
};
use mesh_damper::error::ConfigError;
use mesh_damper::law::Law;
use mesh_damper::real::Real;
use proptest::prelude::*;

/// Each family has its row in the page about them.
#[test]
fn the_page_of_effects_has_every_family() {
    let page = include_str!("../../docs/effects.md");
    for description in DESCRIPTIONS {
        let row = format!("| `{}` |", description.family);
        assert!(page.contains(&row), "docs/effects.md: {row}");
    }
}

/// 4·k·x·(X − x) for each slider, and nothing below its slip limit.
#[test]
fn stick_slip_dissipates_as_jenkins_elements_do() {
    let elements = [(1.2, 0.03), (0.4, 0.08), (2.0, 0.5)];
    let expected = 4.0 * (1.2 * 0.03 * (0.2 - 0.03) + 0.4 * 0.08 * (0.2 - 0.08));
    let force = last_cycle(
        Effect::StickSlip(StickSlip::new(&elements).unwrap()),
        0.2,
        1.0,
        2,
    );
    // A slider's corner falls within a tick: an error of the second order in the tick.
    close(energy(&force, 0.2), expected, 1e-5);

    let stuck = last_cycle(
        Effect::StickSlip(StickSlip::new(&[(2.0, 0.5)]).unwrap()),
        0.2,
        1.0,
        2,
    );
    assert!(energy(&stuck, 0.2).abs() < 1e-12);
    close(stuck[TICKS / 4], 2.0 * 0.2, 1e-9);
}

/// Masing: the unloading branch is the backbone turned round and doubled, F(y) = F(X) − 2·B((X − y)/2).
#[test]
fn stick_slip_unloads_along_its_doubled_backbone() {
    let elements = [(1.2, 0.03), (0.4, 0.08)];
    let backbone = |y: f64| {
        elements
            .iter()
            .map(|&(k, x)| k * f64::min(y, x))
            .sum::<f64>()
    };
    let force = last_cycle(
        Effect::StickSlip(StickSlip::new(&elements).unwrap()),
        0.2,
        1.0,
        2,
    );
    for n in (TICKS / 4..3 * TICKS / 4).step_by(97) {
        let y = 0.2 * (TAU * n as f64 / TICKS as f64).sin();
        let expected = backbone(0.2) - 2.0 * backbone(0.5 * (0.2 - y));
        assert!(
            (force[n] - expected).abs() < 1e-9,
            "at {y} mm: {} is not {expected}",
            force[n]
        );
    }
}

/// Rate independence: the same path at another frequency gives the same force.
#[test]
fn stick_slip_knows_no_frequency() {
    let effect = Effect::StickSlip(StickSlip::new(&[(1.2, 0.03)]).unwrap());
    assert_eq!(
        last_cycle(effect, 0.1, 0.5, 2),
        last_cycle(effect, 0.1, 10.0, 2)
    );
}

/// Storage k·(ωτ)²/(1 + (ωτ)²) and loss k·ωτ/(1 + (ωτ)²).
#[test]
fn relaxation_has_the_moduli_of_a_maxwell_branch() {
    for frequency in [0.5, 3.0, 10.0] {
        let tick = 1.0 / (frequency * TICKS as f64);
        let effect = Effect::Relaxation(Relaxation::new(&[(1.5, 0.05)], tick).unwrap());
        // The start has faded after 10 cycles: e^(−10/(10·0.05)) at the fastest.
        let (storage, loss) = moduli(&last_cycle(effect, 0.1, frequency, 40), 0.1);
        let x = TAU * frequency * 0.05;
        // Straight lines between ticks: an error of (ωΔt)²/12 = 8e-9, and e^(−80) of the start.
        close(storage, 1.5 * x * x / (1.0 + x * x), 1e-6);
        close(loss, 1.5 * x / (1.0 + x * x), 1e-6);
    }
}

/// Branches act side by side.
#[test]
fn branches_of_relaxation_add_up() {
    let branches = [(1.5, 0.02), (0.4, 0.3), (-0.2, 2.0)];
    let of = |branches: &[(f64, f64)]| {
        let effect = Effect::Relaxation(Relaxation::new(branches, 1e-4).unwrap());
        last_cycle(effect, 0.1, 2.0, 3)
    };
    let together = of(&branches);
    let apart = branches.map(|branch| of(&[branch]));
    for (n, force) in together.iter().enumerate() {
        let sum: f64 = apart.iter().map(|alone| alone[n]).sum();
        assert!((force - sum).abs() < 1e-12, "{force} for {sum}");
    }
}

/// A step held for one time constant fades to 1/e in f32 too, however little a tick takes.
#[test]
fn relaxation_fades_over_long_times_in_f32() {
    for time in [1.0, 100.0, 3000.0] {
        let law = alone(Effect::Relaxation(
            Relaxation::new(&[(1.2_f32, time)], 1e-4).unwrap(),
        ));
        let mut state = law.at_rest();
        let mut force = 0.0;
        law.force(&mut state, &Motion::default());
        for _ in 0..(f64::from(time) / 1e-4) as u64 {
            force = law.force(
                &mut state,
                &Motion {
                    displacement: 1.0,
                    ..Motion::default()
                },
            );
        }
        // The step takes a tick, so that the fall is half a tick short of τ. loss = Δt/τ rounds by 2^-24 of itself; the sum
        // of the ticks is compensated.
        let expected = 1.2 * (-1.0 + 0.5e-4 / f64::from(time)).exp();
        close(f64::from(force), expected, 1e-6);
    }
}

#[test]
fn viscous_dissipates_pi_c_omega_square_of_amplitude() {
    let force = last_cycle(Effect::Viscous(Viscous::new(0.006).unwrap()), 0.1, 5.0, 1);
    close(energy(&force, 0.1), PI * 0.006 * TAU * 5.0 * 0.01, 1e-6);
}

#[test]
fn inertia_softens_by_mass_times_omega_square() {
    let force = last_cycle(Effect::Inertia(Inertia::new(120.0).unwrap()), 0.1, 10.0, 1);
    let (storage, loss) = moduli(&force, 0.1);
    // 120 kg at 10 Hz: 120e-6 kN·s²/mm · (20π)².
    close(storage, -120e-6 * (TAU * 10.0).powi(2), 1e-9);
    assert!(loss.abs() < 1e-12);
}

#[test]
fn elastic_effects_dissipate_nothing_and_have_their_parity() {
    let even = last_cycle(Effect::Asymmetry(Asymmetry::new(3.0).unwrap()), 0.2, 1.0, 1);
    let odd = last_cycle(
        Effect::Hardening(Hardening::new(1500.0).unwrap()),
        0.2,
        1.0,
        1,
    );
    let constant = last_cycle(Effect::Offset(Offset::new(0.05).unwrap()), 0.2, 1.0, 1);
    for force in [&even, &odd, &constant] {
        assert!(energy(force, 0.2).abs() < 1e-9);
    }
    close(even[TICKS / 4], 3.0 * 0.04, 1e-12);
    close(even[3 * TICKS / 4], 3.0 * 0.04, 1e-12);
    close(odd[TICKS / 4], 1500.0 * 0.2_f64.powi(5), 1e-12);
    close(odd[3 * TICKS / 4], -1500.0 * 0.2_f64.powi(5), 1e-12);
    assert!(constant.iter().all(|&f| f == 0.05));
}

/// Several tones are each as it would be alone.
#[test]
fn tones_add_up() {
    let tones = [(0.02, 50.0, 0.3), (0.005, 150.0, -1.0), (-0.01, 7.3, 2.0)];
    let of = |tones: &[(f64, f64, f64)]| {
        let law = alone(Effect::Periodic(Periodic::new(tones, 1e-3).unwrap()));
        let mut state = law.at_rest();
        (0..1000)
            .map(|_| law.force(&mut state, &Motion::default()))
            .collect::<Vec<f64>>()
    };
    for count in 1..=tones.len() {
        let together = of(&tones[..count]);
        let apart: Vec<Vec<f64>> = tones[..count].iter().map(|&tone| of(&[tone])).collect();
        for (tick, force) in together.into_iter().enumerate() {
            close(force, apart.iter().map(|force| force[tick]).sum(), 1e-12);
        }
    }
}

#[test]
fn drift_has_done_63_percent_after_its_cycles() {
    let law = alone(Effect::Drift(Drift::new(-0.5, 25.0).unwrap()));
    let mut state = law.at_rest();
    let stiffness = |cycles: f64, state: &mut _| {
        let motion = Motion {
            displacement: 0.1,
            cycles,
            ..Motion::default()
        };
        law.force(state, &motion) / 0.1
    };
    assert_eq!(stiffness(0.0, &mut state), 0.0);
    close(
        stiffness(25.0, &mut state),
        -0.5 * (1.0 - (-1.0_f64).exp()),
        1e-12,
    );
    close(stiffness(1e9, &mut state), -0.5, 1e-12);
}

#[test]
fn drift_changes_elastic_and_damping_force_each_in_its_own_way() {
    let (k1, k3, c, alpha) = (1.0, 10.0, 0.1, 0.4);
    let drift = Drift::new(0.7, 25.0).unwrap().with_forces(-0.2, 0.5);
    let law: AugmentedLaw<f64, 1> = AugmentedLaw::new(Law::new(k1, k3, c, alpha).unwrap())
        .with(Effect::Drift(drift.unwrap()))
        .unwrap();
    for (y, v, cycles) in [(0.1, 1.3, 3.0), (-0.2, 0.4, 25.0), (0.05, -3.0, 1e6)] {
        let motion = Motion {
            displacement: y,
            velocity: v,
            cycles,
            ..Motion::default()
        };
        let done = 1.0 - (-cycles / 25.0_f64).exp();
        let elastic = (1.0 - 0.2 * done) * (k1 * y + k3 * y.powi(3));
        let damping = (1.0 + 0.5 * done) * c * v.abs().powf(alpha) * v.signum();
        close(
            law.force(&mut law.at_rest(), &motion),
            elastic + damping + 0.7 * done * y,
            1e-12,
        );
    }
}

#[test]
fn temperature_scales_the_law_and_nothing_else() {
    let law = Law::new(1.0, 10.0, 0.1, 0.4).unwrap();
    let warm: AugmentedLaw<f64, 2> = AugmentedLaw::new(law)
        .with(Effect::Offset(Offset::new(0.7).unwrap()))
        .unwrap()
        .with(Effect::Temperature(Temperature::new(0.004, 20.0).unwrap()))
        .unwrap();
    let motion = Motion {
        displacement: 0.1,
        velocity: 1.3,
        temperature: 70.0,
        ..Motion::default()
    };
    close(
        warm.force(&mut warm.at_rest(), &motion),
        0.7 + (1.0 - 0.004 * 50.0) * law.force(0.1, 1.3),
        1e-12,
    );
}

#[test]
fn temperature_scales_elastic_and_damping_force_each_in_its_own_way() {
    let (k1, k3, c, alpha) = (1.0, 10.0, 0.1, 0.4);
    let each = Temperature::new(0.004, 20.0).unwrap().with_damping(-0.002);
    let warm: AugmentedLaw<f64, 1> = AugmentedLaw::new(Law::new(k1, k3, c, alpha).unwrap())
        .with(Effect::Temperature(each.unwrap()))
        .unwrap();
    for (y, v, temperature) in [(0.1, 1.3, 70.0), (-0.2, 0.4, -10.0), (0.05, -3.0, 20.0)] {
        let motion = Motion {
            displacement: y,
            velocity: v,
            temperature,
            ..Motion::default()
        };
        let rise = temperature - 20.0;
        let elastic = (1.0 - 0.004 * rise) * (k1 * y + k3 * y.powi(3));
        let damping = (1.0 + 0.002 * rise) * c * v.abs().powf(alpha) * v.signum();
        close(
            warm.force(&mut warm.at_rest(), &motion),
            elastic + damping,
            1e-12,
        );
    }
}

/// A state that was made for fewer effects has the rest at rest, and drops none.
#[test]
fn a_state_of_fewer_effects_serves_more() {
    let offset = Effect::Offset(Offset::new(0.5).unwrap());
    let slider = Effect::StickSlip(StickSlip::new(&[(2.0, 0.5)]).unwrap());
    let small: AugmentedLaw<f64, 2> = AugmentedLaw::new(nothing()).with(offset).unwrap();
    let large = small.clone().with(slider).unwrap();
    let mut state = small.at_rest();
    small.force(&mut state, &Motion::default());
    large.force(&mut state, &Motion::default());
    let force = large.force(
        &mut state,
        &Motion {
            displacement: 0.1,
            ..Motion::default()
        },
    );
    close(force, 0.5 + 0.2, 1e-12);
}

#[test]
fn a_full_set_refuses_one_more() {
    let offset = Effect::Offset(Offset::new(1.0_f32).unwrap());
    assert_eq!(
        alone(offset).with(offset),
        Err(ConfigError::Full {
            field: "effects",
            capacity: 1
        })
    );
}

/// Two of a kind are one with other coefficients, or more elements.
#[test]
fn a_second_effect_of_a_kind_is_refused() {
    let law = one_of_each::<f64>();
    let mut roomy = AugmentedLaw::<f64, 30>::new(*law.law());
    for effect in law.effects() {
        roomy = roomy.with(effect).unwrap();
        let again = roomy.clone().with(effect);
        assert!(
            matches!(again, Err(ConfigError::Full { capacity: 1, .. })),
            "{again:?}"
        );
    }
    assert_eq!(roomy.effects().count(), EFFECTS);
}

#[test]
fn constructors_name_the_field_they_refuse() {
    let field = |error: ConfigError| match error {
        ConfigError::NonFinite(field) | ConfigError::Empty(field) => field,
        ConfigError::OutOfRange { field, .. } | ConfigError::Full { field, .. } => field,
        other => panic!("{other} names no field"),
    };
    assert_eq!(field(Offset::new(f32::NAN).unwrap_err()), "force");
    assert_eq!(field(Asymmetry::new(1e10).unwrap_err()), "k2");
    assert_eq!(field(Hardening::new(f64::INFINITY).unwrap_err()), "k5");
    assert_eq!(field(Viscous::new(-2e9).unwrap_err()), "c1");
    assert_eq!(field(Inertia::new(2e6).unwrap_err()), "mass");
    assert_eq!(field(LoadFriction::new(-1e-3).unwrap_err()), "load");
    assert_eq!(field(LoadFriction::new(f32::INFINITY).unwrap_err()), "load");
    for difference in [-1.001, 1.001, f64::NAN] {
        assert_eq!(
            field(Directional::new(difference).unwrap_err()),
            "difference"
        );
    }
    assert_eq!(field(StickSlip::<f32>::new(&[]).unwrap_err()), "elements");
    assert_eq!(
        field(StickSlip::new(&[(1.0, 0.1); 7]).unwrap_err()),
        "elements"
    );
    assert_eq!(
        field(StickSlip::new(&[(1.0, 0.1), (1.0, 0.0)]).unwrap_err()),
        "slip_limit"
    );
    assert_eq!(
        field(StickSlip::new(&[(f32::NAN, 0.1)]).unwrap_err()),
        "stiffness"
    );
    assert_eq!(
        field(Relaxation::<f32>::new(&[], 1e-4).unwrap_err()),
        "branches"
    );
    assert_eq!(
        field(Relaxation::new(&[(1.0, 0.1); 4], 1e-4).unwrap_err()),
        "branches"
    );
    assert_eq!(
        field(Relaxation::new(&[(1.0, 0.1), (1.0, 0.0)], 1e-4).unwrap_err()),
        "time"
    );
    assert_eq!(
        field(Relaxation::new(&[(1.0, 0.1)], 0.0).unwrap_err()),
        "tick"
    );
    assert_eq!(field(Drift::new(1.0, 0.0).unwrap_err()), "cycles");
    let drift = Drift::new(0.0, 25.0).unwrap();
    assert_eq!(
        field(drift.with_forces(0.0, f64::NAN).unwrap_err()),
        "damping_change"
    );
    assert_eq!(field(Temperature::new(2.0, 20.0).unwrap_err()), "beta");
    assert_eq!(
        field(Temperature::new(0.1, -300.0).unwrap_err()),
        "reference"
    );
    let both = Temperature::new(0.1, 20.0).unwrap();
    assert_eq!(
        field(both.with_damping(f64::NAN).unwrap_err()),
        "beta_damping"
    );
    assert_eq!(field(Stop::<f32>::new(&[]).unwrap_err()), "contacts");
    assert_eq!(field(Stop::new(&[(1.0, 0.1); 3]).unwrap_err()), "contacts");
    assert_eq!(
        field(Stop::new(&[(1.0, 0.1), (-1.0, -0.1)]).unwrap_err()),
        "stiffness"
    );
    assert_eq!(field(Stop::new(&[(1.0, 0.0)]).unwrap_err()), "gap");
    assert_eq!(field(Gap::new(-0.1, true).unwrap_err()), "half_width");
    assert_eq!(field(Gap::new(f32::NAN, false).unwrap_err()), "half_width");
    assert_eq!(
        field(BoucWen::new(f64::INFINITY, 0.1, 1.0).unwrap_err()),
        "stiffness"
    );
    assert_eq!(
        field(BoucWen::new(1.0, 0.0, 1.0).unwrap_err()),
        "slip_limit"
    );
    assert_eq!(field(BoucWen::new(1.0, 0.1, 0.4).unwrap_err()), "sharpness");
    assert_eq!(field(BoucWen::new(1.0, 0.1, 8.1).unwrap_err()), "sharpness");
    let hardening = |sharpness, hardening, loss| {
        field(HardeningFriction::new(1.0, 0.1, sharpness, hardening, loss).unwrap_err())
    };
    assert_eq!(hardening(8.1, 1.0, 1.0), "sharpness");
    assert_eq!(hardening(1.0, -1.1, 1.0), "hardening");
    assert_eq!(hardening(1.0, 1.0, f64::NAN), "loss");
    let yielding = |stretch, rate, time, tick| {
        field(Yielding::new(1.0, stretch, rate, time, tick).unwrap_err())
    };
    assert_eq!(
        field(Yielding::new(f32::NAN, 0.1, 1.0, 0.0, 1e-3).unwrap_err()),
        "stiffness"
    );
    assert_eq!(yielding(-0.1, 1.0, 0.0, 1e-3), "yield_stretch");
    assert_eq!(yielding(0.1, 0.0, 0.0, 1e-3), "rate");
    assert_eq!(yielding(0.1, 1.0, -1e-3, 1e-3), "time");
    assert_eq!(yielding(0.1, 1.0, 0.0, 0.0), "tick");
    assert_eq!(
        field(Backlash::new(2e9, 0.1, 0.1).unwrap_err()),
        "stiffness"
    );
    assert_eq!(
        field(Backlash::new(1.0, 0.0, 0.1).unwrap_err()),
        "slip_limit"
    );
    assert_eq!(field(Backlash::new(1.0, 0.1, -1e-3).unwrap_err()), "slack");
    assert_eq!(
        field(Backlash::new(1.0, 0.1, f32::NAN).unwrap_err()),
        "slack"
    );
    assert_eq!(
        field(Degradation::new(f32::NAN, 0.1, 0.0).unwrap_err()),
        "stiffness"
    );
    assert_eq!(
        field(Degradation::new(1.0, 0.0, 0.0).unwrap_err()),
        "softening"
    );
    for pinching in [-1e-3, 1.001, f64::INFINITY] {
        let refused = Degradation::new(1.0, 0.1, pinching).unwrap_err();
        assert_eq!(field(refused), "pinching");
    }
    let weakening = |stiffness, slip_limit, loss, energy| {
        field(Weakening::new(stiffness, slip_limit, loss, energy).unwrap_err())
    };
    assert_eq!(weakening(f64::INFINITY, 0.1, 0.5, 1.0), "stiffness");
    assert_eq!(weakening(1.0, 0.0, 0.5, 1.0), "slip_limit");
    assert_eq!(weakening(1.0, 0.1, 1.001, 1.0), "loss");
    assert_eq!(weakening(1.0, 0.1, -1e-3, 1.0), "loss");
    assert_eq!(weakening(1.0, 0.1, 0.5, 0.0), "energy");
    assert_eq!(weakening(1.0, 0.1, 0.5, f64::NAN), "energy");
    let periodic = |amplitude, frequency, phase, tick| {
        field(Periodic::new(&[(amplitude, frequency, phase)], tick).unwrap_err())
    };
    assert_eq!(periodic(f32::NAN, 50.0, 0.0, 1e-4), "amplitude");
    assert_eq!(field(Periodic::<f32>::new(&[], 1e-4).unwrap_err()), "tones");
    assert_eq!(
        field(Periodic::new(&[(1.0, 50.0, 0.0); MAX_TONES + 1], 1e-4).unwrap_err()),
        "tones"
    );
    assert_eq!(periodic(1.0, 5000.0, 0.0, 1e-4), "frequency");
    assert_eq!(periodic(1.0, 0.0, 0.0, 1e-4), "frequency");
    assert_eq!(periodic(1.0, 50.0, f64::NAN, 1e-4), "phase");
    assert_eq!(periodic(1.0, 50.0, 0.0, 0.0), "tick");
    assert_eq!(field(Compliance::new(0.0, 1e-4).unwrap_err()), "stiffness");
    assert_eq!(field(Compliance::new(-5.0, 1e-4).unwrap_err()), "stiffness");
    assert_eq!(
        field(Compliance::new(5.0, f32::INFINITY).unwrap_err()),
        "tick"
    );
    assert_eq!(field(Delay::new(-1e-3, 1e-4).unwrap_err()), "time");
    assert_eq!(field(Delay::new(0.02551, 1e-4).unwrap_err()), "time");
    assert_eq!(field(Delay::new(1e-3, 0.0).unwrap_err()), "tick");
    for corner in [0.9, 1.1e7, f32::NAN] {
        assert_eq!(field(ForceFilter::new(corner, 1e-4).unwrap_err()), "corner");
    }
    assert_eq!(field(ForceFilter::new(200.0, 2e3).unwrap_err()), "tick");
}

/// Effects that there are.
const EFFECTS: usize = 24;

/// One of each, of ordinary size.
fn one_of_each<R: Real>() -> AugmentedLaw<R, EFFECTS> {
    let r = R::from_f64;
    let law = Law::new(r(1.05), r(10.5), r(0.11), r(0.4)).unwrap();
    let all = [
        Effect::Offset(Offset::new(r(0.05)).unwrap()),
        Effect::Asymmetry(Asymmetry::new(r(3.0)).unwrap()),
        Effect::Hardening(Hardening::new(r(1500.0)).unwrap()),
        Effect::StickSlip(StickSlip::new(&[(r(1.2), r(0.03)), (r(0.5), r(0.1))]).unwrap()),
        Effect::Viscous(Viscous::new(r(0.006)).unwrap()),
        Effect::Relaxation(
            Relaxation::new(&[(r(1.0), r(0.05)), (r(0.5), r(0.02))], r(1e-4)).unwrap(),
        ),
        Effect::Inertia(Inertia::new(r(120.0)).unwrap()),
        Effect::LoadFriction(LoadFriction::new(r(4.0)).unwrap()),
        Effect::Directional(Directional::new(r(0.1)).unwrap()),
        Effect::Drift(
            Drift::new(r(-0.5), r(25.0))
                .and_then(|drift| drift.with_forces(r(-0.2), r(0.5)))
                .unwrap(),
        ),
        Effect::Temperature(Temperature::new(r(0.004), r(20.0)).unwrap()),
        Effect::Stop(Stop::new(&[(r(2.0), r(0.15)), (r(3.0), r(-0.1))]).unwrap()),
        Effect::BoucWen(BoucWen::new(r(0.8), r(0.04), r(1.5)).unwrap()),
        Effect::HardeningFriction(
            HardeningFriction::new(r(0.3), r(0.4), r(1.2), r(2.0), r(5.0)).unwrap(),
        ),
        Effect::Yielding(Yielding::new(r(0.4), r(0.05), r(0.3), r(0.02), r(1e-4)).unwrap()),
        Effect::ControlInput(
            ControlInput::new(
                0,
                Yielding::new(r(0.4), r(0.05), r(0.3), r(0.0), r(1e-4)).unwrap(),
                r(0.002),
            )
            .and_then(|effect| effect.with_lag(r(0.02), r(1e-4)))
            .and_then(|effect| effect.with_saturation(r(1.5)))
            .unwrap(),
        ),
        Effect::Backlash(Backlash::new(r(0.7), r(0.02), r(0.05)).unwrap()),
        Effect::Degradation(Degradation::new(r(0.6), r(0.08), r(0.3)).unwrap()),
        Effect::Weakening(Weakening::new(r(0.9), r(0.03), r(0.6), r(0.1)).unwrap()),
        Effect::Periodic(
            Periodic::new(&[(r(0.03), 50.0, 0.3), (r(0.01), 150.0, 1.0)], 1e-4).unwrap(),
        ),
        Effect::Gap(Gap::new(r(0.02), false).unwrap()),
        Effect::Compliance(Compliance::new(r(25.0), r(1e-4)).unwrap()),
        Effect::Delay(Delay::new(r(0.0023), r(1e-4)).unwrap()),
        Effect::ForceFilter(ForceFilter::new(r(200.0), r(1e-4)).unwrap()),
    ];
    assert_eq!(
        all.len(),
        DESCRIPTIONS.len(),
        "each effect of the crate is here"
    );
    all.into_iter().fold(AugmentedLaw::new(law), |law, effect| {
        law.with(effect).unwrap()
    })
}

/// f32 beside f64 on the same lines, ten cycles of 2·10^4 ticks, every effect at once.
///
/// The state of relaxation is updated by differences of displacements: each rounds by 2^-24·X = 1.2e-8 mm, which at
/// k = 1.5 kN/mm is a random walk with memory τ/Δt = 1000 ticks, √1000·1.5·1.2e-8/√3 = 3.3e-7 kN, worst 3 of these; that of
/// stick-slip is a walk over one half cycle, √10⁴·1.2·1.2e-8/√3 = 8e-7 kN. The peak force is 0.8 kN.
#[test]
fn f32_follows_f64_within_rounding() {
    let (single, double) = (one_of_each::<f32>(), one_of_each::<f64>());
    let (mut small, mut large) = (single.at_rest(), double.at_rest());
    let (mut error, mut peak) = (0.0_f64, 0.0_f64);
    for n in 0..10 * TICKS {
        let f32_force = f64::from(single.force(&mut small, &sine(0.2, 2.0, n)));
        let f64_force: f64 = double.force(&mut large, &sine(0.2, 2.0, n));
        error = error.max((f32_force - f64_force).abs());
        peak = peak.max(f64_force.abs());
    }
    assert!(error < 4e-6 * peak, "{error} of {peak}");
    assert!(error > 0.0, "f32 and f64 cannot agree to the last bit");
}

fn any_motion() -> impl Strategy<Value = Motion<f32>> {
    let number = || {
        prop_oneof![
            any::<f32>(),
            -1.0..1.0_f32,
            Just(f32::MAX),
            Just(f32::MIN_POSITIVE),
            Just(-0.0)
        ]
    };
    let controls = [number(), number(), number(), number()];
    let all = (number(), number(), number(), number(), number(), controls);
    all.prop_map(|(y, v, a, cycles, temperature, controls)| Motion {
        displacement: y,
        velocity: v,
        acceleration: a,
        cycles,
        temperature,
        controls,
    })
}

proptest! {
    /// Whatever comes in, NaN and infinities included, what goes out is finite, and so it stays afterwards.
    #[test]
    fn every_force_is_finite(motions in prop::collection::vec(any_motion(), 1..40)) {
        let law = one_of_each::<f32>();
        let mut state = law.at_rest();
        for motion in &motions {
            prop_assert!(law.force(&mut state, motion).is_finite());
        }
        prop_assert!(law.force(&mut state, &sine(0.1, 1.0, 7)).is_finite());
    }

    /// A stick-slip element never holds more than stiffness times slip limit.
    #[test]
    fn stick_slip_stays_within_its_limit(
        path in prop::collection::vec(-1.0..1.0_f64, 1..100), k in 0.01..10.0_f64, x in 1e-4..0.5_f64,
    ) {
        let law = alone(Effect::StickSlip(StickSlip::new(&[(k, x)]).unwrap()));
        let mut state = law.at_rest();
        for displacement in path {
            let force = law.force(&mut state, &Motion { displacement, ..Motion::default() });
            prop_assert!(force.abs() <= k * x * (1.0 + 1e-12));
        }
    }

    /// Passive: over any closed path a slider and a Maxwell branch take energy and give none.
    #[test]
    fn friction_and_relaxation_are_passive(
        turns in prop::collection::vec(-0.3..0.3_f64, 2..8), k in 0.1..5.0_f64, x in 1e-3..0.2_f64, tau in 1e-3..1.0_f64,
    ) {
        for effect in [
            Effect::StickSlip(StickSlip::new(&[(k, x)]).unwrap()),
            Effect::Relaxation(Relaxation::new(&[(k, tau)], 1e-3).unwrap()),
        ] {
            let law = alone(effect);
            let mut state = law.at_rest();
            let (mut work, mut y, mut before) = (0.0, 0.0, 0.0);
            law.force(&mut state, &Motion::default());
            for &target in turns.iter().chain(&[0.0]) {
                let start = y;
                for n in 1..=200 {
                    let next = start + (target - start) * f64::from(n) / 200.0;
                    let force = law.force(&mut state, &Motion { displacement: next, ..Motion::default() });
                    work += 0.5 * (force + before) * (next - y);
                    (y, before) = (next, force);
                }
            }
            prop_assert!(work > -1e-9, "{work}");
        }
    }
}
