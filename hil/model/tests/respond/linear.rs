//! A spring and a dashpot: the closed forms from any textbook on vibration.

use std::f64::consts::TAU;

use mesh_damper_model::respond::{
    Excitation, Settings, SweepRange, respond, respond_in_steps, sweep,
};

use super::{KG, fundamental, law, sampled, with};

/// 100 kg on 4 kN/mm: ω = 200 rad/s, 31.8 Hz.
const MASS: f64 = 100.0;
const STIFFNESS: f64 = 4.0;
const OMEGA: f64 = 200.0;
/// Damping ratio 0.05: c = 2ζMω, kN·s/mm.
const ZETA: f64 = 0.05;
const DASHPOT: f64 = 2.0 * ZETA * MASS * KG * OMEGA;

fn oscillator() -> mesh_damper_model::Model {
    law(STIFFNESS, 0.0, DASHPOT, 1.0)
}

#[test]
fn a_sine_force_gives_the_amplitude_and_phase_of_the_closed_form() {
    let tick = 1e-3;
    for frequency in [10.0, 25.0, 31.25, 50.0] {
        let omega = TAU * frequency;
        let force = sampled(tick, 4001, |t| 0.5 * (omega * t).sin());
        let excitation = Excitation::force(tick, force);
        let response = respond(&oscillator(), &excitation, &Settings::new(MASS)).unwrap();
        assert!(response.settled);
        let [sin, cos] = fundamental(&response.moments, tick, frequency, 5, |m| m.displacement);
        // X = P/(k − Mω² + icω)
        let (real, imaginary) = (STIFFNESS - MASS * KG * omega * omega, DASHPOT * omega);
        let size = real.hypot(imaginary);
        let amplitude = sin.hypot(cos);
        // Halving changes the motion by at most 1e-3, and the remaining error is a third of that.
        assert!(
            (amplitude * size / 0.5 - 1.0).abs() < 1e-3,
            "{frequency}: {amplitude}"
        );
        let phase = cos.atan2(sin) + imaginary.atan2(real);
        assert!(phase.abs() < 2e-3, "{frequency}: {phase}");
    }
}

#[test]
fn free_vibration_decays_as_the_closed_form() {
    let tick = 5e-4;
    let settings = Settings {
        start: [0.2, 0.0],
        tolerance: 1e-4,
        ..Settings::new(MASS)
    };
    let still = Excitation::force(tick, vec![0.0; 1001]);
    let response = respond(&oscillator(), &still, &settings).unwrap();
    let damped = OMEGA * (1.0 - ZETA * ZETA).sqrt();
    for (index, moment) in response.moments.iter().enumerate() {
        let time = tick * index as f64;
        let (sin, cos) = (damped * time).sin_cos();
        let decay = (-ZETA * OMEGA * time).exp();
        let expected = 0.2 * decay * (cos + ZETA * OMEGA / damped * sin);
        assert!(
            (moment.displacement - expected).abs() < 0.2 * 2e-4,
            "{time}"
        );
        let velocity = -0.2 * decay * OMEGA * OMEGA / damped * sin;
        assert!(
            (moment.velocity - velocity).abs() < 0.2 * OMEGA * 2e-4,
            "{time}"
        );
    }
}

#[test]
fn a_moving_base_is_transmitted_as_the_closed_form() {
    let range = SweepRange {
        from: 5.0,
        to: 120.0,
        points: 12,
    };
    let settings = Settings::new(MASS);
    let found = sweep(&oscillator(), &settings, &[0.05, 1.0], range, &mut |_| ()).unwrap();
    assert_eq!(found.points.len(), 24);
    for point in &found.points {
        let ratio = TAU * point.frequency / OMEGA;
        // X/B = (1 + 2iζr)/(1 − r² + 2iζr)
        let (damping, rest) = (2.0 * ZETA * ratio, 1.0 - ratio * ratio);
        let expected = (1.0_f64).hypot(damping) / rest.hypot(damping);
        let phase = (damping.atan2(1.0) - damping.atan2(rest)).to_degrees();
        assert!(point.steady && point.change < 2e-3, "{point:?}");
        assert!(
            (point.transmissibility / expected - 1.0).abs() < 1e-3,
            "{point:?} {expected}"
        );
        assert!((point.phase - phase).abs() < 0.1, "{point:?} {phase}");
        assert!(
            (point.peak / point.transmissibility - 1.0).abs() < 2e-3,
            "{point:?}"
        );
    }
}

