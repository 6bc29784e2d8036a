//! Sliders against Jenkins elements and Masing's rule.

use std::f64::consts::TAU;

use mesh_damper::effects::{Effect, Motion, Relaxation, StickSlip};
use proptest::prelude::*;

use crate::loops::{TICKS, alone, close, energy, last_cycle, work};

/// 4·k·x·(X − x) for each slider, and 0 below its slip limit.
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
    // A slider's corner falls within a tick: an error of second order in the tick.
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

/// Masing: the unloading branch is the backbone reversed and doubled, F(y) = F(X) − 2·B((X − y)/2).
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

proptest! {
    /// The force of a stick-slip element never exceeds stiffness times slip limit.
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

    /// Passive: over any closed path a slider and a Maxwell branch absorb energy and supply none.
    #[test]
    fn friction_and_relaxation_are_passive(
        turns in prop::collection::vec(-0.3..0.3_f64, 2..8), k in 0.1..5.0_f64, x in 1e-3..0.2_f64, tau in 1e-3..1.0_f64,
    ) {
        for effect in [
            Effect::StickSlip(StickSlip::new(&[(k, x)]).unwrap()),
            Effect::Relaxation(Relaxation::new(&[(k, tau)], 1e-3).unwrap()),
        ] {
            let work = work(effect, turns.iter().copied().chain([0.0]), 200);
            prop_assert!(work > -1e-9, "{work}");
        }
    }
}
