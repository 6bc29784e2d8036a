//! Changes during a test that are not effects of the specimen, or not listed effects.

use std::f64::consts::TAU;

use mesh_damper_identify::trace::result::{TraceResult, Verdict};

use super::{RATE, random, recorded, rms, steps, traced};

/// A step of the zero in the middle of a test is not an effect of the specimen, and hides none.
#[test]
#[ignore = "half a minute: in the full tier"]
fn a_zero_that_steps_is_moved_back() {
    let test = |stiffness: f64, change: f64, motion: &dyn Fn(f64) -> [f64; 2], seed: u64| {
        let mut recording = recorded(motion, 5e-3, 5e-5, seed);
        let change = change * rms(&recording.force);
        let (mut stretch, mut before) = (0.0, motion(0.0)[0]);
        for (force, time) in recording.force.iter_mut().zip(&recording.time) {
            let [y, _] = motion(*time);
            stretch = f64::clamp(stretch + y - before, -0.03, 0.03);
            before = y;
            *force += stiffness * stretch + if *time > 12.1 { change } else { 0.0 };
        }
        recording
    };
    let families = |result: &TraceResult| -> Vec<String> {
        let effects = result.effects.iter();
        effects.map(|effect| effect.family.clone()).collect()
    };
    for (change, stiffness) in [(0.05, 0.0), (-0.3, 0.0), (0.1, 1.5)] {
        let result = traced(
            test(stiffness, change, &random(5), 5),
            test(stiffness, 0.0, &random(6), 6),
        );
        let expected: &[&str] = if stiffness > 0.0 {
            &["stick_slip"]
        } else {
            &[]
        };
        assert_eq!(
            families(&result),
            expected,
            "{change}: {:?}",
            result.warnings
        );
        assert!(
            matches!(result.verdict, Verdict::None | Verdict::Found),
            "{change}: {:?} {:?}",
            result.verdict,
            result.warnings
        );
        let names_step = |warning: &String| {
            warning.contains("the zero of the force steps by") && warning.contains("at 12.10")
        };
        assert!(
            result.warnings.iter().any(names_step),
            "{:?}",
            result.warnings
        );
    }
    let result = traced(test(0.0, 0.1, &steps(5), 5), test(0.0, 0.0, &steps(6), 6));
    assert_eq!(result.verdict, Verdict::None, "{:?}", result.warnings);
    let names_step = |warning: &String| warning.contains("the zero of the force steps by");
    assert!(
        result.warnings.iter().any(names_step),
        "{:?}",
        result.warnings
    );
}

/// A specimen that warms up as it works softens with the swell of a modulated sine. The change has a frequency of the motion, which
/// no outside tone has.
#[test]
fn what_swells_with_the_motion_is_no_tone() {
    let (carrier, swell, depth) = (3.0, 0.1, 0.35);
    let motion = |size: f64| {
        let tones = [
            (carrier, 1.0),
            (carrier + swell, depth),
            (carrier - swell, depth),
        ];
        move |time: f64| {
            tones.iter().fold([0.0; 2], |[y, v], (frequency, part)| {
                let turn = TAU * frequency;
                let (sin, cos) = (turn * time).sin_cos();
                [y + size * part * sin, v + size * part * turn * cos]
            })
        }
    };
    let test = |size: f64, lasts: f64, softer: f64, seed: u64| {
        let motion = motion(size);
        let mut recording = recorded(motion, 5e-3, 5e-5, seed);
        let work = |force: f64, time: f64| force * motion(time)[1];
        let moments = recording.force.iter().zip(&recording.time);
        let mean = moments
            .map(|(force, time)| work(*force, *time))
            .sum::<f64>()
            / recording.force.len() as f64;
        let mut warmth = 0.0;
        for (force, time) in recording.force.iter_mut().zip(&recording.time) {
            let heat = work(*force, *time) / mean;
            *force *= 1.0 - softer * warmth;
            warmth += (heat - warmth) / (lasts * RATE);
        }
        recording
    };
    for (lasts, softer) in [(5.0, 0.1), (20.0, 0.2)] {
        let result = traced(test(0.08, lasts, softer, 1), test(0.064, lasts, softer, 2));
        assert_ne!(result.verdict, Verdict::None);
        let named = result
            .effects
            .iter()
            .any(|effect| effect.family == "periodic");
        assert!(!named, "{lasts} s: {:?}", result.effects);
    }
}

/// The mean force of a specimen that is stiffer on one side changes with the amplitude. That is not a step of the zero.
#[test]
fn a_mean_that_changes_with_the_amplitude_is_no_step_of_the_zero() {
    let sines = |time: f64| {
        let amplitude = [0.05, 0.1, 0.05, 0.1][((time / 7.5) as usize).min(3)];
        let (sin, cos) = (TAU * 4.0 * time).sin_cos();
        [amplitude * sin, amplitude * TAU * 4.0 * cos]
    };
    let test = |stiffness: f64, power: i32, seed: u64| {
        let mut recording = recorded(sines, 5e-3, 5e-5, seed);
        for (force, time) in recording.force.iter_mut().zip(&recording.time) {
            *force += stiffness * sines(*time)[0].abs().powi(power);
        }
        recording
    };
    // A listed effect and an unlisted one.
    for power in [2, 1] {
        let result = traced(test(2.0, power, 1), test(2.0, power, 2));
        let names_step = |warning: &String| warning.contains("the zero of the force");
        assert!(
            !result.warnings.iter().any(names_step),
            "{power}: {:?}",
            result.warnings
        );
        assert_ne!(result.verdict, Verdict::None, "{power}");
    }
}
