//! Damping that depends on the direction, a slider behind a play, and elements that degrade, each simulated by a few independent
//! lines.

use mesh_damper_identify::trace::Trace;
use mesh_damper_identify::trace::result::Verdict;

use super::{ALPHA, C, Sample, families, traced};

/// Noise of the force over its RMS.
const NOISE: f64 = 0.004;

/// The only effect found is of `family`, with each of `parameters` within a fraction of the truth.
fn is_found(trace: &Trace, family: &str, parameters: &[(&str, f64, f64)]) {
    let result = &trace.result;
    assert_eq!(families(&trace.result), [family], "{:?}", result.verdict);
    assert_eq!(result.verdict, Verdict::Found, "{family}");
    let found = &result.effects[0].parameters;
    for (name, truth, part) in parameters {
        let found = &found[*name];
        assert!(
            (found.value - truth).abs() < part * truth.abs(),
            "{name}: {} for {truth}",
            found.value
        );
        assert!(found.low < found.high);
    }
    let left = result.augmented.nrmse_held_out;
    assert!(left < 1.3 * NOISE, "{family}: {left}");
}

/// The law's coefficients are as exact as without the effect: they are the mean of both directions.
#[test]
fn damping_that_differs_between_the_directions_is_named() {
    for (seed, difference) in [(31, 0.3), (32, -0.08)] {
        let trace = traced(NOISE, seed, || {
            move |s: &Sample| difference * C * s.2.abs().powf(ALPHA)
        });
        is_found(&trace, "directional", &[("difference", difference, 0.03)]);
        let c = trace.model.law[0].c;
        assert!((c - C).abs() < 0.01 * C, "{c}");
    }
}

/// The slider, whose place is stored, carries the play along.
fn backlash(k: f64, x: f64, s: f64) -> impl FnMut(&Sample) -> f64 {
    let mut slider = None;
    move |&(_, y, _, _)| {
        let place = slider.get_or_insert(y);
        let reach = x + 0.5 * s;
        *place = place.clamp(y - reach, y + reach);
        let apart = y - *place;
        k * (apart - apart.clamp(-0.5 * s, 0.5 * s))
    }
}

#[test]
fn friction_behind_a_play_is_named() {
    let trace = traced(NOISE, 33, || backlash(1.5, 0.015, 0.06));
    let truth = [
        ("stiffness", 1.5, 0.05),
        ("slip_limit", 0.015, 0.05),
        ("slack", 0.06, 0.03),
    ];
    is_found(&trace, "backlash", &truth);
}

/// The secant to the farthest displacement so far, and a parabola within, with the share `p`.
fn worn_spring(k: f64, m0: f64, p: f64) -> impl FnMut(&Sample) -> f64 {
    let mut farthest = 0.0;
    move |&(_, y, _, _)| {
        farthest = y.abs().max(farthest);
        let secant = k * m0 / (m0 + farthest);
        secant * ((1.0 - p) * y + p * y * y.abs() / farthest)
    }
}

#[test]
fn a_spring_that_degrades_is_named() {
    let trace = traced(NOISE, 34, || worn_spring(1.5, 0.07, 0.0));
    let truth = [("stiffness", 1.5, 0.05), ("softening", 0.07, 0.1)];
    is_found(&trace, "degradation", &truth);
    assert_eq!(trace.result.effects[0].parameters.get("slip_limit"), None);
}

#[test]
fn a_spring_that_degrades_and_pinches_is_named() {
    let trace = traced(NOISE, 35, || worn_spring(1.5, 0.07, 0.6));
    let truth = [
        ("stiffness", 1.5, 0.05),
        ("softening", 0.07, 0.1),
        ("pinching", 0.6, 0.1),
    ];
    is_found(&trace, "degradation", &truth);
}

/// The slider's place is stored, and its dissipated energy is summed on the way from sample to sample, in tenths.
fn worn_slider(k: f64, x: f64, d: f64, e0: f64) -> impl FnMut(&Sample) -> f64 {
    let (mut energy, mut begun) = (0.0, None);
    move |&(_, y, _, _)| {
        // The place of the damper, and that of the slider.
        let (from, mut slider): (f64, f64) = begun.unwrap_or((y, y));
        for part in 1..=10 {
            let y = from + (y - from) * f64::from(part) / 10.0;
            let slid = slider.clamp(y - x, y + x);
            energy += k * x * (1.0 - d * energy / (energy + e0)) * (slid - slider).abs();
            slider = slid;
        }
        begun = Some((y, slider));
        k * (y - slider) * (1.0 - d * energy / (energy + e0))
    }
}

#[test]
fn a_slider_that_weakens_is_named() {
    let trace = traced(NOISE, 36, || worn_slider(1.5, 0.03, 0.7, 0.1));
    let truth = [
        ("stiffness", 1.5, 0.05),
        ("slip_limit", 0.03, 0.05),
        ("loss", 0.7, 0.1),
        ("energy", 0.1, 0.2),
    ];
    is_found(&trace, "degradation", &truth);
}

/// A slider that does not weaken keeps its name, and so does one without a play.
#[test]
fn a_slider_that_does_not_wear_is_a_slider() {
    for seed in [37, 38] {
        let trace = traced(NOISE, seed, || backlash(0.9, 0.04, 0.0));
        is_found(
            &trace,
            "stick_slip",
            &[("stiffness", 0.9, 0.05), ("slip_limit", 0.04, 0.05)],
        );
    }
}
