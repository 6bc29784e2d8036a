//! What each effect gains on each condition that was held out in turn, as a table whose colours say it at a glance.

use std::collections::BTreeSet;

use maud::{Markup, html};
use mesh_damper_identify::trace::result::{FoundEffect, HeldCondition, TraceResult};

use super::text;

/// The table, and what is said of each effect; nothing where no condition was held out in turn.
pub fn gains(result: &TraceResult) -> Markup {
    if result.conditions.is_empty() {
        return html! {};
    }
    let of_all = result.conditions.iter();
    let families: BTreeSet<&String> = of_all.flat_map(|one| one.nrmse_without.keys()).collect();
    let worst = result.conditions.iter();
    let worst = worst.fold(0.0_f64, |most, one| most.max(one.nrmse_with));
    html! {
        h2 { "What each effect gains" }
        p {
            "Each condition was held out in turn, and the law fitted to the others. The first column of errors is what the law with all \
             effects leaves of that condition, the darker the more. The others are what it leaves without one effect: blue where \
             the effect helps, red where it harms."
        }
        div.scroll { table {
            thead { tr {
                th { "held out" }
                th { "with all" }
                @for family in &families { th { "without " (text::name(family)) } }
            } }
            tbody {
                @for condition in &result.conditions {
                    tr {
                        td.text { (held_out(condition)) }
                        td style=(shade([230, 159, 0], condition.nrmse_with / worst)) {
                            (text::percent(condition.nrmse_with))
                        }
                        @for &family in &families {
                            (cell(condition, family))
                        }
                    }
                }
            }
        } }
        ul { @for effect in result.effects.iter().chain(&result.unconfirmed) { li { (said(effect)) } } }
        @if let Some(left) = &result.remainder {
            p { "What is left is " (text::remainder(left)) "." }
        }
    }
}

fn cell(condition: &HeldCondition, family: &str) -> Markup {
    let Some(&without) = condition.nrmse_without.get(family) else {
        return html! { td { "–" } };
    };
    // By a factor of two either way the colour is full.
    let gained = (without / condition.nrmse_with).log2().clamp(-1.0, 1.0);
    let colour = if gained > 0.0 {
        [33, 102, 172]
    } else {
        [178, 24, 43]
    };
    html! { td style=(shade(colour, gained.abs())) { (text::percent(without)) } }
}

/// A background between white and half of a colour, so that black is read on it.
fn shade(colour: [u8; 3], part: f64) -> String {
    let [r, g, b] = colour;
    format!("background: rgba({r},{g},{b},{:.2})", 0.5 * part)
}

/// `press.csv, 5 mm at 3 Hz`, or `ride.csv, 12 s … 24 s`.
pub fn held_out(condition: &HeldCondition) -> String {
    let name = &condition.recording;
    match (condition.amplitude, condition.frequency) {
        (Some(amplitude), Some(frequency)) => format!(
            "{name}, {} mm at {} Hz",
            text::number(amplitude),
            text::number(frequency)
        ),
        _ => {
            let [start, end] = condition.span.map(text::number);
            format!("{name}, {start} s … {end} s")
        }
    }
}

/// Whether an effect is confirmed, and why not.
pub fn said(effect: &FoundEffect) -> String {
    let name = text::name(&effect.family);
    let Some(rule) = effect.unconfirmed_by else {
        return format!("{name} is confirmed");
    };
    let rivals: Vec<String> = effect
        .rivals
        .iter()
        .map(|rival| text::name(rival))
        .collect();
    let rivals = match rivals.as_slice() {
        [] => String::new(),
        some => format!(" ({})", text::listed(some)),
    };
    format!("{name} is not confirmed: {}{rivals}", rule.says())
}
