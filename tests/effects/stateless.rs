//! Effects without a state: a dashpot, a mass, elastic forces, an offset; and tones, which have only a phase.

use std::f64::consts::{PI, TAU};

use mesh_damper::effects::{
    Asymmetry, Effect, Hardening, Inertia, Motion, Offset, Periodic, Viscous,
};

use crate::loops::{TICKS, alone, close, energy, last_cycle, moduli};

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

/// Several tones are the sum of the separate tones.
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
