//! The result of a trace in a few lines for the terminal.

use mesh_damper_identify::trace::result::TraceResult;
use mesh_damper_report::conditions;
use mesh_damper_report::text::{interval, law_alone, percent, residual, verdict};

use super::say;

/// Prints the verdict, the effects with their parameters, the error before and after, and warnings.
pub fn print(result: &TraceResult) {
    say(&verdict(result).0);
    for effect in result.effects.iter().chain(&result.unconfirmed) {
        for (name, estimate) in &effect.parameters {
            let [low, value, high] = interval(estimate.low, estimate.value, estimate.high);
            let unit = &estimate.unit;
            say(&format!(
                "  {} {name} = {value} ({low} … {high}) {unit}",
                effect.family
            ));
        }
    }
    for effect in result.effects.iter().chain(&result.unconfirmed) {
        if effect.unconfirmed_by.is_some() {
            say(&format!("  {}", conditions::confirmation(effect)));
        }
    }
    if let Some(residual) = residual(result) {
        say(&residual);
    }
    for fact in result.rig.in_words() {
        say(&format!("Stated: {fact}"));
    }
    let noise = match result.noise_known {
        true => "noise of the recording",
        false => "noise of the recording, at most",
    };
    let before = format!("before: {}", law_alone(&result.baseline));
    say("Error of the force, RMS over RMS            fitted     held out");
    for (what, fitted, held_out) in [
        (
            &before[..],
            Some(result.baseline.nrmse_fitted),
            result.baseline.nrmse_held_out,
        ),
        (
            "after: the augmented model, f64",
            Some(result.augmented.nrmse_fitted),
            result.augmented.nrmse_held_out,
        ),
        (
            "after: the embedded law, f32",
            None,
            result.on_target.nrmse_held_out,
        ),
        (noise, None, result.noise_floor_nrmse),
    ] {
        let fitted = fitted.map(percent).unwrap_or_default();
        say(&format!(
            "  {what:34} {fitted:>12} {:>12}",
            percent(held_out)
        ));
    }
    if let Some(test) = &result.separating_test {
        say(&format!("A test that would decide: {test}"));
    }
    for warning in &result.warnings {
        say(&format!("Note: {warning}"));
    }
}
