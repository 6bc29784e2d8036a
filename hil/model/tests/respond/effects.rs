//! The action of each effect of a model on a mass.

use std::f64::consts::TAU;

use mesh_damper_model::predict::{nrmse, predict};
use mesh_damper_model::respond::{Excitation, Settings, respond};
use mesh_damper_model::{LawNode, Model};
use mesh_damper_recording::Recording;
use mesh_damper_recording::trajectory::Trajectory;

use super::{KG, fundamental, law, sampled, with};

/// A dashpot behind a spring: the spring has no mass, and the mass moves its outer end.
#[test]
fn a_series_spring_lies_between_mass_and_damper() {
    let (spring, dashpot, mass) = (5.0, 0.02, 40.0);
    let model = with(
        law(0.0, 0.0, dashpot, 1.0),
        "compliance",
        &[("stiffness", spring)],
    );
    let (tick, frequency) = (5e-4, 25.0);
    let omega = TAU * frequency;
    let force = sampled(tick, 8001, |t| (omega * t).cos());
    let response = respond(
        &model,
        &Excitation::force(tick, force),
        &Settings::new(mass),
    )
    .unwrap();
    // The mean of the displacement is that at the start.
    let [sin, cos] = fundamental(&response.moments, tick, frequency, 10, |m| m.velocity);
    // Spring and dashpot in series: D = K·icω/(K + icω); V = iωP/(D − Mω²).
    let (c, size) = (dashpot * omega, spring * spring + (dashpot * omega).powi(2));
    let real = spring * c * c / size - mass * KG * omega * omega;
    let imaginary = spring * spring * c / size;
    let expected = omega / real.hypot(imaginary);
    assert!(
        (sin.hypot(cos) / expected - 1.0).abs() < 3e-3,
        "{} {expected}",
        sin.hypot(cos)
    );
}

#[test]
fn a_mass_within_a_gap_floats() {
    let model = with(
        law(3.0, 0.0, 0.1, 0.4),
        "gap",
        &[("half_width", 0.5), ("damps_inside", 0.0)],
    );
    let settings = Settings {
        start: [0.0, 10.0],
        ..Settings::new(20.0)
    };
    let tick = 1e-3;
    let response = respond(&model, &Excitation::force(tick, vec![0.0; 400]), &settings).unwrap();
    for (index, moment) in response.moments.iter().enumerate().take(49) {
        assert!((moment.displacement - 0.01 * index as f64).abs() < 1e-9);
    }
    let most = response
        .moments
        .iter()
        .map(|m| m.displacement)
        .fold(0.0, f64::max);
    assert!(most > 0.505, "{most}");
    let end = response.moments.last().unwrap();
    assert!(
        end.velocity.abs() < 10.0,
        "what lies behind the gap takes energy"
    );
}

/// A spring with a stiffness over amplitude: 1 kN/mm at 0.1 mm, 2 kN/mm at 0.2 mm.
#[test]
fn coefficients_are_those_of_the_last_half_cycle() {
    let node = |amplitude, k1| LawNode {
        amplitude,
        k1,
        k3: 0.0,
        c: 0.0,
        alpha: 0.5,
    };
    let model = Model {
        law: vec![node(0.1, 1.0), node(0.2, 2.0)],
        effects: Vec::new(),
        correction: None,
        controls: Vec::new(),
    };
    let (mass, tick) = (10.0, 1e-4);
    let settings = Settings {
        start: [0.15, 0.0],
        ..Settings::new(mass)
    };
    let response = respond(
        &model,
        &Excitation::force(tick, vec![0.0; 20_001]),
        &settings,
    )
    .unwrap();
    let moments = &response.moments;
    let crossings: Vec<f64> = (1..moments.len())
        .filter(|&i| moments[i - 1].displacement < 0.0 && moments[i].displacement >= 0.0)
        .map(|i| {
            let [before, now] = [i - 1, i].map(|i| moments[i].displacement);
            tick * (i as f64 - now / (now - before))
        })
        .collect();
    // The first half cycle has the coefficients of the smallest amplitude. At its end the spring becomes stiffer in the middle of
    // the swing, where no energy changes, and the amplitude becomes smaller. This repeats until amplitude and stiffness agree.
    let last = &moments[moments.len() - 2000..];
    let amplitude = last
        .iter()
        .fold(0.0_f64, |most, m| most.max(m.displacement.abs()));
    let stiffness = 1.0 + (amplitude - 0.1) / 0.1;
    let frequency = (stiffness / (mass * KG)).sqrt() / TAU;
    let cycles = crossings.len() - 1;
    let found = 10.0 / (crossings[cycles] - crossings[cycles - 10]);
    assert!(
        (found / frequency - 1.0).abs() < 2e-3,
        "{found} {frequency} {amplitude}"
    );
    assert!((0.1..0.15).contains(&amplitude), "{amplitude}");
}

