//! Why the verdict is what it is, in one screen: the error over the noise, the gain of each effect on conditions held out, its rivals,
//! and the witness.

use maud::{Markup, html};
use mesh_damper_identify::trace::result::{Explainable, FoundEffect, TraceResult, Verdict};
use mesh_damper_identify::trace::rule::Rule;

use super::bars;
use super::html::Section;
use super::text;

/// The gain of an effect over the conditions held out in turn.
struct Gain {
    /// Mean logarithm of the error without it over that with it, and its standard error.
    mean: f64,
    error: f64,
    /// How many conditions it helps on, of how many.
    helps: usize,
    conditions: usize,
}

impl Gain {
    /// `None` if its error without it was not computed on any condition.
    fn of(effect: &FoundEffect, result: &TraceResult) -> Option<Self> {
        let each = result.conditions.iter();
        let logs = each.filter_map(|one| {
            let without = one.nrmse_without.get(&effect.family)?;
            Some((without / one.nrmse_with).ln())
        });
        let logs: Vec<f64> = logs.filter(|log| log.is_finite()).collect();
        let count = logs.len() as f64;
        let mean = logs.iter().sum::<f64>() / count;
        let squares: f64 = logs.iter().map(|log| (log - mean).powi(2)).sum();
        (!logs.is_empty()).then(|| Self {
            mean,
            error: (squares / (count - 1.0).max(1.0) / count).sqrt(),
            helps: logs.iter().filter(|&&log| log > 0.0).count(),
            conditions: logs.len(),
        })
    }
}

/// The part of the error that is saved for a mean logarithm of the errors' ratio.
fn saved(log: f64) -> f64 {
    1.0 - (-log).exp()
}

/// The section; `None` if nothing was searched for, or without noise, the measure of it all.
pub(crate) fn section(result: &TraceResult) -> Option<Section> {
    let noise = result.noise_floor_nrmse;
    if result.candidates.is_empty() || noise <= 0.0 {
        return None;
    }
    let laws = [
        ("law alone", "bar stood", result.baseline.nrmse_held_out),
        ("as written", "bar won", result.augmented.nrmse_held_out),
    ];
    let largest = laws
        .iter()
        .fold(noise, |most, (_, _, error)| most.max(*error));
    let effects = || result.effects.iter().chain(&result.unconfirmed);
    let gains: Vec<(&FoundEffect, Gain)> = effects()
        .filter_map(|effect| Some((effect, Gain::of(effect, result)?)))
        .collect();
    let body = html! {
        div.bars {
            @for (name, class, error) in laws {
                (bars::bar((name, None), (class, error / largest), bars::dotted(noise / largest), &times(error / noise), "noise"))
            }
            @for (effect, gain) in &gains { (gained(effect, gain)) }
            @if let Some(witness) = result.explainable {
                @let (class, state) = if witness.counts() { ("bar refused", "counts") } else { ("bar", "little") };
                (bars::bar(("witness", None), (class, witness.share), bars::dotted(Explainable::least()), &text::percent(witness.share.max(0.0)), state))
            }
        }
        ul {
            li { "Law alone, as written: the error on data that was never fitted, in times the noise, which is the dotted line" @if !result.noise_known { "; the noise is an upper bound" } "." }
            @if gains.is_empty() {
                li { "No effect was tested on conditions held out in turn" (untested(result)) "." }
            } @else {
                li { "Effects: the part of the error that each saves on conditions held out in turn, as a geometric mean with its standard error (thin line), and on how many it helps." }
            }
            @for (effect, _) in &gains {
                @if let Some(rule) = effect.unconfirmed_by { li { (super::conditions::confirmation(effect)) @if rule == Rule::Rivalled { ": the recordings do not decide" } "." } }
            }
            @if let Some(witness) = result.explainable {
                li { "Witness: the part of the residual's variance that a general regressor predicts on " (witness.conditions) " conditions that it was not fitted to. It counts from a tenth, the dotted line, and beyond chance: then the law lacks more than has a name." }
            }
        }
    };
    Some(Section::new("Why this verdict", body))
}

fn untested(result: &TraceResult) -> &'static str {
    match result.verdict == Verdict::Found && result.remainder.is_none() {
        true => ": with it the error is only noise",
        false => "",
    }
}

fn times(ratio: f64) -> String {
    format!("{} ×", text::number(ratio))
}

/// The gain of an effect, with its standard error either way.
fn gained(effect: &FoundEffect, gain: &Gain) -> Markup {
    let class = match effect.unconfirmed_by {
        None => "bar won",
        Some(Rule::Rivalled) => "bar rival",
        Some(_) => "bar refused",
    };
    let whisker = match gain.conditions {
        1 => html! {},
        _ => bars::whisker(saved(gain.mean - gain.error), saved(gain.mean + gain.error)),
    };
    let part = saved(gain.mean);
    let title = text::description(&effect.family);
    bars::bar(
        (&text::name(&effect.family), Some(title)),
        (class, part),
        whisker,
        &format!("{} %", (100.0 * part).round() as i64),
        &format!("{} of {}", gain.helps, gain.conditions),
    )
}
