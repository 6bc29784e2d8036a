//! Maxwell branches against their moduli, and over long times in f32.

use std::f64::consts::TAU;

use mesh_damper::effects::{Effect, Motion, Relaxation};

use crate::loops::{TICKS, alone, close, last_cycle, moduli};

/// Storage k·(ωτ)²/(1 + (ωτ)²) and loss k·ωτ/(1 + (ωτ)²).
#[test]
fn relaxation_has_the_moduli_of_a_maxwell_branch() {
    for frequency in [0.5, 3.0, 10.0] {
        let tick = 1.0 / (frequency * TICKS as f64);
        let effect = Effect::Relaxation(Relaxation::new(&[(1.5, 0.05)], tick).unwrap());
        // The start has decayed after 10 cycles: e^(−10/(10·0.05)) at the fastest.
        let (storage, loss) = moduli(&last_cycle(effect, 0.1, frequency, 40), 0.1);
        let x = TAU * frequency * 0.05;
        // Straight lines between ticks: an error of (ωΔt)²/12 = 8e-9, and e^(−80) of the start.
        close(storage, 1.5 * x * x / (1.0 + x * x), 1e-6);
        close(loss, 1.5 * x / (1.0 + x * x), 1e-6);
    }
}

/// Branches act in parallel.
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

/// The force of a step held for one time constant decays to 1/e in f32 too, for any decay per tick.
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
            force = law.force(&mut state, &Motion::at(1.0, 0.0));
        }
        // The step takes a tick, so the decay is half a tick short of τ. loss = Δt/τ rounds by 2^-24 of itself; the sum over the
        // ticks is compensated.
        let expected = 1.2 * (-1.0 + 0.5e-4 / f64::from(time)).exp();
        close(f64::from(force), expected, 1e-6);
    }
}
