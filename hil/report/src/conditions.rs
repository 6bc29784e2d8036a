//! The gain of each effect on each condition that was held out in turn, as a table with colours.

use std::collections::BTreeSet;

use maud::{Markup, html};
use mesh_damper_identify::trace::result::{FoundEffect, HeldCondition, TraceResult};

use super::html::{Section, table};
use super::text;

/// The table, and the conclusion about each effect; `None` if no condition was held out in turn.
pub(crate) fn gains(result: &TraceResult) -> Option<Section> {
    if result.conditions.is_empty() {
        return None;
    }
    let of_all = result.conditions.iter();
    let families: BTreeSet<&String> = of_all.flat_map(|one| one.nrmse_without.keys()).collect();
    let worst = result.conditions.iter();
    let worst = worst.fold(0.0_f64, |most, one| most.max(one.nrmse_with));
    let head = html! { tr {
        th scope="col" { "held out" }
        th scope="col" { "with all" }
        @for family in &families { th scope="col" { "without " (text::name(family)) } }
    } };
    let rows = html! {
        @for condition in &result.conditions {
            tr {
                th.text scope="row" { (held_out(condition)) }
                td style=(shade([230, 159, 0], condition.nrmse_with / worst)) {
                    (text::percent(condition.nrmse_with))
                }
                @for &family in &families {
                    (cell(condition, family))
                }
            }
        }
    };
    let body = html! {
        p {
            "Each condition was held out in turn, and the law was fitted to the others. The first column is the error of the law with all \
             effects on that condition; darker is larger. The other columns are its error without one effect: blue and ▲ where \
             the effect helps, red and ▼ where it harms. Samples count less where the estimated motion is uncertain, so that these errors \
             can be far smaller than in part 6."
        }
        (table("Error of each condition where it was held out, with all effects and without each", head, rows))
        ul { @for effect in result.effects.iter().chain(&result.unconfirmed) { li { (confirmation(effect)) } } }
        @if let Some(residual) = text::residual(result) {
            p { (residual) "." }
        }
    };
    Some(Section::new("What each effect gains", body))
}

fn cell(condition: &HeldCondition, family: &str) -> Markup {
    let Some(&without) = condition.nrmse_without.get(family) else {
        return html! { td { "–" } };
    };
    // The colour is full at a factor of two either way.
    let gained = (without / condition.nrmse_with).log2().clamp(-1.0, 1.0);
    let colour = if gained > 0.0 {
        [33, 102, 172]
    } else {
        [178, 24, 43]
    };
    // A hundredth either way counts as no difference.
    let sign = match gained {
        gained if gained > 0.01 => " ▲",
        gained if gained < -0.01 => " ▼",
        _ => "",
    };
    html! { td style=(shade(colour, gained.abs())) { (text::percent(without)) (sign) } }
}

/// A background between the page's colour and half of a colour, so that letters on it can be read.
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

/// Whether an effect is confirmed, with the reason if not.
pub fn confirmation(effect: &FoundEffect) -> String {
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