#[test]
fn what_belongs_to_the_measurement_is_left_out_by_name() {
    let bare = law(2.0, 1.0, 0.05, 0.4);
    let mut model = bare.clone();
    for (family, parameters) in [
        ("offset", &[("force", 0.3)][..]),
        ("delay", &[("time", 0.002)]),
        (
            "periodic",
            &[("amplitude", 0.1), ("frequency", 50.0), ("phase", 0.0)],
        ),
    ] {
        model = with(model, family, parameters);
    }
    let tick = 1e-3;
    let force = sampled(tick, 600, |t| 0.4 * (TAU * 12.0 * t).sin());
    let excitation = Excitation::force(tick, force);
    let settings = Settings::new(50.0);
    let response = respond(&model, &excitation, &settings).unwrap();
    let named: Vec<&str> = response.left_out.iter().map(|one| one.family).collect();
    assert_eq!(named, ["offset", "delay", "periodic"]);
    let plain = respond(&bare, &excitation, &settings).unwrap();
    assert_eq!(plain.moments, response.moments);
    // An unbalanced preload pushes the mass.
    let settings = Settings {
        offset: true,
        ..settings
    };
    let still = Excitation::force(tick, vec![0.0; 4000]);
    let pushed = respond(&model, &still, &settings).unwrap();
    assert!(pushed.left_out.iter().all(|one| one.family != "offset"));
    let at = pushed.moments.last().unwrap().displacement;
    // k1·y + k3·y³ = −f0 gives y = −0.1484 mm, apart from the friction that the damping holds.
    assert!((at + 0.148_4).abs() < 0.01, "{at}");
}

/// The motion and the force of the response are a recording of the same damper.
#[test]
fn a_prediction_of_the_response_gives_the_force_back() {
    let mut model = law(2.0, 4.0, 0.05, 0.4);
    for (family, parameters) in [
        ("inertia", &[("mass", 30.0)][..]),
        ("stick_slip", &[("stiffness", 0.8), ("slip_limit", 0.03)]),
        ("relaxation", &[("stiffness", 0.4), ("time", 0.05)]),
    ] {
        model = with(model, family, parameters);
    }
    let tick = 5e-4;
    let force = sampled(tick, 4000, |t| {
        0.6 * (t / 0.3).min(1.0) * (TAU * 8.0 * t).sin()
    });
    let settings = Settings {
        tolerance: 1e-4,
        ..Settings::new(70.0)
    };
    let response = respond(&model, &Excitation::force(tick, force), &settings).unwrap();
    let channel = |of: fn(&mesh_damper_model::respond::Moment) -> f64| {
        response.moments.iter().map(of).collect::<Vec<f64>>()
    };
    let time = sampled(tick, 4000, |t| t);
    let recording = Recording::new(
        "response",
        time,
        channel(|m| m.relative_displacement),
        channel(|m| m.force),
    )
    .and_then(|recording| recording.with_velocity(channel(|m| m.relative_velocity)))
    .unwrap();
    let trajectory = Trajectory::of(&recording).unwrap();
    let predicted = predict(&model, &trajectory).unwrap();
    let error = nrmse(&predicted, &trajectory.force, |_| true);
    assert!(error < 0.01, "{error}");
}
