//! The table of all traces, which a script sorts and filters.

use std::collections::BTreeSet;

use maud::{Markup, html};
use mesh_damper_identify::trace::conclusion::Conclusion;

use super::{BatchOutcome, BatchRow, pictures};
use crate::text;

/// Every trace that was made; `None` if there is none.
pub fn table(rows: &[BatchRow]) -> Option<Markup> {
    let done = rows.iter();
    let done = done.filter_map(|row| Some((row, row.outcome.as_ref().ok()?)));
    let done: Vec<(&BatchRow, &BatchOutcome)> = done.collect();
    if done.is_empty() {
        return None;
    }
    let groups: BTreeSet<&str> = rows.iter().filter_map(|row| row.group.as_deref()).collect();
    let choices = |name: &str, all: &[&str]| {
        html! {
            label { (name) " " select data-filter=(name) {
                option value="" { "all" }
                @for one in all { option { (one) } }
            } }
        }
    };
    let groups: Vec<&str> = groups.into_iter().collect();
    // No column if there are no groups.
    let column = (!groups.is_empty()).then_some("group");
    let columns = ["trace"].into_iter().chain(column);
    let others = [
        "verdict",
        "effects",
        "before",
        "after",
        "noise",
        "after over noise",
        "warnings",
        "time, s",
    ];
    let caption = "All traces, in the order of the batch";
    Some(html! {
        div.filters hidden {
            label { "search " input type="search" data-filter="text" placeholder="name, group, effect"; }
            (choices("verdict", &Conclusion::ALL.map(Conclusion::words)))
            @if groups.len() > 1 { (choices("group", &groups)) }
            span.shown role="status" {}
            button type="button" hidden { "show all" }
        }
        div.scroll.tall tabindex="0" role="region" aria-label=(caption) {
            table.traces {
                caption { (caption) }
                thead { tr {
                    @for name in columns.chain(others) {
                        th scope="col" { (name) }
                    }
                } }
                tbody { @for (row, outcome) in done { (line(row, outcome, column.is_some())) } }
            }
        }
    })
}

fn line(row: &BatchRow, outcome: &BatchOutcome, has_groups: bool) -> Markup {
    let is_drawn = pictures::is_drawn(outcome.noise, outcome.nrmse_before, outcome.nrmse_after);
    html! {
        tr data-drawn[is_drawn] {
            th scope="row" title=(row.recordings.join(", ")) {
                @match &outcome.report {
                    Some(report) => a href=(report) { (row.id) },
                    None => (row.id),
                }
            }
            @if has_groups { td { (row.group.as_deref().unwrap_or("–")) } }
            td { (outcome.conclusion.words()) @if !outcome.adopted { ", not adopted" } }
            td { (effects(outcome)) }
            td { (text::percent(outcome.nrmse_before)) }
            td { (text::percent(outcome.nrmse_after)) }
            td { (text::percent(outcome.noise)) }
            td { (text::number(outcome.nrmse_after / outcome.noise)) "×" }
            td title=[(!outcome.warnings.is_empty()).then(|| outcome.warnings.join("\n"))] { (outcome.warnings.len()) }
            td { (text::number(row.seconds)) }
        }
    }
}

/// `stick-slip (slip limit 0.0300 mm, 0.0291 … 0.0312)`
fn effects(outcome: &BatchOutcome) -> String {
    let effects = outcome.effects.iter().map(|effect| {
        let parameters = effect.parameters.iter().map(|(name, one)| {
            let [low, value, high] = text::interval(one.low, one.value, one.high);
            let unit = text::unit(&one.unit);
            let space = if unit.is_empty() { "" } else { " " };
            format!(
                "{} {value}{space}{unit}, {low} … {high}",
                name.replace('_', " ")
            )
        });
        let parameters: Vec<String> = parameters.collect();
        format!("{} ({})", text::name(&effect.family), parameters.join("; "))
    });
    let effects: Vec<String> = effects.collect();
    match effects.is_empty() {
        true => "–".into(),
        false => effects.join("; "),
    }
}
