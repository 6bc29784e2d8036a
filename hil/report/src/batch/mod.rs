//! One page for a batch of traces: how often each result occurred, and each trace with a link to its own report.

mod groups;
mod pictures;
mod row;
mod traces;

use maud::{Markup, html};
use mesh_damper_identify::trace::conclusion::Conclusion;

pub use row::{BatchEffect, BatchOutcome, BatchRow};

use super::html::{Section, figure, page, table};
use super::picture;
use super::text;

/// Sorting and filtering of the traces.
const SCRIPT: &str = include_str!("../script/batch.js");

/// The page for the rows in their order, as one HTML file that needs no other. The links lead to the reports of the traces. It
/// takes about a third of a kilobyte per row.
pub fn batch_page(rows: &[BatchRow]) -> String {
    let failed: Vec<&BatchRow> = rows.iter().filter(|row| row.outcome.is_err()).collect();
    let title = match rows.len() {
        1 => "1 trace".into(),
        count => format!("{count} traces"),
    };
    let elapsed: f64 = rows.iter().map(|row| row.seconds).sum();
    let with_warnings = outcomes(rows)
        .filter(|one| !one.warnings.is_empty())
        .count();
    let first = html! {
        div.verdict {
            p.heading { strong { (counted(rows)) } }
            p { "The traces took " (duration(elapsed)) " in total, one after another." }
            @if with_warnings > 0 {
                p { (with_warnings) " of " (outcomes(rows).count()) " traces have warnings; the table of part 4 has their number and text." }
            }
        }
    };
    let sections = [
        Some(Section::new("1. Verdicts", groups::verdicts(rows))),
        errors(rows),
        groups::effects(rows).map(|body| Section::new("3. Effects", body)),
        traces::table(rows).map(|body| Section::new("4. Traces", body)),
        (!failed.is_empty()).then(|| Section::new("5. Failures", failures(&failed))),
    ];
    let sections: Vec<Section> = sections.into_iter().flatten().collect();
    let last = html! {
        p {
            "Errors are the RMS of the force error divided by the RMS of the measured force, on data that was never fitted: before for \
             the law alone, after for the model. Intervals are 90 % intervals."
        }
    };
    page(&title, first, &sections, last, &[SCRIPT])
}

fn outcomes(rows: &[BatchRow]) -> impl Iterator<Item = &BatchOutcome> + Clone {
    rows.iter().filter_map(|row| row.outcome.as_ref().ok())
}

/// How often each conclusion occurred, without those that did not.
fn counted(rows: &[BatchRow]) -> String {
    let failed = rows.len() - outcomes(rows).count();
    let conclusions = Conclusion::ALL.map(|conclusion| {
        let with = outcomes(rows).filter(|one| one.conclusion == conclusion);
        (with.count(), conclusion.words())
    });
    let all = conclusions.into_iter().chain([(failed, "failed")]);
    let occurred = all.filter(|(count, _)| *count > 0);
    let texts: Vec<String> = occurred
        .map(|(count, word)| format!("{count} {word}"))
        .collect();
    match texts.is_empty() {
        true => "Nothing was traced".into(),
        false => texts.join(", "),
    }
}

fn duration(seconds: f64) -> String {
    match seconds {
        seconds if seconds < 120.0 => format!("{} s", text::number(seconds)),
        seconds if seconds < 7200.0 => format!("{} min", text::number(seconds / 60.0)),
        seconds => format!("{} h", text::number(seconds / 3600.0)),
    }
}

fn errors(rows: &[BatchRow]) -> Option<Section> {
    let picture = pictures::errors(rows)?;
    let limited = outcomes(rows).filter(|one| one.nrmse_after <= NOISE_LIMITED * one.noise);
    let body = html! {
        p {
            (limited.count()) " of " (outcomes(rows).count()) " traces are noise-limited after: their error is within " (NOISE_LIMITED)
            " times the noise."
        }
        (picture::key([&picture], &[]))
        (figure(html! { "error on data that was never fitted, before and after, over the noise of the recording" }, &picture))
    };
    Some(Section::new("2. Errors and noise", body))
}

/// Convention, as in the glossary of the reports: an error within this multiple of the noise is noise-limited.
const NOISE_LIMITED: f64 = 1.5;

fn failures(failed: &[&BatchRow]) -> Markup {
    let head = html! { tr {
        th scope="col" { "trace" } th.text scope="col" { "group" } th.text scope="col" { "error" }
    } };
    let rows = html! {
        @for row in failed {
            @if let Err(message) = &row.outcome {
                tr {
                    th.path scope="row" { (row.id) }
                    td.text { (row.group.as_deref().unwrap_or("–")) }
                    td.text.plain { (message) }
                }
            }
        }
    };
    table("Traces that failed", head, rows)
}

#[cfg(test)]
mod tests;
