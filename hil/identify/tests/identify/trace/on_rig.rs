//! A rig whose fixture has a mass, whose displacement is late, or whose displacement has another zero: stated, or to be found.

use super::*;
use mesh_damper_identify::trace::result::FoundEffect;
use mesh_damper_recording::rig::{DisplacementZero, RigFacts};
use rand::RngExt as _;

/// Amplitude mm, frequency Hz, cycles.
const CONDITIONS: [(f64, f64, u32); 9] = [
    (0.1, 1.0, 5),
    (0.1, 5.0, 8),
    (0.1, 20.0, 24),
    (0.4, 1.0, 5),
    (0.4, 5.0, 8),
    (0.4, 20.0, 24),
    (1.0, 1.0, 5),
    (1.0, 5.0, 8),
    (1.0, 20.0, 24),
];

/// kN/mm, s
const BRANCH: (f64, f64) = (0.3, 0.012);
/// kN/mm, mm
const SLIDER: (f64, f64) = (1.5, 0.02);

/// What stands between specimen and recording.
#[derive(Clone, Copy, Default)]
struct Rig {
    /// kg
    mass: f64,
    /// Of the displacement, s.
    late: f64,
    /// The displacement that is recorded at 0, mm.
    zero: f64,
}

/// A spring that hardens, a branch that relaxes and a slider, which start at rest.
fn record(rig: Rig, seed: u64) -> Recording {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = |deviation: f64| Normal::new(0.0, deviation).unwrap().sample(&mut random);
    let (mut time, mut displacement, mut force) = (Vec::new(), Vec::new(), Vec::new());
    let (mut branch, mut slider) = (branch(BRANCH.0, BRANCH.1), slider(SLIDER.0, SLIDER.1));
    let mut put = |y: f64, v: f64, a: f64, recorded: f64| {
        let sample = (0.0, y, v, a);
        let specimen = 0.8 * y + 0.25 * y.powi(3) + branch(&sample) + slider(&sample);
        time.push(time.len() as f64 * TICK);
        displacement.push(recorded + rig.zero + normal(5e-5));
        force.push(specimen + 1e-6 * rig.mass * a + normal(1e-3));
    };
    (0..100).for_each(|_| put(0.0, 0.0, 0.0, 0.0));
    for (amplitude, frequency, cycles) in CONDITIONS {
        let omega = TAU * frequency;
        for n in 0..(f64::from(cycles) / frequency / TICK).round() as usize {
            let phase = omega * n as f64 * TICK;
            let recorded = amplitude * (phase - omega * rig.late).sin();
            let (sin, cos) = phase.sin_cos();
            put(
                amplitude * sin,
                amplitude * omega * cos,
                -amplitude * omega * omega * sin,
                recorded,
            );
        }
    }
    Recording::new("rig", time, displacement, force).unwrap()
}

fn traced_on(facts: RigFacts, rig: Rig, seed: u64) -> Trace {
    let sought = Sought::default().on_rig(facts).unwrap();
    trace_for(&sought, &[record(rig, seed)], &[], &|_| ()).unwrap()
}

/// The branch and the slider, and nothing else.
fn assert_specimen(found: &Trace, what: &str) {
    let mut named = families(&found.result);
    named.sort_unstable();
    assert_eq!(named, ["relaxation", "stick_slip"], "{what}");
    for (family, parameter, truth) in [
        ("relaxation", "stiffness", BRANCH.0),
        ("relaxation", "time", BRANCH.1),
        ("stick_slip", "stiffness", SLIDER.0),
        ("stick_slip", "slip_limit", SLIDER.1),
    ] {
        let mut effects = found.result.effects.iter();
        let effect = effects.find(|effect| effect.family == family).unwrap();
        let value = effect.parameters[parameter].value;
        assert!(
            (value / truth - 1.0).abs() < 0.06,
            "{what}: {family} {parameter} {value}"
        );
    }
}

#[test]
fn a_mass_and_a_delay_that_are_stated_are_not_fitted() {
    for seed in 0..2 {
        let mut random = ChaCha8Rng::seed_from_u64(40 + seed);
        let rig = Rig {
            mass: random.random_range(2.0..8.0),
            late: random.random_range(5e-4..4e-3),
            zero: 0.0,
        };
        let facts = RigFacts {
            fixture_mass: Some(rig.mass),
            force_delay: Some(-rig.late),
            zero: None,
        };
        let found = traced_on(facts, rig, seed);
        assert_specimen(&found, &format!("seed {seed}"));
        assert_eq!(found.result.rig, facts);
        assert_eq!(found.result.baseline.known, ["inertia"]);
        let file = found.model_file();
        assert_eq!(file.rig(), facts);
        let effects = file.model().effects;
        let inertia = effects
            .iter()
            .find(|one| one.family.name() == "inertia")
            .unwrap();
        assert_eq!(inertia.parameters["mass"], rig.mass);
        assert_eq!(found.result.remainder, None);
    }
}

