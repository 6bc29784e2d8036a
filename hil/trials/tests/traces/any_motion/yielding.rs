//! A dashpot that yields is identified under random motion, and so are its limiting cases, a slider and a Maxwell branch.

use mesh_damper_identify::trace::result::{TraceResult, Verdict};
use mesh_damper_recording::Recording;
use mesh_damper_rig::specimen::{DamperForce, HiddenEffect, SlipShape, Specimen};
use rand::SeedableRng;
use rand::rngs::StdRng;
use rand_distr::{Distribution, Normal};

use super::{DURATION, RATE, law, rms, tones};
use crate::support::families;

/// Calls of the specimen per sample.
const CALLS: usize = 8;
/// Noise of the force over its RMS.
const NOISE: f64 = 5e-3;

/// A specimen with the hidden effect `effect`, under noise of 0.3 to 12 Hz.
fn recorded(effect: HiddenEffect, seed: u64) -> Recording {
    let mut random = StdRng::seed_from_u64(seed);
    let tones = tones(&mut random);
    let mut specimen = Specimen::new(law()).with(effect);
    let dt = 1.0 / (RATE * CALLS as f64);
    let (mut time, mut displacement, mut force) = (Vec::new(), Vec::new(), Vec::new());
    for call in 0..(RATE * DURATION) as usize * CALLS {
        let t = call as f64 * dt;
        let [y, v, a] = tones
            .iter()
            .fold([0.0; 3], |[y, v, a], [size, turn, phase]| {
                let (sin, cos) = (turn * t + phase).sin_cos();
                [
                    y + size * sin,
                    v + size * turn * cos,
                    a - size * turn * turn * sin,
                ]
            });
        let answered = specimen.force(t, y, v, a, dt);
        if call % CALLS == 0 {
            time.push(t);
            displacement.push(y);
            force.push(answered);
        }
    }
    let noise = Normal::new(0.0, NOISE * rms(&force)).unwrap();
    let force = force.iter().map(|force| force + noise.sample(&mut random));
    let force = force.collect();
    Recording::new("random motion", time, displacement, force).unwrap()
}

fn traced(effect: HiddenEffect, seed: u64) -> TraceResult {
    super::traced(recorded(effect, seed), recorded(effect, seed + 1))
}

#[test]
fn it_is_named_and_has_its_parameters() {
    let (stiffness, force, rate, c) = (1.2, 0.03, 0.6, 0.01);
    let effect = HiddenEffect::Yielding {
        stiffness,
        force,
        rate,
        c,
    };
    let result = traced(effect, 1);
    assert_eq!(result.verdict, Verdict::Found, "{:?}", families(&result));
    assert_eq!(families(&result), ["yielding"]);
    let found = |name: &str| result.effects[0].parameters[name].value;
    for (name, truth) in [
        ("stiffness", stiffness),
        ("yield_stretch", force / stiffness),
        ("rate", rate),
        ("time", c / stiffness),
    ] {
        let part = found(name) / truth;
        assert!((part - 1.0).abs() < 0.03, "{name}: {} {truth}", found(name));
    }
    // In addition to the noise of the force there is the error of the velocity, where |v|^α is steep.
    let [before, after] = [
        result.baseline.nrmse_held_out,
        result.augmented.nrmse_held_out,
    ];
    assert!(before > 0.1 && after < 2.0 * NOISE, "{before} {after}");
}

/// The general form does equally well on them, with two more parameters.
#[test]
fn what_it_is_at_its_ends_keeps_its_name() {
    let slider = HiddenEffect::StickSlip {
        stiffness: 1.2,
        slip_limit: 0.02,
        shape: SlipShape::Sharp,
    };
    let branch = HiddenEffect::Relaxation {
        stiffness: 0.9,
        time: 0.05,
    };
    for (effect, family) in [(slider, "stick_slip"), (branch, "relaxation")] {
        let result = traced(effect, 5);
        assert_eq!(result.verdict, Verdict::Found, "{:?}", families(&result));
        assert_eq!(families(&result), [family]);
    }
}
