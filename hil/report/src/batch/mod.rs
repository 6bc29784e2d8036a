//! One page for a batch of traces: what was found how often, and each trace with a link to its own report.

mod row;

use maud::{DOCTYPE, Markup, PreEscaped, html};
use mesh_damper_identify::trace::result::Verdict;

pub use row::{BatchEffect, BatchOutcome, BatchRow};

use super::text;

/// The page as one HTML file that needs no other, of the rows in their order. The links lead to the reports of the traces.
pub fn batch_page(rows: &[BatchRow]) -> String {
    let failed = rows.iter().filter(|row| row.outcome.is_err()).count();
    let title = format!("{} traces", rows.len());
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(include_str!("../style.css"))) }
            }
            body {
                main {
                    h1 { (title) }
                    (counts(rows, failed))
                    (table(rows))
                    @if failed > 0 { (failures(rows)) }
                }
            }
        }
    };
    page.into_string()
}

fn counts(rows: &[BatchRow], failed: usize) -> Markup {
    let of = |verdict: Verdict| {
        let outcomes = rows.iter().filter_map(|row| row.outcome.as_ref().ok());
        outcomes.filter(|one| one.verdict == verdict).count()
    };
    html! {
        section.verdict {
            p {
                (of(Verdict::Found)) " found, " (of(Verdict::None)) " nothing missing, " (of(Verdict::Ambiguous))
                " ambiguous, " (of(Verdict::Unlisted)) " unlisted, " (failed) " failed."
            }
        }
    }
}

fn table(rows: &[BatchRow]) -> Markup {
    html! {
        h2 { "Traces" }
        div.scroll { table {
            thead { tr {
                th scope="col" { "trace" } th.text scope="col" { "group" } th.text scope="col" { "verdict" }
                th.text scope="col" { "effects" } th scope="col" { "before" } th scope="col" { "after" }
                th scope="col" { "noise" } th scope="col" { "time, s" }
            } }
            tbody {
                @for row in rows { @if let Ok(outcome) = &row.outcome { tr {
                    td {
                        @if let Some(report) = &outcome.report { a href=(report) { (row.id) } } @else { (row.id) }
                    }
                    td.text { (row.group.as_deref().unwrap_or_default()) }
                    td.text { (word(outcome.verdict)) }
                    td.text { (effects(outcome)) }
                    td { (text::percent(outcome.nrmse_before)) }
                    td { (text::percent(outcome.nrmse_after)) }
                    td { (text::percent(outcome.noise)) }
                    td { (text::number(row.seconds)) }
                } } }
            }
        } }
    }
}

fn word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::None => "nothing missing",
        Verdict::Found => "found",
        Verdict::Ambiguous => "ambiguous",
        Verdict::Unlisted => "unlisted",
    }
}

fn effects(outcome: &BatchOutcome) -> String {
    let names = outcome.effects.iter().map(|one| text::name(&one.family));
    names.collect::<Vec<_>>().join(", ")
}

fn failures(rows: &[BatchRow]) -> Markup {
    html! {
        h2 { "Failures" }
        ul {
            @for row in rows { @if let Err(message) = &row.outcome { li { strong { (row.id) } ": " (message) } } }
        }
    }
}