#[test]
#[ignore = "half a minute: in the full tier"]
fn a_displacement_that_is_late_is_found_and_said() {
    for seed in 0..2 {
        let late = ChaCha8Rng::seed_from_u64(50 + seed).random_range(1.5e-3..2.5e-3);
        let rig = Rig {
            late,
            ..Rig::default()
        };
        let found = traced_on(RigFacts::default(), rig, seed);
        let early = -found.recordings[0].trajectory.late;
        assert!((early - late).abs() < 0.15 * TICK, "{early} s for {late} s");
        assert!(
            found
                .result
                .warnings
                .iter()
                .any(|text| text.contains("early"))
        );
        assert_specimen(&found, &format!("{late} s"));
    }
}

/// A load cell that is compensated for more than the mass: never another effect in its place.
#[test]
fn a_mass_below_zero_is_a_mass() {
    for seed in 0..2 {
        let mass = -ChaCha8Rng::seed_from_u64(60 + seed).random_range(3.0..9.0);
        let slides = || {
            let mut slider = slider(0.9, 0.04);
            move |sample: &Sample| slider(sample) + 1e-5 * mass * sample.3
        };
        let found = traced(0.004, seed, slides);
        let mut named = families(&found.result);
        named.sort_unstable();
        assert_eq!(named, ["inertia", "stick_slip"], "{mass} kg");
        let mut effects = found.result.effects.iter();
        let inertia = effects.find(|one| one.family == "inertia").unwrap();
        let value = inertia.parameters["mass"].value;
        assert!(
            (value / (10.0 * mass) - 1.0).abs() < 0.1,
            "{value} kg for {mass} kg"
        );
    }
}

#[test]
#[ignore = "half a minute: in the full tier"]
fn the_displacement_is_counted_from_the_stated_zero() {
    let rig = Rig {
        zero: 0.03,
        ..Rig::default()
    };
    for (zero, expected) in [
        (DisplacementZero::Start, 0.03),
        (DisplacementZero::Mean, 0.03),
        (DisplacementZero::None, 0.0),
    ] {
        let facts = RigFacts {
            zero: Some(zero),
            ..RigFacts::default()
        };
        let found = traced_on(facts, rig, 3);
        let centre = found.recordings[0].trajectory.centre;
        assert!((centre - expected).abs() < 2e-3, "{zero:?}: {centre}");
        if expected > 0.0 {
            assert_specimen(&found, &format!("{zero:?}"));
        }
    }
}

#[test]
fn facts_that_no_rig_has_are_refused() {
    let refused = |facts: RigFacts| Sought::default().on_rig(facts).unwrap_err().to_string();
    let mass = |mass| RigFacts {
        fixture_mass: Some(mass),
        ..RigFacts::default()
    };
    assert!(refused(mass(f64::NAN)).contains("fixture_mass"));
    assert!(refused(mass(1e9)).contains("fixture_mass"));
    let delay = RigFacts {
        force_delay: Some(f64::INFINITY),
        ..RigFacts::default()
    };
    assert!(refused(delay).contains("force_delay"));
    let twice = Sought::default().on_rig(mass(1.0)).unwrap();
    assert!(twice.on_rig(mass(2.0)).is_err());
    // Longer than the recording.
    let sought = Sought::default().on_rig(RigFacts {
        force_delay: Some(1e3),
        ..RigFacts::default()
    });
    let error = trace_for(&sought.unwrap(), &[record(Rig::default(), 1)], &[], &|_| ());
    assert!(error.unwrap_err().to_string().contains("--force-delay"));
}

/// A spring that hardens evenly about another zero than the recorded one has the same force, beside a slider too.
#[test]
fn an_asymmetry_is_in_doubt_with_the_zero() {
    let zero = 0.05;
    let uneven = |&(_, y, _, _): &Sample| -3.0 * K3 * zero * y * y;
    let traced = |sought: &Sought, slips: f64| {
        let recorded = |name, blocks: &[(f64, f64, u32)], seed| {
            let mut slider = slider(slips, 0.04);
            super::record(name, blocks, 0.004, seed, |s| uneven(s) + slider(s))
        };
        let fitted = recorded("fitted", &BLOCKS, 7);
        let held = recorded("held", &OTHERS, 8);
        trace_for(sought, &[fitted], &[held], &|_| ())
            .unwrap()
            .result
    };
    let names = |effects: &[FoundEffect]| -> Vec<String> {
        effects.iter().map(|effect| effect.family.clone()).collect()
    };
    let is_told = |text: &String| text.contains("--zero") && text.contains("0.05");

    let known = traced(&Sought::at_recorded_zero(), 0.0);
    assert_eq!(
        (known.verdict, &names(&known.effects)[..]),
        (Verdict::Found, &["asymmetry".to_owned()][..])
    );
    assert!(!known.warnings.iter().any(is_told) && known.separating_test.is_none());

    let alone = traced(&Sought::default(), 0.0);
    assert_eq!(
        (alone.verdict, &names(&alone.effects)[..]),
        (Verdict::Ambiguous, &["asymmetry".to_owned()][..])
    );
    assert_eq!(alone.effects[0].rivals, ["zero"]);
    assert!(alone.separating_test.iter().any(is_told));

    let beside = traced(&Sought::default(), 0.9);
    assert_eq!(beside.verdict, Verdict::Found);
    assert_eq!(names(&beside.effects), ["stick_slip"]);
    assert_eq!(names(&beside.unconfirmed), ["asymmetry"]);
    assert!(beside.warnings.iter().any(is_told));
}