#[test]
fn the_error_falls_with_the_square_of_the_step() {
    let tick = 2e-3;
    let omega = TAU * 12.5;
    let force = sampled(tick, 1001, |t| 0.5 * (omega * t).sin());
    let excitation = Excitation::force(tick, force);
    let run = |substeps| {
        respond_in_steps(&oscillator(), &excitation, &Settings::new(MASS), substeps)
            .unwrap()
            .0
    };
    let finest = run(512);
    let error = |substeps| {
        let squares = run(substeps)
            .into_iter()
            .zip(&finest)
            .map(|(coarse, fine)| (coarse.displacement - fine.displacement).powi(2));
        squares.sum::<f64>().sqrt()
    };
    let errors = [8, 16, 32].map(error);
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((1.8..2.2).contains(&order), "{errors:?}");
    }
}

#[test]
fn a_base_that_steps_swings_the_mass_about_its_new_place() {
    let tick = 1e-3;
    let base = sampled(tick, 800, |t| if t < 0.1 { 0.0 } else { 1.0 });
    let response = respond(
        &oscillator(),
        &Excitation::base(tick, base),
        &Settings::new(MASS),
    )
    .unwrap();
    let damped = OMEGA * (1.0 - ZETA * ZETA).sqrt();
    for (index, moment) in response.moments.iter().enumerate() {
        // The step lies in the middle of the tick before the first sample with the step.
        let time = tick * (index as f64 - 99.5);
        if time.abs() < 2.0 * tick {
            continue;
        }
        let expected = if time < 0.0 {
            0.0
        } else {
            let (sin, cos) = (damped * time).sin_cos();
            // The dashpot passes the step on as an impulse.
            1.0 - (-ZETA * OMEGA * time).exp() * (cos - ZETA * OMEGA / damped * sin)
        };
        assert!(
            (moment.displacement - expected).abs() < 0.01,
            "{time}: {moment:?} {expected}"
        );
        let relative = moment.displacement - if index < 100 { 0.0 } else { 1.0 };
        assert!(
            (moment.relative_displacement - relative).abs() < 1e-9,
            "{time}"
        );
    }
}

#[test]
fn the_rate_of_the_recording_does_not_matter() {
    let force = |t: f64| 0.3 * (TAU * 40.0 * t).sin() + 0.2 * (TAU * 17.0 * t).sin();
    let run = |tick: f64, count| {
        let excitation = Excitation::force(tick, sampled(tick, count, force));
        respond(&oscillator(), &excitation, &Settings::new(MASS))
            .unwrap()
            .moments
    };
    // Five samples in a period of the faster sine, and fifty.
    let (slow, fast) = (run(5e-3, 201), run(5e-4, 2001));
    let size = super::peak(&fast, 2001, |m| m.displacement);
    for (index, moment) in slow.iter().enumerate().take(175) {
        let same = fast[10 * index];
        assert!(
            (moment.displacement - same.displacement).abs() < 3e-3 * size,
            "{index}"
        );
    }
}

#[test]
fn the_models_own_mass_is_a_mass() {
    let tick = 1e-3;
    let force = sampled(tick, 500, |t| 0.5 * (TAU * 20.0 * t).sin());
    let excitation = Excitation::force(tick, force);
    let own = with(oscillator(), "inertia", &[("mass", MASS)]);
    let carried = respond(&own, &excitation, &Settings::new(0.0)).unwrap();
    let fastened = respond(&oscillator(), &excitation, &Settings::new(MASS)).unwrap();
    assert_eq!(carried.model_mass, MASS);
    for (own, other) in carried.moments.iter().zip(&fastened.moments) {
        assert_eq!(own.displacement, other.displacement);
        // The reading of the damper's channel: all of the force, or all except the part that moves the mass.
        let inertia = MASS * KG * own.acceleration;
        assert!((own.force - other.force - inertia).abs() < 1e-12);
    }
}
